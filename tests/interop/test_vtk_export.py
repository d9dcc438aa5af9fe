"""Other programs read what ``faying export --to vtk`` writes, and find the run's numbers in it."""

from itertools import pairwise
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import faying as fy
from faying.export.formats import export
from faying.export.vtk_files import write_vtu
from faying.interface.surface import nodal_average
from faying.study.stages.recover import results_of


@pytest.fixture(scope="module")
def results(quick_demo):
    return results_of(quick_demo)


@pytest.fixture(scope="module")
def folder(results, tmp_path_factory):
    folder = tmp_path_factory.mktemp("vtk")
    export(results, "vtk", method="jim-b", out=folder / "pictures")
    return folder / "pictures"


@pytest.fixture(scope="module")
def meshio():
    return pytest.importorskip("meshio", reason="meshio is not installed")


@pytest.fixture(scope="module")
def vtk():
    return pytest.importorskip("vtk", reason="VTK is not installed")


def test_structure(meshio, results, folder):
    mesh = meshio.read(folder / "structure.vtu")
    np.testing.assert_array_equal(mesh.points, results.nodes)
    np.testing.assert_array_equal(mesh.cells_dict["hexahedron"], results.blocks[0].nodes)
    np.testing.assert_array_equal(mesh.point_data["node id"], results.node_ids)
    case = results.cases["LC2"]
    for label, response in {
        "LC2 displacement [mm]": case.reference,
        "LC2 jim-b displacement [mm]": case.methods["jim-b"][20].response,
    }.items():
        np.testing.assert_array_equal(mesh.point_data[label], response.nodal_displacement)


def test_modes(meshio, results, folder):
    modes = meshio.read(folder / "modes.vtu").point_data
    names = [name for name in modes if name.startswith("mode ")]
    assert len(names) == 10
    assert all(name.endswith(" Hz") for name in names)
    for name in names:
        # Scaled, and clamped where the bar is: at its left end.
        assert np.linalg.norm(modes[name], axis=1).max() == pytest.approx(1.0, rel=1e-12)
        left = results.nodes[:, 0] == results.nodes[:, 0].min()
        np.testing.assert_array_equal(modes[name][left], 0.0)
    shapes = meshio.read(folder / "trial_vectors.vtu").point_data
    record = results.reduced["jim-b"][20]
    assert list(shapes)[: len(record.basis.kinds)] == [
        f"q{number} {kind}" for number, kind in enumerate(record.basis.kinds, start=1)
    ]


def test_first_mode_has_the_frequency_of_the_preloaded_joint(joint, classic, meshio, tmp_path):
    own = fy.reduce(joint, classic, compliance=True)
    export(own, "vtk", out=tmp_path / "own")
    first = next(iter(meshio.read(tmp_path / "own" / "modes.vtu").point_data))
    found = float(first.removeprefix("mode 01 of trial vectors, ").removesuffix(" Hz"))
    # Ten normal modes make 5e-4; the name has five digits.
    assert found == pytest.approx(fy.preloaded_frequencies(joint, 1)[0], rel=1e-3)


def test_interface(meshio, results, folder):
    mesh = meshio.read(folder / "interface_joint.vtu")
    record = results.interfaces["joint"]
    np.testing.assert_array_equal(mesh.points, record.pair_points)
    np.testing.assert_array_equal(
        mesh.point_data["LC1 pressure [MPa]"],
        nodal_average(record, results.cases["LC1"].reference.pressure),
    )
    # Out of the lower bar, which is the minus side; averages of equal numbers round.
    np.testing.assert_allclose(mesh.point_data["normal"], [[0.0, 0.0, 1.0]] * len(mesh.points))
    np.testing.assert_array_equal(mesh.point_data["sticking"], record.stuck)


def test_series(meshio, results, folder):
    case, record = results.cases["LC2-step"], results.interfaces["joint"]
    root = ET.parse(folder / "interface_joint_LC2-step.pvd").getroot()
    entries = [(float(one.get("timestep")), one.get("file")) for one in root.iter("DataSet")]
    np.testing.assert_array_equal([time for time, _ in entries], case.times)
    response = case.methods["jim-b"][20].response
    for number in (0, 17, len(entries) - 1):
        data = meshio.read(folder / entries[number][1]).point_data
        for label, values in {
            "pressure [MPa]": case.reference.pressure,
            "gap [mm]": case.reference.gap,
            "jim-b pressure [MPa]": response.pressure,
            "jim-b recovered pressure [MPa]": response.recovered_pressure,
        }.items():
            # Sums of a few numbers, taken one instant at a time here.
            np.testing.assert_allclose(
                data[label], nodal_average(record, values[number]), rtol=1e-12, atol=1e-15
            )


def unit_cell(shape, *, quadratic):
    """Nodes of a straight-edged cell in the order of our elements, which is Nastran's."""
    base = [(0, 0), (1, 0), (1, 1), (0, 1)] if shape == "hex" else [(0, 0), (1, 0), (0, 1)]
    n = len(base)
    ring, upright = [(i, (i + 1) % n) for i in range(n)], [(i, i + n) for i in range(n)]
    if shape == "tet":
        points = np.array([*((x, y, 0.0) for x, y in base), (0.0, 0.0, 1.0)])
        edges = [*ring, (0, 3), (1, 3), (2, 3)]
    else:
        points = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in base])
        edges = [*ring, *upright, *((i + n, j + n) for i, j in ring)]
    return np.concatenate([points, points[edges].mean(axis=1)]) if quadratic else points


KINDS = ["hex8", "hex20", "tet4", "tet10", "wedge6", "wedge15"]


@pytest.mark.parametrize("kind", KINDS)
def test_cells_of_every_kind(vtk, tmp_path, kind):
    """With straight edges VTK's shape functions map linearly, if the nodes are in its order."""
    points = unit_cell(kind.rstrip("0123456789"), quadratic=kind in ("hex20", "tet10", "wedge15"))
    write_vtu(tmp_path / "cell.vtu", points, [(kind, np.arange(len(points))[None])])
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "cell.vtu"))
    reader.Update()
    cell = reader.GetOutput().GetCell(0)
    assert cell.GetNumberOfPoints() == len(points)
    weights, place, number = [0.0] * len(points), [0.0] * 3, vtk.reference(0)
    for inner in ((0.2, 0.3, 0.4), (0.1, 0.5, 0.25)):
        cell.EvaluateLocation(number, inner, place, weights)
        # VTK counts the ends of a linear wedge the other way round. Polynomials of a few terms.
        turned = (inner[1], inner[0], inner[2]) if kind == "wedge6" else inner
        np.testing.assert_allclose(place, turned, atol=1e-12)
    assert enclosed_volume(vtk, reader) == pytest.approx(VOLUMES[kind[:3]], rel=1e-12)


VOLUMES = {"hex": 1.0, "tet": 1 / 6, "wed": 1 / 2}


def enclosed_volume(vtk, reader):
    """Volume by the faces as seen from outside: negative where VTK takes a cell inside out."""
    skin = vtk.vtkDataSetSurfaceFilter()
    skin.SetInputConnection(reader.GetOutputPort())
    skin.Update()
    volume = 0.0
    for number in range(skin.GetOutput().GetNumberOfCells()):
        face = skin.GetOutput().GetCell(number).GetPoints()
        first, *others = (np.array(face.GetPoint(i)) for i in range(face.GetNumberOfPoints()))
        for a, b in pairwise(others):
            volume += np.dot(first, np.cross(a, b)) / 6
    return volume
