"""What must hold for every interface: invariance to place, numbering and the order of elements."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from faying.contact.laws import normal_law
from faying.interface.pairing import find_interfaces
from faying.interface.penalty import automatic_penalty
from faying.interface.zero_thickness import build_interface
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.dofs import DofMap
from faying.model.specs import InterfaceSpec

AUTO = InterfaceSpec(name="joint")

# Keeps coordinates off the halves at which sorting by rounded values would depend on rounding.
OFF_GRID = 1.234e-7

JOINTS = {
    (shape, curvature): lap_joint_assembly(
        element_size=10.0, shape=shape, curvature=curvature, hole_radius=None, washer_radius=9.0
    ).assembly
    for shape in ("hex8", "hex20", "tet4", "tet10", "wedge6", "wedge15")
    for curvature in (0.0, 2e-3)
}
joints = st.sampled_from(sorted(JOINTS))
rules = st.sampled_from(["gauss", "nodal"])
seeds = st.integers(0, 2**32 - 1)


def build(assembly, quadrature):
    spec = replace(AUTO, quadrature=quadrature)
    (faces,) = find_interfaces(assembly, spec).values()
    size = 6 * len(assembly.mesh.nodes)
    dofs = DofMap(transformation=sp.eye_array(size, format="csr"), free=np.arange(size))
    return build_interface(
        assembly, dofs, spec, faces, normal_law(automatic_penalty(assembly, faces))
    )


def gaps(joint, field):
    return joint.gap_operator @ np.hstack([field, np.zeros_like(field)]).ravel()


@settings(max_examples=25)
@given(joints, rules, seeds)
def test_rotating_and_moving_everything_changes_no_gap(which, quadrature, seed):
    random = np.random.default_rng(seed)
    assembly = JOINTS[which]
    turn = Rotation.random(rng=random).as_matrix()
    nodes = assembly.mesh.nodes @ turn.T + random.uniform(-100, 100, 3)
    moved = replace(assembly, mesh=replace(assembly.mesh, nodes=nodes))
    here, there = build(assembly, quadrature), build(moved, quadrature)
    field = random.normal(size=nodes.shape)
    # Coordinates of 200 mm round at 3e-14, normals of 10 mm facets at 1e-14.
    np.testing.assert_allclose(gaps(there, field @ turn.T), gaps(here, field), atol=1e-12)
    np.testing.assert_allclose(there.initial_gap, 0, atol=1e-12)
    np.testing.assert_allclose(there.weights, here.weights, rtol=1e-12)
    np.testing.assert_allclose(there.normals, here.normals @ turn.T, atol=1e-13)
    assert there.penalty == pytest.approx(here.penalty, rel=1e-12)


@settings(max_examples=25)
@given(joints, rules, seeds)
def test_renumbering_nodes_and_elements_changes_no_gap(which, quadrature, seed):
    random = np.random.default_rng(seed)
    assembly = JOINTS[which]
    mesh = assembly.mesh
    place = random.permutation(len(mesh.nodes))
    order = np.argsort(place)
    (block,) = mesh.blocks
    rows = random.permutation(len(block.ids))
    shuffled = replace(
        block,
        nodes=place[block.nodes[rows]],
        ids=block.ids[rows],
        properties=block.properties[rows],
    )
    renumbered = replace(
        assembly,
        mesh=replace(
            mesh, nodes=mesh.nodes[order], node_ids=mesh.node_ids[order], blocks=(shuffled,),
            node_sets={},
        ),
    )  # fmt: skip
    before, after = build(assembly, quadrature), build(renumbered, quadrature)
    field = random.normal(size=mesh.nodes.shape)
    by_place = [np.lexsort(np.round(joint.points + OFF_GRID, 6).T) for joint in (before, after)]
    for name in ("points", "weights", "normals"):
        one, other = (getattr(j, name)[o] for j, o in zip((before, after), by_place, strict=True))
        # Facets may begin at another corner: rounding of 20 mm.
        np.testing.assert_allclose(other, one, atol=1e-12)
    np.testing.assert_allclose(
        gaps(after, field[order])[by_place[1]], gaps(before, field)[by_place[0]], atol=1e-12
    )
    assert after.penalty == pytest.approx(before.penalty, rel=1e-12)


@settings(max_examples=25)
@given(joints, rules, seeds)
def test_swapping_the_sides_keeps_every_gap(which, quadrature, seed):
    """n and u⁺ - u⁻ both change sign."""
    assembly = JOINTS[which]
    size = 6 * len(assembly.mesh.nodes)
    dofs = DofMap(transformation=sp.eye_array(size, format="csr"), free=np.arange(size))
    field = np.random.default_rng(seed).normal(size=assembly.mesh.nodes.shape)
    found = []
    for minus, plus in (("lower", "upper"), ("upper", "lower")):
        spec = replace(AUTO, minus=minus, plus=plus, quadrature=quadrature)
        (faces,) = find_interfaces(assembly, spec).values()
        joint = build_interface(assembly, dofs, spec, faces, normal_law(1.0))
        found.append(gaps(joint, field)[np.lexsort(np.round(joint.points + OFF_GRID, 6).T)])
    np.testing.assert_allclose(found[1], found[0], atol=1e-12)
