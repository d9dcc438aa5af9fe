"""A rigid block that friction holds on a plane, pulled through a spring: Coulomb's law by hand.

Until it slips, spring and stuck contact are in series: T = X/(1/k + 1/(c_t A)) for the end of the
spring at X. Beyond, T = μ N in the direction of the pull, and a cycle ±X takes

    D = 4 μ N (X − μ N (1/k + 1/(c_t A))).
"""

from dataclasses import dataclass

import numpy as np
import pytest
from pressed_layers import STEEL
from rubbed_blocks import rubbing, two_bodies

import faying as fy
from faying.exceptions import ModelError
from faying.model.assembly import RigidCoupling, Spring, Support

SIDE, FRICTION, NORMAL, TANGENTIAL = 4.0, 0.2, 1e6, 8e5
PRESSED, SPRING, GROUND, HOLDING = 1000.0, 5e4, 1e4, 1.0
"""Force on the block, the spring it is pulled by, what the end of that hangs on, and a spring under
the block, which contact alone would hold."""
AREA = SIDE**2
CLAMPED = PRESSED / (1 + HOLDING / (NORMAL * AREA))
LIMIT = FRICTION * CLAMPED
TOGETHER = 1 / (1 / SPRING + 1 / (TANGENTIAL * AREA))
DIRECTION = np.array([0.6, 0.8])


def block_on_a_plane(holding=(2,), *, hung=True):
    """Boundaries ``"block"`` and ``"end"``, of the spring it is hung on, or the block alone.

    The plane is a block that is held; springs hold the other along the axes of ``holding``.
    """
    lines, z, middle = np.linspace(0, SIDE, 3), np.array([0.0, 2.0]), SIDE / 2
    ends = [(middle, middle, 0.0)] * (1 + hung)
    mesh, lower, upper = two_bodies(lines, lines, z, z, ends=ends)
    block = len(mesh.nodes) - len(ends)
    boundaries, springs = {"block": block}, [(((block, axis),), HOLDING) for axis in holding]
    if hung:
        boundaries["end"] = end = block + 1
        springs += [(((end, axis),), GROUND) for axis in (0, 1)]
        springs += [(((block, axis), (end, axis)), SPRING) for axis in (0, 1)]
    return rubbing(
        mesh,
        STEEL,
        boundaries=boundaries,
        penalty=NORMAL,
        friction=FRICTION,
        tangential_penalty=TANGENTIAL,
        supports=(
            Support(id=1, nodes=lower, components=(0, 1, 2)),
            Support(id=2, nodes=np.array([block]), components=(3, 4, 5)),
        ),
        rigid_couplings=(RigidCoupling(id=1, reference=block, nodes=upper),),
        springs=tuple(
            Spring(id=number, ends=ends, stiffness=size)
            for number, (ends, size) in enumerate(springs, start=2)
        ),
    )


def test_a_block_that_nothing_else_holds_is_refused_or_held_by_friction():
    """The way it could go is named; weak springs leave holding it to friction."""
    pressed = fy.Load({"block.Fz": -PRESSED})
    for holding, way in (((2, 0), "0.00, 1.00, 0.00"), ((2, 1), "1.00, 0.00, 0.00")):
        with pytest.raises(ModelError, match=rf"can move freely along \({way}\); support it, tie"):
            fy.solve_path(block_on_a_plane(holding, hung=False), [pressed])
    loose = block_on_a_plane(hung=False)
    with pytest.raises(ModelError, match=r"rigid, or fixed, at the contact.* give the stiffness"):
        fy.with_weak_springs(loose)
    loads = [pressed, *(fy.Load(pressed.forces | {"block.Fx": pull}) for pull in (150.0, 150.0))]
    path = fy.solve_path(fy.with_weak_springs(loose, 0.1), loads)
    moved = path.displacement("block")[:, 0]
    # In series with contact that sticks; nine springs of 0.1 beside 1e7 N/mm take 7e-8, and as
    # much is round-off: what the springs alone leave moves 167 mm. Of springs of 1e-2 it is 1e-6.
    assert moved[1] == pytest.approx(150.0 / (TANGENTIAL * AREA), rel=1e-6)
    np.testing.assert_allclose(path.shear_forces[1:].sum(axis=-1)[:, 0], -150.0, rtol=1e-6)
    assert moved[2] == pytest.approx(moved[1], rel=1e-9)


@dataclass(frozen=True)
class Pulled:
    """What holds the block (2,), where the end of the spring is (2,), energy of a cycle."""

    held: np.ndarray
    end: np.ndarray
    energy: float


def pulled(force):
    """Pull obliquely, to and fro; the direction stays, so one increment each is exact."""
    model = block_on_a_plane()
    pressing = {"block.Fz": -PRESSED}
    pulls = [np.zeros(2), *(force * DIRECTION * sign for sign in (1, -1, 1))]
    loads = [fy.Load(pressing | {"end.Fx": x, "end.Fy": y}) for x, y in pulls]
    path = fy.solve_path(model, loads)
    return Pulled(
        held=-path.shear_forces[1].sum(axis=1),
        end=path.displacement("end")[1, :2],
        energy=float(path.dissipation[2:].sum()),
    )


def end_of(force):
    """Return how far the end of the spring goes, and with which force it pulls the block."""
    sticking = force * TOGETHER / (GROUND + TOGETHER)
    held = min(sticking, LIMIT)
    return (force - held) / GROUND, held


@pytest.mark.parametrize("force", [60.0, 230.0, 500.0])
def test_force_and_energy(force):
    found, (moved, held) = pulled(force), end_of(force)
    assert (held < LIMIT) == (force < 240.0)
    energy = 4 * LIMIT * max(moved - LIMIT / TOGETHER, 0.0)
    # Round-off: the block is rigid, and nothing is discretized.
    np.testing.assert_allclose(found.held, held * DIRECTION, rtol=1e-9)
    np.testing.assert_allclose(found.end, moved * DIRECTION, rtol=1e-9)
    assert found.energy == pytest.approx(energy, rel=1e-9, abs=1e-12)
