"""What case control does not select constrains nothing."""

from collections.abc import Callable
from pathlib import Path

import pytest

from faying.exceptions import FormatError
from faying.io.nastran import read_joint
from faying.model.assembly import Assembly

BULK = (
    "GRID,1,,0.,0.,0.\nGRID,2,,5.,0.,0.\nCBAR,7,2,1,2,0.,1.,0.\nPBAR,2,1,3.,2.,2.,1.\n"
    "MAT1,1,210000.,,.3\nSPC1,1,123,1\nSPC,2,2,3,0.\nSPCADD,12,1,2\n"
    "MPC,5,2,1,1.,1,1,-1.\nMPC,6,2,2,1.,1,2,-1.\nMPCADD,56,5,6\nENDDATA\n"
)
Deck = Callable[[str], Assembly]


@pytest.fixture
def deck(nastran) -> Deck:
    return lambda control: nastran(control + BULK).assembly


@pytest.mark.parametrize(
    ("control", "supports", "equations"),
    [
        ("SOL 103\nCEND\nMETHOD=9\nBEGIN BULK\n", set(), 0),
        ("SOL 101\nCEND\nSPC=1\nBEGIN BULK\n", {1}, 0),
        ("SOL 101\nCEND\nMPC=6\nBEGIN BULK\n", set(), 1),
        ("SOL 101\nCEND\nSPC=12\nMPC=56\nBEGIN BULK\n", {1, 2}, 2),
        ("SOL 101\nCEND\nSUBCASE 1\nSPC=2\nSUBCASE 2\nMPC=5\nBEGIN BULK\n", {2}, 0),
        # Without CEND, but with a selection.
        ("SPC=1\nBEGIN BULK\n", {1}, 0),
        ("BEGIN BULK\n", {1, 2}, 2),
        ("", {1, 2}, 2),
    ],
)
def test_constraints_are_those_selected(
    deck: Deck, control: str, supports: set[int], equations: int
) -> None:
    assembly = deck(control)
    assert {support.id for support in assembly.supports} == supports
    assert len(assembly.equations) == equations
    said = "all apply" if control in ("", "BEGIN BULK\n") else "they constrain nothing"
    for kind, sets, empty in (("SPC", "1, 2", not supports), ("MPC", "5, 6", not equations)):
        told = any(n.startswith(f"{kind} sets {sets}: ") and said in n for n in assembly.ignored)
        assert told == (empty or "all" in said)


def test_bolt_sequences_that_are_not_selected(deck: Deck) -> None:
    bolt = "BOLT,1,1,7\nBOLTFOR,3,5.,1\nBOLTSEQ,4,1,3\n"
    assembly = deck(f"SOL 101\nCEND\nBOLTLD=3\nBEGIN BULK\n{bolt}")
    assert any(note.startswith("BOLTSEQ 4 (") for note in assembly.ignored)
    with pytest.raises(FormatError, match="BOLTSEQ: it is not supported"):
        deck(f"SOL 101\nCEND\nBOLTLD=4\nBEGIN BULK\n{bolt}")


def test_added_masses_that_are_not_selected(deck: Deck) -> None:
    mass = "NSM1,3,PBAR,2,.5\n"
    assembly = deck(f"SOL 103\nCEND\nBEGIN BULK\n{mass}")
    assert "1 NSM1: case control selects none by NSM" in assembly.ignored
    for control in ("SOL 103\nCEND\nNSM=3\nBEGIN BULK\n", ""):
        with pytest.raises(FormatError, match="NSM1: the card is not supported"):
            deck(control + mass)


def test_what_only_statics_hold_is_said(deck: Deck) -> None:
    assembly = deck("SOL 103\nCEND\nBEGIN BULK\nSUPORT,1,123456\n")
    assert any(note.startswith("1 SUPORT: fixed in Nastran's statics") for note in assembly.ignored)


def test_sets_that_the_deck_does_not_have(deck: Deck, tmp_path: Path) -> None:
    """Nastran goes on without them, as decks of its own test library show."""
    assembly = deck("SOL 101\nCEND\nSPC=22\nBEGIN BULK\nSPCADD,22,1,9\n")
    assert {support.id for support in assembly.supports} == {1}
    assert any("SPCADD: sets that are not in the deck: 9" in n for n in assembly.ignored)
    bulk = "".join(line + "\n" for line in BULK.splitlines() if line[:3] != "MPC")
    (tmp_path / "b.bdf").write_text(f"SOL 101\nCEND\nMPC=1\nBEGIN BULK\n{bulk}")
    assembly = read_joint(tmp_path / "b.bdf").assembly
    assert "case control selects MPC = 1, which the deck lacks" in assembly.ignored


@pytest.mark.parametrize(
    ("card", "said"),
    [
        ("SPC,1,,3,0.", r"SPC: field 3 \(G1\) holds nothing, expected an integer"),
        ("SPC,1,1,3,0.,,3", r"SPC: field 6 \(G2\) holds nothing, expected an integer"),
        ("SLOAD,1,1,3.,,4.", r"SLOAD: field 5 \(S2\) holds nothing, expected an integer"),
    ],
)
def test_nothing_is_lost_of_fields_that_repeat(deck: Deck, card: str, said: str) -> None:
    with pytest.raises(FormatError, match=f"a.bdf:1: {said}"):
        deck(f"{card}\n")
