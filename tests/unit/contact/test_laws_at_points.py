"""Laws of several interfaces, each at its own points."""

from dataclasses import dataclass

import numpy as np
import pytest

from faying.contact.laws import Coulomb, Hard
from faying.contact.laws.unilateral import Unilateral
from faying.contact.laws_at_points import LawsAtPoints
from few_points import ELASTIC, LAWS, PLACES, WEIGHTS, N, joint


@dataclass(frozen=True)
class Curve(Unilateral):
    """Closure as the square root of pressure."""

    name = "curve"
    penalty = 1.0
    proportional = False

    def closure(self, forces, weights):
        root = np.sqrt(np.maximum(forces, 0.0) / weights)
        return root, 0.5 / (np.maximum(root, 1e-3) * weights)

    def pressure_of(self, closure):
        return np.maximum(closure, 0.0) ** 2, 2.0 * np.maximum(closure, 0.0)


@pytest.mark.parametrize("third", [Coulomb(Hard(), 0.2, np.inf), Curve()])
def test_laws_hold_at_their_own_points(third):
    """As each of them says alone; what a law does not have is zero."""
    laws = LAWS | {"three": third}
    plain, _ = joint(0, laws)
    at_points = LawsAtPoints(contact=plain.contact)
    random = np.random.default_rng(1)
    forces = random.normal(size=(3, N))
    closed, compliance = np.zeros((2, 3, N))
    admissible, slope = np.zeros((3, N)), np.zeros((N, 3, 3))
    for name, law in laws.items():
        at, n = PLACES[name], law.components
        closed[:n, at], compliance[:n, at] = law.closure(forces[:n, at], WEIGHTS[at])
        admissible[:n, at] = law.admissible(forces[:n, at])
        slope[at, :n, :n] = law.derivative(forces[:n, at])
    found = at_points.closure(forces)
    np.testing.assert_array_equal(found[0], closed)
    np.testing.assert_array_equal(found[1], compliance)
    np.testing.assert_array_equal(at_points.admissible(forces), admissible)
    np.testing.assert_array_equal(at_points.derivative(forces), slope)
    np.testing.assert_array_equal(at_points.yielded(forces), closed)
    assert found[1][1:, 3].max() == 0.0


def test_laws_respond_at_their_own_points():
    """As each of them says alone, and alone as beside others."""
    at_points = LawsAtPoints(contact=joint(0, ELASTIC)[0].contact)
    moved = np.random.default_rng(2).normal(-0.2, 1.0, (3, N))
    expected, springs = np.zeros((2, 3, N))
    stiffness = np.zeros((N, 3, 3))
    for name, law in ELASTIC.items():
        at, n = PLACES[name], law.components
        expected[:n, at], stiffness[at, :n, :n] = law.respond(moved[:n, at], WEIGHTS[at])
        springs[:n, at] = law.springs(WEIGHTS[at])
        own = LawsAtPoints(contact=joint(0, dict.fromkeys(ELASTIC, law))[0].contact)
        np.testing.assert_array_equal(own.respond(moved)[0][:n, at], expected[:n, at])
    forces, slope = at_points.respond(moved)
    np.testing.assert_array_equal(forces, expected)
    np.testing.assert_array_equal(slope, stiffness)
    np.testing.assert_array_equal(at_points.springs, springs)
