"""Bolts that decks make of two-node springs, forces they start with, and bolts tightened twice."""

import numpy as np
import pytest

from faying.exceptions import ModelError, StudyError
from faying.study.inputs.load_model import build, load_model
from faying.study.keys.schema import read_study
from faying.study.stages.offline import prepare_joint
from faying.workflow.run import run
from small_nastran_deck import blocks

# Two blocks of 10 mm; the bolt is cut at z = 10, where nodes 23 (nut's side) and 24 coincide.
DECK = f"""SOL 101
CEND
SPC = 1
BCSET = 1
LOAD = 7
BEGIN BULK
{blocks(10)}GRID,21,,5.,5.,0.
GRID,22,,5.,5.,20.
GRID,23,,5.,5.,10.
GRID,24,,5.,5.,10.
RBE2,31,21,123,1,2,3,4
RBE2,32,22,123,15,16,17,18
SPC1,1,123456,21
CBEAM,41,5,21,23,1.,0.,0.
CBEAM,42,5,24,22,1.,0.,0.
CELAS2,43,1.+5,23,3,24,3
RBE2,33,23,12456,24
PBEAM,5,1,28.,63.,63.,,126.
BSURFS,1,,,,1,5,6,7
BSURFS,2,,,,2,11,12,13
BCTSET,1,1,2,0.
FORCE,7,23,,800.,0.,0.,1.
FORCE,7,24,,800.,0.,0.,-1.
FORCE,7,22,,100.,0.,0.,-1.
ENDDATA
"""
STUDY = """
[model]
source = "nastran"
file = "joint.bdf"
[[bolt]]
name = "M6"
elements = [43]
preload = 5e3
[reduction]
methods = ["compliance"]
normal_modes = 2
[output]
report = false
"""
CASE = """
[[load_case]]
name = "pull"
kind = "static"
forces = [{ deck_load = "7", value = 1.0 }]
"""
REVERSED = ("23,3,24,3", "24,3,23,3")
# The spring joins touching nodes 5 and 11 of the blocks themselves.
BETWEEN = ("CELAS2,43,1.+5,23,3,24,3", "CELAS2,43,1.+5,5,3,11,3\nCELAS2,44,1.+5,23,3,24,3")
BETWEEN_REVERSED = (BETWEEN[0], BETWEEN[1].replace("5,3,11,3", "11,3,5,3"))


@pytest.fixture
def study(tmp_path):
    """Write the deck and a study with changes; return the study."""

    def write(deck=("", ""), text=("", ""), more=""):
        assert deck[0] in DECK
        assert text[0] in STUDY
        (tmp_path / "joint.bdf").write_text(DECK.replace(*deck))
        (tmp_path / "study.toml").write_text(STUDY.replace(*text) + more)
        return read_study(tmp_path / "study.toml")

    return write


def prepared(study):
    return prepare_joint(study)


@pytest.mark.parametrize("deck", [("", ""), REVERSED, BETWEEN, BETWEEN_REVERSED])
def test_a_spring_pulls_together_in_whichever_order_its_nodes_stand(study, deck):
    joint = prepared(study(deck))
    assert joint.preload.bolt_force("M6") == pytest.approx(5e3, rel=1e-9)  # Newton's 1e-10
    # Nothing else holds the upper block but the spring of 1e5 N/mm beside it in some decks.
    assert joint.preload.contact_force() > 2e3
    assert joint.model.bolts["M6"].initial_force > 5e3


def test_both_orders_give_the_same_pressures(study):
    one, other = (prepared(study(deck)).preload.pressure for deck in (("", ""), REVERSED))
    np.testing.assert_allclose(other, one, rtol=1e-9)  # round-off of K


def test_an_interface_that_stays_open_is_named(study, tmp_path, caplog):
    """A gap of 1 mm under a bolt beside stiff springs, which 5 kN do not close."""
    beside = ("CELAS2,43", "CELAS2,44,1.+5,5,3,11,3\nCELAS2,43")
    apart = study(beside, more='[[interface]]\nname = "contact-1-2"\ninitial_gap = 1.0\n')
    summary = run(apart, tmp_path / "out")
    said = "is open everywhere after tightening: no bolt presses it"
    assert said in caplog.text
    assert any(said in warning for warning in summary["warnings"])


@pytest.mark.parametrize("nodes", ["[23, 24]", "[24, 23]"])
def test_a_spring_is_found_by_its_nodes(study, nodes):
    by_nodes = prepared(study(text=("elements = [43]", f"nodes = {nodes}")))
    assert by_nodes.loaded.bolts[0].elements == (43,)


def test_several_springs_between_the_nodes(study):
    more = ("ENDDATA", "CELAS2,45,1.+5,23,1,24,1\nENDDATA")
    with pytest.raises(StudyError, match=r"springs 43, 45 join these nodes; give the axial one"):
        load_model(study(more, ("elements = [43]", "nodes = [23, 24]")))


@pytest.mark.long
def test_initial_force_is_what_the_joint_relaxes(study, tmp_path):
    """Locked at the N₀ that tightening found, a bolt has the same final force."""
    tightened = prepared(study())
    initial = tightened.model.bolts["M6"].initial_force
    locked = study(text=("preload = 5e3", f"initial_force = {initial!r}"))
    joint = prepared(locked)
    assert joint.model.bolts["M6"].initial_force == initial
    assert joint.preload.bolt_force("M6") == pytest.approx(5e3, rel=1e-9)  # round-off of K
    summary = run(locked, tmp_path / "out")
    assert summary["bolts"]["M6"]["initial_force"] == initial
    assert summary["bolts"]["M6"]["preload"] == pytest.approx(5e3, rel=1e-9)


def test_final_and_initial_force_exclude_each_other(study):
    with pytest.raises(StudyError, match="found 'preload', 'initial_force', which each"):
        study(text=("preload = 5e3", "preload = 5e3\ninitial_force = 6e3"))
    with pytest.raises(StudyError, match=r"missing key 'preload', .* or 'initial_force'"):
        study(text=("preload = 5e3", ""))


def test_preload_of_the_deck_beside_that_of_the_study(study):
    both = r"load '7' pulls at both ends of bolt 'M6' with 800, .* tightened to 5000 beside it"
    with pytest.raises(StudyError, match=both):
        load_model(study(more=CASE))
    # Either alone is fine.
    assert load_model(study(text=("preload = 5e3", "preload = 0"), more=CASE)).preloads["M6"] == 0
    assert load_model(study()).preloads["M6"] == 5e3


def test_a_bolt_generated_where_the_deck_has_one(study):
    generated = """
[[bolt]]
name = "again"
axis = [[5.0, 5.0, 0.0], [5.0, 5.0, 20.0]]
diameter = 6.0
washer_radius = 8.0
washer = "rbe3"
preload = 1e3
"""
    with pytest.raises(ModelError, match=r"bolts 'M6' and 'again' hold the same nodes"):
        build(study(more=generated))
