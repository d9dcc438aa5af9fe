"""Surfaces that a deck declares to be in contact are paired whatever the gap between them."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import FormatError, ModelError
from faying.interface.gap_field import with_gap_rule
from faying.interface.gap_pairing import declared
from faying.interface.mortar import find_couplings
from faying.interface.pairing import find_interfaces
from faying.io.abaqus import write_deck
from faying.model.assembly import Assembly, Support
from faying.model.description import JointDescription
from faying.model.generate import brick_grid
from faying.model.mesh import Mesh
from faying.model.specs import GapRule
from faying.model.surface import facet_normals
from mortar_blocks import SIZE, blocks
from solid_blocks import stacked

ANY = fy.InterfaceSpec(
    name="joint", minus="under", plus="over", penalty=1e5, search_distance=np.inf
)
AREA = SIZE[0] * SIZE[1]


def faced(assembly):
    """Name the upper faces of the lower block and the lower ones of the upper block."""
    mesh = assembly.mesh
    facets = mesh.exterior
    up = facet_normals(mesh.nodes, facets)[:, 2]
    chosen = {
        "under": np.isin(facets.elements, mesh.element_sets["lower"]) & (up > 0.7),
        "over": np.isin(facets.elements, mesh.element_sets["upper"]) & (up < -0.7),
    }
    faces = {name: facets.taken(rows).nodes for name, rows in chosen.items()}
    return replace(assembly, face_sets=faces)


def lifted(height):
    """Move the upper block by a height, which may depend on the place."""

    def move(nodes):
        raised = nodes.copy()
        raised[:, 2] += height(nodes) if callable(height) else height
        return raised

    return move


def joint_of(assembly, spec=ANY):
    base = np.flatnonzero(assembly.mesh.nodes[:, 2] == assembly.mesh.nodes[:, 2].min())
    held = replace(assembly, supports=(Support(id=1, nodes=base, components=(0, 1, 2)),))
    return fy.build_model(held, interfaces=[spec]).interfaces["joint"]


@pytest.mark.parametrize("kind", ["hex8", "hex20", "tet4", "tet10"])
@pytest.mark.parametrize("gap", [0.0, 0.1, 7.5])
def test_matching_facets_are_paired_across_any_gap(kind, gap):
    """The same interface as at gap zero, but for the gap."""
    parts = (((4, 3), kind),) * 2
    touching = faced(blocks(*parts))
    apart = faced(blocks(*parts, move=lifted(gap)))
    spec = declared(apart, ANY)
    assert spec.meshes == "matching"
    closed = joint_of(touching, replace(ANY, search_distance=None))
    found = joint_of(apart, spec)
    for name in ("pairs", "weights", "face_of_point"):
        np.testing.assert_allclose(getattr(found, name), getattr(closed, name), rtol=1e-12)
    for one, other in zip(found.faces, closed.faces, strict=True):
        np.testing.assert_array_equal(one.minus, other.minus)
        np.testing.assert_array_equal(one.plus, other.plus)
    np.testing.assert_allclose(found.initial_gap, gap, atol=1e-12)


@pytest.mark.parametrize("kinds", [("hex8", "hex8"), ("hex20", "tet10"), ("tet4", "hex8")])
@pytest.mark.parametrize("gap", [0.0, 0.1, 7.5])
def test_other_meshes_are_projected_across_any_gap(kinds, gap):
    parts = ((4, 3), kinds[0]), ((5, 7), kinds[1])
    spec = declared(faced(blocks(*parts, move=lifted(gap))), ANY)
    assert spec.meshes == "non-matching"
    found = joint_of(faced(blocks(*parts, move=lifted(gap))), spec)
    assert found.area == pytest.approx(AREA, rel=1e-12)
    np.testing.assert_allclose(found.initial_gap, gap, atol=1e-12)


@pytest.mark.parametrize("kind", ["hex8", "hex20", pytest.param("tet10", marks=pytest.mark.long)])
@pytest.mark.parametrize("counts", [((10, 8), (10, 8)), ((8, 8), (12, 10))], ids=["same", "other"])
@pytest.mark.parametrize("clearance", [0.0, 0.1, 0.5, -0.05])
def test_pins_in_holes(kind, counts, clearance):
    """Tubes around each other, of radius 50 at the face between them."""
    radius = 50.0

    def bent(nodes):
        distance, angle = radius + nodes[:, 2], nodes[:, 0] / radius
        return np.column_stack([distance * np.sin(angle), nodes[:, 1], distance * np.cos(angle)])

    flat = faced(blocks((counts[0], kind), (counts[1], kind), move=lifted(clearance)))
    tubes = replace(flat, mesh=replace(flat.mesh, nodes=bent(flat.mesh.nodes)))
    spec = declared(tubes, ANY)
    assert (spec.meshes == "matching") == (counts[0] == counts[1])
    found = joint_of(tubes, spec)
    # The face midway has another radius, and polygons are smaller by (h/R)²/24.
    assert found.area == pytest.approx(AREA * (1 + max(clearance, 0) / 2 / radius), rel=6e-3)
    np.testing.assert_allclose(found.initial_gap, clearance, atol=1e-4)


def test_before_they_were_left_out():
    """What the tolerance of a spec without search distance does of a wedge-shaped gap."""
    wedge = lifted(lambda x: 0.3 * (x[:, 0] / SIZE[0] + 0.5))
    assembly = faced(blocks(((40, 2), "hex8"), ((40, 2), "hex8"), move=wedge))
    touching = replace(ANY, search_distance=None, meshes="non-matching", tolerance=0.03)
    assert joint_of(assembly, touching).area < 0.2 * AREA
    found = joint_of(assembly, declared(assembly, ANY))
    assert found.area == pytest.approx(AREA, rel=1e-3)  # the tilt of half a wedge
    expected = 0.3 * (found.points[:, 0] / SIZE[0] + 0.5)
    np.testing.assert_allclose(found.initial_gap, expected, atol=1e-3)


@pytest.mark.parametrize("meshes", [((8, 2), (8, 2)), ((8, 2), (5, 3))])
def test_search_distance_is_respected(meshes):
    """Facets whose gap is larger are left out."""
    wedge = lifted(lambda x: 0.8 * (x[:, 0] / SIZE[0] + 0.5))
    assembly = faced(blocks(*((counts, "hex8") for counts in meshes), move=wedge))
    near = replace(ANY, search_distance=0.4)
    found = joint_of(assembly, declared(assembly, near))
    assert found.area == pytest.approx(AREA / 2, rel=0.15)  # whole facets
    assert found.initial_gap.max() < 0.55
    with pytest.raises(ModelError, match="interface 'joint' is empty"):
        joint_of(faced(blocks(*(((2, 2), "hex8"),) * 2, move=lifted(1.0))), declared_of(near, 1.0))


def declared_of(spec, gap):
    return declared(faced(blocks(*(((2, 2), "hex8"),) * 2, move=lifted(gap))), spec)


@pytest.mark.parametrize("counts", [(4, 3), (7, 5)])
def test_penetrations_are_paired_down_to_the_depth_of_an_element(counts):
    for depth in (0.02, 0.5, 2.9):
        assembly = faced(blocks(((4, 3), "hex8"), (counts, "hex8"), move=lifted(-depth)))
        found = joint_of(assembly, declared(assembly, ANY))
        np.testing.assert_allclose(found.initial_gap, -depth, atol=1e-12)
    deep = blocks(((4, 3), "hex8"), (counts, "hex8"), move=lifted(-3.1))
    with pytest.raises(ModelError, match=r"'joint' is empty.*search distance inf.*no facet sees"):
        joint_of(faced(deep), declared(faced(deep), ANY))


def test_whole_bodies_see_only_each_others_near_sides():
    """The top of the upper block and the bottom of the lower one face each other's far side."""
    for gap in (0.0, 0.1, 2.0):
        bodies = blocks(((4, 3), "hex8"), ((6, 5), "hex8"), move=lifted(gap))
        spec = replace(ANY, minus="lower", plus="upper", meshes="non-matching")
        found = joint_of(bodies, spec)
        assert found.area == pytest.approx(AREA, rel=1e-12)
        np.testing.assert_allclose(found.initial_gap, gap, atol=1e-12)


