"""A joint with friction described otherwise has the same tractions, along a path that reverses.

Turned by any angle and by a right one, mirrored, renumbered, and under other loads in proportion.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree
from test_same_physics import (
    FORCE,
    MOMENT,
    PRELOAD,
    SHIFT,
    TURN,
    built,
    described,
    load,
    moved,
    renumbered,
)

import faying as fy

FRICTION, PENALTY = 0.15, 1e5
STILL = np.eye(3)
SHARES = [0.5, 2.5, -2.5]


def path(model, turn=STILL, factor=1.0):
    """Tightened with friction, pulled until part of the joint slips, and back."""
    axial = np.linalg.det(turn) * turn  # moments and turns are axial vectors
    loads = [
        fy.Load(),
        *(load(f * turn @ FORCE, f * axial @ MOMENT) for f in factor * np.array(SHARES)),
    ]
    rubbing = model.with_bolt_forces({"bolt": factor * PRELOAD}).with_friction(FRICTION)
    return fy.solve_path(rubbing, loads)


@pytest.fixture(scope="module")
def usual():
    """Places of the contact points, and the path of the joint as it is."""
    model = built(described(PENALTY))
    found = path(model)
    pressed = found.contact_forces > 0
    slip = np.linalg.norm(np.diff(found.slip, axis=0), axis=2)
    slid = (slip > 1e-6 * slip.max()) & pressed[1:]  # above what round-off slips
    # The loads do something: points slip, stick, open and close.
    assert slid.any()
    assert (pressed[1:] & ~slid).any()
    assert (pressed[1:] != pressed[:-1]).any()
    return model.interfaces["joint"].points, found


def assert_same(usual, places, found, back=STILL, factor=1.0):
    """Compare at the same places, in whatever order they come, vectors turned back."""
    points, expected = usual
    distance, order = cKDTree(places).query(points)
    assert distance.max() < 1e-9 * np.ptp(points, axis=0).max()
    # Displacements are some 1e3 times larger than what presses, matrices have conditions of 1e8: a
    # digit or two of sixteen are left over 1e-9.
    small = 1e-9 * expected.pressure.max()
    np.testing.assert_allclose(
        found.pressure[:, order] / factor, expected.pressure, rtol=0, atol=small
    )
    traction = found.traction[:, order] @ back.T / factor
    np.testing.assert_allclose(traction, expected.traction, rtol=0, atol=small)
    np.testing.assert_allclose(
        found.dissipation / factor**2,
        expected.dissipation,
        rtol=0,
        atol=1e-9 * expected.dissipation.max(),
    )


RIGHT = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


@pytest.mark.parametrize(
    "turn", [TURN, RIGHT, np.diag([1.0, -1.0, 1.0]), RIGHT @ np.diag([-1.0, 1.0, 1.0])]
)
def test_turned_moved_and_mirrored(usual, turn):
    joint = described(PENALTY)
    model = built(replace(joint, assembly=moved(joint.assembly, turn, SHIFT)))
    places = (model.interfaces["joint"].points - SHIFT) @ turn
    assert_same(usual, places, path(model, turn), back=turn.T)


def test_renumbered(usual):
    joint = described(PENALTY)
    assembly = renumbered(joint.assembly, np.random.default_rng(8))
    model = built(replace(joint, assembly=assembly))
    assert_same(usual, model.interfaces["joint"].points, path(model))


@pytest.mark.parametrize("factor", [1e-3, 7.0])
def test_loads_in_proportion(usual, factor):
    """Coulomb's law knows no force of its own: all of them grow as the loads do."""
    model = built(described(PENALTY))
    found = path(model, factor=factor)
    assert_same(usual, model.interfaces["joint"].points, found, factor=factor)
