"""Mesh files: groups become materials, sets and faces; fragmented parts come apart."""

from dataclasses import replace

import meshio
import numpy as np
import pytest
from meshio._mesh import topological_dimension

from faying.exceptions import FormatError, ModelError
from faying.io.mesh_files import read_mesh_file
from faying.joint.build import build_model
from faying.model.assembly import Material, Spring, Support
from faying.model.bodies import separated
from faying.model.elements import SOLIDS
from faying.model.generate import brick_grid, shaped
from faying.model.matrices import assemble_matrices, mass_properties
from faying.model.specs import BoundarySpec, InterfaceSpec
from faying.simulation.load import Load
from faying.simulation.path import solve_static

topological_dimension.setdefault("wedge15", 3)  # as the reader does

STEEL = Material(name="default", youngs_modulus=210e3, poissons_ratio=0.29, density=7.82e-9)
MATERIALS = {"default": STEEL}
LAYERS = np.array([0.0, 1.0, 2.0])
PLAN = np.array([0.0, 1.0, 2.0])
MESHIO = {
    "tet4": "tetra",
    "tet10": "tetra10",
    "hex8": "hexahedron",
    "hex20": "hexahedron20",
    "wedge6": "wedge",
    "wedge15": "wedge15",
}
TO_MESHIO = {
    "hex20": [*range(12), *range(16, 20), *range(12, 16)],
    "wedge15": [*range(9), *range(12, 15), *range(9, 12)],
}


def fragmented(kind):
    """A block of two layers that share the nodes between them, as a mesher makes it."""
    cells = shaped(brick_grid(PLAN, PLAN, LAYERS), kind)
    upper = cells.centroids()[:, 2] > 1
    table = cells.cells[:, TO_MESHIO.get(kind, slice(None))]
    numbers = np.arange(len(table))
    groups = {"lower": [numbers[~upper]], "upper": [numbers[upper]]}
    return meshio.Mesh(cells.nodes, [(MESHIO[kind], table)], cell_sets=groups)


def tagged(mesh):
    """The same groups as numbers of a gmsh file."""
    tags = np.where(np.isin(np.arange(len(mesh.cells[0].data)), mesh.cell_sets["upper"][0]), 7, 3)
    return meshio.Mesh(
        mesh.points,
        mesh.cells,
        cell_data={"gmsh:physical": [tags], "gmsh:geometrical": [tags]},
        field_data={"lower": np.array([3, 3]), "upper": np.array([7, 3])},
    )


def written(mesh, path, **options):
    meshio.write(path, mesh, **options)
    return path


def as_gmsh(kind, tmp_path):
    mesh = tagged(fragmented(kind))
    return written(mesh, tmp_path / "block.msh", file_format="gmsh22", binary=False)


@pytest.mark.parametrize("kind", list(MESHIO))
def test_solids_come_in_our_order(kind, tmp_path):
    """A wrong node order inverts elements or changes their volume."""
    assembly = read_mesh_file(as_gmsh(kind, tmp_path), materials=MATERIALS)
    assert [block.kind for block in assembly.mesh.blocks] == [kind]
    weight = mass_properties(assembly)
    # exact volume of straight elements; round-off of the sums
    assert weight.mass == pytest.approx(8 * STEEL.density, rel=1e-13)
    K = assemble_matrices(assembly).K
    translation = np.tile([1.0, 0, 0, 0, 0, 0], len(assembly.mesh.nodes))
    assert np.abs(K @ translation).max() < 1e-9 * abs(K).max()  # no force on rigid motion


def test_groups_are_materials_and_sets(tmp_path):
    soft = Material(name="upper", youngs_modulus=70e3, poissons_ratio=0.3, density=2.7e-9)
    assembly = read_mesh_file(as_gmsh("hex8", tmp_path), materials={**MATERIALS, "upper": soft})
    mesh = assembly.mesh
    assert set(mesh.element_sets) == {"lower", "upper"}
    owners = dict(zip(mesh.element_ids.tolist(), mesh.element_properties.tolist(), strict=True))
    moduli = {
        name: {
            assembly.materials[owners[i]].youngs_modulus for i in mesh.element_sets[name].tolist()
        }
        for name in mesh.element_sets
    }
    assert moduli == {"lower": {210e3}, "upper": {70e3}}