@pytest.mark.parametrize(("minus", "plus"), [(1, "both"), ("both", 1)])
def test_of_several_layers_the_nearest_one_is_taken(minus, plus):
    """Two plates on one side, one behind the other, both declared."""
    assembly = layered((0.0, 3.2, 8.0))
    found = joint_of(assembly, replace(ANY, minus=minus, plus=plus, meshes="non-matching"))
    assert found.area == pytest.approx(AREA, rel=1e-9)
    np.testing.assert_allclose(found.initial_gap, 0.2, atol=1e-12)


def layered(bases):
    """Plates of 10 x 8 x 3 over each other, of different meshes; the upper two are "both"."""
    parts = []
    for number, base in enumerate(bases):
        lines = [np.linspace(0, size, 3 + number + 1) for size in SIZE[:2]]
        parts.append(brick_grid(*lines, z=np.array([base, base + SIZE[2]])))
    mesh = stacked(*parts)
    upper = np.concatenate([block.ids for block in mesh.blocks[1:]])
    mesh = replace(mesh, element_sets={"both": upper})
    steel = blocks(((1, 1), "hex8"), ((1, 1), "hex8")).materials[1]
    return Assembly(mesh=mesh, materials=dict.fromkeys((1, 2, 3), steel), element="standard")


@pytest.mark.parametrize("counts", [(4, 3), (7, 5)])
def test_gap_rules(counts):
    wedge = lifted(lambda x: 0.4 * (x[:, 0] / SIZE[0] + 0.25))
    assembly = faced(blocks(((4, 3), "hex8"), (counts, "hex8"), move=wedge))
    mesh = assembly.mesh
    joint = joint_of(assembly, declared(assembly, ANY))
    place = joint.points[:, 0] / SIZE[0]
    np.testing.assert_allclose(joint.initial_gap, 0.4 * (place + 0.25), atol=2e-3)  # the tilt

    def ruled(**rule):
        return with_gap_rule(joint, mesh.nodes, mesh.node_ids, GapRule(**rule)).initial_gap

    np.testing.assert_array_equal(ruled(value=0.07), 0.07)
    # The wedge is 0 at a quarter of the length and penetrates before.
    away = ruled(closed_up_to=0.0)
    assert (away >= -1e-12).all()
    np.testing.assert_allclose(away[place > 0.01], joint.initial_gap[place > 0.01], atol=1e-12)
    np.testing.assert_allclose(ruled(closed_up_to=np.inf), 0.0, atol=1e-6)
    nodes = np.unique(joint.pairs[:, 0])
    every = tuple(mesh.node_ids[nodes].tolist())
    np.testing.assert_allclose(ruled(closed_nodes=every), 0.0, atol=1e-6)
    np.testing.assert_array_equal(ruled(closed_nodes=()), joint.initial_gap)


