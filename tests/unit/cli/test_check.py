"""``faying check`` says what can move, what bolts are, and what applies loads of the deck."""

import re
import sys
import tomllib
from pathlib import Path

import pytest
from rich.text import Text

import faying as fy
from faying import cli
from faying.cli.tables import text_table
from faying.joint.diagnosis import free_parts
from faying.linalg.backends import available_backends
from lap_joints import tiny_lap
from small_nastran_deck import blocks

SUPPORT = "SPC1,1,123,1,2,3,4,5,6\n,7,8,9,10,11,12,13,14\n,15\n"
EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture
def check(monkeypatch, capsys, tmp_path):
    """Check the example with changes to its deck; return status, lines and error."""

    def call(deck_changes, *options):
        deck = (EXAMPLES / "cantilever.bdf").read_text()
        for old, new in deck_changes.items():
            assert old in deck
            deck = deck.replace(old, new)
        (tmp_path / "cantilever.bdf").write_text(deck)
        (tmp_path / "study.toml").write_text((EXAMPLES / "nastran_deck.toml").read_text())
        monkeypatch.setattr(
            sys, "argv", ["faying", "check", str(tmp_path / "study.toml"), *options]
        )
        # wide enough that rich does not wrap what the tests look for
        monkeypatch.setenv("COLUMNS", "200")
        with pytest.raises(SystemExit) as ended:
            cli.main()
        out, err = capsys.readouterr()
        return ended.value.code or 0, [line.split() for line in out.splitlines()], err

    return call


@pytest.mark.parametrize("command", ["check", "init"])
@pytest.mark.parametrize(
    ("name", "text", "held"),
    [
        (
            "beam.inp",
            "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n*ELEMENT, TYPE=B31, ELSET=B\n1, 1, 2\n"
            "*MATERIAL, NAME=M\n*ELASTIC\n209000., 0.3\n"
            "*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT\n1., 1.\n",
            "1 beams, 2 nodes",
        ),
        ("grid.bdf", "BEGIN BULK\nGRID,1,,0.,0.,0.\nENDDATA\n", "0 beams, 1 nodes"),
    ],
)
def test_decks_in_which_nothing_can_touch(call, tmp_path, command, name, text, held):
    (tmp_path / name).write_text(text)
    status, _, error = call(command, tmp_path / name)
    assert status
    (line,) = error.splitlines()
    assert f"no solids, no shells and no matrices ({held})" in line


def test_a_deck_of_one_body_says_that_an_interface_is_missing(call, tmp_path):
    """So does the study that is begun from it, whose loads are those of the deck."""
    upper = re.compile(r"GRID,1\d,.*\n|CHEXA,2,.*\n,17,18\n")
    cards = f"{upper.sub('', blocks())}FORCE,7,5,,9.,1.,0.,0.\n"
    (tmp_path / "block.bdf").write_text(f"SOL 101\nCEND\nLOAD = 7\nBEGIN BULK\n{cards}ENDDATA\n")
    call("init", tmp_path / "block.bdf", "--out", tmp_path / "block.toml")
    for name in ("block.bdf", "block.toml"):
        status, out, _ = call("check", tmp_path / name)
        assert not status
        assert "an interface: none is declared" in " ".join(out.split())


def cells(lines, first):
    return next(line for line in lines if line[:1] == [first])


def test_tables_leave_out_columns_in_which_nothing_stands():
    shown = text_table("Bolts", ["name", "said by", "force"], [("a", "", 1.0), ("b", "", 2.0)])
    assert [str(column.header) for column in shown.columns] == ["name", "force"]
    assert list(shown.columns[1].cells) == [Text("1"), Text("2")]


def test_held_joint_has_no_rigid_body_modes(check):
    status, lines, _ = check({})
    assert status == 0
    assert cells(lines, "none") == ["none", "everything", "is", "held"]


SIDES = """
[model]
source = "lap-joint"
lap_joint = {{ element_size = 5.0, upper_element_size = {upper} }}
[[interface]]
name = "joint"
minus = "{minus}"
plus = "{plus}"
meshes = "{meshes}"
[[bolt]]
name = "bolt"
preload = 5e3
[[load_case]]
name = "bend"
kind = "static"
forces = [{{ boundary = "tip", component = "Fz", value = -150.0 }}]
"""


