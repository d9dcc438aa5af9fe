"""The built-in lap joint, its meshes, bolts and bodies."""

from dataclasses import replace

import numpy as np
import pytest

from faying.exceptions import ModelError
from faying.joint.lap_joint import STEEL, lap_joint_assembly
from faying.model.assembly import Assembly, Beam, BeamSection, Bush, Material, Spring
from faying.model.cells import CellBlock
from faying.model.constraints import constrain
from faying.model.deck_bolt import bolt_axis_element
from faying.model.generate import brick_grid, shaped
from faying.model.generated_bolt import add_bolt
from faying.model.matrices import mass_properties, used_components
from faying.model.mesh import Mesh
from faying.model.specs import BoltSpec
from faying.model.surface import (
    facet_area_vectors,
    facet_centres,
    facet_normals,
)
from solid_blocks import stacked

SHAPES = ("hex8", "hex20", "tet4", "tet10", "wedge6")


def touching(mesh, below, above):
    """Pairs of coinciding nodes of two bodies."""
    label = mesh.bodies
    first, second = np.flatnonzero(label == below), np.flatnonzero(label == above)
    known = {tuple(p): i for p, i in zip(mesh.nodes[first].round(9).tolist(), first, strict=True)}
    points = mesh.nodes[second].round(9).tolist()
    pairs = [(known[tuple(p)], j) for p, j in zip(points, second, strict=True) if tuple(p) in known]
    return np.array(pairs)


def test_default_has_the_size_of_the_papers_model():
    mesh = lap_joint_assembly().assembly.mesh
    assert mesh.n_elements == 1824
    assert np.count_nonzero(mesh.bodies >= 0) == 2740
    assert len(mesh.nodes) == 2743
    assert len(touching(mesh, 0, 1)) == 148


def test_without_hole():
    mesh = lap_joint_assembly(hole_radius=None).assembly.mesh
    assert mesh.n_elements == 1920
    assert np.count_nonzero(mesh.bodies >= 0) == 2790
    assert len(touching(mesh, 0, 1)) == 153


def test_default_lies_where_the_paper_puts_it():
    joint = lap_joint_assembly()
    mesh, (lower, upper) = joint.assembly.mesh, (joint.assembly.mesh.bodies == i for i in (0, 1))
    np.testing.assert_array_equal(mesh.nodes[lower].min(axis=0), [-55, -10, -10])
    np.testing.assert_array_equal(mesh.nodes[lower].max(axis=0), [20, 10, 0])
    np.testing.assert_array_equal(mesh.nodes[upper].min(axis=0), [-20, -10, 0])
    np.testing.assert_array_equal(mesh.nodes[upper].max(axis=0), [55, 10, 10])
    tip = mesh.node_index([joint.boundaries[0].node])[0]
    np.testing.assert_array_equal(mesh.nodes[tip], [55, 0, 5])
    head_and_nut = mesh.nodes[list(joint.assembly.beams[0].nodes)]
    np.testing.assert_array_equal(head_and_nut, [[0, 0, -10], [0, 0, 10]])
    assert len(mesh.node_sets["clamp"]) == len(mesh.node_sets["tip-face"]) == 45


def test_default_names_sides_and_bolt():
    joint = lap_joint_assembly(penalty=1e5, quadrature="nodal")
    (interface,), (bolt,) = joint.interfaces, joint.bolts
    assert (interface.name, interface.minus, interface.plus) == ("joint", "lower", "upper")
    assert (interface.penalty, interface.quadrature) == (1e5, "nodal")
    assert bolt.name == "bolt"
    assert bolt_axis_element(joint.assembly, bolt) is joint.assembly.beams[0]
    (block,) = joint.assembly.mesh.blocks
    for number, name in ((1, "lower"), (2, "upper")):
        ids = block.ids[block.properties == number]
        np.testing.assert_array_equal(joint.assembly.mesh.element_sets[name], ids)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("curvature", [0.0, 0.01])
def test_volume_is_that_of_the_plates(shape, curvature):
    joint = lap_joint_assembly(
        shape=shape, curvature=curvature, element_size=5, hole_radius=None, bolt_mass=False
    )
    # Shearing along z keeps volumes; 2000 elements add up to rounding.
    volume = mass_properties(joint.assembly).mass / STEEL.density
    assert volume == pytest.approx(2 * 75 * 20 * 10, rel=1e-12)


