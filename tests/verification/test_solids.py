"""Solid elements against exact answers, scikit-fem's own assembly and the reference matrices."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import spsolve
from skfem.helpers import dot
from skfem.models.elasticity import lame_parameters, linear_elasticity

from faying.interface.facets import shape_functions as facet_shape_functions
from faying.model.assembly import Assembly, Material
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS, solid_element
from faying.model.elements.solid_element import shape_gradients, shape_values
from faying.model.matrices import assemble_matrices, mass_properties, rigid_body_motions
from faying.model.mesh import Mesh
from solid_blocks import STEEL, one_sheared_cell, solid_assembly, solid_block, solid_dofs

DATA = Path(__file__).parents[1] / "data" / "lap_joint"
FORMULATIONS = [
    ("hex8", "standard"),
    ("hex8", "incompatible"),
    ("hex8", "reduced"),
    ("hex8", "reduced-abaqus"),
    ("hex20", "standard"),
    ("hex20", "reduced"),
    ("tet4", "standard"),
    ("tet10", "standard"),
    ("wedge6", "standard"),
    ("wedge15", "standard"),
    ("pyramid5", "standard"),
    ("pyramid13", "standard"),
]
every_solid = pytest.mark.parametrize(("kind", "formulation"), FORMULATIONS)
SIZE = np.array([3.0, 2.0, 4.0])
CELLS = (3, 2, 3)
# Interior corners move by up to a fifth of a cell: clearly distorted, yet no cell is inverted.
DISTORTION = 0.2


def nodal_matrices(assembly: Assembly):
    """M and K on the translations only."""
    matrices = assemble_matrices(assembly)
    dofs = solid_dofs(len(assembly.mesh.nodes))
    return matrices.M[dofs][:, dofs], matrices.K[dofs][:, dofs]


def on_surface(nodes):
    return np.any((nodes < 1e-9) | (nodes > SIZE - 1e-9), axis=1)


@every_solid
def test_patch_of_distorted_elements_reproduces_constant_strain(kind, formulation):
    mesh = solid_block(kind, CELLS, SIZE, DISTORTION)
    _, K = nodal_matrices(solid_assembly(mesh, formulation))
    gradient = np.random.default_rng(1).standard_normal((3, 3)) * 1e-3
    exact = (mesh.nodes @ gradient.T).ravel()
    held = np.repeat(on_surface(mesh.nodes), 3)
    free = ~held
    assert free.sum() >= 12
    solved = spsolve(K[free][:, free].tocsc(), -K[free][:, held] @ exact[held])
    # Rounding times a condition number below 1e4.
    assert np.abs(solved - exact[free]).max() < 1e-11 * np.abs(exact).max()


@every_solid
def test_constant_strain_stores_the_exact_energy(kind, formulation):
    mesh = solid_block(kind, CELLS, SIZE, DISTORTION)
    _, K = nodal_matrices(solid_assembly(mesh, formulation))
    gradient = np.random.default_rng(2).standard_normal((3, 3)) * 1e-3
    field = (mesh.nodes @ gradient.T).ravel()
    strain = (gradient + gradient.T) / 2
    lame, shear = lame_parameters(STEEL.youngs_modulus, STEEL.poissons_ratio)
    density = lame * np.trace(strain) ** 2 + 2 * shear * np.sum(strain**2)
    # Sums of about a thousand rounded terms.
    assert field @ (K @ field) == pytest.approx(density * SIZE.prod(), rel=1e-12)


@every_solid
@pytest.mark.parametrize("cells", [(1, 1, 1), (2, 2, 2)])
def test_only_the_six_rigid_motions_store_no_energy(kind, formulation, cells):
    mesh = solid_block(kind, cells, SIZE, DISTORTION)
    if cells == (1, 1, 1):
        if (kind, formulation) == ("hex20", "reduced"):
            pytest.skip("alone it has six more, which a neighbour holds")
        mesh = one_sheared_cell(mesh)
    _, K = nodal_matrices(solid_assembly(mesh, formulation))
    stiffness = np.linalg.eigvalsh(K.toarray())
    # Rounding of a dense eigenvalue solution against the softest elastic mode, above 1e-4.
    assert np.abs(stiffness[:6]).max() < 1e-12 * stiffness[-1]
    assert stiffness[6] > 1e-5 * stiffness[-1]


@every_solid
def test_rigid_motions_need_no_force_and_matrices_are_symmetric(kind, formulation):
    mesh = solid_block(kind, CELLS, SIZE, DISTORTION)
    matrices = assemble_matrices(solid_assembly(mesh, formulation))
    force = matrices.K @ rigid_body_motions(mesh.nodes, np.array([10.0, -20.0, 30.0]))
    # Rounding of displacements of size 40.
    assert np.abs(force).max() < 1e-13 * 40 * np.abs(matrices.K).max()
    assert abs(matrices.K - matrices.K.T).max() == 0.0
    assert abs(matrices.M - matrices.M.T).max() == 0.0
    # Sparse direct solvers ask for 32-bit indices.
    assert matrices.K.indices.dtype == matrices.M.indices.dtype == np.int32


@every_solid
def test_mass_properties_of_a_distorted_box_are_exact(kind, formulation):
    mesh = solid_block(kind, CELLS, SIZE, DISTORTION)
    found = mass_properties(solid_assembly(mesh, formulation))
    mass = STEEL.density * SIZE.prod()
    squares = SIZE**2
    inertia = mass / 12 * np.diag(squares.sum() - squares)
    # rᵀ M r is a sum of about a thousand rounded terms.
    assert found.mass == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(found.centre, SIZE / 2, rtol=1e-12)
    np.testing.assert_allclose(found.inertia, inertia, rtol=1e-11, atol=1e-12 * inertia.max())


@every_solid
def test_mass_of_a_distorted_box_is_positive_definite(kind, formulation):
    mesh = solid_block(kind, (1, 1, 1), SIZE)
    M, _ = nodal_matrices(solid_assembly(one_sheared_cell(mesh), formulation))
    masses = np.linalg.eigvalsh(M.toarray())
    assert masses[0] > 1e-3 * masses[-1]  # far above rounding


PURE_BENDING = [
    # Bricks must be rectangular for a quadratic field; tetrahedra need only straight edges.
    ("hex8", "incompatible", 0.0),
    ("hex20", "standard", 0.0),
    ("tet10", "standard", DISTORTION),
    ("wedge15", "standard", 0.0),
    # The middle of a rectangular brick: bases are rectangles, and edges straight.
    ("pyramid13", "standard", 0.0),
]


@pytest.mark.parametrize(("kind", "formulation", "distortion"), PURE_BENDING)
def test_pure_bending_is_exact(kind, formulation, distortion):
    """Saint-Venant's bending of a prism with anticlastic curvature, curvature 1e-3."""
    mesh = solid_block(kind, CELLS, SIZE, distortion)
    _, K = nodal_matrices(solid_assembly(mesh, formulation))
    curvature, ratio = 1e-3, STEEL.poissons_ratio
    x, y, z = (mesh.nodes - SIZE / 2).T
    field = curvature * np.stack(
        [x * z, -ratio * y * z, -(x**2 + ratio * (z**2 - y**2)) / 2], axis=1
    )
    force = (K @ field.ravel()).reshape(-1, 3)
    inside = (mesh.nodes[:, 0] > 1e-9) & (mesh.nodes[:, 0] < SIZE[0] - 1e-9)
    # Only the end faces carry load, for the sides of the prism are free.
    assert np.abs(force[inside]).max() < 1e-11 * np.abs(force).max()
    moment = STEEL.youngs_modulus * SIZE[1] * SIZE[2] ** 3 / 12 * curvature
    at_end = mesh.nodes[:, 0] > SIZE[0] - 1e-9
    assert np.sum(force[at_end, 0] * z[at_end]) == pytest.approx(moment, rel=1e-11)


