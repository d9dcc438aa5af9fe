"""Pairing: exterior facets, selections, matching, and what is said when facets do not match."""

from dataclasses import replace

import numpy as np
import pytest

from faying.exceptions import ModelError
from faying.interface.pairing import find_interfaces, pair_facets
from faying.interface.selection import select_facets
from faying.model.assembly import Assembly
from faying.model.cells import CellBlock
from faying.model.generate import brick_grid
from faying.model.mesh import Mesh
from faying.model.specs import InterfaceSpec
from solid_blocks import stacked

AUTO = InterfaceSpec(name="joint")
NAMED = InterfaceSpec(name="joint", minus="lower", plus="upper")


def brick(origin, size, counts):
    lines = (o + s * np.linspace(0, 1, n + 1) for o, s, n in zip(origin, size, counts, strict=True))
    return brick_grid(*lines)


def blocks(*bricks):
    """An assembly of bricks, each with property, element set and nodes of its own."""
    mesh = stacked(*bricks, names=("lower", "upper", "third")[: len(bricks)])
    return Assembly(mesh=replace(mesh, node_ids=9 + mesh.node_ids))


LOWER = brick((0, 0, -1), (4, 3, 1), (4, 3, 1))


def lap(shift=(0.0, 0.0, 0.0), counts=(4, 3, 1)):
    """Two plates that overlap on x in [1, 4]: nine facets of each when they match."""
    return blocks(LOWER, brick(np.array([1.0, 0, 0]) + shift, (4, 3, 1), counts))


def assert_aligned(assembly, faces):
    for entry in faces:
        np.testing.assert_allclose(
            assembly.mesh.nodes[entry.minus], assembly.mesh.nodes[entry.plus], atol=1e-12
        )


def test_exterior_of_a_box():
    facets = lap().mesh.exterior
    one_box = 2 * (4 * 3 + 4 * 1 + 3 * 1)
    assert len(facets) == 2 * one_box
    np.testing.assert_array_equal(np.bincount(facets.bodies), [one_box, one_box])
    np.testing.assert_array_equal(facets.properties, facets.bodies + 1)
    # Every facet's nodes are nodes of its element.
    cells = np.concatenate([block.nodes for block in lap().mesh.blocks])
    owner = cells[facets.elements - 1]
    assert (facets.nodes[:, :4, None] == owner[:, None, :]).any(axis=2).all()


def test_a_mixed_mesh_has_no_inner_facets_outside():
    """A wedge on a brick share their quadrilateral."""
    nodes = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1],
         [0.5, 0, 2], [0.5, 1, 2]], dtype=float
    )  # fmt: skip
    one = np.array([1])
    mesh = Mesh(
        nodes=nodes,
        node_ids=np.arange(10),
        blocks=(
            CellBlock(kind="hex8", nodes=np.arange(8)[None], ids=one, properties=one),
            CellBlock(kind="wedge6", nodes=[[4, 8, 5, 7, 9, 6]], ids=2 * one, properties=one),
        ),
    )
    by_kind = mesh.exterior.by_kind()
    assert {kind: len(facets) for kind, facets in by_kind.items()} == {"tri3": 2, "quad4": 7}
    top = [4, 5, 6, 7]
    assert not any(sorted(row) == top for row in by_kind["quad4"].tolist())


def test_selections_name_the_same_facets():
    joint = lap()
    exterior = joint.mesh.exterior
    upper = exterior.nodes[exterior.bodies == 1]
    for selection in ("upper", 2, "2", [2], "body 1", joint.mesh.element_sets["upper"].tolist()):
        np.testing.assert_array_equal(select_facets(joint, selection).nodes, upper)
    assert (select_facets(joint, [2, 3]).elements <= 3).all()


def test_a_node_set_selects_facets_with_all_their_nodes():
    joint = lap()
    top = np.flatnonzero((joint.mesh.nodes[:, 2] == 0) & (np.arange(len(joint.mesh.nodes)) < 40))
    named = replace(joint, mesh=joint.mesh.with_node_set("top", top))
    assert len(select_facets(named, "top")) == 12


