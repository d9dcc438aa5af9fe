"""``faying check`` says what can move, what bolts are, and what applies loads of the deck."""

import re
import sys
import tomllib
from pathlib import Path

import pytest
from rich.text import Text

import faying as fy
from faying import cli
from faying.cli.description import _table
from faying.joint.diagnosis import free_parts
from faying.linalg.backends import available_backends
from small_abaqus_deck import DECK

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
def test_decks_in_which_nothing_can_touch(monkeypatch, capsys, tmp_path, command, name, text, held):
    (tmp_path / name).write_text(text)
    monkeypatch.setattr(sys, "argv", ["faying", command, str(tmp_path / name)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code
    (line,) = capsys.readouterr().err.splitlines()
    assert f"no solids, no shells and no matrices ({held})" in line


def cells(lines, first):
    return next(line for line in lines if line[:1] == [first])


def test_tables_leave_out_columns_in_which_nothing_stands():
    shown = _table("Bolts", ["name", "said by", "force"], [("a", "", 1.0), ("b", "", 2.0)])
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
    taken = r"(\S+) GB of factors, (\S+) GB while they are made"
    found = re.fullmatch(rf"factorization {name}, {taken}.*; 300 GB are free", said)
    assert found, said
    factor, peak = map(float, found.groups())
    assert 1e-3 < factor <= peak < 300
    monkeypatch.setenv("FAYING_MEMORY", "1e5")  # room for the deck alone
    status, lines, _ = check({})
    assert status == 0
    assert " ".join(cells(lines, "factorization")).endswith("are free, which is not enough")
    monkeypatch.setenv("FAYING_FACTORIZATION", "superlu")
    assert "give or take" in " ".join(cells(check({})[1], "factorization"))


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
    assert row[2:5] == ["nothing", "resists", "6"]


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
    model = fy.lap_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
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


def run_check(monkeypatch, capsys, path, *options):
    """Check a file; return status, lines and error."""
    monkeypatch.setattr(sys, "argv", ["faying", "check", str(path), *options])
    monkeypatch.setenv("COLUMNS", "200")
    with pytest.raises(SystemExit) as ended:
        cli.main()
    out, err = capsys.readouterr()
    return ended.value.code or 0, [line.split() for line in out.splitlines()], err


@pytest.fixture
def check_file(monkeypatch, capsys):
    return lambda path, *options: run_check(monkeypatch, capsys, path, *options)


def without_contact(text):
    start, end = text.index("*SURFACE INTERACTION"), text.index("*RIGID BODY")
    return text[:start] + text[end:]


def test_a_bare_deck_is_told_with_what_a_run_would_need(check_file, tmp_path):
    path = tmp_path / "joint.inp"
    path.write_text(DECK.replace("102, 1, 6", "102, 1, 2"))
    status, lines, err = check_file(path, "--out", str(tmp_path))
    assert (status, err) == (0, "")
    assert ["Interfaces"] in lines
    assert cells(lines, "Joint")[-1] == "1e+06"
    assert " ".join(cells(lines, "bolt")).endswith("400 the source")
    needs = lines.index(["what", "a", "run", "would", "still", "need"])
    assert ["a", "[[load_case]]", "or", "[[frequency]]"] in lines[needs:]
    # A study is refused for that; of a deck it is told.
    assert any(line[:2] == ["supports,", "unless"] for line in lines[needs:])
    assert (tmp_path / "model.png").stat().st_size > 0
    start = lines.index(["[model]"])
    pasted = "\n".join(" ".join(line) for line in lines[start : start + 3])
    assert tomllib.loads(pasted) == {"model": {"source": "abaqus", "file": "joint.inp"}}


def test_candidates_where_no_interface_is_declared(check_file, tmp_path):
    path = tmp_path / "bricks.inp"
    path.write_text(without_contact(DECK))
    study = tmp_path / "study.toml"
    study.write_text('[model]\nsource = "abaqus"\nfile = "bricks.inp"\n')
    for one in (path, study):
        status, lines, err = check_file(one, "--out", str(tmp_path))
        assert (status, err) == (0, "")
        assert ["Candidate", "interfaces"] in lines
        assert cells(lines, "joint")[1:4] == ["1", "4", "4"]
        start = lines.index(["[[interface]]"])
        pasted = "\n".join(" ".join(line) for line in lines[start : start + 5])
        (found,) = tomllib.loads(pasted)["interface"]
        assert found == {"name": "joint", "minus": "auto", "plus": "auto", "meshes": "matching"}
    apart = without_contact(DECK)
    for node in range(11, 19):
        apart = re.sub(rf"^({node}, .*), (.)\.$", r"\1, 2\2.", apart, flags=re.MULTILINE)
    path.write_text(apart)
    status, lines, _ = check_file(path)
    assert status == 0
    assert ["Candidate", "interfaces"] not in lines
    assert any(line[:4] == ["an", "interface:", "none", "is"] for line in lines)


def test_a_study_without_density_is_told_that_it_needs_one(check_file, tmp_path):
    """It is refused when it is run."""
    (tmp_path / "cantilever.bdf").write_text(
        (EXAMPLES / "cantilever.bdf").read_text().replace("7.82-9", "")
    )
    study = tmp_path / "study.toml"
    text = (EXAMPLES / "nastran_deck.toml").read_text()
    study.write_text(text)
    status, lines, _ = check_file(study)
    assert status == 0
    assert any(line[:1] == ["densities:"] for line in lines)


def test_bolts_and_contact_that_cannot_be_built_are_needs_of_a_deck_alone(check_file, tmp_path):
    path = tmp_path / "bricks.inp"
    # Head and nut in one brick.
    path.write_text(DECK.replace("NAME=HEAD\nUPPER, S2", "NAME=HEAD\nLOWER, S2"))
    status, lines, err = check_file(path)
    assert (status, err) == (0, "")
    assert ["Bodies"] in lines
    assert any(line[:4] == ["contact", "and", "bolts", "that"] for line in lines)
    # A bolt through one body and no contact at all: both are told.
    path.write_text(
        without_contact(DECK.replace("NAME=HEAD\nUPPER, S2", "NAME=HEAD\nLOWER, S2")).replace(
            "UPPER\n2, 11, 12, 13, 14", "UPPER\n2, 5, 6, 7, 8"
        )
    )
    status, lines, _ = check_file(path)
    assert status == 0
    assert any(line[:4] == ["contact", "and", "bolts", "that"] for line in lines)
    assert any(line[:4] == ["an", "interface:", "none", "is"] for line in lines)
    # The slave lies inside out, so that it sees nothing of the master.
    path.write_text(DECK.replace("NAME=MASTER\n2, S1", "NAME=MASTER\n2, S2"))
    status, lines, _ = check_file(path)
    assert status == 0
    assert any(line[:4] == ["contact", "and", "bolts", "that"] for line in lines)


def test_what_a_deck_alone_is_to_be_read_without(check_file, tmp_path):
    path = tmp_path / "bricks.inp"
    path.write_text(DECK.replace("*DENSITY\n", "*PLASTIC\n300., 0.\n*DENSITY\n", 1))
    status, _, err = check_file(path)
    assert status == 2
    assert 'ignore = ["plastic"]' in err
    status, lines, _ = check_file(path, "--ignore", "plastic")
    assert status == 0
    assert ["ignore", "=", '["plastic"]'] in lines
    status, _, err = check_file(path, "--ignore", "plastik")
    assert status == 2
    assert "'plastik'" in err
    status, _, err = check_file(EXAMPLES / "nastran_deck.toml", "--ignore", "plastic")
    assert status == 2
    assert "a study says what to ignore itself" in err


def test_files_of_no_known_kind_are_refused(check_file, tmp_path):
    path = tmp_path / "joint.step"
    path.write_text("")
    status, _, err = check_file(path)
    assert status == 2
    assert "'.step' is neither .toml nor a suffix of decks (.bdf, " in err
    for name, text, said in (
        (
            "ds.dat",
            "/batch\n/com,--- Data in consistent MKS units.\n/prep7\n",
            "CDWRITE,DB,joint,cdb",
        ),
        ("joint.msh", "", "faying init joint.msh begins its study"),
    ):
        (tmp_path / name).write_text(text)
        status, _, err = check_file(tmp_path / name)
        assert status == 2
        assert said in " ".join(err.split())
