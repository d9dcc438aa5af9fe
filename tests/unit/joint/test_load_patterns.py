"""Loads of a deck as patterns of the free degrees of freedom, and amplitudes among the inputs."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.joint.load_pattern import load_pattern
from faying.joint.system import bolt_input, input_forces
from faying.model.assembly import NodalLoads, Support
from lap_joints import tiny_lap

UP = NodalLoads(nodes=[100], forces=[[0, 0, 7.0, 0, 0, 0]])


@pytest.fixture(scope="module")
def plain():
    return tiny_lap()


def tip(model):
    """Reference node of the coupling at the tip, and the nodes that follow it."""
    coupling = model.assembly.rigid_couplings[0]
    return coupling.reference, coupling.nodes


def one(node, force):
    return NodalLoads(nodes=[node], forces=[force])


def test_a_free_node_takes_its_force(plain):
    free = int(plain.dofs.free[plain.dofs.free % 6 == 2][5]) // 6
    loads = one(free, [1.0, 0, -3.0, 0, 0, 0])
    pattern = plain.with_load_patterns({"push": loads}).load_patterns["push"]
    expected = np.zeros(plain.K.shape[0])
    expected[plain.dofs.index(np.array([free, free]), np.array([0, 2]))] = [1.0, -3.0]
    np.testing.assert_array_equal(pattern.forces, expected)


def test_a_dependent_node_hands_its_force_to_the_node_it_follows(plain):
    """A force on a node of the RBE2 is the same force and its moment at the reference."""
    reference, nodes = tip(plain)
    arm = plain.assembly.mesh.nodes[nodes[0]] - plain.assembly.mesh.nodes[reference]
    force = np.array([2.0, -3.0, 5.0])
    loads = {
        "follower": one(nodes[0], [*force, 0, 0, 0]),
        "reference": one(reference, [*force, *np.cross(arm, force)]),
    }
    found = plain.with_load_patterns(loads).load_patterns
    # Round-off of three products.
    np.testing.assert_allclose(
        found["follower"].forces, found["reference"].forces, rtol=0, atol=1e-13
    )


def test_a_held_component_hands_its_force_to_ground(plain):
    (support, *_) = plain.assembly.supports
    held, free = int(support.nodes[0]), int(tip(plain)[0])
    both = NodalLoads(nodes=[held, free], forces=[[9.0] * 3 + [0] * 3, [1.0] + [0] * 5])
    found = plain.with_load_patterns({"both": both, "free": one(free, [1.0] + [0] * 5)})
    patterns = found.load_patterns
    np.testing.assert_array_equal(patterns["both"].forces, patterns["free"].forces)
    with pytest.raises(ModelError, match="load 'held' moves nothing"):
        plain.with_load_patterns({"held": one(held, [1.0] + [0] * 5)})


def test_loads_of_one_node_add_up(plain):
    twice = NodalLoads(nodes=[UP.nodes[0]] * 2, forces=[[0, 0, 3.0, 0, 0, 0], [0, 0, 4.0, 0, 0, 0]])
    found = plain.with_load_patterns({"once": UP, "twice": twice}).load_patterns
    np.testing.assert_array_equal(found["once"].forces, found["twice"].forces)


@pytest.mark.parametrize(
    ("loads", "message"),
    [
        (one(100, [0, 0, 0, 1.0, 0, 0]), "load 'L' puts Mx on node 101, but nothing there has"),
        (one(100, [np.nan, 0, 0, 0, 0, 0]), "load 'L' holds NaN or infinity"),
        (one(100, [0.0] * 6), "load 'L' moves nothing"),
    ],
)
def test_refuses_loads_on_nothing(plain, loads, message):
    with pytest.raises(ModelError, match=message):
        plain.with_load_patterns({"L": loads})


def test_a_moment_on_a_held_rotation_goes_to_ground(plain):
    """Solids have no rotations, but a deck that holds them says that nothing is lost."""
    held = Support(id=9, nodes=[100], components=(3, 4, 5))
    assembly = replace(plain.assembly, supports=(*plain.assembly.supports, held))
    loads = NodalLoads(nodes=[100], forces=[[1.0, 0, 0, 5.0, 0, 0]])
    pattern = load_pattern("L", loads, assembly, plain.dofs)
    assert pattern.forces.sum() == 1.0


def test_names():
    model = tiny_lap()
    with pytest.raises(ModelError, match=r"'tip\.Fz' is the load Fz on boundary 'tip'"):
        model.with_load_patterns({"tip.Fz": UP})
    with pytest.raises(ModelError, match="no deck load '12'; the deck loads are none"):
        model.with_deck_loads("12")
    loads = {"12": UP, "13": one(100, [1.0] + [0] * 5)}
    assembly = replace(model.assembly, loads=loads)
    of_deck = replace(model, assembly=assembly)
    with pytest.raises(ModelError, match="no deck load '14'; the deck loads are 12, 13"):
        of_deck.with_deck_loads("12", "14")
    assert list(of_deck.with_deck_loads("13").load_patterns) == ["13"]
    assert list(of_deck.with_deck_loads("13").with_deck_loads("12").load_patterns) == ["13", "12"]
    assert of_deck.load_patterns == {}


@pytest.fixture(scope="module")
def loaded(joint):
    return joint.with_load_patterns({"a": UP, "b": one(100, [1.0] + [0] * 5)})


def test_amplitudes_come_last_among_the_inputs(loaded):
    history = fy.History([0.0, 2.0], [0.0, 4.0])
    load = fy.Load({"tip.Fz": -500.0, "b": history, "a": 0.5})
    locked = loaded.bolts["bolt"].initial_force
    inputs = load.inputs(loaded, np.array([0.0, 1.0]))
    np.testing.assert_array_equal(
        inputs,
        [[0, 0, -500.0, 0, 0, 0, locked, 0.5, 0.0], [0, 0, -500.0, 0, 0, 0, locked, 0.5, 2.0]],
    )
    assert bolt_input(loaded, "bolt") == 6
    patterns = loaded.load_patterns
    bare = inputs.copy()
    bare[:, 7:] = 0.0
    expected = input_forces(loaded, bare)
    expected += np.outer(inputs[:, 7], patterns["a"].forces)
    expected += np.outer(inputs[:, 8], patterns["b"].forces)
    # Round-off of one sum.
    np.testing.assert_allclose(
        input_forces(loaded, inputs), expected, rtol=0, atol=1e-13 * np.abs(expected).max()
    )


def test_unknown_keys_name_what_there_is(loaded):
    message = "no boundary load 'c' and no load pattern of that name; .* the load patterns a, b"
    with pytest.raises(ModelError, match=message):
        fy.Load({"c": 1.0}).inputs(loaded, np.zeros(1))
    with pytest.raises(ModelError, match="holds NaN or infinity"):
        fy.Load({"a": np.inf}).inputs(loaded, np.zeros(1))


def test_each_pattern_has_its_shape_in_the_basis(loaded, joint):
    basis, bare = fy.craig_bampton(loaded, normal_modes=4), fy.craig_bampton(joint, normal_modes=4)
    assert [kind.value for kind in basis.kinds[-2:]] == ["load", "load"]
    np.testing.assert_array_equal(basis.vectors[:, :-2], bare.vectors)


def test_what_acts_at_the_boundary_alone_needs_no_shape(joint):
    reference = joint.assembly.rigid_couplings[0].reference
    loads = {"tip": one(reference, [0, 0, 1.0, 0, 0, 0])}
    loaded = joint.with_load_patterns(loads)
    basis = fy.craig_bampton(loaded, normal_modes=4)
    assert "load" not in [kind.value for kind in basis.kinds]
    rom = fy.reduce(loaded, basis, compliance=True)
    found = fy.solve_static(rom, fy.Load({"tip": -300.0}))
    expected = fy.solve_static(rom, fy.Load({"tip.Fz": -300.0}))
    # The two paths differ by round-off of one product.
    np.testing.assert_allclose(
        found.pressure, expected.pressure, rtol=0, atol=1e-11 * expected.max_pressure
    )


def test_a_model_without_patterns_shares_the_ports_of_its_structure(joint, loaded):
    assert joint.port_compliance is joint.structure.port_compliance
    assert loaded.structure is joint.structure
    ports = loaded.port_compliance
    assert (ports.n_pattern, ports.bolts) == (2, slice(6, 7))
    np.testing.assert_array_equal(ports.input_rows[:7, :7], joint.port_compliance.input_rows)
