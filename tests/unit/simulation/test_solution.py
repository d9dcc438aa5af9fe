"""What a solution tells about itself."""

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError

LOAD = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")


@pytest.fixture(scope="module")
def static(joint):
    return fy.solve_static(joint, LOAD)


@pytest.fixture(scope="module")
def motion(joint):
    return fy.solve_transient(joint, LOAD, step=1e-4, duration=5e-4)


def test_shapes(static, motion, joint):
    n_dof, n_point = joint.K.shape[0], joint.contact.n_points
    assert static.states.shape == (n_dof,)
    assert static.pressure.shape == static.gap.shape == (n_point,)
    assert static.inputs.shape == (7,)
    assert static.times is None
    assert (
        motion.states.shape == motion.velocities.shape == motion.accelerations.shape == (6, n_dof)
    )
    assert motion.pressure.shape == motion.gap.shape == (6, n_point)
    assert motion.iterations.shape == motion.max_pressure.shape == (6,)
    assert motion.displacement("tip").shape == (6, 6)
    assert motion.bolt_force("bolt").shape == (6,)
    assert motion.open_fraction().shape == (6,)


def test_name_is_that_of_the_load(static, motion):
    assert static.name == motion.name == "LC2"


def test_first_instant_is_the_preload(motion, joint):
    start = fy.solve_static(joint)
    np.testing.assert_array_equal(motion.pressure[0], start.pressure)
    np.testing.assert_array_equal(motion.states[0], start.states)
    np.testing.assert_array_equal(motion.inputs[0], start.inputs)
    assert motion.times[0] == 0


def test_pressure_is_force_over_area(static, joint):
    np.testing.assert_array_equal(static.pressure, static.contact_forces / joint.contact.weights)
    assert static.max_pressure == static.pressure.max()
    assert static.contact_force() == static.contact_forces.sum()
    assert static.contact_force("joint") == static.contact_force()


def test_penetration_is_pressure_over_penalty(static, joint):
    expected = static.max_pressure / joint.interfaces["joint"].penalty
    assert static.max_penetration == pytest.approx(expected, rel=1e-6)  # 1e-12 of a gap of 1e-4


def test_open_area_is_where_there_is_no_pressure(static, joint):
    share = joint.contact.weights[static.pressure == 0].sum() / joint.contact.weights.sum()
    assert 0 < share < 1
    assert static.open_fraction() == pytest.approx(share)
    assert (static.gap[static.pressure == 0] >= 0).all()
    assert (static.gap[static.pressure > 0] < 0).all()


def test_bolt_force_is_spring_and_initial_force(static, joint):
    bolt = joint.bolts["bolt"]
    expected = bolt.stiffness * (static.states @ bolt.elongation) + bolt.initial_force
    assert static.bolt_force("bolt") == pytest.approx(expected)


def test_bolt_force_follows_the_inputs(joint):
    load = fy.Load(bolt_forces={"bolt": 2 * joint.bolts["bolt"].initial_force})
    # Without gap contact is homogeneous: twice the initial force is twice everything.
    assert fy.solve_static(joint, load).bolt_force("bolt") == pytest.approx(20e3, rel=1e-9)


def test_displacement_is_at_the_boundary(static, joint):
    place = joint.assembly.mesh.node_index(joint.boundaries["tip"].nodes[:1])
    nodal = joint.dofs.nodal(static.full_displacement())
    np.testing.assert_array_equal(static.displacement("tip"), nodal[place[0]])


def test_two_interfaces_are_told_apart():
    model = fy.preload(
        fy.lap_joint(element_size=5.0, plates=3, tip_suspension=(1e4, 1e7)), {"bolt": 10e3}
    )
    solution = fy.solve_static(model)
    below, above = (solution.contact_force(name) for name in ("joint-1", "joint-2"))
    assert solution.contact_force() == pytest.approx(below + above)
    # The joint is its own mirror image; the clamped outer plates add 1 % by prying.
    assert below == pytest.approx(above, rel=1e-9)
    assert solution.bolt_force("bolt") == pytest.approx(10e3, rel=1e-9)
    assert 10e3 < above < 10.5e3
    assert 0 < solution.open_fraction("joint-1") < 1


def test_reduced_solution_expands_to_the_full_model(joint, classic):
    solution = fy.solve_static(fy.reduce(joint, classic), LOAD)
    assert solution.states.shape == (len(classic),)
    np.testing.assert_allclose(
        solution.full_displacement(), classic.vectors @ solution.states, rtol=1e-12
    )


def test_arrays_cannot_be_changed(static, motion):
    for solution in (static, motion):
        for name in ("states", "contact_forces", "gap", "inputs"):
            with pytest.raises(ValueError, match="read-only"):
                getattr(solution, name)[...] = 0.0


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda s: s.displacement("tap"), "no boundary 'tap'; the boundaries are tip"),
        (lambda s: s.bolt_force("nut"), "no bolt 'nut'; the bolts are bolt"),
        (lambda s: s.contact_force("gap"), "no interface 'gap'; the interfaces are joint"),
        (lambda s: s.open_fraction("gap"), "no interface 'gap'"),
    ],
)
def test_refuses_names_that_are_not_there(ask, message, static):
    with pytest.raises(ModelError, match=message):
        ask(static)


def test_progress_counts_every_step(joint):
    count = []
    fy.solve_transient(joint, LOAD, step=1e-4, duration=5e-4, progress=count.append)
    assert sum(count) == 5
