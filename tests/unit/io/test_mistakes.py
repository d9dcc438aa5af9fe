"""Mistakes that people make in studies and decks end in one message that says what to do."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import faying as fy
from faying.exceptions import FormatError, ModelError, StudyError
from faying.export.formats import format_named
from faying.io import abaqus, nastran
from faying.io.deck_lines import naming
from faying.model.assembly import Material
from faying.model.cells import CellBlock
from faying.model.generate import brick_grid
from faying.model.mesh import Mesh
from faying.model.specs import BoltSpec
from faying.study.inputs.load_model import build, build_loaded, load_model
from faying.study.judgement.model_warnings import bolt_doubts, doubts, uneven_seats
from faying.study.keys.load_files import read_history
from faying.study.keys.schema import parse_study, read_study
from faying.workflow.run import run
from lap_joints import tiny_lap
from refusals import refuses
from small_abaqus_deck import DECK as ABAQUS
from small_nastran_deck import blocks

STUDY = """
units = "mm-t-s"
[model]
source = "lap-joint"
lap_joint = { element_size = 10.0, hole_radius = 0.0, washer_radius = 11.0 }
[[bolt]]
name = "bolt"
preload = 1e3
[reduction]
methods = ["compliance"]
"""
MARK = b"\xef\xbb\xbf"
NASTRAN = f"""SOL 101
CEND
SPC = 1
BCSET = 1
BOLTLD = 1
BEGIN BULK
{blocks(10)}GRID,21,,5.,5.,0.
GRID,22,,5.,5.,20.
RBE2,31,21,123,1,2,3,4
RBE2,32,22,123,15,16,17,18
SPC1,1,123456,21
CBEAM,41,5,21,22,1.,0.,0.
PBEAM,5,1,28.,63.,63.,,126.
BSURFS,1,,,,1,5,6,7
BSURFS,2,,,,2,11,12,13
BCTSET,1,1,2,0.
BOLT,1,1,41
BOLTFOR,1,5000.,1
ENDDATA
"""
DECK_STUDY = """
[model]
source = "nastran"
file = "joint.bdf"
[reduction]
methods = ["compliance"]
"""


def refused(text, change=("", ""), error=StudyError):
    assert change[0] in text
    with pytest.raises(error) as raised:
        parse_study(text.replace(*change), Path("study.toml"))
    return str(raised.value)


@pytest.fixture
def deck(tmp_path):
    """Write a Nastran deck with a change, and its study; return the study's path."""

    def write(*change):
        assert not change or change[0] in NASTRAN
        text = NASTRAN.replace(*change) if change else NASTRAN
        (tmp_path / "joint.bdf").write_text(text)
        (tmp_path / "study.toml").write_text(DECK_STUDY)
        return tmp_path / "study.toml"

    return write


@pytest.mark.parametrize(
    ("units", "reason"),
    [
        ("N-mm-MPa", "'N' is a force, not a length"),
        ("t-mm-s", "'t' is a mass, not a length"),
        ("mm-MPa-s", "'MPa' is a pressure, not a mass"),
        ("mm-t", "expected length-mass-time"),
    ],
)
def test_units_of_another_kind(units, reason):
    message = refused(STUDY, ('"mm-t-s"', f'"{units}"'))
    assert "'units'" in message
    assert reason in message


def test_units_that_are_not_known_are_left_to_the_user():
    assert parse_study(STUDY.replace("mm-t-s", "furlong-firkin-d"), Path("s.toml")).units


@pytest.mark.parametrize(
    ("change", "line", "remedy"),
    [
        (("preload = 1e3", "preload = 1000,0"), 8, "decimal point"),
        (("element_size = 10.0", "element_size = 10,0"), 5, "decimal point"),
        (('"lap-joint"', '"lap\\joint"'), 4, "write paths with /"),
        (("preload = 1e3", "preload = 1e3\npreload = 2e3"), 9, "keep one"),
        (("preload = 1e3", "preload = 1e"), 8, "correct the line"),
    ],
)
def test_lines_that_are_no_toml(change, line, remedy):
    message = refused(STUDY, change)
    assert f"study.toml is not valid TOML: {message.split('TOML: ')[1]}" in message
    assert f"line {line}" in message
    assert message.endswith(remedy) or remedy in message.rpartition(";")[2]


def test_study_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "study.toml"
    path.write_bytes(MARK + STUDY.replace("\n", "\r\n").encode())
    assert read_study(path).bolts[0].preload == 1e3


