"""Interfaces against exact answers and against another program's contact pressures."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp

from faying.contact.laws import normal_law
from faying.exceptions import ModelError
from faying.interface.interface import FacePairs
from faying.interface.pairing import find_interfaces, pair_facets
from faying.interface.penalty import automatic_penalty
from faying.interface.relative_displacement import times_normals
from faying.interface.zero_thickness import build_interface
from faying.joint.build import build_model
from faying.joint.lap_joint import lap_joint_assembly
from faying.joint.sticking import sticking_stiffness, stuck_pairs
from faying.model.assembly import Assembly, Material, Support
from faying.model.dofs import DofMap
from faying.model.mesh import Mesh
from faying.model.specs import InterfaceSpec

SHAPES = ("hex8", "hex20", "tet4", "tet10", "wedge6", "wedge15")
RULES = ("gauss", "nodal")
REFERENCE = Path(__file__).parents[1] / "data" / "lap_joint"
OVERLAP_AREA = 40.0 * 20.0


def unconstrained(assembly):
    size = 6 * len(assembly.mesh.nodes)
    return DofMap(transformation=sp.eye_array(size, format="csr"), free=np.arange(size))


def lap(shape="hex8", curvature=0.0, **options):
    joint = lap_joint_assembly(
        element_size=5.0, shape=shape, curvature=curvature, hole_radius=None, **options
    )
    return joint.assembly


def interface(assembly, penalty=1e5, **options):
    spec = InterfaceSpec(name="joint", **options)
    faces = pair_facets(assembly, spec)
    return build_interface(assembly, unconstrained(assembly), spec, faces, normal_law(penalty))


def translations(field):
    """Six degrees of freedom per node from a displacement field (n_node, 3)."""
    return np.hstack([field, np.zeros_like(field)]).ravel()


def nodal_forces(joint, pressure):
    """Contact forces Gᵀλ (n_node, 3) of a pressure at the points."""
    forces = joint.gap_operator.T @ (joint.weights * pressure)
    return forces.reshape(-1, 6)[:, :3]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("curvature", [0.0, 2e-3])
@pytest.mark.parametrize("quadrature", RULES)
class TestEveryKindOfFacet:
    def test_newtons_third_law_holds_to_the_last_bit(self, shape, curvature, quadrature):
        joint = interface(lap(shape, curvature), quadrature=quadrature)
        G = joint.gap_operator.tocsc()
        columns = 6 * joint.pairs[:, :, None] + np.arange(3)
        minus, plus = (G[:, columns[:, side].ravel()].toarray() for side in (0, 1))
        np.testing.assert_array_equal(minus, -plus)
        assert np.abs(plus).max() > 0.1

    def test_a_rigid_motion_of_everything_leaves_gaps_alone(self, shape, curvature, quadrature):
        assembly = lap(shape, curvature)
        joint = interface(assembly, quadrature=quadrature)
        motion = np.array([1.0, 2.0, 3.0]) + np.cross([0.1, -0.2, 0.3], assembly.mesh.nodes)
        # Coincident nodes move alike; their coordinates agree to rounding (1e-14 of 10 mm).
        gap = joint.gap_operator @ translations(motion)
        np.testing.assert_allclose(gap, 0, atol=1e-12)

    def test_a_rigid_separation_opens_by_its_normal_part(self, shape, curvature, quadrature):
        assembly = lap(shape, curvature)
        joint = interface(assembly, quadrature=quadrature)
        step = np.array([0.03, -0.02, 0.5])
        field = np.zeros_like(assembly.mesh.nodes)
        upper = np.unique(assembly.mesh.blocks[0].nodes[assembly.mesh.blocks[0].properties == 2])
        field[upper] = step
        expected = joint.normals @ step
        np.testing.assert_allclose(joint.gap_operator @ translations(field), expected, rtol=1e-13)
        if curvature == 0:
            np.testing.assert_allclose(expected, 0.5, rtol=1e-14)

    def test_normals_leave_the_minus_side(self, shape, curvature, quadrature):
        joint = interface(lap(shape, curvature), quadrature=quadrature)
        assert joint.normals[:, 2].min() > 0.9
        assert joint.pair_normals[:, 2].min() > 0.9
        np.testing.assert_allclose(np.linalg.norm(joint.normals, axis=1), 1, rtol=1e-14)
        swapped = interface(
            lap(shape, curvature), quadrature=quadrature, minus="upper", plus="lower"
        )
        assert swapped.normals[:, 2].max() < -0.9

    def test_contact_points_lie_on_the_surface(self, shape, curvature, quadrature):
        joint = interface(lap(shape, curvature), quadrature=quadrature)
        x, _, z = joint.points.T
        sink = z + 0.5 * curvature * x**2
        # Chords of 5 mm stand off the arch by κ h²/8; parabolas reproduce it exactly.
        chord = curvature * 25 / 8 if shape in ("hex8", "tet4", "wedge6") else 0.0
        assert np.abs(sink).max() <= chord + 1e-12
        assert np.bincount(joint.face_of_point).min() > 0 or quadrature == "nodal"

    def test_uniform_pressure_pushes_with_the_projected_area(self, shape, curvature, quadrature):
        """∫ n dA depends on the rim alone: its z part is the plan area, curved or not."""
        joint = interface(lap(shape, curvature), quadrature=quadrature)
        pushed = joint.weights @ joint.normals
        if quadrature == "gauss" or curvature == 0:
            # w n is a polynomial of low degree, so only rounding and the unit normal remain.
            assert pushed[2] == pytest.approx(OVERLAP_AREA, rel=1e-12)
        else:
            # Merged points use the direction of the mean normal with the whole area: second order
            # in the turn κ h = 0.01 between neighbouring facets.
            assert pushed[2] == pytest.approx(OVERLAP_AREA, rel=1e-4)
        # Symmetric about x = 0 and straight in y.
        np.testing.assert_allclose(pushed[:2] / OVERLAP_AREA, 0, atol=1e-12)


@pytest.mark.parametrize(
    ("shape", "share"),
    [
        ("hex8", [1 / 4] * 4),
        ("hex20", [-1 / 12] * 4 + [1 / 3] * 4),
        ("tet4", [1 / 3] * 3),
        ("tet10", [0.0] * 3 + [1 / 3] * 3),
    ],
)
@pytest.mark.parametrize("quadrature", RULES)
def test_constant_pressure_gives_the_consistent_nodal_forces(shape, share, quadrature):
    assembly = lap(shape)
    joint = interface(assembly, quadrature=quadrature)
    (faces,) = joint.faces
    area = OVERLAP_AREA / len(faces.minus)
    expected = np.zeros(len(assembly.mesh.nodes))
    # Spelled out per facet: ufunc.at of NumPy 2.4.6 reads past an operand it has to broadcast.
    each = np.tile(7.0 * area * np.array(share), (len(faces.minus), 1))
    np.add.at(expected, faces.plus, each)
    np.add.at(expected, faces.minus, -each)
    forces = nodal_forces(joint, np.full(joint.n_points, 7.0))
    # Facets of one area, 25 or 12.5 mm²: rounding of their sums.
    np.testing.assert_allclose(forces[:, 2], expected, atol=1e-10)
    np.testing.assert_allclose(forces[:, :2], 0, atol=1e-12)
    assert joint.area == pytest.approx(OVERLAP_AREA, rel=1e-13)


def test_nodal_points_of_linear_facets_are_the_pairs():
    for shape in ("hex8", "tet4"):
        joint = interface(lap(shape), quadrature="nodal")
        assert joint.n_points == len(joint.pairs)
        assert joint.point_shape.nnz == joint.n_points
        # One force per pair: hard contact has a unique answer.
        assert np.linalg.matrix_rank(joint.gap_operator.toarray()) == joint.n_points


def test_nodal_weights_are_tributary_areas():
    joint = interface(lap(), quadrature="nodal")
    inside = (np.abs(joint.points[:, 0]) < 19.9) & (np.abs(joint.points[:, 1]) < 9.9)
    corner = (np.abs(joint.points[:, 0]) > 19.9) & (np.abs(joint.points[:, 1]) > 9.9)
    np.testing.assert_allclose(joint.weights[inside], 25.0, rtol=1e-13)
    np.testing.assert_allclose(joint.weights[corner], 6.25, rtol=1e-13)


def test_quadrature_defaults_follow_the_law():
    assembly = lap()
    assert interface(assembly).quadrature == "gauss-2"
    assert interface(assembly, penalty=np.inf).quadrature == "nodal"
    assert interface(assembly, order=4).n_points == 32 * 16
    with pytest.raises(ModelError, match="order 3 is given but nodal"):
        interface(assembly, quadrature="nodal", order=3)


@pytest.mark.parametrize("curvature", [2e-3, 1e-7])
def test_pairs_have_the_relative_displacements_that_their_points_feel(curvature):
    flat, curved = interface(lap()), interface(lap(curvature=curvature))
    assert flat.relative_operator.shape[0] == len(flat.pairs)
    # What is left out is felt by no point: gaps of any motion are those of all components.
    whole = times_normals(curved.point_shape, curved.normals) @ curved.motion_operator
    assert len(curved.pairs) < curved.relative_operator.shape[0] < 3 * len(curved.pairs)
    difference = abs(curved.gap_operator - whole)
    assert difference.max() < 1e-13  # round-off of normals that should be equal
    axes = curved.pair_axes @ curved.pair_axes.T
    # Axes of normals that hardly differ are as orthogonal as any.
    np.testing.assert_allclose(axes.toarray(), np.eye(axes.shape[0]), rtol=0, atol=1e-14)
    # Axis-parallel: two entries per row, no rounding in the other directions.
    assert flat.relative_operator.nnz == 2 * len(flat.pairs)
    np.testing.assert_array_equal(np.unique(flat.relative_operator.data), [-1.0, 1.0])


def test_what_supports_hold_on_both_sides_is_no_relative_displacement():
    """Of a half joint across its plane of symmetry: compliances with rows of zeros are singular."""
    described = lap_joint_assembly(element_size=5.0)
    assembly = described.assembly
    edge = np.flatnonzero(assembly.mesh.nodes[:, 1] == -10.0)
    held = Support(id=10, nodes=edge, components=(1,))
    half = build_model(
        replace(assembly, supports=(*assembly.supports, held)),
        interfaces=described.interfaces,
        bolts=described.bolts,
        boundaries=described.boundaries,
    ).with_friction(0.2)
    joint, between = half.interfaces["joint"], half.static_contact.between
    on_plane = np.isin(joint.pairs, edge).all(axis=1)
    assert joint.relative_operator.shape[0] == 3 * len(joint.pairs) - np.count_nonzero(on_plane)
    np.linalg.cholesky(between.compliance)


def test_an_initial_gap_is_measured_along_the_normal_and_keeps_the_balance():
    assembly = lap()
    nodes = assembly.mesh.nodes.copy()
    upper = np.unique(assembly.mesh.blocks[0].nodes[assembly.mesh.blocks[0].properties == 2])
    nodes[upper] += [0.0, 0.0, 0.02]
    apart = replace(assembly, mesh=replace(assembly.mesh, nodes=nodes))
    joint = interface(apart, tolerance=0.03)
    np.testing.assert_allclose(joint.initial_gap, 0.02, rtol=1e-12)
    np.testing.assert_allclose(joint.points[:, 2], 0.01, rtol=1e-12)
    forces = nodal_forces(joint, np.full(joint.n_points, 10.0))
    moment = np.cross(nodes, forces).sum(axis=0)
    # Forces along the gap have no arm.
    np.testing.assert_allclose(moment / 8000.0, 0, atol=1e-12)
    nodes[upper] += [0.02, 0.0, -0.02]
    slid = replace(assembly, mesh=replace(assembly.mesh, nodes=nodes))
    np.testing.assert_allclose(interface(slid, tolerance=0.03).initial_gap, 0, atol=1e-13)


def test_constraints_enter_through_the_map_of_degrees_of_freedom():
    """A held plus side leaves only the minus entries; its rows of T are empty."""
    assembly = lap()
    faces = pair_facets(assembly, InterfaceSpec(name="joint"))
    full = unconstrained(assembly)
    held = np.unique(faces[0].plus)
    keep = np.setdiff1d(full.free, (6 * held[:, None] + np.arange(6)).ravel())
    reduced = DofMap(transformation=full.transformation[:, keep].tocsr(), free=keep)
    spec = InterfaceSpec(name="joint")
    free, stuck = (
        build_interface(assembly, d, spec, faces, normal_law(1.0)) for d in (full, reduced)
    )
    difference = free.gap_operator[:, keep] - stuck.gap_operator
    assert abs(difference).max() == 0
    assert stuck.relative_operator.nnz == len(stuck.pairs)


def test_a_facet_without_area_is_refused():
    mesh = Mesh(nodes=np.zeros((8, 3)), node_ids=np.arange(8))
    faces = (FacePairs(kind="quad4", minus=[[0, 1, 2, 3]], plus=[[4, 5, 6, 7]]),)
    assembly = Assembly(mesh=mesh)
    with pytest.raises(ModelError, match="has no area"):
        build_interface(
            assembly, unconstrained(assembly), InterfaceSpec(name="joint"), faces, normal_law(1.0)
        )


def test_the_seeds_joint_has_its_pairs_and_the_designs_penalty():
    joint = lap_joint_assembly()
    (faces,) = find_interfaces(joint.assembly, joint.interfaces[0]).values()
    # 10 E/h = 8.4e5 on 2.5 mm bricks, 148 pairs with the hole.
    assert automatic_penalty(joint.assembly, faces) == pytest.approx(8.4e5, rel=1e-12)
    built = build_interface(
        joint.assembly,
        unconstrained(joint.assembly),
        joint.interfaces[0],
        faces,
        normal_law(8.4e5),
    )
    assert len(built.pairs) == 148
    assert built.n_points == 464


@pytest.mark.parametrize("shape", SHAPES)
def test_automatic_penalty_takes_the_softer_side_and_the_elements_height(shape):
    assembly = lap(shape, thickness=15.0)
    soft = Material(name="soft", youngs_modulus=7e4, poissons_ratio=0.3, density=2.7e-9)
    assembly = replace(assembly, materials={**assembly.materials, 2: soft})
    faces = pair_facets(assembly, InterfaceSpec(name="joint"))
    # Layers of 5 mm; tetrahedra and wedges from bricks reach as deep as the brick.
    assert automatic_penalty(assembly, faces) == pytest.approx(10 * 7e4 / 5.0, rel=1e-12)


def test_automatic_penalty_needs_elements_and_materials():
    assembly = lap()
    faces = pair_facets(assembly, InterfaceSpec(name="joint"))
    with pytest.raises(ModelError, match="property 1 has no material"):
        automatic_penalty(replace(assembly, materials={}), faces)
    (entry,) = faces
    mesh = Mesh(nodes=assembly.mesh.nodes, node_ids=assembly.mesh.node_ids)
    sets = {"a": entry.minus, "b": entry.plus[:, ::-1]}
    matrices_only = Assembly(mesh=mesh, face_sets=sets)
    spec = InterfaceSpec(name="joint", minus="a", plus="b")
    (found,) = pair_facets(matrices_only, spec)
    np.testing.assert_array_equal(found.plus, entry.plus)
    with pytest.raises(ModelError, match="give the penalty as a number"):
        automatic_penalty(matrices_only, (found,))


def reference_points(mesh, rule):
    """Coordinates of the reference program's quadrature points, facet by facet."""
    xi = mesh["quad_gauss2"] if rule == "gauss2" else np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    shape = np.prod(1 + xi[:, None] * corner, axis=2) / 4
    return np.einsum("qa,fad->fqd", shape, mesh["pair_xy"][mesh["faces"]]).reshape(-1, 2)