def tip_deflection_ratio(kind, formulation, cells) -> float:
    """Deflection of a cantilever under end shear over that of Timoshenko's beam (ν = 0)."""
    length, width, height = 100.0, 10.0, 10.0
    material = Material(youngs_modulus=1000.0, poissons_ratio=0.0, density=1.0)
    mesh = solid_block(kind, cells, np.array([length, width, height]))
    _, K = nodal_matrices(solid_assembly(mesh, formulation, material))
    free = np.repeat(mesh.nodes[:, 0] > 1e-9, 3)
    at_tip = mesh.nodes[:, 0] > length - 1e-9
    # How the load is shared over the end face matters only locally (Saint-Venant).
    load = np.zeros((len(mesh.nodes), 3))
    load[at_tip, 2] = 1.0 / at_tip.sum()
    solution = np.zeros(3 * len(mesh.nodes))
    solution[free] = spsolve(K[free][:, free].tocsc(), load.ravel()[free])
    inertia, shear = width * height**3 / 12, material.shear_modulus
    exact = length**3 / (3 * 1000.0 * inertia) + length / (5 / 6 * shear * width * height)
    return float(solution @ load.ravel() / exact)


@pytest.mark.parametrize(
    ("kind", "formulation"),
    [
        ("hex8", "incompatible"),
        ("hex20", "standard"),
        ("tet10", "standard"),
        ("wedge15", "standard"),
        ("pyramid13", "standard"),
    ],
)
def test_cantilever_agrees_with_timoshenko_on_a_coarse_mesh(kind, formulation):
    # Two layers of cells; local deformation under the nodal loads is part of the compliance.
    assert tip_deflection_ratio(kind, formulation, (10, 2, 2)) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("kind", ["hex8", "tet4", "wedge6", "pyramid5"])