def test_path_of_another_system(tmp_path):
    text = DECK_STUDY.replace('"joint.bdf"', r"'decks\joint.bdf'")
    with pytest.raises(StudyError, match=r"does not exist.*, and folders are separated by /"):
        parse_study(text, tmp_path / "study.toml")


def test_only_methods_that_need_no_training_are_compared_unasked(tmp_path):
    text = STUDY.replace('methods = ["compliance"]', "")
    untrained = ("craig-bampton", "jim-a", "compliance", "jim-a+compliance")
    path = tmp_path / "study.toml"
    assert parse_study(text, path).reduction.methods == untrained
    box = '{ boundary = "tip", component = "Fz", min = -1.0, max = 1.0 }'
    trained = parse_study(text + f"\n[reduction.training]\nbox = [{box}]\n", path)
    assert set(trained.reduction.methods) == {*untrained, "jim-b", "jim-b+compliance"}


def test_methods_without_training_are_named(tmp_path):
    message = refused(STUDY, ('methods = ["compliance"]', 'methods = ["craig-bampton", "jim-b"]'))
    assert "'jim-b' needs training loads" in message
    assert 'methods = ["craig-bampton", "compliance"]' in message


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("SOL 101\nCEND\nBEGIN BULK\nENDDATA\n", "has no GRID"),
        (NASTRAN.replace("SPC1,1,", "SPC1,2,"), "selects SPC = 1"),
        (NASTRAN.replace("BCTSET,1,", "BCTSET,2,"), "selects BCSET = 1"),
        (NASTRAN.replace("BOLTFOR,1,", "BOLTFOR,2,"), "selects BOLTLD = 1"),
    ],
)
def test_mistakes_of_a_deck_as_a_whole_name_it(tmp_path, text, reason):
    path = tmp_path / "joint.bdf"
    path.write_text(text)
    with pytest.raises(FormatError, match=reason) as raised:
        nastran.read_joint(path)
    assert str(raised.value).startswith(str(path))


def test_places_are_named_once():
    with pytest.raises(FormatError, match=r"^sub/part\.bdf:3: GRID: wrong$"), naming("deck.bdf"):
        raise FormatError("sub/part.bdf:3: GRID: wrong")
    with pytest.raises(FormatError, match=r"^deck\.bdf: wrong$"), naming("deck.bdf"):
        raise FormatError("wrong")


def test_subcase_that_is_not_there(tmp_path):
    path = tmp_path / "joint.bdf"
    path.write_text(NASTRAN)
    refuses(r"joint\.bdf: case control has no subcase 3", nastran.read_joint, path, subcase=3)


@pytest.mark.parametrize(
    ("read", "text", "name"),
    [
        (nastran.read_joint, NASTRAN, "joint.bdf"),
        (abaqus.read_joint, ABAQUS, "joint.inp"),
    ],
)
def test_decks_as_editors_save_them(tmp_path, read, text, name):
    plain, marked, wide = (tmp_path / f"{kind}-{name}" for kind in ("plain", "marked", "wide"))
    plain.write_text(text)
    marked.write_bytes(MARK + text.replace("\n", "\r\n").encode())
    wide.write_bytes(text.encode("utf-16"))
    np.testing.assert_array_equal(read(marked).assembly.mesh.nodes, read(plain).assembly.mesh.nodes)
    refuses(r"wide.* is UTF-16 text; save it as UTF-8", read, wide)


def test_bolt_that_presses(deck):
    study = deck("BOLTFOR,1,5000.,1", "BOLTFOR,1,-5000.,1")
    refuses(r"joint\.bdf:40: BOLTFOR: field 3 \(LOAD\) is -5000", load_model, read_study(study))
    study = deck("BOLTFOR,1,5000.,1", "BOLTFOR,7,5000.,1\nBOLTLD,1,1.,-1.,7")
    with pytest.raises(StudyError, match="'bolt-1' has the preload -5000, which is compressive"):
        load_model(read_study(study))


STEP = """
[[boundary]]
name = "top"
node = 15
[[load_case]]
name = "blow"
kind = "step"
forces = [{ boundary = "top", component = "Fz", value = -10.0 }]
steps_per_period = 10
periods = 0.1
"""


BACKBONE = '[[load_case]]\nname = "blow"\nkind = "backbone"\nmodes = [1]\namplitudes = [0.1]\n'


