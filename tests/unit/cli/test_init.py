"""``faying init``: the first study of a deck or mesh says what is there and runs."""

import tomllib
from dataclasses import replace

import meshio
import numpy as np
import pytest
from typer.testing import CliRunner

from faying.assessment.strength.sizes import size_through
from faying.cli import app
from faying.draft import first_study as first
from faying.draft.cylinders import cylinders
from faying.draft.first_study import first_study
from faying.draft.study_text import DECIDE
from faying.exceptions import FayingError, StudyError
from faying.interface.facing import facing_bodies
from faying.io.nastran import write_deck
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import Assembly, Material
from faying.model.generate import Cells
from faying.study.inputs.load_model import build
from faying.study.keys.schema import parse_study
from small_abaqus_deck import DECK
from solid_blocks import stacked

STEEL = Material(name="default", youngs_modulus=210e3, poissons_ratio=0.3, density=7.85e-9)
AROUND = 16


def washer(radii, heights, centre=(0.0, 0.0)):
    """Bricks of a ring around z."""
    turn = 2 * np.pi * np.arange(AROUND) / AROUND
    grid = np.array(
        [
            [centre[0] + r * np.cos(a), centre[1] + r * np.sin(a), z]
            for z in heights
            for r in radii
            for a in turn
        ]
    )
    at = np.arange(len(grid)).reshape(len(heights), len(radii), AROUND)
    on = np.roll(at, -1, axis=2)
    corners = [at[:-1, :-1], at[:-1, 1:], on[:-1, 1:], on[:-1, :-1]]
    corners += [at[1:, :-1], at[1:, 1:], on[1:, 1:], on[1:, :-1]]
    return Cells(kind="hex8", nodes=grid, cells=np.stack(corners, axis=-1).reshape(-1, 8))


LOWER = washer([5.5, 9.0, 14.0], [-8.0, -4.0, 0.0], (3.0, 1.0))
UPPER = washer([5.5, 9.0, 14.0], [0.0, 4.0, 8.0], (3.0, 1.0))


def written(folder, mesh):
    """A mesh file of it, parts as groups by number."""
    tables = [("hexahedron", np.vstack([block.nodes for block in mesh.blocks]))]
    tags = {"cell_tags": [mesh.element_properties]}
    path = folder / "rings.vtu"
    meshio.Mesh(mesh.nodes, tables, cell_data=tags).write(path)
    return path


def said(path):
    study = first_study(path, path.with_suffix(".toml"))
    return study, tomllib.loads(study.text)


@pytest.mark.parametrize(("hole", "size"), [(14.0, "M12"), (18.0, "M16"), (12.2, None)])
def test_holes_of_pipe_flanges_have_a_size(hole, size):
    """EN 1092: M12 in 14 mm, M16 in 18; between those of M10 and M12 is none."""
    assert size_through(1e-3 * hole) == size


@pytest.mark.parametrize(
    ("factor", "units", "why"),
    [
        (1.0, "mm-t-s", "fits its materials"),
        (1e3, "mm-kg-s", "fits its materials"),  # mN and kPa
        (1e7, "mm-t-s", "none tried fits its materials"),
    ],
)
def test_units_are_those_in_which_the_materials_can_be(tmp_path, factor, units, why):
    plates = lap_joint_assembly(element_size=10.0).assembly
    heavy = {
        number: replace(
            steel, youngs_modulus=factor * steel.youngs_modulus, density=factor * steel.density
        )
        for number, steel in plates.materials.items()
    }
    write_deck(replace(plates, materials=heavy), tmp_path / "plates.bdf")
    study, tables = said(tmp_path / "plates.bdf")
    assert tables["units"] == units
    (line,) = [line for line in study.text.splitlines() if line.startswith("units")]
    assert why in line


