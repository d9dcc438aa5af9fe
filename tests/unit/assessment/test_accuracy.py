"""Errors in the seed's measure, Eq. (15.31)."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError

LOAD = fy.Load({"tip.Fz": -500.0})


@pytest.fixture(scope="module")
def reference(joint):
    return fy.solve_static(joint, LOAD)


def test_relative_error_is_over_the_largest_reference():
    error = fy.relative_error(np.array([1.0, 5.0, 0.0]), np.array([0.0, 4.0, 2.0]))
    np.testing.assert_array_equal(error, [0.25, 0.25, -0.5])


def test_largest_pressure_is_over_all_instants():
    error = fy.relative_error(np.array([[1.0], [3.0]]), np.array([[2.0], [4.0]]))
    np.testing.assert_array_equal(error, [[-0.25], [-0.25]])


def test_a_solution_equals_itself(reference):
    accuracy = fy.compare(reference, reference)
    assert accuracy.max_relative_error == accuracy.rms_relative_error == 0
    assert accuracy.p999_relative_error == accuracy.displacement_error == 0
    assert accuracy.max_pressure_ratio == 1


def test_figures_of_a_known_difference(reference):
    changed = reference.contact_forces.copy()
    place = int(np.argmax(reference.pressure))
    changed[place] *= 1.5
    other = replace(reference, contact_forces=changed, states=1.1 * reference.states)
    accuracy = fy.compare(other, reference)
    n = len(changed)
    assert accuracy.max_relative_error == pytest.approx(0.5)
    assert accuracy.rms_relative_error == pytest.approx(0.5 / np.sqrt(n))
    # One of n errors: the percentile interpolates between it and zero.
    assert accuracy.p999_relative_error == pytest.approx(0.5 * (1 - 0.001 * (n - 1)))
    assert accuracy.max_pressure_ratio == pytest.approx(1.5)
    assert accuracy.displacement_error == pytest.approx(0.1)


def test_rotations_do_not_count_as_displacements(reference, joint):
    changed = reference.states.copy()
    changed[joint.boundaries["tip"].dofs[3:]] += 1.0
    assert fy.compare(replace(reference, states=changed), reference).displacement_error == 0


def test_boundary_that_only_turns_is_judged_by_its_rotation(reference, joint):
    """Its translations are round-off, and so is their difference."""
    tip = joint.boundaries["tip"].dofs
    turned, other = reference.states.copy(), reference.states.copy()
    turned[tip], other[tip] = 0.0, 0.0
    turned[tip[3:]] = other[tip[3:]] = 1e-3
    turned[tip[:3]], other[tip[:3]] = 1e-15, -4e-15
    small = replace(reference, states=turned)
    assert fy.compare(replace(reference, states=other), small).displacement_error == 0
    other[tip[4]] = 1.2e-3
    # 0.2e-3 about one of three axes, about each of which it turns by 1e-3.
    error = fy.compare(replace(reference, states=other), small).displacement_error
    assert error == pytest.approx(0.2 / np.sqrt(3), rel=1e-12)
    # A translation of a thousandth of the rotation is one.
    turned[tip[0]], other[tip[0]] = 1e-6, 2e-6
    small = replace(reference, states=turned)
    error = fy.compare(replace(reference, states=other), small).displacement_error
    assert error == pytest.approx(1.0)


def test_displacement_error_is_over_the_boundary_that_moves_most(reference, joint):
    """A held boundary next to one that moves has round-off only."""
    still = replace(joint.boundaries["tip"], name="still", dofs=joint.boundaries["tip"].dofs[:3])
    still = replace(still, nodes=still.nodes[:3], components=still.components[:3])
    moving = replace(joint.boundaries["tip"], dofs=np.arange(3), nodes=still.nodes)
    moving = replace(moving, components=still.components)
    system = replace(joint, boundaries={"still": still, "moving": moving})
    states, others = np.zeros_like(reference.states), np.zeros_like(reference.states)
    states[still.dofs], others[still.dofs] = 1e-15, -4e-15
    states[:3], others[:3] = 1.0, 1.1
    one = replace(reference, system=system, states=states)
    assert fy.compare(replace(one, states=others), one).displacement_error == pytest.approx(0.1)


def test_boundary_that_only_turns_counts_beside_one_that_moves(reference, joint):
    """Rotations of a held one are round-off of those of the other."""
    tip = joint.boundaries["tip"]
    turning = replace(tip, name="turning", dofs=tip.dofs[3:])
    turning = replace(turning, nodes=tip.nodes[3:], components=tip.components[3:])
    moving = replace(tip, dofs=np.arange(3), nodes=tip.nodes[:3], components=tip.components[:3])
    system = replace(joint, boundaries={"turning": turning, "moving": moving})
    states = np.zeros_like(reference.states)
    states[:3], states[turning.dofs] = 1.0, 1e-3
    others = 1.1 * states
    others[turning.dofs] = 1.3e-3
    one = replace(reference, system=system, states=states)
    assert fy.compare(replace(one, states=others), one).displacement_error == pytest.approx(0.3)
    states, others = states.copy(), others.copy()
    states[turning.dofs], others[turning.dofs] = 1e-12, -4e-12
    one = replace(one, states=states)
    assert fy.compare(replace(one, states=others), one).displacement_error == pytest.approx(0.1)


def test_transients_compare_over_all_instants(joint):
    coarse, fine = (
        fy.solve_transient(joint, LOAD, step=1e-4, duration=5e-4, integrator=scheme)
        for scheme in (fy.ImplicitEuler(), fy.GeneralizedAlpha(0.8))
    )
    accuracy = fy.compare(coarse, fine)
    largest = np.abs(coarse.pressure - fine.pressure).max() / fine.pressure.max()
    assert accuracy.max_relative_error == pytest.approx(largest)
    assert accuracy.rms_relative_error < accuracy.p999_relative_error <= largest


def test_gaps_that_stay_open_are_equal(reference):
    """Without any pressure there is nothing to be wrong by."""
    open_ = replace(reference, contact_forces=np.zeros_like(reference.contact_forces))
    accuracy = fy.compare(open_, open_)
    assert accuracy.max_relative_error == accuracy.rms_relative_error == 0
    assert accuracy.max_pressure_ratio == 1


def test_refuses_what_does_not_compare(reference, joint):
    with pytest.raises(ModelError, match="cannot be compared; solve the same load case"):
        fy.relative_error(np.zeros(3), np.ones(4))
    with pytest.raises(ModelError, match="no contact pressure"):
        fy.relative_error(np.ones(3), np.zeros(3))
    motion = fy.solve_transient(joint, LOAD, step=1e-4, duration=2e-4)
    with pytest.raises(ModelError, match="cannot be compared"):
        fy.compare(motion, reference)
