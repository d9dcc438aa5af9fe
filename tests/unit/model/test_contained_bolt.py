"""Bolts that given matrices contain, and bolts that clamp nothing."""

import re
from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.joint.bolt_pull import misdirected
from faying.joint.lap_joint import lap_joint_assembly
from faying.joint.model import Model
from faying.model.assembly import RigidCoupling, Spring

COARSE = 5.0


@pytest.fixture(scope="module")
def generated() -> Model:
    return fy.lap_joint(element_size=COARSE)


@pytest.fixture(scope="module")
def ends(generated) -> tuple[int, int]:
    """Ids of the head's and the nut's node."""
    nut, head = generated.assembly.mesh.node_ids[list(generated.assembly.beams[0].nodes)].tolist()
    return head, nut


def from_matrices(model: Model, **bolt) -> Model:
    """The model as its own matrices would give it."""
    ids, free = model.assembly.mesh.node_ids, model.dofs.free
    (faces,) = model.interfaces["joint"].faces
    sides = {"minus": ids[faces.minus], "plus": ids[faces.plus[:, ::-1]]}
    return fy.from_matrices(
        M=model.M,
        K=model.K,
        nodes=model.assembly.mesh.nodes,
        node_ids=ids,
        dofs=np.column_stack([ids[free // 6], free % 6 + 1]),
        faces=sides,
        interfaces=[fy.InterfaceSpec(name="joint", minus="minus", plus="plus", penalty=4e5)],
        bolts=[fy.BoltSpec(name="bolt", **bolt)],
    )


def test_elongation_and_force_are_those_of_the_beam(generated, ends):
    bolt = generated.bolts["bolt"]
    same = from_matrices(generated, nodes=ends, stiffness=bolt.stiffness).bolts["bolt"]
    # Elongation does not depend on which end is called the head.
    turned = from_matrices(generated, nodes=ends[::-1], stiffness=bolt.stiffness).bolts["bolt"]
    assert np.array_equal(same.elongation, bolt.elongation)
    assert np.array_equal(turned.elongation, bolt.elongation)
    apart = np.zeros(len(bolt.elongation))
    mesh = generated.assembly.mesh
    head = mesh.node_index(np.array([ends[0]]))
    apart[generated.dofs.index(head, np.array([2]))] = 0.01
    assert same.force(apart) == pytest.approx(0.01 * bolt.stiffness)  # tension is positive


def cut(model: Model) -> tuple[Model, float]:
    """Cut the bolt above its nut: two nodes in one place, joined by springs."""
    assembly = model.assembly
    (beam,) = assembly.beams
    nut, head = beam.nodes
    mesh = assembly.mesh
    upper = len(mesh.nodes)
    mesh = replace(
        mesh,
        nodes=np.vstack([mesh.nodes, mesh.nodes[nut]]),
        node_ids=np.append(mesh.node_ids, mesh.node_ids.max() + 1),
    )
    stiffness = 1e6
    springs = tuple(
        Spring(id=1000 + c, ends=((nut, c), (upper, c)), stiffness=stiffness) for c in range(6)
    )
    beams = (replace(beam, nodes=(upper, head)),)
    split = replace(assembly, mesh=mesh, beams=beams, springs=springs)
    axial = fy.BoltSpec(name="bolt", elements=[1002])
    return fy.build_model(split, bolts=[axial]), stiffness


def test_a_cut_with_coincident_nodes_needs_a_direction(generated, ends):
    model, stiffness = cut(generated)
    head, nut = int(model.assembly.mesh.node_ids[-1]), ends[1]
    along = from_matrices(model, nodes=(head, nut), stiffness=stiffness, direction=(0, 0, 2.0))
    assert np.array_equal(along.bolts["bolt"].elongation, model.bolts["bolt"].elongation)
    with pytest.raises(ModelError, match=r"two nodes coincide.*add direction"):
        from_matrices(model, nodes=(head, nut), stiffness=stiffness)
    against = from_matrices(model, nodes=(head, nut), stiffness=stiffness, direction=(0, 0, -1))
    with pytest.raises(ModelError, match=r"clamps nothing: its tension closes no .*not reversed"):
        fy.preload(against, {"bolt": 10e3})
    for built, vector, text in (
        (along, (0, 0, 2.0), None),
        (against, (0, 0, -1), r"pulls 'joint' open: its direction \(0.0, 0.0, -1.0\) .*turn it"),
        (against, (1, 0, 0.5), "lies 63° or more from the normals of .* those of 'joint'"),
    ):
        spec = fy.BoltSpec(name="bolt", nodes=(head, nut), stiffness=stiffness, direction=vector)
        said = list(misdirected(built, [spec]))
        assert (text is None and not said) or re.search(text, *said)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"nodes": (477, 477)}, r"nodes are \[477, 477\]; give two different"),
        ({"nodes": (477, 9999)}, r"bolt 'bolt': .*no node with id 9999"),
        ({"stiffness": None}, "stiffness is None"),
        ({"stiffness": -1.0}, "stiffness is -1"),
        ({"direction": (0, 0, 0)}, r"direction is \(0, 0, 0\)"),
        ({"direction": (0, 0, -1)}, "does not point from the nut to the head"),
        ({"nodes": (1, 2)}, r"neither of its nodes \[1, 2\] can move"),  # clamped, without rows
        ({"stiffness": 3e6}, "K does not contain a spring of 3e"),
    ],
)
def test_mistakes(generated, ends, change, text):
    stiffness = generated.bolts["bolt"].stiffness
    with pytest.raises(ModelError, match=text):
        from_matrices(generated, **{"nodes": ends, "stiffness": stiffness, **change})