def test_motions_of_a_structure_without_mass(deck):
    path = deck(",7.8-9", "")
    plain = path.read_text()
    path.write_text(plain + STEP)
    with pytest.raises(ModelError, match=r"no mass.* load case 'blow' is a transient; give rho"):
        build(read_study(path))
    path.write_text(plain + STEP.split("[[load_case]]")[0] + BACKBONE)
    with pytest.raises(ModelError, match=r"no mass.* load case 'blow' is a backbone; give rho"):
        build(read_study(path))
    trained = plain.replace('"compliance"', '"jim-b"') + (
        "[reduction.training]\n"
        'box = [{ boundary = "top", component = "Fz", min = -1.0, max = 1.0 }]\n'
        '[[boundary]]\nname = "top"\nnode = 15\n'
    )
    path.write_text(trained)
    with pytest.raises(ModelError, match=r"no mass.* train on step responses \(dynamics = false"):
        build(read_study(path))
    with pytest.raises(ModelError, match=r"20 normal modes .* no mass; ask for none"):
        fy.craig_bampton(build_loaded(load_model(read_study(path))))


@pytest.mark.long
def test_statics_need_no_mass(deck, tmp_path):
    """Same pressures with and without density, whatever the number of modes."""
    static = STEP.replace('"step"', '"static"').split("steps_per_period")[0]
    found = {}
    for name, change in (("heavy", ("", "")), ("light", (",7.8-9", ""))):
        path = deck(*change)
        path.write_text(path.read_text() + static)
        summary = run(read_study(path), tmp_path / name)
        found[name] = summary["load_cases"]["blow"]
        assert (summary["model"]["mass"] > 0) == (name == "heavy")
    for name in ("max_pressure", "contact_force"):
        # Round-off of two orders of elimination.
        expected = pytest.approx(found["heavy"]["reference"][name], rel=1e-9)
        assert found["light"]["reference"][name] == expected
    assert found["light"]["methods"]["compliance"]["0"]["max_relative_error"] < 1e-9


def test_no_bolt_tightened():
    model = tiny_lap()
    tightening = fy.tighten(model, {})
    assert tightening.initial_forces == {"bolt": 0.0}
    assert tightening.bolt_forces.shape == (0, 1)
    assert fy.solve_static(fy.preload(model, {})).pressure.max() == 0.0


def test_first_line_of_a_history_is_a_header_only_without_numbers(tmp_path):
    path = tmp_path / "force.csv"
    path.write_text("time [s], force [N]\n0,1\n1,2\n")
    assert len(read_history(path).times) == 2
    path.write_text("0.O,1\n1,2\n2,3\n")  # a letter for a zero
    refuses(r"line 1: found '0\.O' in column 'time'", read_history, path)
    path.write_text("time;force\n0,0;1,5\n1,0;2,5\n")
    refuses("line 1: columns are separated by semi", read_history, path)


def test_formats_are_listed_once():
    with pytest.raises(StudyError) as raised:
        format_named("ansys")
    assert str(raised.value).count("'nastran'") == 1


def solid(modulus, density, name=""):
    return Material(youngs_modulus=modulus, poissons_ratio=0.3, density=density, name=name)


STEEL = solid(210e3, 7.85e-9, name="steel")


@pytest.mark.parametrize(
    ("material", "units"),
    [
        (STEEL, "mm-t-s"),
        (solid(2.1e11, 7850.0), "m-kg-s"),
        (solid(210.0, 7.85e-6), "mm-kg-ms"),
        (solid(3.0e7, 7.35e-4), "in-slinch-s"),
        (solid(1.0, 0.0), "furlong-firkin-d"),
        (solid(210e3, 0.0), "mm-t-s"),  # without mass: refused elsewhere
    ],
)
def test_constants_of_solids_raise_no_doubt(material, units):
    assert list(doubts({1: material}, units)) == []


def test_constants_in_other_units_do():
    wrong = {1: solid(2.1e11, 7850.0, name="steel"), 2: STEEL}
    assert list(doubts(wrong, "mm-t-s")) == [
        "material 'steel': E = 2.1e+11 is 2.1e+17 Pa in mm-t-s, beyond any solid; check E and "
        "'units'",
        "material 'steel': rho = 7850 is 7.85e+15 kg/m³ in mm-t-s, beyond any solid; check rho and "
        "'units'",
    ]
    assert len(list(doubts({1: STEEL}, "m-kg-s"))) == 1  # 7.85e-9 kg/m³
    (soft,) = doubts({1: solid(210e3, 7.85e-6)}, "mm-kg-s")
    assert (
        "E is 0.21 GPa and rho 7.85e+03 kg/m³ in mm-kg-s; no solid of that density is so soft"
        in soft
    )