def test_arch_follows_the_parabola():
    mesh = lap_joint_assembly(curvature=0.02, shape="hex20", element_size=5).assembly.mesh
    pairs = touching(mesh, 0, 1)
    x, _, z = mesh.nodes[pairs[:, 0]].T
    np.testing.assert_allclose(z, -0.01 * x**2, atol=1e-13)  # rounding of heights up to 10


def test_double_lap_has_two_interfaces():
    joint = lap_joint_assembly(plates=3, element_size=5)
    mesh = joint.assembly.mesh
    sides = [(i.name, i.minus, i.plus) for i in joint.interfaces]
    assert sides == [("joint-1", "lower", "middle"), ("joint-2", "middle", "upper")]
    assert len(touching(mesh, 0, 1)) == len(touching(mesh, 1, 2)) == 9 * 5 - 1
    for body, reach in ((0, (-55, 20)), (1, (-20, 55)), (2, (-55, 20))):
        x = mesh.nodes[mesh.bodies == body, 0]
        assert (x.min(), x.max()) == reach
    tip = mesh.node_index([joint.boundaries[0].node])[0]
    np.testing.assert_array_equal(mesh.nodes[tip], [55, 0, 0])


def test_several_bolts_are_numbered_and_share_no_node():
    joint = lap_joint_assembly(bolt_positions=((-10, 0), (10, 0)), washer_radius=5)
    assert [bolt.name for bolt in joint.bolts] == ["bolt-1", "bolt-2"]
    tied = np.concatenate([c.nodes for c in joint.assembly.rigid_couplings])
    assert len(np.unique(tied)) == len(tied)
    ids = [b.id for b in joint.assembly.beams] + [c.id for c in joint.assembly.rigid_couplings]
    assert len(set(ids)) == len(ids)
    assert min(ids) > joint.assembly.mesh.blocks[0].ids.max()


@pytest.mark.parametrize("size", [3.0, 1.7, 7.0, 100.0])
def test_any_element_size_keeps_the_overlap(size):
    mesh = lap_joint_assembly(element_size=size, bolt_positions=()).assembly.mesh
    overlap = mesh.nodes[touching(mesh, 0, 1)[:, 0]]
    assert (overlap[:, 0].min(), overlap[:, 0].max()) == (-20, 20)


@pytest.mark.parametrize("washer", ["rbe2", "rbe3"])
def test_washers_hold_the_outer_surface_within_their_radius(washer):
    assembly = lap_joint_assembly(washer=washer, washer_radius=6.5).assembly
    couplings = (*assembly.rigid_couplings[1:], *assembly.average_couplings)
    nodes = assembly.mesh.nodes
    for coupling, height in zip(couplings, (-10, 10), strict=True):
        solid = assembly.mesh.bodies >= 0
        expected = solid & (nodes[:, 2] == height) & (np.hypot(*nodes[:, :2].T) <= 6.5)
        np.testing.assert_array_equal(coupling.nodes, np.flatnonzero(expected))


def test_washers_of_an_arch_find_their_curved_seats():
    flat, arch = (lap_joint_assembly(curvature=k).assembly for k in (0.0, 0.01))
    for one, other in zip(flat.rigid_couplings, arch.rigid_couplings, strict=True):
        np.testing.assert_array_equal(one.nodes, other.nodes)


def test_bolt_has_a_round_section_and_the_plates_material():
    beam = lap_joint_assembly(bolt_diameter=8).assembly.beams[0]
    assert beam.material == STEEL
    assert beam.section.area == pytest.approx(16 * np.pi)
    assert beam.section.inertia_y == beam.section.inertia_z == pytest.approx(64 * np.pi)
    assert beam.section.torsion == pytest.approx(128 * np.pi)
    # Cowper's table gives 0.886 for a Poisson's ratio of 0.3.
    assert beam.section.shear_factor_y == pytest.approx(0.886, abs=1e-3)
    slender = lap_joint_assembly(shear_flexible=False, bolt_mass=False).assembly.beams[0]
    assert slender.section.shear_factor_z == np.inf
    assert slender.material == replace(STEEL, density=0.0)


def test_bolt_takes_the_material_it_names():
    brass = Material(name="brass", youngs_modulus=1e5, poissons_ratio=0.34, density=8.5e-9)
    bare = lap_joint_assembly(bolt_positions=()).assembly
    known = replace(bare, materials={**bare.materials, 9: brass})
    for wanted in (9, "brass"):
        assert add_bolt(known, bolt(material=wanted)).beams[0].material == brass
    with pytest.raises(ModelError, match=r"no material 'tin'.*9 \('brass'\)"):
        add_bolt(known, bolt(material="tin"))