def test_gap_rules_are_written_or_refused(tmp_path):
    assembly = faced(blocks(((4, 3), "hex8"), ((4, 3), "hex8"), move=lifted(0.1)))
    joint = JointDescription(assembly=assembly, interfaces=(ANY,))
    for rule in (None, GapRule(value=0.03), GapRule(value=0.0)):
        specs = (replace(ANY, gap=rule),)
        write_deck(replace(joint, interfaces=specs), tmp_path / "a.inp")
        (interface,) = fy.read_abaqus(tmp_path / "a.inp").interfaces.values()
        expected = 0.1 if rule is None else rule.value
        np.testing.assert_allclose(interface.initial_gap, expected, atol=1e-12)
    closed = replace(joint, interfaces=(replace(ANY, gap=GapRule(closed_up_to=1.0)),))
    with pytest.raises(FormatError, match=r"closes gaps .* .* not written"):
        write_deck(closed, tmp_path / "b.inp")


def test_matching_needs_no_tolerance_but_a_search_distance():
    assembly = faced(blocks(((4, 3), "hex8"), ((4, 3), "hex8"), move=lifted(0.1)))
    with pytest.raises(ModelError, match="larger tolerance"):
        find_interfaces(assembly, replace(ANY, search_distance=None))
    other = faced(blocks(((4, 3), "hex8"), ((5, 3), "hex8"), move=lifted(0.1)))
    with pytest.raises(ModelError, match=r'do not lie node on node .*"non-matching"'):
        find_interfaces(other, ANY)
    assert len(find_couplings(other, replace(ANY, meshes="non-matching"))) == 1


def spoiled(change):
    """Two blocks with named faces, the nodes of the upper one then changed."""
    assembly = faced(blocks(*(((4, 4), "hex8"),) * 2))
    nodes, mesh = assembly.mesh.nodes.copy(), assembly.mesh
    upper = mesh.element_nodes(mesh.element_sets["upper"])
    nodes[upper] = change(nodes[upper])
    return replace(assembly, mesh=replace(mesh, nodes=nodes))


def test_a_surface_without_area_sees_nothing():
    flat = spoiled(lambda nodes: nodes * [0.0, 1.0, 1.0])
    assert declared(flat, ANY).meshes == "non-matching"
    with pytest.raises(ModelError):
        joint_of(flat, declared(flat, ANY))


def test_surfaces_too_far_apart_to_be_looked_through():
    """As a slip of the pen in one coordinate puts them: 1e9 facets would fit between them."""
    corner = [*(SIZE[:2] / 2), 0.0]
    far = spoiled(lambda x: np.where((x == corner).all(axis=1)[:, None], [*SIZE[:2], 1e10], x))
    with pytest.raises(ModelError, match=r"facets of \S+ and lie up to 1e\+10 apart"):
        declared(far, ANY)


def test_coordinates_that_cannot_be_computed_with():
    with pytest.raises(ModelError, match=r"node 7 is at \(0, 1e\+308, nan\); coordinates are at"):
        Mesh(nodes=[[0.0, 1e308, np.nan]], node_ids=[7])
