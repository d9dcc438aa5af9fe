"""Loads become inputs at boundaries and bolts."""

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.joint.system import input_forces
from faying.model.boundary import Boundary


def test_total_is_spread_evenly_over_a_boundary():
    end = Boundary(name="end", nodes=[4, 4, 9, 9], components=[0, 2, 0, 2], dofs=[7, 8, 1, 2])
    np.testing.assert_array_equal(end.pattern("Fz"), [0, 0.5, 0, 0.5])
    np.testing.assert_array_equal(end.pattern("Fx"), [0.5, 0, 0.5, 0])
    with pytest.raises(ModelError, match="takes no load 'Mx'; it has Fx, Fz"):
        end.pattern("Mx")


def test_constant_load_and_locked_bolt(joint):
    inputs = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}).inputs(joint, np.array([0.0, 1.0]))
    locked = joint.bolts["bolt"].initial_force
    expected = [0, 0, -500.0, 20e3, 0, 0, locked]
    np.testing.assert_array_equal(inputs, [expected, expected])


def test_bolt_force_of_the_load_replaces_the_locked_one(joint):
    inputs = fy.Load(bolt_forces={"bolt": 123.0}).inputs(joint, np.zeros(1))
    np.testing.assert_array_equal(inputs, [[0, 0, 0, 0, 0, 0, 123.0]])


def test_history_is_linear_between_samples_and_constant_outside(joint):
    history = fy.History(times=np.array([1.0, 2.0, 4.0]), values=np.array([10.0, 20.0, 0.0]))
    np.testing.assert_array_equal(history.at([0.0, 1.5, 3.0, 9.0]), [10, 15, 10, 0])
    inputs = fy.Load({"tip.Fy": history}).inputs(joint, np.array([0.0, 1.5, 9.0]))
    np.testing.assert_array_equal(inputs[:, 1], [10, 15, 0])


def test_history_keeps_its_own_samples():
    times = np.array([0.0, 1.0])
    history = fy.History(times=times, values=np.array([0.0, 1.0]))
    times[1] = 100.0
    assert history.at(np.array([1.0])) == 1.0
    with pytest.raises(ValueError, match="read-only"):
        history.values[0] = 5.0


@pytest.mark.parametrize(
    ("times", "values", "message"),
    [
        ([0.0, 1.0], [1.0], "one value per time; found 2 times and 1 values"),
        ([], [], "one value per time"),
        ([0.0, 2.0, 2.0], [0.0, 1.0, 2.0], "must increase; sample 2"),
        ([0.0, -1.0], [0.0, 1.0], "must increase; sample 1"),
        ([0.0, np.nan], [0.0, 1.0], "must increase"),
    ],
)
def test_refuses_a_history_that_is_none(times, values, message):
    with pytest.raises(ModelError, match=message):
        fy.History(times=np.array(times), values=np.array(values))


@pytest.mark.parametrize(
    ("load", "message"),
    [
        (fy.Load({"tap.Fz": 1.0}, name="A"), r"load 'A': there is no boundary 'tap'.*are tip"),
        (fy.Load({"tip.Fq": 1.0}), "takes no load 'Fq'; it has Fx, Fy, Fz, Mx, My, Mz"),
        (fy.Load({"Fz": 1.0}), "there is no boundary"),
        (fy.Load(bolt_forces={"nut": 1.0}, name="B"), "load 'B': there is no bolt 'nut'.* bolt"),
        (fy.Load({"tip.Fz": np.nan}, name="C"), "load 'C' holds NaN or infinity"),
        (fy.Load(bolt_forces={"bolt": np.inf}), "holds NaN or infinity"),
    ],
)
def test_refuses_a_load_that_does_not_fit(load, message, joint):
    with pytest.raises(ModelError, match=message):
        load.inputs(joint, np.zeros(1))


def test_inputs_become_forces(joint):
    inputs = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
    force = input_forces(joint, inputs)
    expected = -7.0 * joint.bolts["bolt"].elongation
    expected[joint.boundaries["tip"].dofs] += inputs[:6]
    np.testing.assert_array_equal(force, expected)
    np.testing.assert_array_equal(input_forces(joint, np.stack([inputs, 0 * inputs]))[0], force)


def test_initial_force_pulls_head_and_nut_together(joint):
    """Newton's third law: the pair has no resultant, and tension lifts the nut."""
    force = input_forces(joint, np.array([0, 0, 0, 0, 0, 0, 1.0]))
    node, component = joint.dofs.free // 6, joint.dofs.free % 6
    below = joint.assembly.mesh.nodes[node, 2] < 0
    vertical = np.where(component == 2, force, 0.0)
    assert vertical.sum() == pytest.approx(0.0, abs=1e-14)  # rounding of a sum
    assert vertical[below].sum() == pytest.approx(1.0)