def test_structure_with_bolt_has_only_resisted_freedoms():
    joint = lap_joint_assembly(element_size=5)
    assembly = joint.assembly
    tip = int(assembly.mesh.node_index([joint.boundaries[0].node])[0])
    dofs = constrain(assembly, used_components(assembly), keep=6 * tip + np.arange(6))
    n_solid = np.count_nonzero(assembly.mesh.bodies >= 0)
    tied = sum(len(c.nodes) for c in assembly.rigid_couplings)
    clamped = len(assembly.mesh.node_sets["clamp"])
    assert len(dofs.free) == 3 * (n_solid - tied - clamped) + 3 * 6


BAD_MEASURES = {
    "element size": ({"element_size": 0.0}, "element_size is 0; it must be positive"),
    "thickness": ({"thickness": -1.0}, "thickness is -1"),
    "not a number": ({"width": np.nan}, "width is nan"),
    "overlap": ({"overlap": 110.0}, "overlap 110 is not shorter than the whole length 110"),
    "plates": ({"plates": 4}, "plates is 4; it must be 2 or 3"),
    "shape": ({"shape": "hex27"}, "no solid shape 'hex27'.*hex8, hex20"),
    "hole": ({"hole_radius": -1.0}, "hole_radius is -1"),
    "huge hole": ({"hole_radius": 1e3}, "leaves nothing"),
    "bolt outside": ({"bolt_positions": ((30, 0),)}, r"bolt at \(30, 0\) lies outside"),
    "small washer": (
        {"washer_radius": 3.0},
        r"bolt 'bolt'.*radius 3 at \(0, 0, -10\).*nearest.* 3.536",
    ),
    "washer": ({"washer": "glue"}, "washer is 'glue'; give 'rbe2' or 'rbe3'"),
    "diameter": ({"bolt_diameter": 0.0}, "bolt 'bolt': diameter is 0.0; give a positive length"),
}


@pytest.mark.parametrize("case", BAD_MEASURES)
def test_bad_measures_are_refused(case):
    measures, message = BAD_MEASURES[case]
    with pytest.raises(ModelError, match=message):
        lap_joint_assembly(**measures)


def bolt(**changes):
    axis = ((0.0, 0.0, -10.0), (0.0, 0.0, 10.0))
    return BoltSpec(**{"name": "b", "axis": axis, "diameter": 6, "washer_radius": 6, **changes})


@pytest.mark.parametrize(
    ("axis", "message"),
    [
        (((-40, 0, -10), (-40, 0, 0)), "bolt 'b' clamps nothing"),  # through one plate
        (((0, 0, -10), (0, 0, 14)), "no surface lies there"),
        (((-10, 0, -10), (10, 0, 10)), "the surfaces there lie askew of the axis"),
        (None, "give two different points"),
        (((0, 0, 0), (0, 0, 0)), "give two different points"),
        (((0, 0), (0, 1)), "give two different points"),
    ],
)
def test_bolts_along_no_axis_of_the_joint_are_refused(axis, message):
    with pytest.raises(ModelError, match=message):
        add_bolt(lap_joint_assembly(bolt_positions=()).assembly, bolt(axis=axis))


def test_bolt_through_a_fork_clamps_the_part_between():
    """A fork (a body with two arms) and a plate between its arms."""
    line = np.linspace(0, 4, 5)
    solid = brick_grid(np.linspace(0, 6, 7), line, np.linspace(0, 3, 4))
    x, _, z = solid.centroids().T
    fork, plate = (
        solid.restricted((z < 1) | (z > 2) | (x > 5)),
        solid.restricted((z > 1) & (z < 2) & (x < 5)),
    )
    mesh = stacked(fork, plate)
    spec = bolt(axis=((2, 2, 0), (2, 2, 3)), washer_radius=1.0)
    assembly = add_bolt(Assembly(mesh=mesh, materials={1: STEEL, 2: STEEL}), spec)
    # Five nodes each: the axis and its four neighbours; none from the faces one element deeper.
    assert [len(c.nodes) for c in assembly.rigid_couplings] == [5, 5]
    for coupling, height in zip(assembly.rigid_couplings, (0, 3), strict=True):
        assert np.all(mesh.nodes[coupling.nodes, 2] == height)