def test_linear_elements_are_too_stiff_and_converge(kind):
    coarse, fine = (tip_deflection_ratio(kind, "standard", (n * 8, n, n)) for n in (2, 4))
    assert coarse < fine < 1.0
    # The error of a linear element falls with h², a factor of four, less where it is still large.
    assert (1 - fine) < 0.45 * (1 - coarse)


def test_standard_hex8_equals_the_reference_matrices():
    data = np.load(DATA / "mesh.npz")
    n_cell = len(data["elems"])
    block = CellBlock(
        kind="hex8",
        nodes=data["elems"],
        ids=np.arange(n_cell),
        properties=np.ones(n_cell, dtype=int),
    )
    mesh = Mesh(nodes=data["nodes"], node_ids=np.arange(len(data["nodes"])), blocks=(block,))
    M, K = nodal_matrices(solid_assembly(mesh))
    # The same element in another program: rounding only.
    for ours, name in ((M, "M_free"), (K, "K_free")):
        theirs = sp.load_npz(DATA / f"{name}.npz")
        assert abs(ours - theirs).max() < 1e-13 * abs(theirs).max()


SKFEM_MESH = {
    "hex8": skfem.MeshHex1,
    "hex20": skfem.MeshHex1,
    "tet4": skfem.MeshTet1,
    "tet10": skfem.MeshTet1,
    "wedge6": skfem.MeshWedge1,
}


@pytest.mark.parametrize("kind", list(SKFEM_MESH))
def test_matrices_equal_those_of_scikit_fem(kind):
    element = SOLIDS[kind]
    mesh = solid_block(kind, CELLS, SIZE, DISTORTION)
    M, K = nodal_matrices(solid_assembly(mesh))
    stiffness_basis, mass_basis = (
        skfem_basis(element, mesh, rule())
        for rule in (element.stiffness_quadrature, element.mass_quadrature)
    )
    law = linear_elasticity(*lame_parameters(STEEL.youngs_modulus, STEEL.poissons_ratio))
    weight = skfem.BilinearForm(lambda u, v, w: STEEL.density * dot(u, v))
    order = node_of_dof(stiffness_basis, mesh.nodes)
    # The same integrals summed in another order.
    for ours, theirs in ((K, law.assemble(stiffness_basis)), (M, weight.assemble(mass_basis))):
        assert abs(ours[order][:, order] - theirs).max() < 1e-13 * abs(theirs).max()


def skfem_basis(element, mesh, rule):
    corners = mesh.blocks[0].nodes[:, : element.n_corners]
    theirs = getattr(skfem, element.shape_functions)()
    reference = np.asarray(theirs.doflocs)[: element.n_corners]
    ours = element.reference_nodes[: element.n_corners]
    order = [int(np.argmin(np.abs(ours - place).max(axis=1))) for place in reference]
    used = np.unique(corners)
    kind = SKFEM_MESH[element.kind]
    their_mesh = kind(mesh.nodes[used].T.copy(), np.searchsorted(used, corners)[:, order].T.copy())
    quadrature = (rule.points.T, rule.weights)
    return skfem.Basis(their_mesh, skfem.ElementVector(theirs), quadrature=quadrature)


def node_of_dof(basis, nodes):
    """Our degree of freedom (3 node + component) of each of scikit-fem's, by coordinates."""
    places = basis.doflocs.T
    distance = np.abs(places[:, None, :] - nodes[None]).max(axis=2)
    node = distance.argmin(axis=1)
    assert distance.min(axis=1).max() < 1e-12
    names = np.empty(basis.N, dtype=int)
    names[basis.element_dofs] = components(basis)
    return 3 * node + names


def components(basis):
    per_element = np.arange(basis.element_dofs.shape[0]) % 3
    return np.broadcast_to(per_element[:, None], basis.element_dofs.shape)