@pytest.mark.parametrize(
    ("upper", "meshes", "minus", "plus", "normal", "points"),
    [
        (5.0, "matching", "lower", "upper", "(0, 0, 1)", "both sides"),
        (5.0, "matching", "upper", "lower", "(0, 0, -1)", "both sides"),
        (3.0, "non-matching", "upper", "lower", "(0, 0, -1)", "minus"),
    ],
)
def test_sides_are_told_with_the_sign_of_the_normal(
    check_file, tmp_path, upper, meshes, minus, plus, normal, points
):
    study = tmp_path / "study.toml"
    study.write_text(SIDES.format(upper=upper, meshes=meshes, minus=minus, plus=plus))
    _, lines, _ = check_file(study)
    assert ["joint", minus, plus, *normal.split(), *points.split()] in lines


def test_the_memory_of_the_factorization_is_foreseen(check, monkeypatch):
    monkeypatch.delenv("FAYING_FACTORIZATION", raising=False)
    monkeypatch.setenv("FAYING_MEMORY", "3e11")
    said = " ".join(cells(check({})[1], "factorization"))
    name = available_backends()[0]
    # A thousand degrees of freedom: a few megabytes, and workspace of PARDISO's threads.
    taken = r"(\S+) GB of factors, (\S+) GB at the peak"
    found = re.fullmatch(rf"factorization {name}, {taken}.*; 300 GB are free", said)
    assert found, said
    factor, peak = map(float, found.groups())
    assert 1e-3 < factor <= peak < 300
    monkeypatch.setenv("FAYING_MEMORY", "1e5")  # room for the deck alone
    status, lines, _ = check({})
    assert status == 0
    assert " ".join(cells(lines, "factorization")).endswith("are free, which is not enough")
    monkeypatch.setenv("FAYING_FACTORIZATION", "superlu")
    assert "within a factor of two" in " ".join(cells(check({})[1], "factorization"))


def test_supports_say_what_they_hold(check):
    _, lines, _ = check({})
    assert cells(lines, "supports") == ["supports", "of", "ux", "uy", "uz", "1", "15"]


def test_bolts_say_what_they_are(check):
    _, lines, _ = check({})
    bolt = " ".join(cells(lines, "M6"))
    assert bolt.startswith("M6 element 226 (0, 0, 1) ")
    assert bolt.endswith(" 10000 the study")


def test_loads_of_the_deck_are_listed_with_what_applies_them(check):
    changes = {
        "SPC = 1\n": "SPC = 1\nLOAD = 7\n",
        "ENDDATA": "FORCE,7,475,,100.,0.,3.,-4.\nFORCE,7,1,,1.,5.,0.,0.\nENDDATA",
    }
    status, lines, _ = check(changes)
    assert status == 0
    assert cells(lines, "7") == ["7", "2", "5", "300", "-400", "none", "yes"]
    start = lines.index(["[[load_case]]"])
    pasted = [" ".join(line) for line in lines[start : start + 4]]
    (case,) = tomllib.loads("\n".join(pasted))["load_case"]
    assert case == {
        "name": "load 7",
        "kind": "static",
        "forces": [{"deck_load": "7", "value": 1.0}],
    }


def test_what_moves_as_a_whole_is_told_and_not_refused(check):
    status, lines, err = check({"SPC = 1\n": "", SUPPORT: ""})
    assert (status, err) == (0, "")
    (row,) = [line for line in lines if line[:2] == ["the", "whole"]]
    assert row[2:6] == ["no", "support", "holds", "6"]


def test_what_can_move_is_told_before_it_is_refused(check, tmp_path):
    no_mass = {",7.82-9": ",0."}
    changes = {"SPC = 1\n": "", SUPPORT: "", **no_mass}
    status, lines, err = check(changes, "--out", str(tmp_path))
    assert status == 2
    title = next(line for line in lines if line[:1] == ["Rigid-body"])
    assert title[-1] == "6"
    assert [line for line in lines if line[:2] == ["body", "'lower'"]]
    assert [line for line in lines if line[:2] == ["body", "'upper'"]]
    assert (tmp_path / "model.png").stat().st_size > 0
    assert len(err.strip().splitlines()) == 1
    assert "unconstrained body" in err


def test_joint_without_bolt_lets_one_body_go():
    model = tiny_lap()
    loose = fy.build_model(
        type(model.assembly)(
            **{**vars(model.assembly), "beams": (), "rigid_couplings": ()},
        ),
        interfaces=[fy.InterfaceSpec(name="joint")],
        bolts=[],
        boundaries=[],
    )
    found = free_parts(loose)
    assert found.count == 6
    assert len(found.parts) == 1
    ((name, how),) = found.parts.items()
    assert name.startswith("body 'upper'")
    assert how == "is held by nothing"


# --- decks alone, and studies that are not ready to run ---------------------------------------


@pytest.fixture
def check_file(call):
    """Return what checks a file, to its status, lines and error."""

    def check(path, *options):
        status, out, err = call("check", path, *options)
        return status, [line.split() for line in out.splitlines()], err

    return check
