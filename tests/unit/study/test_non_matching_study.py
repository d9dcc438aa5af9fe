"""A study whose plates do not match, from its file to what a run leaves and what is drawn of it."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from faying.exceptions import FayingError
from faying.interface.surface import pair_facets
from faying.report.figures.surface_map import best_plane, covered
from faying.study.inputs.load_model import build
from faying.study.keys.schema import read_study
from faying.study.results.store import read_results
from faying.workflow.run import run

STUDY = """
title = "Plates that do not match"

[model]
source = "lap-joint"
lap_joint = { element_size = 5.0, upper_element_size = 3.0 }

[[interface]]
name = "joint"
minus = "upper"
plus = "lower"
meshes = "non-matching"

[[bolt]]
name = "bolt"
preload = 5e3

[sticking]
stiffness = 1e6

[reduction]
normal_modes = 4
joint_modes = [3]
methods = ["jim-a", "compliance"]

[[load_case]]
name = "bend"
kind = "static"
forces = [{ boundary = "tip", component = "Fz", value = -150.0 }]

[output]
report = false
"""
AREA = 40.0 * 20.0 - 10.0 * 10.0
"""Of the overlap without the hole of the lower plate, the larger of the two."""


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("apart")
    path = folder / "apart.toml"
    path.write_text(STUDY)
    assert run(read_study(path), folder / "out")["converged"]
    return folder / "out"


@pytest.fixture(scope="module")
def record(finished):
    return read_results(finished / "results.h5").interfaces["joint"]


def read(tmp_path, text):
    path = tmp_path / "study.toml"
    path.write_text(text)
    return read_study(path)


def polygon_area(polygons):
    """Sum of the areas of polygons (n_corner, 2)."""
    total = 0.0
    for polygon in polygons:
        x, y = polygon.T
        total += 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    return total


def test_static_pressures_of_the_compliance_method_are_exact(finished):
    methods = read_results(finished / "results.h5").cases["bend"].methods
    assert methods["compliance"][0].accuracy.max_relative_error < 1e-9
    assert methods["jim-a"][3].accuracy.max_relative_error > 1e-3


def test_record_knows_what_is_covered(record):
    assert record.weights.sum() == pytest.approx(AREA, rel=1e-12)
    assert record.quadrature == "gauss-2+segments-2"
    facets = sum(len(nodes) for _, nodes in pair_facets(record))
    assert record.face_coverage.shape == (facets,)
    assert 0 < record.face_coverage.min() < 1
    assert record.face_coverage.max() == 1
    # The smaller hole of the upper plate is ringed by facets covered in part.
    corners = np.concatenate([record.pair_points[n].mean(axis=1) for _, n in pair_facets(record)])
    partly = corners[record.face_coverage < 1]
    assert np.abs(partly[:, :2]).max() < 7.0


def test_maps_show_the_common_part_alone(record):
    polygons = covered(record, best_plane(record))
    assert polygon_area(polygons) == pytest.approx(AREA, rel=1e-9)


def test_files_for_viewers_hold_the_pairs_at_their_nodes(finished, record):
    tree = ET.parse(finished / "interface_joint.vtu").getroot()
    piece = tree.find("UnstructuredGrid/Piece")
    assert int(piece.attrib["NumberOfPoints"]) == len(record.pairs)
    assert int(piece.attrib["NumberOfCells"]) == len(record.face_coverage)
    np.testing.assert_allclose(record.pair_points[:, 2], 0.0, atol=1e-12)


def test_matching_meshes_record_no_coverage(tmp_path):
    text = STUDY.replace("upper_element_size = 3.0", "thickness = 10.0").replace(
        'meshes = "non-matching"', 'meshes = "matching"'
    )
    path = tmp_path / "alike.toml"
    path.write_text(text)
    assert run(read_study(path), tmp_path / "out")["converged"]
    joint = read_results(tmp_path / "out" / "results.h5").interfaces["joint"]
    assert joint.face_coverage is None
    assert joint.overlap is None


def test_the_key_belongs_to_the_interface(tmp_path):
    text = STUDY.replace("upper_element_size = 3.0", 'meshes = "non-matching"')
    with pytest.raises(FayingError, match=r"it belongs in \[\[interface\]\]"):
        read(tmp_path, text)


def test_the_error_of_matching_meshes_names_the_key(tmp_path):
    text = STUDY.replace('meshes = "non-matching"', 'meshes = "matching"')
    with pytest.raises(FayingError, match='Give the interface meshes = "non-matching"'):
        build(read(tmp_path, text))


def test_an_upper_element_size_must_be_positive(tmp_path):
    text = STUDY.replace("upper_element_size = 3.0", "upper_element_size = -3.0")
    with pytest.raises(FayingError, match="upper_element_size is -3; it must be positive"):
        build(read(tmp_path, text))


def test_gap_files_by_node_reach_the_projected_pairs(tmp_path):
    """A wedge given at the plus nodes alone."""
    plain = build(read(tmp_path, STUDY))
    mesh, interface = plain.assembly.mesh, plain.interfaces["joint"]
    used = np.unique(interface.coupling.plus.tocoo().col)
    lines = [f"{mesh.node_ids[i]},{1e-3 * mesh.nodes[i, 0]:.17g}" for i in used]
    (tmp_path / "wedge.csv").write_text("\n".join(["node,gap", *lines]) + "\n")
    text = STUDY.replace(
        'meshes = "non-matching"', 'meshes = "non-matching"\ninitial_gap = "wedge.csv"'
    )
    shimmed = build(read(tmp_path, text)).interfaces["joint"]
    np.testing.assert_allclose(shimmed.initial_gap, 1e-3 * shimmed.points[:, 0], atol=1e-14)