def test_two_rings_become_a_bolted_joint(tmp_path):
    study, tables = said(written(tmp_path, stacked(LOWER, UPPER)))
    assert study.problem == ""
    (joint,) = tables["interface"]
    assert {joint["minus"], joint["plus"]} == {"volume 1", "volume 2"}
    (bolt,) = tables["bolt"]
    assert bolt["axis"] == [[3.0, 1.0, -8.0], [3.0, 1.0, 8.0]]  # as drawn, all digits
    assert (bolt["size"], bolt["grade"]) == ("M10", "8.8")  # a clearance hole of 11 mm, ISO 273
    strained = 1.5e-3 * 210e3 * np.pi / 4 * 10.0**2
    assert bolt["preload"] == pytest.approx(strained, rel=1e-6)  # seven digits are written
    assert tables["load_case"][0]["forces"][0]["component"] == "Fz"
    assert len(tables["support"]) == 3
    assert study.undecided == study.text.count(DECIDE) >= 5
    assert study.text.startswith("#:schema file:")


def test_the_study_checks_and_runs(tmp_path):
    path = written(tmp_path, stacked(LOWER, UPPER))
    runner = CliRunner()
    assert runner.invoke(app, ["init", str(path)]).exit_code == 0
    target = tmp_path / "rings.toml"
    assert runner.invoke(app, ["check", str(target)]).exit_code == 0
    target.write_text(target.read_text() + "[output]\nreport = false\n")
    done = runner.invoke(app, ["run", str(target), "--out", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output


def test_nothing_is_overwritten_unless_told(tmp_path):
    path = written(tmp_path, stacked(LOWER, UPPER))
    target = tmp_path / "rings.toml"
    target.write_text("mine")
    with pytest.raises(StudyError, match=r"rings\.toml exists already; .*--overwrite"):
        CliRunner().invoke(app, ["init", str(path)], catch_exceptions=False)
    assert target.read_text() == "mine"
    CliRunner().invoke(app, ["init", str(path), "--overwrite"], catch_exceptions=False)
    assert tomllib.loads(target.read_text())["bolt"]


def test_what_a_deck_declares_is_not_repeated(tmp_path):
    path = tmp_path / "bricks.inp"
    path.write_text(DECK)
    study, tables = said(path)
    assert study.problem == ""
    assert "interface" not in tables
    assert "bolt" not in tables
    assert "support" not in tables
    assert "Joint" in study.text or "JOINT" in study.text
    assert "preload 400" in study.text
    assert "area 6, gap 0 to 0" in study.text  # 2 by 3
    (case,) = tables["load_case"]
    assert case["forces"] == [{"deck_load": "step 1", "value": 1.0}]


def test_beams_that_clamp_bodies_are_bolts(tmp_path):
    lines = DECK.splitlines()
    at = lines.index("*PRE-TENSION SECTION, ELEMENT=3, NODE=104")
    gone = {at, lines.index("104, 9., 9., 9."), lines.index("104, 1, 400.")}
    path = tmp_path / "bricks.inp"
    path.write_text("\n".join(line for row, line in enumerate(lines) if row not in gone))
    study, tables = said(path)
    assert study.problem == ""
    (bolt,) = tables["bolt"]
    assert bolt["elements"] == [3]
    # The placeholder: 0.15 % strain of a shank of radius 0.5.
    assert bolt["preload"] == pytest.approx(1.5e-3 * 210e3 * np.pi * 0.25, rel=1e-6)


def test_faces_across_a_gap_are_marked(tmp_path):
    mesh = stacked(LOWER, replace(UPPER, nodes=np.add(UPPER.nodes, [0, 0, 0.05])))
    assembly = Assembly(mesh=mesh, materials={1: STEEL, 2: STEEL})
    (face,) = facing_bodies(assembly)
    assert not face.touching
    assert face.gap == pytest.approx((0.05, 0.05), abs=1e-12)  # round-off of coordinates
    outer, inner = 14.0, 5.5
    area = AROUND / 2 * np.sin(2 * np.pi / AROUND) * (outer**2 - inner**2)
    assert face.area == pytest.approx(area, rel=1e-12)
    study, tables = said(written(tmp_path, mesh))
    assert study.problem == ""
    assert tables["interface"][0]["search_distance"] > 0.05
    assert f"{DECIDE} gap 0.05" in study.text


def test_cylinders_are_found_whatever_their_place():
    rng = np.random.default_rng(3)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    ring = washer([5.5, 9.0, 14.0], np.linspace(-8.0, 0.0, 6))
    grid = ring.nodes
    # Nodes anywhere on the circles, so that facets are inclined as a mesher's are.
    angle = np.arctan2(grid[:, 1], grid[:, 0]) + rng.uniform(-0.08, 0.08, len(grid))
    radius = np.linalg.norm(grid[:, :2], axis=1)
    uneven = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), grid[:, 2]])
    found = cylinders(stacked(replace(ring, nodes=1e3 + uneven @ turn.T)))
    order = np.argsort(found.radii)
    # Corners lie on the circles to the digits of coordinates of 1e3.
    assert found.radii[order] == pytest.approx([5.5, 14.0], rel=1e-9)
    assert found.holes[order].tolist() == [True, False]
    assert np.abs(found.axes @ turn[:, 2]) == pytest.approx(1.0, abs=1e-9)
    assert np.ptp(found.spans, axis=1) == pytest.approx(8.0, rel=1e-9)


