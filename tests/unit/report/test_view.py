"""What the view of a report is given: arrays that unpack, bodies taken apart, fields that fit."""

import json
import re
import zlib
from base64 import b64decode
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fake_results import fake_results
from faying.interface.surface import nodal_average
from faying.model.cells import CellBlock
from faying.model.mesh import Mesh
from faying.report.view.outer_surface import explosion, outer_surface
from faying.report.view.packing import STEPS, packed_integers, packed_numbers
from faying.report.view.scene import own, scene, three
from faying.study.results.path_record import SlipRecord

RESULTS = fake_results()
WEB = Path(__file__).parents[3] / "web"


def unpacked(packed):
    """Undo the packing in the words of its documentation, one step after the other."""
    rows, columns = packed["shape"]
    octets = np.frombuffer(zlib.decompress(b64decode(packed["data"])), dtype=np.uint8)
    if not len(octets):
        return np.empty((rows, columns))
    width = len(octets) // (rows * columns)
    words = (octets.reshape(width, -1).astype(np.int64) << (8 * np.arange(width))[:, None]).sum(0)
    steps = np.cumsum(words.reshape(columns, rows), axis=1).T % (1 << (8 * width))
    if not packed["low"]:
        return steps
    low, high = np.array(packed["low"]), np.array(packed["high"])
    return low + (high - low) * steps / STEPS


def test_numbers_come_back_to_half_a_step():
    values = np.random.default_rng(0).normal(size=(200, 3)) * [1.0, 1e-6, 1e9]
    values[:, 1] -= 5.0
    found = unpacked(packed_numbers(values))
    # Half a step, and a little for the rounding of double precision far from zero.
    assert (np.abs(found - values) <= 0.501 * np.ptp(values, axis=0) / STEPS).all()
    assert np.allclose(found.max(axis=0), values.max(axis=0), rtol=1e-15, atol=0)


def test_a_column_of_one_value_comes_back_as_it_is():
    assert np.array_equal(unpacked(packed_numbers(np.full((4, 2), -7.25))), np.full((4, 2), -7.25))
    assert unpacked(packed_numbers(np.empty((0, 3)))).shape == (0, 3)


def test_integers_come_back_exactly():
    values = np.array([[0, 4294967295, 70000], [65536, 3, 0]])
    assert np.array_equal(unpacked(packed_integers(values)), values)


def test_every_interface_opens_by_one_along_its_normal():
    joint = RESULTS.interfaces["joint"]
    moves = explosion({"joint": joint}, RESULTS.body)
    assert np.allclose(moves, [[0, 0, -0.5], [0, 0, 0.5]], rtol=0, atol=1e-15)
    # A third bar on top, as nodes alone.
    body = np.concatenate([RESULTS.body, np.full(56, 2)])
    above = replace(joint, pairs=joint.pairs + np.array([56, 56]))
    moves = explosion({"joint": joint, "above": above}, body)
    assert np.allclose(np.diff(moves, axis=0), [[0, 0, 1], [0, 0, 1]], rtol=0, atol=1e-14)


def test_what_closes_on_itself_stays_together():
    joint = RESULTS.interfaces["joint"]
    half = len(joint.normals) // 2
    ring = np.concatenate([joint.normals[:half], -joint.normals[half:]])
    assert not explosion({"pin": replace(joint, normals=ring)}, RESULTS.body).any()
    inside = replace(joint, pairs=np.repeat(joint.pairs[:, :1], 2, axis=1))
    assert not explosion({"self": inside}, RESULTS.body).any()


def bar():
    return Mesh(nodes=RESULTS.nodes, node_ids=np.arange(1, 113), blocks=RESULTS.blocks)


def test_surface_of_a_bar_is_closed_and_its_sharp_edges_are_those_of_a_box():
    mesh = bar()
    surface = outer_surface(mesh, np.empty(0, dtype=np.int64))
    points = mesh.nodes[surface.nodes]
    corners = points[surface.triangles]
    areas = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # Two bars of 30 x 15 x 5: twice the sum of the products of their sides; outward, so it closes.
    assert np.linalg.norm(areas, axis=1).sum() == pytest.approx(2 * 2 * (450 + 150 + 75))
    assert np.abs(areas.sum(axis=0)).max() < 1e-10
    assert np.einsum("ti,ti->", areas, corners.mean(axis=1)) > 0
    ends = points[surface.edges]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(2 * 4 * 50)
    outline = surface.outline(np.array([0, 5]))
    assert np.array_equal(mesh.nodes[outline.nodes][outline.edges], ends)