def test_a_face_set_knows_its_owners():
    joint = lap()
    exterior = joint.mesh.exterior
    chosen = exterior.taken(exterior.bodies == 1)
    # Other first corner, same facet.
    faces = np.roll(chosen.nodes[:, :4], 1, axis=1)
    found = select_facets(replace(joint, face_sets={"f": faces}), "f")
    np.testing.assert_array_equal(found.elements, chosen.elements)
    np.testing.assert_array_equal(found.nodes[:, :4], faces)


def test_unknown_selections_are_refused_with_near_names():
    with pytest.raises(ModelError, match=r"'uper'; did you mean 'upper'"):
        select_facets(lap(), "uper")
    with pytest.raises(ModelError, match=r"interface 'joint', minus side: .*'uper'"):
        pair_facets(lap(), replace(NAMED, minus="uper"))
    with pytest.raises(ModelError, match=r"element with id 777.*properties are 1, 2"):
        select_facets(lap(), [1, 777])
    mesh = lap().mesh.with_node_set("corner", np.array([0]))
    with pytest.raises(ModelError, match="no exterior facet"):
        select_facets(Assembly(mesh=mesh), "corner")
    with pytest.raises(ModelError, match="cannot select"):
        select_facets(lap(), [0.5])


@pytest.mark.parametrize("spec", [AUTO, NAMED, replace(NAMED, plus="auto"), replace(NAMED, plus=2)])
def test_the_overlap_matches_node_on_node(spec):
    joint = lap()
    (faces,) = pair_facets(joint, spec)
    assert faces.kind == "quad4"
    assert faces.minus.shape == (9, 4)
    assert_aligned(joint, (faces,))
    corners = joint.mesh.nodes[faces.minus]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    # Out of the lower body.
    assert (normals[:, 2] > 0).all()
    assert faces.minus.max() < 40 <= faces.plus.min()


def test_auto_takes_the_body_with_the_smallest_node_id_as_minus():
    joint = lap()
    ids = joint.mesh.node_ids[::-1]
    (faces,) = pair_facets(replace(joint, mesh=replace(joint.mesh, node_ids=ids)), AUTO)
    assert faces.minus.min() >= 40


def test_auto_finds_one_interface_per_pair_of_bodies():
    """A base, and two blocks on it that also touch each other: three nodes in one place."""
    joint = blocks(
        LOWER,
        brick((0, 0, 0), (2, 3, 1), (2, 3, 1)),
        brick((2, 0, 0), (2, 3, 1), (2, 3, 1)),
    )
    found = find_interfaces(joint, AUTO)
    sizes = {name: sum(len(f.minus) for f in faces) for name, faces in found.items()}
    assert sizes == {"joint-1": 6, "joint-2": 6, "joint-3": 3}
    for faces in found.values():
        assert_aligned(joint, faces)
    assert list(find_interfaces(lap(), AUTO)) == ["joint"]


def test_a_side_may_consist_of_several_touching_bodies():
    joint = blocks(
        LOWER,
        brick((0, 0, 0), (2, 3, 1), (2, 3, 1)),
        brick((2, 0, 0), (2, 3, 1), (2, 3, 1)),
    )
    (faces,) = pair_facets(joint, replace(NAMED, plus=[2, 3]))
    assert len(faces.minus) == 12
    assert_aligned(joint, (faces,))


def test_a_gap_within_the_tolerance_is_bridged():
    joint = lap(shift=(0, 0, 0.05))
    (faces,) = pair_facets(joint, replace(NAMED, tolerance=0.06))
    assert len(faces.minus) == 9
    with pytest.raises(ModelError, match=r"is empty.*0\.05 apart \(tolerance 0\.01\)"):
        pair_facets(joint, NAMED)