def test_a_shank_of_solids_is_said_and_no_bolt_is_made(tmp_path):
    shank = washer([1.0, 5.2], [-8.0, 0.0, 8.0], (3.0, 1.0))
    study, tables = said(written(tmp_path, stacked(LOWER, UPPER, shank)))
    assert "bolt" not in tables
    said_once = " ".join(study.text.replace("\n# ", " ").split())
    assert "a shank of solids in a hole, radius 5.5, and nothing tightens it" in said_once
    assert study.problem  # the upper ring is held by nothing
    assert "it does not run yet" in " ".join(study.text.split())


def test_no_bolt_is_made_beside_shanks_of_solids(tmp_path):
    shank = washer([1.0, 5.2], [-8.0, 0.0, 8.0], (3.0, 1.0))
    beside = [washer([7.0, 9.0, 14.0], heights, (43.0, 1.0)) for heights in ([-8, 0], [0, 8])]
    study, tables = said(written(tmp_path, stacked(LOWER, UPPER, shank, *beside)))
    assert "bolt" not in tables
    assert "holes of several bodies in line, radius 7, not tightened" in study.text


def test_bodies_that_touch_and_nearly_touch_elsewhere_are_one_interface():
    """A head on a plate, its shank in the hole: where they touch the plate has the finer facets."""
    rod = washer([1.0, 5.2, 9.0], np.arange(-8.0, 11.0), (3.0, 1.0))
    centres = rod.centroids() - [3.0, 1.0, 0.0]
    bolt = rod.restricted((np.linalg.norm(centres[:, :2], axis=1) < 5.2) | (centres[:, 2] > 8.0))
    mesh = stacked(washer([5.5, 9.0, 14.0], [-8.0, 8.0], (3.0, 1.0)), bolt)
    (face,) = facing_bodies(Assembly(mesh=mesh, materials={1: STEEL, 2: STEEL}))
    assert (face.minus, face.plus) == (0, 1)
    assert face.gap == pytest.approx((0.0, 0.0), abs=1e-12)  # round-off of coordinates


def test_parts_that_share_nodes_are_separated(tmp_path):
    rings = washer([5.5, 9.0, 14.0], [-8.0, -4.0, 0.0, 4.0, 8.0])
    upper = rings.centroids()[:, 2] > 0
    path = tmp_path / "rings.vtu"
    tags = {"cell_tags": [1 + upper.astype(int)]}
    meshio.Mesh(rings.nodes, [("hexahedron", rings.cells)], cell_data=tags).write(path)
    study, tables = said(path)
    assert tables["model"]["separate"] == ["volume 2"]
    assert study.problem == ""