@pytest.mark.parametrize("kind", list(SOLIDS))
def test_face_normals_point_out_and_sum_to_the_volume(kind):
    """Divergence theorem: ∮ x·n dA = 3 V, each face taken in its own corner order."""
    element = SOLIDS[kind]
    cell = one_sheared_cell(solid_block(kind, (1, 1, 1), SIZE)).nodes
    centre = cell[: element.n_corners].mean(axis=0)
    total = 0.0
    for face, local in element.faces:
        n_corner = face.n_corners
        corners = cell[list(local[:n_corner])]
        vector, moment = face_integrals(corners)
        assert vector @ (corners.mean(axis=0) - centre) > 0
        total += moment
        # Mid-side k lies between corners k and k + 1.
        for k, middle in enumerate(local[n_corner : 2 * n_corner]):
            ends = (corners[k] + corners[(k + 1) % n_corner]) / 2
            np.testing.assert_allclose(cell[middle], ends, atol=1e-14)
    M, _ = nodal_matrices(solid_assembly(one_sheared_cell(solid_block(kind, (1, 1, 1), SIZE))))
    volume = M.sum() / 3 / STEEL.density
    assert total / 3 == pytest.approx(volume, rel=1e-12)  # both rules are exact, rounding remains


def face_integrals(corners):
    """∫ n dA and ∮ x·n dA of a flat triangle or a bilinear quadrilateral, by 2 x 2 points."""
    if len(corners) == 3:
        vector = np.cross(corners[1] - corners[0], corners[2] - corners[0]) / 2
        return vector, vector @ corners.mean(axis=0)
    vector, moment = np.zeros(3), 0.0
    for s in (0.5 - 12**-0.5, 0.5 + 12**-0.5):
        for t in (0.5 - 12**-0.5, 0.5 + 12**-0.5):
            shape = np.array([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
            along_s = np.array([t - 1, 1 - t, t, -t]) @ corners
            along_t = np.array([s - 1, -s, s, 1 - s]) @ corners
            normal = np.cross(along_s, along_t) / 4
            vector, moment = vector + normal, moment + normal @ (shape @ corners)
    return vector, moment


def test_formulation_only_concerns_hex8():
    assert solid_element("tet10", "incompatible") is SOLIDS["tet10"]
    assert solid_element("hex8", "incompatible") is not SOLIDS["hex8"]


@pytest.mark.parametrize("kind", list(SOLIDS))
def test_shape_functions_are_one_at_their_node_and_reproduce_their_polynomials(kind):
    element = SOLIDS[kind]
    nodes = element.reference_nodes
    np.testing.assert_allclose(shape_values(element, nodes), np.eye(len(nodes)), atol=1e-14)
    points = np.random.default_rng(5).uniform(0, 0.5, (7, 3))
    degree = 2 if element.n_nodes > element.n_corners else 1
    for exponents in product(range(degree + 1), repeat=3):
        if sum(exponents) <= degree:
            found = shape_values(element, points) @ np.prod(nodes**exponents, axis=1)
            # Rounding of numbers of size one.
            np.testing.assert_allclose(found, np.prod(points**exponents, axis=1), atol=1e-14)


@pytest.mark.parametrize("kind", list(SOLIDS))
def test_shape_gradients_are_the_derivatives(kind):
    element = SOLIDS[kind]
    points, step = np.random.default_rng(6).uniform(0, 0.5, (4, 3)), 1e-5
    found = shape_gradients(element, points)
    for axis in range(3):
        move = step * np.eye(3)[axis]
        slope = shape_values(element, points + move) - shape_values(element, points - move)
        # Central differences of quadratics and cubics: step² plus rounding over the step.
        np.testing.assert_allclose(found[:, axis], slope / (2 * step), atol=1e-8)


@pytest.mark.parametrize("kind", list(SOLIDS))
def test_on_a_face_only_its_nodes_count_and_as_in_the_facet(kind):
    """So that solids of any kind conform where they share a face."""
    element = SOLIDS[kind]
    local = np.array([[0.2, 0.3], [0.5, 0.1], [0.25, 0.6]])
    for kind_of_face, face in element.faces:
        on_facet = facet_shape_functions(kind_of_face.name, local)
        values = shape_values(element, on_facet @ element.reference_nodes[list(face)])
        np.testing.assert_allclose(values[:, list(face)], on_facet, atol=1e-14)
        others = np.setdiff1d(np.arange(element.n_nodes), face)
        np.testing.assert_allclose(values[:, others], 0, atol=1e-14)