@pytest.mark.parametrize("case", ["P0", "LC1", "LC2"])
@pytest.mark.parametrize(("rule", "quadrature"), [("gauss2", "gauss"), ("lobatto", "nodal")])
def test_pressures_of_another_program_follow_from_its_displacements(case, rule, quadrature):
    mesh, result = (np.load(REFERENCE / f"{name}.npz") for name in ("mesh", case))
    faces = mesh["pairs"][mesh["faces"]]
    nodes = mesh["nodes"]
    diagonal = nodes[faces[:, 2, 0]] - nodes[faces[:, 0, 0]]
    other = nodes[faces[:, 3, 0]] - nodes[faces[:, 1, 0]]
    # The file does not say how its facets run: make them face up, out of the lower plate.
    down = np.cross(diagonal, other)[:, 2] < 0
    faces[down] = faces[down, ::-1]
    assembly = Assembly(mesh=Mesh(nodes=nodes, node_ids=np.arange(len(nodes))))
    pairs = (FacePairs(kind="quad4", minus=faces[:, :, 0], plus=faces[:, :, 1]),)
    spec = InterfaceSpec(name="joint", quadrature=quadrature)
    joint = build_interface(assembly, unconstrained(assembly), spec, pairs, normal_law(1e6))
    gap = joint.gap_operator @ translations(result[f"u__{rule}"]) + joint.initial_gap
    pressure = joint.penalty * np.maximum(-gap, 0.0)
    points = reference_points(mesh, rule)
    distance = np.linalg.norm(points[:, None] - joint.points[None, :, :2], axis=2)
    assert distance.min(axis=1).max() < 1e-6
    theirs = result[f"p_quad__{rule}"]
    # Their displacements carry 16 digits: u of 1 mm against penetrations of 4e-5 mm.
    np.testing.assert_allclose(pressure[distance.argmin(axis=1)], theirs, atol=1e-8 * theirs.max())
    summary = json.loads((REFERENCE / "case.json").read_text())
    assert summary["n_pairs"] == len(joint.pairs)
    assert summary["n_faces"] == len(faces)