def test_sets_are_taken_by_their_names(tmp_path):
    path = tmp_path / "bricks.inp"
    held, load = DECK.index("*BOUNDARY\n102, 1, 6\n"), DECK.index("*CLOAD\n")
    cut = DECK[:held] + DECK[held:load].replace("*BOUNDARY\n102, 1, 6\n", "")
    text = cut + "*CLOAD\n104, 1, 400.\n*END STEP\n"
    path.write_text(
        text.replace("NSET=Bottom", "NSET=Clamped")
        .replace("\nBOTTOM, TOP", "\nCLAMPED, LOADED")
        .replace("NSET=BOTTOM", "NSET=CLAMPED")
        .replace("NSET=TOP", "NSET=LOADED")
    )
    _, tables = said(path)
    assert [one["set"].upper() for one in tables["support"]] == ["CLAMPED"]
    assert tables["boundary"][0]["set"].upper() == "LOADED"


def test_the_placeholder_load_enters_where_something_moves(tmp_path):
    """Not at a set that is called loaded and held by the deck."""
    path = tmp_path / "bricks.inp"
    held = "*BOUNDARY\n102, 1, 6\n"
    text = DECK[: DECK.index("*CLOAD\n")] + "*CLOAD\n104, 1, 400.\n*END STEP\n"
    text = text.replace("\nBOTTOM, TOP", "\nBOTTOM, LOADED").replace("NSET=TOP", "NSET=LOADED")
    path.write_text(text)
    study, tables = said(path)
    assert tables["boundary"][0]["set"].upper() == "LOADED"
    assert study.problem == ""
    assert tables["load_case"][0]["forces"][0]["component"] == "Fz"
    path.write_text(text.replace(held, f"{held}LOADED, 3, 3\n"))
    study, tables = said(path)
    assert tables["load_case"][0]["forces"][0]["component"] == "Fx"
    assert study.problem == ""
    path.write_text(text.replace(held, f"{held}LOADED, 1, 3\n"))
    study, tables = said(path)
    assert "boundary" not in tables  # all others touch, or are held
    assert study.problem == ""


def test_shells_without_solids_have_no_interface(tmp_path):
    (tmp_path / "plate.bdf").write_text(
        "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,9.,0.,0.\nGRID,3,,9.,9.,0.\nGRID,4,,0.,9.,0.\n"
        "CQUAD4,1,1,1,2,3,4\nPSHELL,1,1,2.,1,,1\nMAT1,1,210000.,,.3,7.8-9\nENDDATA\n"
    )
    study = first_study(tmp_path / "plate.bdf", tmp_path / "plate.toml")
    assert "no faces of different bodies face each other" in study.text


def test_a_single_body_is_said_to_have_no_interface(tmp_path, monkeypatch):
    builds = []
    monkeypatch.setattr(first, "build", lambda study: builds.append(study) or build(study))
    study, tables = said(written(tmp_path, stacked(LOWER)))
    assert "interface" not in tables
    assert f"{DECIDE} no faces of different bodies face each other" in study.text
    assert "contact interface" in study.problem
    assert len(builds) == 1  # no second one with weak springs, which no problem asked for


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("study.toml", "", "is a study already"),
        ("mesh.vtu", "nothing", "cannot be read"),
        ("none.inp", None, "none.inp"),
    ],
)
def test_bad_input_is_one_message(tmp_path, name, text, message):
    path = tmp_path / name
    if text is not None:
        path.write_text(text)
    with pytest.raises(FayingError, match=message):
        first_study(path, tmp_path / "new.toml")


def test_units_follow_the_materials(tmp_path):
    path = tmp_path / "bricks.inp"
    path.write_text(DECK.replace("210000., 0.3", "2.1E11, 0.3").replace("7.85E-9", "7850."))
    study, tables = said(path)
    assert tables["units"] == "m-kg-s"
    text = study.text.replace("DECIDE:", "")
    assert build(parse_study(text, tmp_path / "bricks.toml")).units == "m-kg-s"