def test_what_no_solid_and_no_bolt_bears_is_said(tmp_path):
    """mm-kg-s in place of mm-t-s: steel of 0.21 GPa, bolts of 0.2 MPa; and 10⁸ N in mm-t-s."""
    text = STUDY + "[material.steel]\nE = 210e3\nrho = 7.85e-9\n"
    said = {}
    for units, force in (("mm-t-s", "10e3"), ("mm-kg-s", "10e3"), ("mm-t-s", "1e8")):
        study = parse_study(
            text.replace("mm-t-s", units).replace("preload = 1e3", f"preload = {force}"),
            tmp_path / "study.toml",
        )
        loaded = load_model(study)
        found = [*doubts(loaded.assembly.materials, units), *bolt_doubts(study, loaded)]
        said[units, force] = " ".join(found)
    assert said["mm-t-s", "10e3"] == ""
    assert "E is 0.21 GPa and rho 7.85 kg/m³ in mm-kg-s" in said["mm-kg-s", "10e3"]
    assert "a preload of 10000 mN" in said["mm-kg-s", "10e3"]
    assert "as of no tightened bolt" in said["mm-t-s", "1e8"]


@pytest.mark.parametrize(("at", "share"), [(0.0, None), (3.0, "14%")])
def test_nodes_that_lie_unevenly_under_heads_are_said(tmp_path, at, share):
    """A grid of 10 mm: within 11 mm of (3, 0) are its neighbours but one, 0.5 mm beside."""
    study = parse_study(STUDY, tmp_path / "study.toml")
    grid = np.arange(-20.0, 21.0, 10.0)
    plates = brick_grid(grid, grid, np.array([0.0, 8.0]))
    mesh = Mesh(
        nodes=plates.nodes,
        node_ids=np.arange(len(plates.nodes)),
        blocks=(
            CellBlock(
                kind="hex8",
                nodes=plates.cells,
                ids=np.arange(16),
                properties=np.ones(16, dtype=int),
            ),
        ),
    )
    axis = ((at, 0.0, 0.0), (at, 0.0, 8.0))
    bolt = BoltSpec(name="bolt", axis=axis, diameter=8.0, washer_radius=11.0)
    loaded = load_model(study)
    loaded = replace(loaded, bolts=(bolt,), assembly=replace(loaded.assembly, mesh=mesh))
    said = list(uneven_seats(loaded))
    assert len(said) == (share is not None)
    assert share is None or (f"by up to {share} of" in said[0] and "0.5 mm beside" in said[0])


def test_a_run_says_what_no_solid_bears(tmp_path):
    case = '[[load_case]]\nname = "rest"\nkind = "static"\n'
    case += 'forces = [{ boundary = "tip", component = "Fz", value = 1.0 }]\n'
    case += "[output]\nreport = false\n"
    study = parse_study(STUDY.replace("1e3", "1e8") + case, tmp_path / "study.toml")
    said = run(study, tmp_path / "out")["warnings"]
    assert any("as of no tightened bolt" in text for text in said)
    assert any("load case 'rest': the largest pressure is" in text for text in said)


def test_check_tells_of_doubtful_constants(call, tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY + "[material.steel]\nE = 2.1e11\n")
    status, out, _ = call("check", path)
    assert status == 0
    assert "Doubtful: material 'steel': E = 2.1e+11 is 2.1e+17 Pa" in out


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize(
    ("table", "place"),
    [
        (
            '[[interface]]\nname = "joint"\nminus = "lowr"\nplus = 1\n',
            r"\[\[interface\]\] number 1 of study",
        ),
        ('[[boundary]]\nname = "end"\nnode = 9999\n', r"\[\[boundary\]\] number 1 of study"),
    ],
)
def test_complaints_of_the_model_name_the_table(call, deck, tmp_path, command, table, place):
    study = deck()
    case = (
        '[[boundary]]\nname = "head"\nnode = 22\n[[load_case]]\nname = "pull"\nkind = "static"\n'
        'forces = [{ boundary = "head", component = "Fz", value = 1.0 }]\n'
    )
    study.write_text(DECK_STUDY + table + case)
    out = ["--out", str(tmp_path / "out")] if command == "run" else []
    status, _, error = call(command, study, *out)
    assert status == 2
    # A line for each stage that was begun stands before the message.
    stages = r"(?: +\d+:\d\d  [^\n]*\n)*"
    assert re.match(rf"{stages}faying: {place}\.toml \(line 7\): ", error), error