def test_sticking_pairs_of_the_reference_case():
    """The other program marks pairs whose nodal pressure exceeds half the largest in P0."""
    mesh, result = (np.load(REFERENCE / f"{name}.npz") for name in ("mesh", "P0"))
    faces = mesh["pairs"][mesh["faces"]]
    assembly = Assembly(mesh=Mesh(nodes=mesh["nodes"], node_ids=np.arange(len(mesh["nodes"]))))
    pairs = (FacePairs(kind="quad4", minus=faces[:, ::-1, 0], plus=faces[:, ::-1, 1]),)
    spec = InterfaceSpec(name="joint", quadrature="nodal")
    joint = build_interface(assembly, unconstrained(assembly), spec, pairs, normal_law(1e6))
    gap = joint.gap_operator @ translations(result["u__lobatto"])
    pressure = 1e6 * np.maximum(np.sign(joint.normals[0, 2]) * -gap, 0.0)
    stuck = joint.pairs[stuck_pairs(joint, pressure, 0.5)]
    expected = mesh["pairs"][mesh["stick"]]
    np.testing.assert_array_equal(np.sort(stuck.min(axis=1)), np.sort(expected.min(axis=1)))


def test_sticking_threshold_selects_by_nodal_average():
    joint = interface(lap(), quadrature="nodal")
    pressure = np.linspace(0.0, 10.0, joint.n_points)
    average = joint.nodal_average(pressure)
    np.testing.assert_array_equal(stuck_pairs(joint, pressure, 0.6), average > 6.0)
    assert stuck_pairs(joint, pressure, 0.0).sum() == joint.n_points - 1
    assert not stuck_pairs(joint, np.zeros(joint.n_points), 0.0).any()
    for threshold in (-0.1, 1.0, np.nan):
        with pytest.raises(ModelError, match="sticking threshold"):
            stuck_pairs(joint, pressure, threshold)


