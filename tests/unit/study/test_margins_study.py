"""Margins that a study demands: computed by its run, kept, told by its verdict."""

import pytest

from faying.exceptions import StudyError
from faying.study.keys.schema import parse_study
from faying.study.results.store import read_results
from faying.workflow.run import run
from small_study import NO_REPORT, SMALL_JOINT, UNCHECKED, reduction, static

STUDY = (
    SMALL_JOINT.replace(
        "5e3\n", '5e3\nsize = "M6"\ngrade = "8.8"\ngamma = 0.2\nthread_friction = 0.12\n', 1
    )
    + reduction("compliance")
    + f"{UNCHECKED}[requirement]\nslip_friction = 0.15\n[requirement.margins]\nFACTORS\n"
    + static("bend", "Fz", 150.0)
    + "REPETITIONS\n"
    + NO_REPORT
)
NASA = 'standard = "nasa-std-5020b"\nFF = 1.1\nFS_u = 1.4\nFS_y = 1.25\nFS_sep = 1.2'


@pytest.mark.long
def test_a_run_tells_the_margins_of_its_standard(tmp_path):
    text = STUDY.replace("FACTORS", NASA).replace("REPETITIONS", "repetitions = 1e6")
    summary = run(parse_study(text, tmp_path / "joint.toml"), tmp_path / "out")
    results = read_results(tmp_path / "out" / "results.h5")
    found = {one.quantity: one for one in results.assessment.checks}
    margins = {"MS_u", "ultimate, combined", "MS_y", "MS_sep", "MS_slip"}
    assert {*margins, "tightening", "yield", "fatigue, Miner's sum", "clamp loss"} == set(found)
    assert all(found[quantity].required for quantity in margins)
    assert found["MS_u"].scatter == "P_p,max"
    assert found["MS_sep"].scatter == "P_p,min"
    assert "NASA-STD-5020B 4.4.3 (19)" in found["MS_sep"].source
    # Gaps are none and springs linear: what opens or slips the joint goes with its preloads.
    opening = results.assessment.loosened[0]
    nominal = results.assessment.interfaces["joint"].opening["bend"]
    assert (opening.quantity, opening.scatter) == ("opening", "P_p,min")
    assert opening.value == pytest.approx(0.8 * 0.95 * nominal, rel=1e-5)  # found to a millionth
    assert results.omissions == ()
    assert len(summary["assessment"]["checks"]) == len(found)
    rows = {row["part"]: row["all checks"] for row in summary["verdict"]["table"]}
    assert "MS_u" in rows["bolt"]
    assert "MS_slip" in rows["joint"]


@pytest.mark.parametrize(
    ("factors", "message"),
    [
        ('standard = "vdi-symbols"\nFS_u = 1.4', "no such factor; remove it"),
        ('standard = "nasa-std-5020b"\nS_F = 1.2', "no such factor; remove it"),
        ('standard = "nasa-std-5020"', "nasa-std-5020b"),
    ],
)
def test_factors_are_those_of_the_standard(tmp_path, factors, message):
    text = STUDY.replace("FACTORS", factors).replace("REPETITIONS", "")
    with pytest.raises(StudyError, match=message):
        parse_study(text, tmp_path / "joint.toml")