@pytest.mark.parametrize("kind", list(MESHIO))
def test_separated_layers_touch_in_matching_facets(kind, tmp_path):
    path = as_gmsh(kind, tmp_path)
    assert read_mesh_file(path, materials=MATERIALS).mesh.bodies.max() == 0
    assembly = read_mesh_file(path, materials=MATERIALS, separate=("upper",))
    assert assembly.mesh.bodies.max() == 1
    low = np.flatnonzero(assembly.mesh.nodes[:, 2] == 0)
    top = np.flatnonzero(assembly.mesh.nodes[:, 2] == 2)
    mesh = assembly.mesh.with_node_set("low", low).with_node_set("top", top)
    held = Support(id=1, nodes=low, components=(0, 1, 2))
    # one soft spring a component of the loose layer: contact carries the load
    springs = tuple(
        Spring(id=10**6 + i, ends=((int(node), c),), stiffness=1e-3)
        for i, (node, c) in enumerate((node, c) for node in top for c in range(3))
    )
    model = build_model(
        replace(assembly, mesh=mesh, supports=(held,), springs=springs),
        interfaces=[InterfaceSpec(name="joint", minus="lower", plus="upper")],
        boundaries=[BoundarySpec(name="top", set="top")],
    )
    assert model.interfaces["joint"].area == pytest.approx(4.0, rel=1e-12)
    pressed = solve_static(model, Load({"top.Fz": -100.0}))
    # the springs share the load with K of the block at 1e-3 / 1e5
    assert pressed.contact_force("joint") == pytest.approx(100.0, rel=1e-5)


def test_separating_keeps_node_sets_on_both_sides(tmp_path):
    mesh = read_mesh_file(as_gmsh("hex8", tmp_path), materials=MATERIALS).mesh
    between = np.flatnonzero(mesh.nodes[:, 2] == 1)
    apart = separated(mesh.with_node_set("seam", between), ["upper"])
    assert len(apart.node_sets["seam"]) == 2 * len(between)
    assert len(separated(apart, ["lower"]).nodes) == len(apart.nodes)  # nothing is shared any more
    with pytest.raises(ModelError, match=r"no element set 'middle'.*'lower', 'upper'"):
        separated(mesh, ["middle"])


def test_separated_bodies_keep_the_surface_groups_of_their_own_faces(tmp_path):
    """What holds a side of one layer held the edge of the other one, which shares its nodes."""
    mesh = tagged(fragmented("hex8"))
    cells = mesh.cells[0].data[:, [0, 4, 7, 3]]
    sides = cells[(mesh.points[cells][:, :, 0] == 0).all(axis=1)]
    upper = mesh.points[sides][:, :, 2].mean(axis=1) > 1
    both = meshio.Mesh(
        mesh.points,
        [("quad", sides), *mesh.cells],
        cell_data={k: [np.where(upper, 8, 9), *v] for k, v in mesh.cell_data.items()},
        field_data={**mesh.field_data, "left": np.array([9, 2]), "top left": np.array([8, 2])},
    )
    path = written(both, tmp_path / "sides.msh", file_format="gmsh22", binary=False)
    assembly = read_mesh_file(path, materials=MATERIALS, separate=("upper",))
    for name, body in (("left", 0), ("top left", 1)):
        nodes = assembly.mesh.node_sets[name]
        np.testing.assert_array_equal(assembly.mesh.bodies[nodes], body)
        np.testing.assert_array_equal(np.unique(assembly.face_sets[name][:, :4]), np.sort(nodes))
        assert len(nodes) == 6


def test_surface_groups_face_outwards(tmp_path):
    """A mesher's facets may be turned the wrong way; ours come from the solids."""
    mesh = tagged(fragmented("hex8"))
    top = np.array([f[[0, 3, 2, 1]] for f in _top_faces(mesh)])
    for faces in (top, top[:, ::-1]):
        both = meshio.Mesh(
            mesh.points,
            [("quad", faces), *mesh.cells],
            cell_data={
                key: [np.full(len(faces), 9), *values] for key, values in mesh.cell_data.items()
            },
            field_data={**mesh.field_data, "lid": np.array([9, 2])},
        )
        path = written(both, tmp_path / "lid.msh", file_format="gmsh22", binary=False)
        lid = read_mesh_file(path, materials=MATERIALS).face_sets["lid"]
        corners = mesh.points[lid[:, :4]]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])
        assert (normals[:, 2] > 0).all()


def _top_faces(mesh):
    cells = mesh.cells[0].data[mesh.cell_sets["upper"][0]] if mesh.cell_sets else mesh.cells[0].data
    faces = cells[:, 4:]
    return faces[(mesh.points[faces][:, :, 2] == 2).all(axis=1)]


@pytest.mark.parametrize(
    ("name", "content", "fragments"),
    [
        ("none.msh", None, ["'", "does not exist"]),
        ("deck.bdf", "GRID,1", ["would drop", 'source = "nastran"']),
        ("deck.inp", "*NODE", ["would drop", 'source = "abaqus"']),
        ("bad.msh", "$MeshFormat\nno\n", ["cannot be read", "write it again"]),
        ("bad.vtu", "<VTKFile", ["cannot be read"]),
        ("what.xyz", "1 2 3", ["cannot be read"]),
    ],
)
def test_unreadable_files_are_named(name, content, fragments, tmp_path, capsys):
    path = tmp_path / name
    if content is not None:
        path.write_text(content)
    with pytest.raises(FormatError) as caught:
        read_mesh_file(path, materials=MATERIALS)
    assert name in str(caught.value)
    for fragment in fragments:
        assert fragment in str(caught.value)
    assert capsys.readouterr().out == ""


