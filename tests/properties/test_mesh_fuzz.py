"""Damaged mesh files end in one message or in a mesh, never in a traceback, an exit or a hang."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from damage import damaged
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.exceptions import FayingError
from faying.io.mesh_files import read_mesh_file
from faying.model.assembly import Material
from faying.model.generate import brick_grid, shaped

STEEL = Material(name="steel", youngs_modulus=210e3, poissons_ratio=0.29, density=7.82e-9)
MATERIALS = {"default": STEEL}
LINES = np.array([0.0, 1.0, 2.0])
FORMATS = {
    "gmsh22": {"suffix": ".msh", "file_format": "gmsh22", "binary": False},
    "gmsh": {"suffix": ".msh", "file_format": "gmsh", "binary": False},
    "gmsh22-binary": {"suffix": ".msh", "file_format": "gmsh22", "binary": True},
    "vtu": {"suffix": ".vtu", "file_format": "vtu", "binary": False},
    "vtu-binary": {"suffix": ".vtu", "file_format": "vtu", "binary": True},
    "medit": {"suffix": ".mesh", "file_format": "medit"},
    "mail": {"suffix": ".mail"},
}
GMSH = ["gmsh:physical", "gmsh:geometrical"]


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, tuple[Path, bytes]]:
    folder = tmp_path_factory.mktemp("meshes")
    cells = shaped(brick_grid(LINES, LINES[:2], LINES[:2]), "tet4")
    tags = np.where(cells.centroids()[:, 0] > 1, 2, 1)
    mesh = meshio.Mesh(
        cells.nodes,
        [("tetra", cells.cells)],
        cell_data={},
        field_data={"left": np.array([1, 3]), "right": np.array([2, 3])},
    )
    found = {}
    for name, options in FORMATS.items():
        kept = {key: value for key, value in options.items() if key != "suffix"}
        path = folder / f"{name}{options['suffix']}"
        if name == "mail":
            found[name] = (folder, _mail(cells.nodes, cells.cells).encode())
            continue
        tagged = {"gmsh:dim_tags": np.tile([3, 1], (len(cells.nodes), 1))}
        mesh.point_data = tagged if kept["file_format"] == "gmsh" else {}
        # As text meshio writes other data than its own in a way that it cannot read.
        names = {"medit": ["medit:ref"], "vtu": []}.get(kept["file_format"], GMSH)
        mesh.cell_data = {name: [tags] for name in names}
        mesh.write(path, **kept)
        found[name] = (folder, path.read_bytes())
    return found


def _mail(nodes, cells) -> str:
    """The mesh for code_aster, which meshio does not write."""
    places = [f" N{i} {x} {y} {z}" for i, (x, y, z) in enumerate(nodes.tolist())]
    rows = [f" M{i} " + " ".join(f"N{n}" for n in row) for i, row in enumerate(cells.tolist())]
    halves = [" ".join(f"M{i}" for i in part) for part in np.array_split(range(len(cells)), 2)]
    groups = [f"GROUP_MA NOM={name}\n{part}" for name, part in zip("AB", halves, strict=True)]
    sections = ["\n".join(["COOR_3D", *places]), "\n".join(["TETRA4", *rows]), *groups]
    return "\nFINSF\n".join([*sections, "FIN\n"])


@pytest.mark.parametrize("name", list(FORMATS))
def test_whole_files_are_read(files, name):
    folder, content = files[name]
    path = folder / f"whole{FORMATS[name]['suffix']}"
    path.write_bytes(content)
    assert read(path)[1] is not None


@pytest.mark.parametrize("name", list(FORMATS))
@settings(max_examples=60)
@given(data=st.data())
def test_damaged_files_end_in_one_message(files, name, data):
    folder, content = files[name]
    path = folder / f"damaged{FORMATS[name]['suffix']}"
    path.write_bytes(data.draw(damaged(content)) or b" ")
    said, mesh = read(path)
    if mesh is None:
        assert "damaged" in said
        assert "\n" not in said
    else:
        assert np.isfinite(mesh.nodes).all()
        assert all((b.nodes >= 0).all() and (b.nodes < len(mesh.nodes)).all() for b in mesh.blocks)


def read(path):
    """What the reader says, or the mesh it makes."""
    try:
        return "", read_mesh_file(path, materials=MATERIALS).mesh
    except FayingError as error:
        return str(error), None