def test_washer_of_a_thin_stack_holds_only_the_outer_sheet():
    thin = lap_joint_assembly(thickness=0.5, element_size=2.5)
    nodes = thin.assembly.mesh.nodes
    for coupling, height in zip(thin.assembly.rigid_couplings[1:], (-0.5, 0.5), strict=True):
        assert np.all(nodes[coupling.nodes, 2] == height)


def line_elements():
    """Beams 1 to 3 in a row 0-1-2-3, an axial spring 4 from 3 to 4, a torsion spring 5."""
    section = BeamSection(area=1, inertia_y=1, inertia_z=1, torsion=1)
    beams = tuple(
        Beam(id=i + 1, nodes=(i, i + 1), section=section, material=STEEL, orientation=(1, 0, 0))
        for i in range(3)
    )
    springs = (
        Spring(id=4, ends=((3, 2), (4, 2)), stiffness=1.0),
        Spring(id=5, ends=((3, 5), (4, 5)), stiffness=1.0),
    )
    nodes = np.zeros((5, 3))
    nodes[:, 2] = [0, 1, 2, 3, 3]
    mesh = Mesh(nodes=nodes, node_ids=np.arange(5))
    return Assembly(mesh=mesh, beams=beams, springs=springs)


@pytest.mark.parametrize(
    ("elements", "middle"), [((2,), 2), ((3, 1, 2), 2), ((2, 3, 4), 3), ((4,), 4), ((1, 2), 1)]
)
def test_deck_bolt_is_tightened_in_the_middle(elements, middle):
    assert bolt_axis_element(line_elements(), BoltSpec(name="b", elements=elements)).id == middle


@pytest.mark.parametrize(
    ("elements", "message"),
    [
        ((1, 77), "element 77 is no beam and no spring"),
        ((5,), "spring 5 is not axial"),
        ((1, 3), "elements 1, 3 do not form one chain"),
        (None, "names no elements"),
    ],
)
def test_deck_bolt_of_wrong_elements_is_refused(elements, message):
    with pytest.raises(ModelError, match=message):
        bolt_axis_element(line_elements(), BoltSpec(name="b", elements=elements))


def test_a_bush_is_no_bolt_and_the_message_says_what_is():
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    bush = Bush(id=6, nodes=(0, 1), stiffness=(1.0,) * 6, axes=axes, place=(0.0, 0.0, 0.0))
    bushed = replace(line_elements(), bushes=(bush,))
    with pytest.raises(ModelError, match="put a CBEAM or an axial CELAS"):
        bolt_axis_element(bushed, BoltSpec(name="b", elements=(6,)))


@pytest.mark.parametrize("shape", SHAPES)
def test_surface_is_closed_and_faces_outward(shape):
    cells = shaped(
        brick_grid(np.linspace(0, 2, 3), np.linspace(0, 1, 3), np.linspace(0, 3, 2)), shape
    )
    mesh = stacked(cells)
    # Sides of 2 x 2 x 1 bricks; tetrahedra halve all squares, wedges those at top and bottom.
    halved = {"hex8": 0, "hex20": 0, "tet4": 16, "tet10": 16, "wedge6": 8}[shape]
    assert len(mesh.exterior) == 16 + halved
    facets = mesh.exterior
    vectors = facet_area_vectors(mesh.nodes, facets)
    area = vectors.sum(axis=0)
    flux = np.sum(vectors * facet_centres(mesh.nodes, facets)) / 3
    sizes = np.linalg.norm(vectors, axis=1, keepdims=True)
    np.testing.assert_allclose(facet_normals(mesh.nodes, facets) * sizes, vectors, atol=1e-15)
    # Gauss' theorem: a closed surface has no net area, and ∮ x·n/3 is the volume; rounding only.
    np.testing.assert_allclose(area, 0, atol=1e-13)
    assert flux == pytest.approx(6, rel=1e-13)


def test_bodies_are_numbered_by_their_lowest_node():
    cells = np.array([[4, 5, 6, 7], [0, 1, 2, 3], [7, 8, 9, 10]])
    block = CellBlock(kind="tet4", nodes=cells, ids=[1, 2, 3], properties=[1, 1, 1])
    mesh = Mesh(nodes=np.zeros((12, 3)), node_ids=np.arange(12), blocks=(block,))
    np.testing.assert_array_equal(mesh.bodies, [0] * 4 + [1] * 7 + [-1])
    np.testing.assert_array_equal(replace(mesh, blocks=()).bodies, [-1] * 12)