def test_non_matching_faces_are_refused_with_numbers():
    """Upper facets 4/5 as long: only the nodes at x = 1 coincide."""
    joint = lap(counts=(5, 3, 1))
    for spec in (NAMED, AUTO, replace(NAMED, minus="upper", plus="lower")):
        with pytest.raises(ModelError, match="non-matching faces") as caught:
            pair_facets(joint, spec)
        assert "miss each other by up to 0.4" in str(caught.value) or spec.minus == "upper"
        assert "tolerance 0.008" in str(caught.value)
    with pytest.raises(ModelError, match=r"9 of 38 facets of minus='lower' and 12 of 46"):
        pair_facets(joint, NAMED)


def test_a_single_shifted_node_is_refused_not_dropped():
    joint = lap()
    nodes = joint.mesh.nodes.copy()
    moved = int(np.flatnonzero((nodes == [2.0, 1.0, 0.0]).all(axis=1))[-1])
    nodes[moved, 0] += 0.1
    with pytest.raises(ModelError, match=r"up to 0\.1 \(tolerance 0\.009") as caught:
        pair_facets(replace(joint, mesh=replace(joint.mesh, nodes=nodes)), NAMED)
    assert "9 of 38 facets of minus='lower'" in str(caught.value)
    assert "8 of them without" in str(caught.value)


def test_other_diagonals_are_told_from_shifted_nodes():
    """The same four nodes, cut into triangles along different diagonals."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    mesh = Mesh(nodes=np.vstack([square, square]), node_ids=np.arange(1, 9))
    below = np.array([[0, 1, 2], [0, 2, 3]])
    above = np.array([[5, 4, 7], [6, 5, 7]])
    joint = Assembly(mesh=mesh, face_sets={"lower": below, "upper": above})
    with pytest.raises(ModelError, match="other diagonals"):
        pair_facets(joint, NAMED)


def test_non_matching_curved_faces_are_found():
    """Centres of chords stand off the other mesh's chords by more than the tolerance."""

    def arc(n, radius, outwards, first):
        angle = np.linspace(0, np.pi / 2, n + 1)
        ring = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
        nodes = np.vstack([np.c_[ring, np.zeros(n + 1)], np.c_[ring, np.ones(n + 1)]])
        low = np.arange(n)
        quads = np.column_stack([low, low + 1, low + n + 2, low + n + 1]) + first
        return nodes, quads if outwards else quads[:, ::-1]

    inner, inner_faces = arc(8, 5.0, True, 0)
    outer, outer_faces = arc(6, 5.0, False, len(inner))
    mesh = Mesh(nodes=np.vstack([inner, outer]), node_ids=np.arange(len(inner) + len(outer)))
    sets = {"lower": inner_faces, "upper": outer_faces}
    with pytest.raises(ModelError, match=r"8 of 8 facets of minus.*6 of 6"):
        pair_facets(Assembly(mesh=mesh, face_sets=sets), NAMED)


@pytest.mark.parametrize(
    ("joint", "spec", "message"),
    [
        (lap(shift=(0, 0, 2.5)), NAMED, r"'joint' is empty.*2\.5 apart"),
        (lap(shift=(0, 0, 2.5)), AUTO, r"the bodies have no facet.*2\.5 apart"),
        (lap(shift=(3, 0, 0)), NAMED, "only edges or points"),
        (blocks(LOWER, LOWER), NAMED, "face the same way"),
        (lap(), replace(NAMED, plus="lower"), "select the same 38 facets"),
        (
            lap(),
            replace(NAMED, minus=[*range(1, 25)], plus=[*range(1, 25)]),
            r"4 facets coincide.*same facets",
        ),
        (lap(), replace(NAMED, tolerance=1.5), r"tolerance 1\.5"),
        (lap(), replace(NAMED, tolerance=-1.0), "tolerance is -1"),
        (blocks(LOWER), AUTO, "one body"),
        (Assembly(mesh=Mesh(nodes=np.zeros((1, 3)), node_ids=[1])), AUTO, "no solid elements"),
    ],
)
def test_sides_that_do_not_meet_or_are_one_are_refused(joint, spec, message):
    with pytest.raises(ModelError, match=message):
        pair_facets(joint, spec)
