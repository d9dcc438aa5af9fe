"""Assembly of discrete parts and the messages about unusable elements."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from faying.exceptions import ModelError
from faying.io import abaqus, nastran
from faying.joint.build import structure_model
from faying.model.assembly import (
    Assembly,
    Beam,
    BeamSection,
    Material,
    MatrixBlock,
    PointMass,
    Spring,
)
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS
from faying.model.matrices import (
    assemble_matrices,
    mass_properties,
    rigid_body_motions,
    used_components,
)
from faying.model.mesh import Mesh
from faying.model.solid_cells import check_cells, tangled

STEEL = Material(youngs_modulus=210000.0, poissons_ratio=0.3, density=8e-9)


def nodes_only(n_node):
    nodes = np.zeros((n_node, 3))
    nodes[:, 0] = np.arange(n_node)
    return Mesh(nodes=nodes, node_ids=np.arange(n_node) + 101)


def one_cell(kind, change=lambda nodes: nodes, order=slice(None)):
    nodes = change(SOLIDS[kind].reference_nodes.copy())
    block = CellBlock(
        kind=kind, nodes=np.arange(len(nodes))[None, order], ids=np.array([77]), properties=[5]
    )
    return Mesh(nodes=nodes, node_ids=np.arange(len(nodes)), blocks=(block,))


def assembly_of(mesh, **fields):
    return Assembly(mesh=mesh, materials={5: STEEL}, **fields)


@pytest.mark.parametrize("kind", list(SOLIDS))
def test_inverted_element_is_named(kind):
    mirrored = one_cell(kind, lambda nodes: nodes * [1, 1, -1])
    text = rf"element 77 \({kind}\) has negative volume .*determinant -1\).*order"
    with pytest.raises(ModelError, match=text):
        assemble_matrices(assembly_of(mirrored))


@pytest.mark.parametrize("kind", list(SOLIDS))
def test_flat_element_is_named(kind):
    flat = one_cell(kind, lambda nodes: nodes * [1, 1, 0])
    text = rf"element 77 \({kind}\) has no volume .*determinant 0\).*collapsed"
    with pytest.raises(ModelError, match=text):
        assemble_matrices(assembly_of(flat))


def test_collapsed_corner_is_refused_although_quadrature_points_are_fine():
    collapsed = one_cell("hex8", order=np.array([0, 1, 2, 2, 4, 5, 6, 6]))
    with pytest.raises(ModelError, match=r"element 77 \(hex8\) has no volume at a corner.*wedge"):
        assemble_matrices(assembly_of(collapsed))


@pytest.mark.parametrize("corner", [0.6, 0.7])
def test_a_corner_alone_may_be_inside_out_and_is_told(corner):
    """Where (1, 1, 1) of the unit cube moves to (c, c, c) the determinant there is 3 c - 2."""
    nodes = SOLIDS["hex8"].reference_nodes
    moved = np.where((nodes == 1).all(axis=1)[:, None], corner, nodes)
    assembly = assembly_of(one_cell("hex8", lambda _: moved))
    assert ("(77)" in tangled(assembly)) is (corner < 2 / 3)
    stiffness = assemble_matrices(assembly).K.toarray()
    solids = np.arange(48).reshape(8, 6)[:, :3].ravel()
    values = np.linalg.eigvalsh(stiffness[np.ix_(solids, solids)])
    assert (values > 1e-6 * values[-1]).sum() == 18  # all but six rigid motions, round-off 1e-15


def test_thin_element_is_accepted():
    thin = one_cell("hex8", lambda nodes: nodes * [100, 100, 1e-3])
    found = mass_properties(assembly_of(thin))
    assert found.mass == pytest.approx(8e-9 * 10, rel=1e-12)  # rounding


def test_count_of_other_bad_elements_is_told():
    cell = one_cell("tet4", lambda nodes: nodes * [1, 1, -1])
    block = CellBlock(kind="tet4", nodes=[[0, 1, 2, 3]] * 3, ids=[7, 8, 9], properties=[5] * 3)
    mesh = Mesh(nodes=cell.nodes, node_ids=cell.node_ids, blocks=(block,))
    with pytest.raises(ModelError, match=r"element 7 \(tet4\) \(and 2 more elements\)"):
        assemble_matrices(assembly_of(mesh))


def lone(kind, nodes, number=5):
    """Mesh of five nodes in one place, and one cell."""
    block = CellBlock(kind=kind, nodes=[nodes], ids=[number], properties=[5])
    return Mesh(nodes=np.zeros((5, 3)), node_ids=np.arange(5), blocks=(block,))


@pytest.mark.parametrize(
    ("assembly", "message"),
    [
        (
            Assembly(mesh=one_cell("hex8")),
            r"property 5 \(of element 77, hex8\) has no material",
        ),
        (
            assembly_of(one_cell("hex8"), element="selective"),
            r"'selective'.*'standard' or 'incompatible'",
        ),
        (assembly_of(lone("pyramid7", range(5))), r"'pyramid7'.*hex8"),
        (assembly_of(lone("hex8", range(4))), "needs 8 nodes"),
        (
            assembly_of(lone("tet4", [0, 1, 2, 5], number=6)),
            r"element 6 \(tet4\) uses node index 5; the mesh has 5",
        ),
    ],
)
def test_cells_that_cannot_be_are_named(assembly, message):
    with pytest.raises(ModelError, match=message):
        assemble_matrices(assembly)


def test_two_materials_in_one_block_and_two_blocks_add_up():
    heavy = Material(youngs_modulus=70000.0, poissons_ratio=0.2, density=5e-9)
    cell = one_cell("hex8")
    upper = cell.nodes + np.array([0, 0, 1])
    nodes = np.vstack([cell.nodes, upper[4:]])
    stack = [[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]]
    together = (CellBlock(kind="hex8", nodes=stack, ids=[1, 2], properties=[5, 6]),)
    apart = tuple(
        CellBlock(kind="hex8", nodes=[row], ids=[i], properties=[5 + i])
        for i, row in enumerate(stack)
    )
    one, two = (
        assemble_matrices(
            Assembly(
                mesh=Mesh(nodes=nodes, node_ids=np.arange(12), blocks=blocks),
                materials={5: STEEL, 6: heavy},
            )
        )
        for blocks in (together, apart)
    )
    # The same two element matrices added: rounding only.
    assert abs(one.K - two.K).max() < 1e-14 * abs(one.K).max()
    assert abs(one.M - two.M).max() < 1e-14 * abs(one.M).max()
    assert one.M.sum() / 3 == pytest.approx(13e-9, rel=1e-13)


def test_batches_do_not_change_the_matrices(monkeypatch):
    lattice = np.stack(np.meshgrid(*[np.arange(4.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    first = (lattice.max(axis=1) < 3).nonzero()[0]
    corner = np.array([0, 16, 20, 4, 1, 17, 21, 5])
    block = CellBlock(
        kind="hex8", nodes=first[:, None] + corner, ids=np.arange(27), properties=np.full(27, 5)
    )
    mesh = Mesh(nodes=lattice, node_ids=np.arange(64), blocks=(block,))
    whole = assemble_matrices(assembly_of(mesh))
    monkeypatch.setattr("faying.linalg.pieces.PIECE_NUMBERS", 4 * 24**2)
    pieces = assemble_matrices(assembly_of(mesh))
    assert abs(whole.K - pieces.K).max() < 1e-15 * abs(whole.K).max() * 8  # eight terms per entry
    assert abs(whole.M - pieces.M).max() < 1e-15 * abs(whole.M).max() * 8


def test_springs_between_points_and_to_ground():
    springs = (
        Spring(id=1, ends=((0, 0), (1, 0)), stiffness=10.0),
        Spring(id=2, ends=((1, 0),), stiffness=3.0),
        Spring(id=3, ends=((0, 5), (1, 5)), stiffness=7.0),
    )
    assembly = Assembly(mesh=nodes_only(2), springs=springs)
    expected = np.zeros((12, 12))
    expected[np.ix_([0, 6], [0, 6])] = [[10, -10], [-10, 13]]
    expected[np.ix_([5, 11], [5, 11])] = [[7, -7], [-7, 7]]
    np.testing.assert_array_equal(assemble_matrices(assembly).K.toarray(), expected)
    np.testing.assert_array_equal(np.flatnonzero(used_components(assembly)), [0, 5, 6, 11])
    with pytest.raises(ModelError, match="spring 4 has 0 ends"):
        assemble_matrices(
            Assembly(mesh=nodes_only(1), springs=(Spring(id=4, ends=(), stiffness=1),))
        )


def test_point_masses_give_their_own_mass_properties():
    inertia = ((4.0, 0.5, 0.0), (0.5, 5.0, 0.0), (0.0, 0.0, 6.0))
    masses = (PointMass(id=1, node=0, mass=2.0), PointMass(id=2, node=3, mass=1.0, inertia=inertia))
    assembly = Assembly(mesh=nodes_only(4), masses=masses)
    found = mass_properties(assembly)
    assert found.mass == pytest.approx(3.0, rel=1e-15)
    np.testing.assert_allclose(found.centre, [1, 0, 0], atol=1e-15)
    # Two masses 3 apart: reduced mass 2/3 times 9.
    np.testing.assert_allclose(found.inertia, np.array(inertia) + np.diag([0, 6, 6]), rtol=1e-14)
    np.testing.assert_array_equal(
        np.flatnonzero(used_components(assembly)), [0, 1, 2, *range(18, 24)]
    )


def test_massless_structure_has_zero_mass():
    spring = Spring(id=2, ends=((1, 0),), stiffness=3.0)
    found = mass_properties(Assembly(mesh=nodes_only(2), springs=(spring,)))
    assert found.mass == 0.0
    assert not found.inertia.any()


@pytest.mark.parametrize("kind", list(SOLIDS))
def test_mass_properties_are_those_of_the_mass_matrix(kind):
    rng = np.random.default_rng(1)
    mesh = one_cell(kind, lambda nodes: 3 + nodes + rng.uniform(-0.05, 0.05, nodes.shape))
    beam = Beam(
        id=3,
        nodes=(0, 1),
        property=1,
        material=STEEL,
        section=BeamSection(area=2.0, inertia_y=0.1, inertia_z=0.3, torsion=0.4),
        orientation=(0.3, 0.5, 1.0),
    )
    masses = (PointMass(id=1, node=1, mass=2e-9),)
    assembly = assembly_of(mesh, beams=(beam,), masses=masses)
    found = mass_properties(assembly)
    motion = rigid_body_motions(mesh.nodes, found.centre)
    rigid = motion.T @ (assemble_matrices(assembly).M @ motion)
    # Sums of some dozens of numbers in another order.
    np.testing.assert_allclose(rigid[:3, :3], found.mass * np.eye(3), atol=1e-14 * found.mass)
    np.testing.assert_allclose(rigid[3:, :3], 0.0, atol=1e-14 * found.mass)  # of sides of 1
    np.testing.assert_allclose(rigid[3:, 3:], found.inertia, atol=1e-13 * found.inertia.max())


def test_inertia_far_from_the_origin_keeps_its_digits():
    near, far = (one_cell("hex8", lambda n, s=s: n + s) for s in (0.0, 1e4))
    inertia = [mass_properties(assembly_of(mesh)).inertia for mesh in (near, far)]
    # Coordinates of size 1e4 carry a relative rounding of 1e-12 of the unit cell.
    np.testing.assert_allclose(inertia[1], inertia[0], atol=1e-11 * inertia[0].max())


def test_matrices_of_another_program_are_added_and_repeated_rows_summed():
    M = sp.csr_array(np.diag([1.0, 2.0, 3.0]))
    K = sp.csr_array(np.array([[2.0, -1, 0], [-1, 2, -1], [0, -1, 1]]))
    block = MatrixBlock(M=M, K=K, nodes=[1, 0, 1], components=[2, 4, 2])
    spring = Spring(id=1, ends=((1, 2),), stiffness=10.0)
    assembly = Assembly(mesh=nodes_only(2), matrices=block, springs=(spring,))
    found = assemble_matrices(assembly)
    assert found.C is None
    assert found.M[8, 8] == 4.0
    assert found.M[4, 4] == 2.0
    assert found.K[8, 8] == 13.0
    assert found.K[8, 4] == found.K[4, 8] == -2.0
    np.testing.assert_array_equal(np.flatnonzero(used_components(assembly)), [4, 8])


def test_damping_comes_from_the_matrix_block():
    one = sp.csr_array(np.eye(1))
    block = MatrixBlock(M=one, C=3 * one, K=one, nodes=[0], components=[1])
    C = assemble_matrices(Assembly(mesh=nodes_only(1), matrices=block)).C
    assert C is not None
    assert C[1, 1] == 3.0


def test_matrix_block_of_the_wrong_size_is_refused():
    one = sp.csr_array(np.eye(2))
    block = MatrixBlock(M=one, K=one, nodes=[0, 0, 0], components=[0, 1, 2])
    with pytest.raises(ModelError, match=r"matrix M has shape \(2, 2\) but 3 nodes"):
        assemble_matrices(Assembly(mesh=nodes_only(1), matrices=block))


def test_solids_use_translations_only_and_beams_all_components():
    mesh = one_cell("tet4")
    section = BeamSection(area=1.0, inertia_y=1.0, inertia_z=1.0, torsion=1.0)
    beam = Beam(id=1, nodes=(0, 1), section=section, material=STEEL, orientation=(0, 1, 0))
    used = used_components(assembly_of(mesh, beams=(beam,))).reshape(-1, 6)
    assert used[:2].all()
    assert used[2:, :3].all()
    assert not used[2:, 3:].any()


def test_beams_that_cannot_be_placed_are_named():
    section = BeamSection(area=1.0, inertia_y=1.0, inertia_z=1.0, torsion=1.0)
    along = Beam(id=8, nodes=(0, 1), section=section, material=STEEL, orientation=(2, 0, 0))
    with pytest.raises(ModelError, match=r"beam 8: the orientation vector.*parallel"):
        assemble_matrices(Assembly(mesh=nodes_only(2), beams=(along,)))
    short = Beam(id=9, nodes=(1, 1), section=section, material=STEEL, orientation=(0, 1, 0))
    with pytest.raises(ModelError, match="beam 9: its two nodes coincide"):
        assemble_matrices(Assembly(mesh=nodes_only(2), beams=(short,)))


def test_results_are_read_only():
    matrices = assemble_matrices(assembly_of(one_cell("hex8")))
    with pytest.raises(ValueError, match="read-only"):
        matrices.K.data[0] = 1.0


def test_registry_is_imported_without_scikit_fem():
    code = "import sys, faying.model.matrices; sys.exit('skfem' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_cells_listed_twice_are_refused(tmp_path):
    """In another block, with other nodes in front, in decks of every kind."""
    mesh = one_cell("hex8")
    (block,) = mesh.blocks
    # Turned by 180° about its axis, which leaves it right side out.
    again = replace(block, nodes=block.nodes[:, [2, 3, 0, 1, 6, 7, 4, 5]], ids=np.array([99]))
    check_cells(assembly_of(mesh))
    text = r"elements 77 and 99 have the same corners: .* twice there; remove one \(1 such"
    with pytest.raises(ModelError, match=text):
        check_cells(assembly_of(replace(mesh, blocks=(block, again))))
    places = list(enumerate(mesh.nodes.tolist(), 1))
    (tmp_path / "a.bdf").write_text(
        "".join(f"GRID,{i},,{x},{y},{z}\n" for i, (x, y, z) in places)
        + "CHEXA,1,1,1,2,3,4,5,6\n,7,8\nCHEXA,2,1,1,2,3,4,5,6\n,7,8\nPSOLID,1,1\nMAT1,1,1.,,.3\n"
    )
    (tmp_path / "a.inp").write_text(
        "*NODE\n"
        + "".join(f"{i}, {x}, {y}, {z}\n" for i, (x, y, z) in places)
        + "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n2, 1, 2, 3, 4, 5, 6, 7, 8\n"
        + "*MATERIAL, NAME=M\n*ELASTIC\n1., .3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"
    )
    for described in (
        nastran.read_joint(tmp_path / "a.bdf"),
        abaqus.read_joint(tmp_path / "a.inp"),
    ):
        with pytest.raises(ModelError, match="elements 1 and 2 have the same corners"):
            structure_model(described.assembly)