@pytest.mark.parametrize("curvature", [0.0, 2e-3])
def test_sticking_springs_hold_the_tangential_directions_only(curvature):
    assembly = lap(curvature=curvature)
    joint, dofs = interface(assembly), unconstrained(assembly)
    chosen = np.zeros(len(joint.pairs), dtype=bool)
    chosen[[3, 17, 40]] = True
    stiffness = sticking_stiffness(joint, chosen, 1e4)
    assert stiffness.shape == (dofs.transformation.shape[1],) * 2
    assert abs(stiffness - stiffness.T).max() == 0
    slide = np.random.default_rng(2).normal(size=(len(assembly.mesh.nodes), 3))
    relative = (slide[joint.pairs[:, 1]] - slide[joint.pairs[:, 0]])[chosen]
    normal = joint.pair_normals[chosen]
    tangential = relative - (relative * normal).sum(axis=1, keepdims=True) * normal
    energy = translations(slide) @ stiffness @ translations(slide)
    assert energy == pytest.approx(1e4 * (tangential**2).sum(), rel=1e-12)
    opening = np.zeros_like(slide)
    opening[joint.pairs[:, 1]] = joint.pair_normals
    # k (I - n nᵀ) n: rounding of 1e4.
    np.testing.assert_allclose(stiffness @ translations(opening), 0, atol=1e-11)
    nothing = sticking_stiffness(joint, np.zeros_like(chosen), 1e4)
    assert nothing.shape == stiffness.shape
    assert nothing.nnz == 0
    with pytest.raises(ModelError, match="sticking stiffness is 0"):
        sticking_stiffness(joint, chosen, 0.0)
