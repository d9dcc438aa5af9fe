"""An elastic bar that strikes a rigid wall, started from rest.

One end of the bar is held, the other pressed back by a force F and let go. With d = F L/(E A) and
the speed of waves c the bar is unstressed at t = L/c and moves with the speed c d/L as a whole: the
wall is where its free end then is. From there until 2 L/c the wall carries the force F, and the end
stands still; then the bar flies back, and at 3 L/c everything is as at the start. (Superposition of
waves: K. F. Graff, Wave Motion in Elastic Solids, Oxford 1975, §2.4.)
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

import faying as fy
from small_system import small_system

LENGTH, STIFFNESS, MASS, FORCE = 1.0, 1.0, 1.0, 0.01
"""Of the whole bar: E A/L and ρ A L. The speed of waves is then one."""


@dataclass(frozen=True)
class Impact:
    """What the wall felt, over three times L/c.

    ``impulse`` is exact at F L/c, ``displacement`` the root mean square error of the free end over
    d, ``kept`` the energy at the end over that at the start.
    """

    impulse: float
    displacement: float
    kept: float


def bar(n):
    """n linear elements, held at one end, before a wall at the other."""
    K, M = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    for i in range(n):
        own = np.ix_([i, i + 1], [i, i + 1])
        K[own] += n * STIFFNESS * np.array([[1, -1], [-1, 1]])
        M[own] += MASS / n / 6 * np.array([[2, 1], [1, 2]])
    G = np.zeros((1, n))
    G[0, -1] = -1.0  # the gap closes as the end moves out
    held = slice(1, None)
    return small_system(
        M[held, held], np.zeros((n, n)), K[held, held], G, gap=0.0, stiffness=np.inf, loaded=n - 1
    )


def exact_end(times):
    """Displacement of the free end over d."""
    return np.interp(times, [0, 1, 2, 3], [-1, 0, 0, -1])


@cache
def struck(n, scheme, steps_per_element=2):
    system = bar(n)
    pressed = fy.solve_static(system, fy.Load({"mass.Fx": -FORCE}))
    step = 1.0 / n / steps_per_element
    motion = fy.solve_transient(
        system, fy.Load(), step=step, duration=3.0, integrator=scheme, initial=pressed
    )
    distance = FORCE * LENGTH / STIFFNESS
    end = motion.states[:, -1] / distance
    energy = [
        0.5 * v @ system.M @ v + 0.5 * u @ system.K @ u
        for u, v in zip(motion.states[[0, -1]], motion.velocities[[0, -1]], strict=True)
    ]
    return Impact(
        impulse=float(np.trapezoid(motion.contact_forces[:, 0], motion.times) / FORCE),
        displacement=float(np.sqrt(np.mean((end - exact_end(motion.times)) ** 2))),
        kept=energy[1] / energy[0],
    )


SCHEMES = {"euler": fy.ImplicitEuler(), "decaying": fy.EnergyDecaying(0.8)}


@pytest.mark.parametrize(
    ("scheme", "impulse", "displacement", "kept"),
    # Measured with 80 elements: 0.911, 0.053, 0.733 and 0.989, 0.0063, 0.993.
    [("euler", 0.1, 0.06, 0.7), ("decaying", 0.02, 0.01, 0.99)],
)
def test_the_wall_feels_the_bar(scheme, impulse, displacement, kept):
    found = struck(80, SCHEMES[scheme])
    assert found.impulse == pytest.approx(1.0, abs=impulse)
    assert found.displacement < displacement
    assert kept < found.kept <= 1.0 + 1e-12  # neither scheme gains energy


@pytest.mark.parametrize("scheme", SCHEMES)
def test_finer_bars_come_nearer(scheme):
    errors = [struck(n, SCHEMES[scheme]).displacement for n in (20, 40, 80)]
    # A front that jumps is smeared over ever fewer elements: an order of a half at least.
    assert errors[0] > 1.3 * errors[1] > 1.3**2 * errors[2]


def test_the_bar_returns_to_its_start():
    assert exact_end(np.array([0.0, 0.5, 1.5, 2.5, 3.0])).tolist() == [-1, -0.5, 0, -0.5, -1]
    motion = fy.solve_transient(
        bar(40),
        fy.Load(),
        step=1 / 80,
        duration=3.0,
        integrator=SCHEMES["decaying"],
        initial=fy.solve_static(bar(40), fy.Load({"mass.Fx": -FORCE})),
    )
    closed = motion.times[motion.contact_forces[:, 0] > 0]
    # The fronts are a few elements of 1/40 wide.
    assert closed.min() == pytest.approx(1.0, abs=0.05)
    assert closed.max() == pytest.approx(2.0, abs=0.15)
    middle = (motion.times > 1.3) & (motion.times < 1.7)
    # Behind the front the force swings about its value, as the mesh does not resolve a jump.
    assert motion.contact_forces[middle, 0].mean() == pytest.approx(FORCE, rel=0.02)
