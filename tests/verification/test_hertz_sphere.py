"""Point contact after Hertz: a paraboloid's gap between two blocks, a quarter by symmetry."""

from functools import cache

import numpy as np
import pytest
from hertz import PointContact, effective_modulus
from pressed_blocks import graded, pressed_blocks
from pressed_layers import STEEL, Layers

import faying as fy

MODULUS = effective_modulus(*[(STEEL.youngs_modulus, STEEL.poissons_ratio)] * 2)
# Load and radius that give a contact radius of 1 and a peak of 500 MPa.
HERTZ = PointContact(load=1000 * np.pi / 3, radius=2 * MODULUS / (500 * np.pi), modulus=MODULUS)
SIZE = 10.0


@cache
def solve(fine, penalty="hard"):
    """Return a quarter of the blocks and its solution."""
    lines = graded(fine, 1.25, SIZE, growth=1.5)
    blocks = pressed_blocks(
        lines, lines, lines, penalty=penalty, gap=lambda x, y: (x**2 + y**2) / (2 * HERTZ.radius)
    )
    return blocks, blocks.pressed(HERTZ.load / 2)  # pressed() takes half of what it is given


def error(fine, penalty="hard"):
    """Root mean square deviation from Hertz over the contact, relative to the peak."""
    blocks, solution = solve(fine, penalty)
    radius = np.hypot(*blocks.joint.points[:, :2].T)
    deviation = (solution.pressure - HERTZ.pressure(radius)) / HERTZ.peak_pressure
    weights = blocks.joint.weights
    return np.sqrt(weights @ deviation**2 / weights[radius < 1].sum())


def test_formulas_are_consistent():
    assert HERTZ.contact_radius == pytest.approx(1.0)
    assert HERTZ.peak_pressure == pytest.approx(500.0)
    r = np.linspace(0, 1, 20001)
    # The trapezoidal rule at a square-root edge: (5e-5)^1.5.
    assert np.trapezoid(2 * np.pi * r * HERTZ.pressure(r), r) == pytest.approx(HERTZ.load, rel=1e-5)


@pytest.mark.parametrize("penalty", ["hard", "auto"])
def test_peak_and_radius(penalty):
    blocks, solution = solve(1 / 4, penalty)
    # Blocks ten radii large bend the surface by (1/10)² = 1 %; measured 0.5 %.
    assert solution.max_pressure == pytest.approx(HERTZ.peak_pressure, rel=1e-2)
    radius = np.hypot(*blocks.joint.points[:, :2].T)
    assert abs(radius[solution.pressure > 0].max() - HERTZ.contact_radius) <= 1 / 4
    # Less what the holding spring of 0.1 N/mm takes.
    assert solution.contact_force() == pytest.approx(HERTZ.load / 4, rel=1e-5)
    basis = fy.craig_bampton(blocks.model, normal_modes=4)
    reduced = Layers(fy.reduce(blocks.model, basis, compliance=True)).pressed(HERTZ.load / 2)
    # Statics are exact, up to what a spring of 0.1 N/mm beside 1e6 leaves of 16 digits.
    np.testing.assert_allclose(reduced.pressure, solution.pressure, atol=5e-4)


@pytest.mark.parametrize("penalty", ["hard", "auto"])
def test_pressures_converge(penalty):
    coarse, fine = error(1 / 2, penalty), error(1 / 4, penalty)
    # Facets cut by the edge of the contact make the first order; measured 0.176 to 0.076 (hard,
    # nodal) and 0.185 to 0.102 (penalty, Gauss).
    assert fine < coarse / 1.6
    assert fine < 0.12
