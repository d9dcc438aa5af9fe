"""Solids that are numbered the other way round."""

from types import SimpleNamespace

import meshio
import numpy as np
import pytest

from faying.io.mesh_files import read_mesh_file
from faying.io.mesh_groups import groups_of
from faying.io.nastran import read_deck
from faying.model.assembly import Material
from faying.model.elements import SOLIDS
from faying.model.elements.orientation import right_side_out
from faying.model.elements.solid_element import shape_values
from faying.model.matrices import mass_properties

STEEL = Material(youngs_modulus=210000.0, poissons_ratio=0.3, density=2.0)


@pytest.mark.parametrize("kind", SOLIDS)
def test_the_mirror_image_of_an_element_is_turned(kind):
    element = SOLIDS[kind]
    mirrored = element.reference_nodes * [1.0, 1.0, -1.0]
    cells = np.arange(element.n_nodes)[None]
    nodes, turned = right_side_out(kind, cells, mirrored)
    assert turned.all()
    # Mid-side nodes lie between the same corners: the shape is that of the mirror image.
    points = mirrored[nodes[0]]
    middle = element.reference_nodes[: element.n_corners].mean(axis=0, keepdims=True)
    centre = shape_values(element, middle) @ points
    np.testing.assert_allclose(centre, middle * [1.0, 1.0, -1.0], atol=1e-12)  # rounding
    again, turned = right_side_out(kind, nodes, mirrored)
    assert not turned.any()
    np.testing.assert_array_equal(again, nodes)
    kept, turned = right_side_out(kind, cells, element.reference_nodes)
    assert kept is cells
    assert not turned.any()


def test_meshes_of_other_conventions_are_read(tmp_path):
    """MED numbers bricks with the bottom clockwise seen from above."""
    points = np.array(
        [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (0, 2), (3, 2), (3, 0))], float
    )
    path = tmp_path / "a.vtu"
    meshio.Mesh(points, [("hexahedron", np.arange(8)[None])]).write(path)
    assembly = read_mesh_file(path, materials={"default": STEEL})
    assert mass_properties(assembly).mass == pytest.approx(12.0)
    assert assembly.ignored == ("node order of 1 inverted solids",)


def test_decks_with_solids_inside_out_are_read(tmp_path):
    path = tmp_path / "a.bdf"
    path.write_text(
        "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\n"
        "CTETRA,7,1,1,3,2,4\nPSOLID,1,1\nMAT1,1,1.,,.3,6.\n"
    )
    assembly = read_deck(path)
    assert mass_properties(assembly).mass == pytest.approx(1.0)
    assert "node order of 1 inverted CTETRA, the first 7" in assembly.ignored


def test_data_of_a_mesh_that_name_no_group_are_passed_over():
    """MED has field data that are no pairs of number and dimension."""
    found = SimpleNamespace(
        cell_sets={},
        cell_data={"cell_tags": [np.array([5])]},
        field_data={"time": np.array([0.5]), "steel": np.array([5, 3])},
        cells=[SimpleNamespace(type="hexahedron", data=np.zeros((1, 8), dtype=int))],
    )
    assert [group.name for group in groups_of(found)] == ["steel"]
