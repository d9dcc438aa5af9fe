"""Line contact after Hertz: a parabolic gap between two large blocks."""

import doctest

import hertz
import numpy as np
import oscillator
import pytest
import spring_gap
from hertz import LineContact, effective_modulus
from pressed_layers import STEEL, pressed_layers

MODULUS = effective_modulus(*[(STEEL.youngs_modulus, STEEL.poissons_ratio)] * 2)
# Load and radius that give a half width of 1 and a peak of 500 MPa.
HERTZ = LineContact(load=250 * np.pi, radius=MODULUS / 1000, modulus=MODULUS)
SIZE = 24.0


def graded(fine, until):
    """Lines at distance ``fine`` up to ``until``, then ever wider up to SIZE."""
    lines, width = list(np.arange(0.0, until + fine / 2, fine)), fine
    while lines[-1] < SIZE:
        width *= 1.25
        lines.append(min(lines[-1] + width, SIZE))
    return np.array(lines)


def solve(fine, penalty="hard"):
    lines = graded(fine, 1.5)
    blocks = pressed_layers(lines, lines, SIZE, element="incompatible", penalty=penalty)
    place = blocks.joint.points[:, 0]
    model = blocks.model.with_initial_gap("joint", HERTZ.initial_gap(place))
    solution = type(blocks)(model).pressed(HERTZ.load)
    return place, blocks.joint.weights, solution


def error(fine, penalty="hard"):
    """Root mean square deviation from Hertz over the contact, relative to the peak."""
    place, weight, solution = solve(fine, penalty)
    deviation = (solution.pressure - HERTZ.pressure(place)) / HERTZ.peak_pressure
    return np.sqrt(weight @ deviation**2 / weight[place < 1].sum())


def test_formulas_are_consistent():
    assert HERTZ.half_width == pytest.approx(1.0)
    assert HERTZ.peak_pressure == pytest.approx(500.0)
    x = np.linspace(-1, 1, 20001)
    # The trapezoidal rule at a square-root edge: (1e-4)^1.5.
    assert np.trapezoid(HERTZ.pressure(x), x) == pytest.approx(HERTZ.load, rel=1e-5)
    assert HERTZ.pressure(np.array([1.5])) == 0


@pytest.mark.parametrize("penalty", ["hard", "auto"])
def test_peak_and_width(penalty):
    place, _, solution = solve(1 / 16, penalty)
    # Blocks 24 half widths large bend the surface by (1/24)² = 0.2 %; the mesh misses less.
    assert solution.max_pressure == pytest.approx(HERTZ.peak_pressure, rel=3e-3)
    pressed = place[solution.pressure > 0].max()
    assert abs(pressed - HERTZ.half_width) <= 1 / 16  # the edge is known to one element


@pytest.mark.long
def test_nodal_pressure_of_hard_contact_converges():
    errors = [error(fine) for fine in (1 / 4, 1 / 8, 1 / 16)]
    # The node where contact ends carries half of its neighbour: first order, measured 0.0955,
    # 0.0470, 0.0237.
    assert errors[0] > 1.8 * errors[1] > 1.8 * 1.8 * errors[2]
    assert errors[2] < 0.03


@pytest.mark.long
def test_pressure_at_gauss_points_converges():
    errors = [error(fine, "auto") for fine in (1 / 4, 1 / 8, 1 / 16)]
    # Measured 0.0047, 0.0035, 0.0030, down to the 0.2 % of the blocks' size.
    assert errors[0] > errors[1] > errors[2]
    assert errors[0] < 0.006
    assert errors[2] < 0.004


def test_contact_carries_the_load():
    _, _, solution = solve(1 / 4)
    # Less what the holding spring of 0.1 N/mm takes.
    assert solution.contact_force() == pytest.approx(HERTZ.load / 2, rel=1e-5)


def solve_apart(fine, penalty, minus):
    """The same on meshes that do not match: elements above are 0.73 times as long."""
    lines, above = graded(fine, 1.5), graded(0.73 * fine, 1.5)
    plus = "body 1" if minus == "body 0" else "body 0"
    blocks = pressed_layers(
        lines, lines, SIZE, element="incompatible", penalty=penalty, upper_x=above, minus=minus,
        plus=plus,
    )  # fmt: skip
    place = blocks.joint.points[:, 0]
    model = blocks.model.with_initial_gap("joint", HERTZ.initial_gap(place))
    return place, blocks.joint.weights, type(blocks)(model).pressed(HERTZ.load)


@pytest.mark.long
@pytest.mark.parametrize("minus", ["body 0", "body 1"])
def test_meshes_that_do_not_match(minus):
    errors = []
    for fine in (1 / 8, 1 / 16):
        place, weight, solution = solve_apart(fine, "auto", minus)
        deviation = (solution.pressure - HERTZ.pressure(place)) / HERTZ.peak_pressure
        errors.append(np.sqrt(weight @ deviation**2 / weight[place < 1].sum()))
        # As on matching meshes; measured 0.7 % at most.
        assert solution.max_pressure == pytest.approx(HERTZ.peak_pressure, rel=1e-2)
        assert solution.contact_force() == pytest.approx(HERTZ.load / 2, rel=1e-5)
    # Measured 0.0047 and 0.0033, or 0.0067 and 0.0041 with the finer side as minus.
    assert errors[1] < 0.8 * errors[0] < 0.8 * 0.008


@pytest.mark.parametrize("minus", ["body 0", "body 1"])
def test_hard_contact_of_meshes_that_do_not_match(minus):
    place, _, solution = solve_apart(1 / 16, "hard", minus)
    assert solution.max_pressure == pytest.approx(HERTZ.peak_pressure, rel=3e-3)
    pressed = place[solution.pressure > 0].max()
    assert abs(pressed - HERTZ.half_width) <= 1 / 16


@pytest.mark.parametrize("module", [hertz, oscillator, spring_gap], ids=lambda one: one.__name__)
def test_closed_forms_give_what_their_examples_say(module):
    result = doctest.testmod(module)
    assert result.attempted > 0
    assert result.failed == 0