@pytest.mark.parametrize("kind", ["hex20", "tet10"])
def test_quadratic_facets_are_covered_whole(kind):
    corners = np.array(
        [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=float
    )
    if kind == "tet10":
        corners = corners[[0, 1, 3, 4]]
        pairs = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
        area = 1.5 + np.sqrt(3) / 2
    else:
        ring = [(0, 1), (1, 2), (2, 3), (3, 0)]
        upper = [(i + 4, j + 4) for i, j in ring]
        pairs = [*ring, *((i, i + 4) for i in range(4)), *upper]
        area = 6.0
    nodes = np.concatenate([corners, [(corners[i] + corners[j]) / 2 for i, j in pairs]])
    block = CellBlock(
        kind=kind, nodes=np.arange(len(nodes))[None], ids=np.array([1]), properties=np.array([1])
    )
    mesh = Mesh(nodes=nodes, node_ids=np.arange(len(nodes)), blocks=(block,))
    surface = outer_surface(mesh, np.empty(0, dtype=np.int64))
    places = nodes[surface.nodes][surface.triangles]
    areas = 0.5 * np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    assert np.linalg.norm(areas, axis=1).sum() == pytest.approx(area)
    assert np.abs(areas.sum(axis=0)).max() < 1e-12
    # Half edges, all of them sharp.
    assert len(surface.edges) == 2 * (6 if kind == "tet10" else 12)


def test_fields_are_the_nodal_averages_of_chosen_instants():
    shown = json.loads(scene(RESULTS).text)
    case = next(one for one in shown["cases"] if one["name"] == "LC2-step")
    truth = RESULTS.cases["LC2-step"]
    assert case["frames"]["values"] == pytest.approx(truth.times.tolist(), rel=1e-5)  # six digits
    for model, response in ((0, truth.reference), (1, truth.methods["craig-bampton"][0].response)):
        packed = case["models"][model]["fields"]["pressure"]
        wanted = nodal_average(RESULTS.interfaces["joint"], response.pressure).T
        assert packed["at"] == list(range(11))
        assert np.abs(unpacked(packed) - wanted).max() <= 0.51 * wanted.max() / STEPS
    forces = case["models"][0]["bolts"]["bolt"]
    assert forces == pytest.approx(truth.reference.bolt_forces["bolt"].tolist(), rel=1e-5)
    assert case["peak"] == truth.reference.pressure.max()
    moved = next(one for one in shown["cases"] if one["name"] == "LC1")["models"][0]
    found = unpacked(moved["fields"]["displacement"])
    assert found.min() == RESULTS.cases["LC1"].reference.nodal_displacement.min()
    assert shown["cases"][-1]["name"] == "preload"


def test_displacements_of_all_instants_come_back_from_their_shapes():
    shown = json.loads(scene(RESULTS).text)
    (field,) = (
        case["models"][0]["fields"]["displacement"]
        for case in shown["cases"]
        if case["name"] == "LC2-step"
    )
    motion = RESULTS.cases["LC2-step"].reference.motion
    wanted = np.tensordot(motion.amplitudes, motion.shapes, axes=1)
    surface = unpacked(shown["bodies"]["points"])
    place = np.abs(surface[:, None] - RESULTS.nodes).sum(axis=2).argmin(axis=1)
    shapes = unpacked(field).reshape(len(place), -1, 3)
    found = np.einsum("ts,nsc->tnc", field["amplitudes"], shapes)
    # Steps of shapes, and amplitudes to six digits.
    assert np.abs(found - wanted[:, place]).max() < 2e-5 * np.abs(wanted).max()
    assert field["at"] == list(range(11))
    assert field["largest"] == pytest.approx(np.linalg.norm(wanted, axis=-1).max(), rel=1e-12)
    assert "displaced as the reference, by up to 2 shapes" in scene(RESULTS).notes[0]


def test_slip_of_transients_is_shown_at_every_instant():
    case = RESULTS.cases["LC2-step"]
    slip = np.outer(np.arange(11.0), RESULTS.interfaces["joint"].points[:, 0])
    nothing, none = np.zeros(11), np.zeros(slip.shape)
    record = SlipRecord(
        traction=np.stack([none, none, none], axis=-1),
        slip=np.stack([0.6 * slip, 0.8 * slip, none], axis=-1),
        status=none.astype(np.int64), open_share=nothing, stick_share=nothing, slip_share=nothing,
        macroslip=nothing > 0, dissipation=nothing,
    )  # fmt: skip
    rubbing = replace(case, reference=replace(case.reference, friction=record))
    shown = json.loads(scene(replace(RESULTS, cases={"rub": rubbing})).text)
    fields = shown["cases"][0]["models"][0]["fields"]
    assert np.allclose(unpacked(fields["slip"]), slip.T, rtol=0, atol=1e-4 * slip.max())
    assert fields["slip"]["at"] == list(range(11))


def test_long_transients_are_thinned_out_but_keep_their_peak():
    case = RESULTS.cases["LC2-step"]
    times = np.linspace(0, 1, 1001)
    pressure = np.tile(case.reference.pressure[0], (1001, 1))
    pressure[333] *= 3.0
    long = replace(
        case, times=times, methods={},
        reference=replace(
            case.reference, pressure=pressure, gap=np.zeros_like(pressure), motion=None,
            bolt_forces={"bolt": np.linspace(1.0, 2.0, 1001)},
        ),
    )  # fmt: skip
    shown = json.loads(scene(replace(RESULTS, cases={"long": long})).text)
    values = shown["cases"][0]["frames"]["values"]
    assert len(values) == 42
    assert pytest.approx(0.333, rel=1e-5) in values
    assert len(shown["cases"][0]["models"][0]["bolts"]["bolt"]) == 42


def test_what_has_no_room_is_counted_and_references_come_first():
    whole = scene(RESULTS)
    assert len(whole.notes) == 1
    base = len(scene(replace(RESULTS, cases={})).text)
    room = base + (len(whole.text) - base) // 3
    part = scene(RESULTS, room)
    assert base < len(part.text) <= room
    cases = json.loads(part.text)["cases"]
    assert all("pressure" in case["models"][0]["fields"] for case in cases)
    kept, every = (
        sum(len(m["fields"]) for case in json.loads(one.text)["cases"] for m in case["models"])
        for one in (part, whole)
    )
    assert part.notes[-1].startswith(f"{every - kept} more fields are only in results.h5")


def test_names_cannot_end_the_script():
    evil = replace(RESULTS, bolts={"</script><b>": RESULTS.bolts["bolt"]})
    text = scene(evil).text
    assert "<" not in text
    assert json.loads(text)["bolts"][0]["name"] == "</script><b>"


def test_of_very_large_surfaces_the_edges_alone_are_kept(monkeypatch):
    whole = json.loads(scene(RESULTS).text)
    monkeypatch.setattr("faying.report.view.scene.MOST_NODES", 50)
    found = scene(RESULTS)
    assert found.notes[0].startswith("The surface of the bodies is too large")
    shown = json.loads(found.text)
    assert shown["bodies"]["triangles"]["shape"] == [0, 3]
    points, edges = (unpacked(shown["bodies"][name]) for name in ("points", "edges"))
    length = np.linalg.norm(np.diff(points[edges], axis=1), axis=-1).sum()
    assert length == pytest.approx(2 * 4 * 50, rel=1e-3)  # a step is 1e-5 of the size
    # The contact faces are there, and know their nodes.
    assert shown["contact"][0]["triangles"] == whole["contact"][0]["triangles"]
    contact = shown["contact"][0]
    for side, numbers in zip(contact["points"], contact["nodes"], strict=True):
        assert np.allclose(points[unpacked(numbers)[:, 0]], unpacked(side), atol=1e-3)


def test_matrices_without_elements_have_no_view():
    joint = replace(RESULTS.interfaces["joint"], faces=())
    assert scene(replace(RESULTS, blocks=(), interfaces={"joint": joint})) is None


def test_nothing_to_see_is_no_view():
    assert scene(replace(RESULTS, blocks=(), interfaces={}, cases={})) is None


def test_three_is_the_release_the_recipe_names_and_brings_its_licence():
    wanted = json.loads((WEB / "package.json").read_text())["devDependencies"]["three"]
    assert f'"{wanted.split(".")[1]}"' in three()
    assert three().startswith("/*! three.js\nThe MIT License")
    assert "Copyright © 2010" in three()
    names = set(re.findall(r"THREE\.(\w+)", own()))
    listed = (WEB / "three_subset.js").read_text()
    assert names == _listed(listed)
    for script in (three(), own()):
        assert "</script" not in script


def _listed(text):
    body = re.sub(r"//.*", "", text)
    return {
        name.strip() for part in re.findall(r"\{(.*?)\}", body, re.S) for name in part.split(",")
    } - {"", "REVISION"}
