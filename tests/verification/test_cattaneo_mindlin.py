"""Cylinders pressed together and pushed sideways: a stick zone inside a ring of slip.

Cattaneo 1938 and Mindlin 1949, after K. L. Johnson, Contact Mechanics, Cambridge 1985, §7.2: bodies
of one material, pressed by P and pushed by Q < μ P, stick within c and slip between c and a,

    c/a = √(1 − Q/(μP)),    q = μ p₀ (√(1 − x²/a²) − (c/a) √(1 − x²/c²)).
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from hertz import LineContact, effective_modulus
from pressed_blocks import graded
from pressed_layers import HOLDING_SPRING, STEEL
from rubbed_blocks import rubbing, two_bodies

import faying as fy
from faying.assessment.slip import STICK, slip_states
from faying.model.assembly import RigidCoupling, Spring, Support

FRICTION, SHARE = 0.2, 0.5
MODULUS = effective_modulus(*[(STEEL.youngs_modulus, STEEL.poissons_ratio)] * 2)
# Load and radius that give a half width of 1 and a peak of 500 MPa.
HERTZ = LineContact(load=250 * np.pi, radius=MODULUS / 1000, modulus=MODULUS)
PUSH = SHARE * FRICTION * HERTZ.load
STICKS = float(np.sqrt(1 - SHARE))
SIZE, THICK = 24.0, 1.0


def traction(x):
    """q of the formula above, at any x."""
    inner = np.sqrt(np.maximum(1 - np.square(x / STICKS), 0))
    outer = np.sqrt(np.maximum(1 - np.square(x), 0))
    return FRICTION * HERTZ.peak_pressure * (outer - STICKS * inner)


def energy():
    """Energy of a cycle ±Q, 8 ∫ μ p s from c to a, with Johnson's slip s of the ring."""
    x = np.linspace(STICKS, 1, 200_001)
    peak = FRICTION * HERTZ.peak_pressure
    slip = x * np.sqrt(x**2 - STICKS**2) - STICKS**2 * np.arccosh(x / STICKS)
    pressed = FRICTION * HERTZ.pressure(x)
    return float(8 * np.trapezoid(pressed * slip * peak / MODULUS, x))


@dataclass(frozen=True)
class Pushed:
    """What the joint does under Q, and in the cycle that follows."""

    place: np.ndarray
    weights: np.ndarray
    pressure: np.ndarray
    traction: np.ndarray
    sticks: np.ndarray
    energy: float

    @property
    def half_width(self):
        """Half the width of what sticks."""
        return float(self.weights[self.sticks].sum() / THICK / 2)

    @property
    def traction_error(self):
        """Root mean square over the contact, over μ p₀."""
        wrong = (self.traction - traction(self.place)) / (FRICTION * HERTZ.peak_pressure)
        inside = np.abs(self.place) < 1
        return float(np.sqrt(self.weights @ wrong**2 / self.weights[inside].sum()))


@cache
def pushed(fine, penalty="auto"):
    """Blocks 24 half widths large, neither of whose far faces turns."""
    half = graded(fine, 1.5, SIZE)
    lines, y = np.concatenate([-half[:0:-1], half]), np.array([0.0, THICK])
    mesh, lower, upper = two_bodies(lines, y, half, half, ends=[(0.0, THICK / 2, SIZE)])
    top, z = len(mesh.nodes) - 1, mesh.nodes[:, 2]
    model = rubbing(
        mesh,
        STEEL,
        boundaries={"top": top},
        penalty=penalty,
        friction=FRICTION,
        tangential_penalty="auto",
        supports=(
            Support(id=1, nodes=np.arange(top), components=(1,)),
            Support(id=2, nodes=lower[z[lower] == -SIZE], components=(0, 2)),
            Support(id=3, nodes=np.array([top]), components=(1, 3, 4, 5)),
        ),
        rigid_couplings=(
            RigidCoupling(id=1, reference=top, nodes=upper[z[upper] == SIZE], components=(0, 2)),
        ),
        springs=tuple(
            Spring(id=2 + at, ends=((top, at),), stiffness=HOLDING_SPRING) for at in (0, 2)
        ),
    )
    place = model.interfaces["joint"].points[:, 0]
    model = model.with_initial_gap("joint", HERTZ.initial_gap(place))
    # Slip goes one way between reversals and pressures stay, so one increment each is exact.
    loads = [
        fy.Load({"top.Fz": -HERTZ.load, "top.Fx": PUSH * share}) for share in (0.0, 1.0, -1.0, 1.0)
    ]
    path = fy.solve_path(model, loads)
    return Pushed(
        place=place,
        weights=model.contact.weights,
        pressure=path.pressure[1],
        traction=-path.traction[1, :, 0],  # resists the upper body, which is pushed
        sticks=slip_states(path).status[1] == STICK,
        energy=float(path.dissipation[2:].sum()),
    )


def test_formulas_are_consistent():
    x = np.linspace(-1, 1, 200_001)
    # The trapezoidal rule at square-root edges: (1e-5)^1.5.
    assert np.trapezoid(traction(x), x) == pytest.approx(PUSH, rel=1e-6)
    # Another program's table: 0.01254712 at E 210000, ν 0.3, P 1000, R 100. D goes with P²/E*.
    scale = (HERTZ.load / 1000) ** 2 * 115384.61538 / MODULUS
    assert energy() == pytest.approx(0.01254712 * scale, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("penalty", ["auto", "hard"])
def test_stick_zone_traction_and_energy(penalty):
    coarse, fine = pushed(1 / 8, penalty), pushed(1 / 16, penalty)
    # The holding spring takes 1e-5 of the push.
    assert fine.traction @ fine.weights == pytest.approx(PUSH, rel=1e-4)
    for found, element in ((coarse, 1 / 8), (fine, 1 / 16)):
        assert abs(found.half_width - STICKS) < element
    # Elements smear the kink where slip ends. Measured 5.4 and 2.1 %, hard 4.5 and 2.3 %.
    assert fine.traction_error < 0.03
    assert fine.traction_error < 0.6 * coarse.traction_error
    # Measured 4.1 and 2.0 %, hard 4.3 and 2.3 %.
    wrong = [abs(one.energy / energy() - 1) for one in (coarse, fine)]
    assert wrong[1] < 0.03
    assert wrong[1] < 0.6 * wrong[0]


@pytest.mark.slow
@pytest.mark.parametrize("penalty", ["auto", "hard"])
def test_a_finer_mesh(penalty):
    """How far tractions are off depends on where in an element slip ends: auto 0.6 % at 1/24."""
    found = pushed(1 / 32, penalty)
    assert abs(found.half_width - STICKS) < 1 / 32
    assert found.traction_error < 0.02  # measured 1.5 and 1.1 %
    assert abs(found.energy / energy() - 1) < 0.003  # measured 0.14 %