def test_a_bolt_stiffer_than_the_matrices_is_found_out_by_tightening(generated, ends):
    # Before contact the bolt alone holds the upper plate against its tension: K has EA/L exactly.
    stiffness = generated.bolts["bolt"].stiffness
    model = from_matrices(generated, nodes=ends, stiffness=1.001 * stiffness)
    with pytest.raises(ModelError, match=f"resists its elongation with {stiffness:.6g}"):
        fy.preload(model, {"bolt": 10e3})


def one_body_bolt(nodes_at) -> None:
    """A bolt of the deck between two nodes of the lap joint."""
    joint = lap_joint_assembly(element_size=COARSE)
    beam = joint.assembly.beams[0]
    first, second = (
        int(np.linalg.norm(joint.assembly.mesh.nodes - point, axis=1).argmin())
        for point in nodes_at
    )
    extra = replace(beam, id=9000, nodes=(first, second))
    assembly = replace(joint.assembly, beams=(*joint.assembly.beams, extra))
    fy.build_model(
        assembly, interfaces=joint.interfaces, bolts=[fy.BoltSpec(name="M8", elements=[9000])]
    )


def test_a_deck_bolt_in_one_body_clamps_nothing():
    with pytest.raises(ModelError, match="'M8' clamps nothing: head and nut hold the same body"):
        one_body_bolt([(-35.0, 0.0, -10.0), (-35.0, 0.0, 0.0)])


def test_a_deck_bolt_through_both_bodies_clamps():
    one_body_bolt([(-10.0, 0.0, -10.0), (-10.0, 0.0, 10.0)])


def test_washers_are_followed_to_their_bodies():
    """A bolt with washers through the lower plate alone."""
    joint = lap_joint_assembly(element_size=COARSE)
    mesh, beam = joint.assembly.mesh, joint.assembly.beams[0]
    ends = np.array([[-35.0, 0.0, -10.0], [-35.0, 0.0, 0.0]])
    seats = [np.flatnonzero(np.linalg.norm(mesh.nodes - end, axis=1) < 4.0) for end in ends]
    first = len(mesh.nodes)
    mesh = replace(
        mesh,
        nodes=np.vstack([mesh.nodes, ends]),
        node_ids=np.append(mesh.node_ids, [8001, 8002]),
    )
    washers = [
        RigidCoupling(id=8000 + i, reference=first + i, nodes=seat) for i, seat in enumerate(seats)
    ]
    assembly = replace(
        joint.assembly,
        mesh=mesh,
        beams=(*joint.assembly.beams, replace(beam, id=9000, nodes=(first, first + 1))),
        rigid_couplings=(*joint.assembly.rigid_couplings, *washers),
    )
    with pytest.raises(ModelError, match="'M8' clamps nothing"):
        fy.build_model(
            assembly, interfaces=joint.interfaces, bolts=[fy.BoltSpec(name="M8", elements=[9000])]
        )
