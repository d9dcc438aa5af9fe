"""Where paths, cycles and transients begin: at states of any joint with the same interfaces."""

import numpy as np
import pytest

import faying as fy
from faying.assessment.slip import slip_states
from faying.exceptions import ModelError
from faying.model.assembly import NodalLoads

SIZES = {"element_size": 10.0, "hole_radius": 0.0, "washer_radius": 11.0}
PUSH = fy.Load({"push": 1.0})
SHEAR = [fy.Load({"tip.Fx": 900.0})]


def tight(**sizes):
    joint = fy.lap_joint(**{**SIZES, **sizes}).with_bolt_forces({"bolt": 8e3})
    return joint.with_friction(0.2)


@pytest.fixture(scope="module")
def plain():
    return tight()


@pytest.fixture(scope="module")
def pushed(plain):
    middle = np.array([len(plain.assembly.mesh.nodes) // 2])
    forces = np.array([[0, 0, -10.0, 0, 0, 0]])
    return plain.with_load_patterns({"push": NodalLoads(nodes=middle, forces=forces)})


@pytest.fixture(scope="module")
def states(plain, pushed):
    """The same state, of the joint before it had the load, and of the joint itself."""
    return [fy.solve_path(joint, SHEAR) for joint in (plain, pushed)]


ROADS = {
    "path": lambda joint, start: fy.solve_path(joint, [PUSH], initial=start).states,
    "cycles": lambda joint, start: (
        fy.solve_cycles(joint, PUSH, initial=start, amplitude=0.5).energies
    ),
    "transient": lambda joint, start: (
        fy.solve_transient(joint, PUSH, step=1e-5, duration=1e-4, initial=start).states
    ),
    "backbone": lambda joint, start: fy.backbone(joint, 1, [0.1], initial=start).frequency,
    "slip reserve": lambda joint, start: np.array(
        [fy.slip_reserve(joint, PUSH, start, largest=2.0).largest]
    ),
}


@pytest.mark.long
@pytest.mark.parametrize("road", list(ROADS))
def test_a_state_from_before_a_load_was_added_is_that_of_the_joint(road, pushed, states):
    before, itself = (ROADS[road](pushed, start) for start in states)
    # The same increments but for round-off in displacements without contact forces.
    np.testing.assert_allclose(before, itself, rtol=1e-9, atol=1e-9 * np.abs(itself).max())


def test_a_transient_of_a_reduced_model_starts_from_the_full_one(plain, states):
    rom = fy.reduce(plain, fy.craig_bampton(plain, normal_modes=4), compliance=True)
    began = fy.solve_transient(rom, SHEAR[0], step=1e-5, duration=1e-5, initial=states[0])
    # Statics of a basis with compliance are exact, and its contact is solved to 1e-10.
    there, ours = states[0].displacement("tip")[-1], began.displacement("tip")[0]
    np.testing.assert_allclose(ours, there, rtol=0, atol=1e-7 * np.abs(there).max())


@pytest.fixture(scope="module")
def other():
    """Of as many points in other places."""
    return fy.solve_path(tight(overlap=44.0), SHEAR)


@pytest.mark.parametrize("road", list(ROADS))
def test_a_state_of_another_mesh_is_refused(road, pushed, other):
    assert other.contact_forces.shape[1] == pushed.contact.n_points
    with pytest.raises(ModelError, match="is of another joint: its contact points of interface"):
        ROADS[road](pushed, other)


def test_frequencies_and_slip_about_a_state_of_another_mesh_are_refused(pushed, states, other):
    with pytest.raises(ModelError, match="is of another joint"):
        fy.preloaded_frequencies(pushed, 2, state=other)
    with pytest.raises(ModelError, match="is of another joint"):
        slip_states(states[1], other)


def test_a_state_under_a_load_that_the_joint_lacks_is_refused(plain, pushed):
    state = fy.solve_path(pushed, [PUSH])
    with pytest.raises(ModelError, match="carries load pattern 'push', which the joint does not"):
        fy.solve_path(plain, SHEAR, initial=state)
    # At rest it carries nothing of it.
    rest = fy.solve_path(pushed, [fy.Load()])
    assert fy.solve_path(plain, SHEAR, initial=rest).contact_forces.any()


def test_without_friction_shear_has_as_many_components_as_contact(joint):
    path, n_point = fy.solve_path(joint, 2 * SHEAR), joint.contact.n_points
    assert path.shear_forces.shape == path.shear_slip.shape == (2, 0, n_point)
    assert fy.solve_static_newton(joint).shear_forces.shape == (0, n_point)
    assert path.slip.shape == (2, n_point, 3)
    assert not path.traction.any()
    assert not slip_states(path).slip_of_closed.any()