def test_groups_without_material_and_without_solids(tmp_path):
    path = as_gmsh("tet4", tmp_path)
    with pytest.raises(FormatError, match=r"group 'lower' has no material; add \[material.lower\]"):
        read_mesh_file(path, materials={"upper": STEEL})
    flat = meshio.Mesh(np.eye(3), [("triangle", np.array([[0, 1, 2]]))])
    with pytest.raises(FormatError, match="has no solids"):
        read_mesh_file(written(flat, tmp_path / "flat.vtu"), materials=MATERIALS)


def test_solids_of_other_kinds_are_refused(tmp_path):
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1.0]])
    many = np.vstack([points, np.zeros((9, 3))])
    pyramid = meshio.Mesh(many, [("pyramid14", np.arange(14)[None])])
    with pytest.raises(FormatError, match="solids of kind 'pyramid14'; mesh with tetrahedra"):
        read_mesh_file(
            written(pyramid, tmp_path / "p.msh", file_format="gmsh22", binary=False),
            materials=MATERIALS,
        )


def test_pyramids(tmp_path):
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1.0]])
    mesh = meshio.Mesh(points, [("pyramid", np.array([[0, 1, 2, 3, 4]]))])
    found = read_mesh_file(written(mesh, tmp_path / "p.vtu"), materials=MATERIALS)
    assert [block.kind for block in found.mesh.blocks] == ["pyramid5"]


def test_pyramids_with_mid_side_nodes(tmp_path, monkeypatch):
    """In MED, which meshio reads without knowing that they are solids."""
    pytest.importorskip("h5py", reason="MED is read with h5py")
    places = SOLIDS["pyramid13"].reference_nodes
    monkeypatch.setitem(topological_dimension, "pyramid13", 3)
    mesh = meshio.Mesh(places, [("pyramid13", np.arange(13)[None])])
    path = written(mesh, tmp_path / "p.med")
    monkeypatch.delitem(topological_dimension, "pyramid13")
    found = read_mesh_file(path, materials=MATERIALS)
    (block,) = found.mesh.blocks
    assert block.kind == "pyramid13"
    np.testing.assert_array_equal(block.nodes, [range(13)])


def test_meshes_of_a_salome_file_are_joined_and_their_groups_have_names(tmp_path):
    """Two bricks over each other, each a mesh of its own; one has solids without a group.

    Both know the groups by name, so that the mesh tells them apart.
    """
    h5py = pytest.importorskip("h5py", reason="MED is read with h5py")
    places = SOLIDS["hex8"].reference_nodes
    bricks = np.arange(8)[None]
    with h5py.File(tmp_path / "two.med", "w") as both:
        for z, name in enumerate(("low", "up")):
            cells = [("hexahedron", bricks), ("quad", np.arange(4)[None])]
            tags = [np.array([-1 if z else 0]), np.array([-2])]
            mesh = meshio.Mesh(
                places + np.array([0, 0, 2.0 * z]), cells, cell_data={"cell_tags": tags}
            )
            mesh.cell_tags = {-1: ["body"], -2: ["foot"]}
            meshio.med.write(tmp_path / "one.med", mesh)
            with h5py.File(tmp_path / "one.med") as one:
                for folder in ("ENS_MAA", "FAS"):
                    (own,) = one[folder]
                    one.copy(f"{folder}/{own}", both.require_group(folder), name=name)
    found = read_mesh_file(tmp_path / "two.med", materials=MATERIALS)
    assert [len(block.ids) for block in found.mesh.blocks] == [1, 1]
    assert {name: ids.tolist() for name, ids in found.mesh.element_sets.items()} == {
        "low": [1],
        "up/body": [2],
    }
    assert set(found.face_sets) == {"low/foot", "up/foot"}
    np.testing.assert_array_equal(found.mesh.nodes[8:], places + np.array([0, 0, 2]))
    alone = read_mesh_file(tmp_path / "one.med", materials=MATERIALS)
    assert set(alone.mesh.element_sets) == {"body"}


def test_ungrouped_solids_are_one_group(tmp_path):
    mesh = fragmented("tet10")
    bare = meshio.Mesh(mesh.points, mesh.cells)
    assembly = read_mesh_file(written(bare, tmp_path / "bare.vtu"), materials=MATERIALS)
    assert list(assembly.mesh.element_sets) == ["solids"]


def test_forgotten_solids_are_named(tmp_path):
    mesh = tagged(fragmented("hex8"))
    tags = np.where(mesh.cell_data["gmsh:physical"][0] == 7, 0, 3)
    lost = meshio.Mesh(mesh.points, mesh.cells, cell_data={"material": [tags]})
    with pytest.raises(FormatError, match="4 solids belong to no group"):
        read_mesh_file(written(lost, tmp_path / "lost.vtu"), materials=MATERIALS)
