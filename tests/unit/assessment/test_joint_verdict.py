"""The verdict on a joint: a row for each bolt and interface, a sentence, and what is not known."""

from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import faying as fy
from faying.assessment import joint_judge
from faying.assessment.check import Check
from faying.assessment.joint_checks import joint_checks
from faying.assessment.joint_verdict import amount_of, joint_verdict, share_used, verdict_rows
from faying.assessment.requirements import Verdict
from faying.assessment.slip_demand import SlipDemand
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.strength.thread import Thread
from faying.assessment.verdicts import verdicts
from faying.exceptions import ConvergenceError
from faying.report.html import check_table
from faying.units import units_of

UNITS = units_of("mm-t-s")
BOLT = Check(part="b", kind="bolt", quantity="yield", outcome="met", utilisation=0.5)


@pytest.fixture(scope="module")
def joint():
    model = fy.lap_joint(element_size=5.0, bolt_positions=((-10.0, 0.0), (10.0, 0.0)))
    return fy.preload(model, dict.fromkeys(model.bolts, 8e3))


def judged(joint, requirements=None, **options):
    load = fy.Load({"tip.Fz": -300.0}, name="bend")
    found = fy.assess(joint, [load], requirements, **options)
    return found, {(one.part, one.quantity): one for one in joint_checks(found, UNITS)}


def test_what_nobody_demands_is_judged_at_the_load_itself(joint):
    found, checks = judged(joint)
    interface = found.interfaces["joint"]
    loss, opening = checks["joint", "clamp loss"], checks["joint", "opening"]
    expected = 1 - interface.least_clamp / interface.preload
    assert loss.utilisation == pytest.approx(max(expected, 0.0), rel=1e-12)  # the same numbers
    assert (opening.limit, opening.value) == (1.0, interface.opening["bend"])
    assert opening.utilisation == pytest.approx(1 / interface.opening["bend"], rel=1e-12)
    assert not any(check.required for check in checks.values())
    # Of several bolts the surroundings of each are told, of the interface where most is used.
    around = checks["bolt-2", "clamp loss at joint"]
    area = found.bolts["bolt-2"].clamp_around["joint"]
    assert around.utilisation == pytest.approx(max(1 - area.least / area.preload, 0), rel=1e-12)
    verdict = joint_verdict(joint_checks(found, UNITS), UNITS)
    assert [one.part for one in verdict.parts] == ["bolt-1", "bolt-2", "joint"]
    assert verdict.holds
    assert [text.split(":")[0] for text in verdict.open_questions] == [
        "yield of bolt-1, bolt-2",
        "slip of joint",
    ]


def test_every_interface_is_judged_by_what_is_demanded(joint):
    least = 1.5 * judged(joint)[0].interfaces["joint"].least_clamp
    wanted = fy.Requirements(
        min_clamp_force=least, max_pressure=1.0, min_opening_factor=1e3, min_slip_safety=1.0
    )
    found, checks = judged(joint, wanted)
    clamp, pressure = checks["joint", "clamp force"], checks["joint", "pressure"]
    assert (clamp.outcome, clamp.required) == ("not met", True)
    assert clamp.utilisation == pytest.approx(least / clamp.value, rel=1e-12)
    assert pressure.utilisation == pytest.approx(found.interfaces["joint"].max_pressure, rel=1e-12)
    assert checks["joint", "opening"].limit == 1e3
    assert checks["bolt-1", "opening at joint"].required
    assert checks["joint", "slip"].outcome == "unknown"
    verdict = joint_verdict(joint_checks(found, UNITS), UNITS)
    assert not verdict.holds
    # Bolt 2 opens above ten times the load, and whether above a thousand is not known.
    assert "Not known: opening at joint of bolt-2: it holds up to 10 times bend" in verdict.sentence
    assert "; slip of joint: it is judged by static loads" in verdict.sentence
    by_requirement = {one.requirement: one.met for one in found.verdicts}
    assert by_requirement["min_clamp_force"] is by_requirement["max_pressure"] is False


def test_load_factors_beyond_what_was_tried_are_told_as_bounds(joint):
    """Opening was told to use 0 % where nothing opens up to ten times the load."""
    found = fy.assess(joint, [fy.Load({"tip.Fz": -10.0}, name="touch")])
    verdict = joint_verdict(joint_checks(found, UNITS), UNITS)
    (opening,) = (c for c in verdict.parts[-1].checks if c.quantity == "opening")
    assert (opening.value, opening.beyond, share_used(opening)) == (10.0, True, "< 10 %")
    shown = {row[0].text: row for row in check_table(verdict).rows if row[1].text == "opening"}
    assert {"< 10.0", "> 10"} <= {cell.text for cell in shown["joint"]}
    assert found.interfaces["joint"].opening == {"touch": np.inf}


def test_limits_read_as_values_do():
    check = replace(BOLT, unit="Pa").at_most(7.34e8, 6.4e8)
    assert amount_of(check) == "7.340e8 of 6.4e8 Pa"


def test_a_bolt_that_yields_fails_whether_demanded_or_not(joint):
    thread = Thread(diameter=4.0, pitch=0.7, grade="4.6")
    found, checks = judged(joint, threads={"bolt-1": thread}, paths=False)
    check = checks["bolt-1", "yield"]
    assert check.outcome == "not met"
    assert check.utilisation > 1
    verdict = joint_verdict(joint_checks(found, UNITS), UNITS)
    assert not verdict.holds
    assert verdict.sentence.startswith("The joint does not hold: bolt-1, yield ")
    assert "of 240 MPa, in bend." in verdict.sentence
    row = verdict_rows(verdict)[0]
    assert row[:3] == ("bolt-1", "not met", share_used(check))


def reserve(**changes):
    return SlipReserve(
        **{
            "first_slip": 0.1, "interface": "joint", "point": 0, "onset": 0.2, "share": 0.5,
            "share_slip": 0.4, "gross_slip": None, "largest": 10.0, "stopped": False,
        } | changes
    )  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "outcome", "value"),
    [
        ({}, "met", 10.0),  # followed that far without sliding
        ({"gross_slip": 1.5, "slides": "joint"}, "met", 1.5),
        ({"gross_slip": 0.5, "slides": "joint"}, "not met", 0.5),
        ({"largest": 0.5, "stopped": True}, "unknown", None),
        ({"gross_slip": 0.5, "slides": "another"}, "unknown", None),
    ],
)
def test_sliding_is_judged_by_the_load_that_was_followed(joint, changes, outcome, value):
    found, _ = judged(joint, paths=False)
    checks = joint_checks(found, UNITS, {"bend": reserve(**changes)})
    (sliding,) = (one for one in checks if one.quantity == "sliding")
    assert (sliding.outcome, sliding.value) == (outcome, value)
    assert sliding.reason.startswith("it holds up to 0.5 times bend") == (outcome == "unknown")


@pytest.mark.parametrize("reserves", [{}, {"pull": reserve()}])
def test_what_is_told_to_do_about_unknown_slip_suits_the_joint(joint, reserves):
    """A joint with friction was told to leave what it had not got, and to demand what it had."""
    bent = SlipDemand(coefficient=0.2, unknown="it is curved")
    interfaces = {"joint": replace(judged(joint, paths=False)[0].interfaces["joint"], slip=bent)}
    asked = fy.Requirements(min_slip_safety=1.2)
    (verdict,) = verdicts(asked, {}, joint.bolts, None, {}, interfaces, {}, reserves)
    assert ("in place of min_slip_safety" in verdict.reason) == bool(reserves)
    assert ("out of slip_friction" in verdict.reason) != bool(reserves)


@pytest.mark.parametrize(
    ("other", "outcome"),
    [
        ({"largest": 0.5, "stopped": True}, "unknown"),
        ({"gross_slip": 0.5, "slides": "another"}, "unknown"),
        ({"gross_slip": 0.5, "slides": "joint"}, "not met"),
        ({}, "met"),
    ],
)
def test_a_case_that_slides_late_hides_none_that_was_not_followed(joint, other, outcome):
    """Sliding at 3 times the load of one case met the check, whatever became of the others."""
    found, _ = judged(joint, paths=False)
    paths = {"late": reserve(gross_slip=3.0, slides="joint"), "bend": reserve(**other)}
    checks = joint_checks(found, UNITS, paths)
    (sliding,) = (one for one in checks if one.quantity == "sliding")
    assert sliding.outcome == outcome


def test_a_case_whose_opening_cannot_be_followed_is_judged_by_its_open_area(joint, monkeypatch):
    """It was judged by nothing, and a joint of which most opened held."""

    def fail(*_, **__):
        raise ConvergenceError("no equilibrium on the way")

    lenient = partial(joint_judge.JointJudge, attempt=lambda _: suppress(ConvergenceError))
    monkeypatch.setattr(joint_judge, "opening_factors", fail)
    monkeypatch.setattr(joint_judge, "JointJudge", lenient)
    _, checks = judged(joint)
    assert ("joint", "opening") not in checks
    assert checks["joint", "open area"].value > 0


@pytest.mark.parametrize(("limit", "outcome"), [(1.2, "met"), (2.0, "not met")])
def test_slip_safety_of_a_joint_without_bolts_is_demanded_of_its_path(joint, limit, outcome):
    """A press fit that was to reach 2 and reached 1.75 was said to hold."""
    found, _ = judged(joint, paths=False)
    verdict = Verdict.at_least("min_slip_safety", "joint", "bend", 1.75, limit)
    fit = replace(found, bolts={}, verdicts=(verdict,))
    checks = joint_checks(fit, UNITS, {"bend": reserve(gross_slip=1.75, slides="joint")})
    (sliding,) = (one for one in checks if one.quantity == "sliding")
    assert (sliding.outcome, sliding.limit, sliding.required) == (outcome, limit, True)
    assert joint_verdict(checks, UNITS).holds is verdict.met


def test_an_opening_that_is_demanded_of_what_nothing_presses_is_unknown(joint):
    found, _ = judged(joint, fy.Requirements(min_opening_factor=2.0), paths=False)
    loose = replace(found.interfaces["joint"], preload=0.0)
    checks = joint_checks(replace(found, interfaces={"joint": loose}), UNITS)
    assert [one.quantity for one in checks if one.required] == ["opening"]
    assert not joint_verdict(checks, UNITS).holds


@pytest.mark.parametrize(
    ("second", "holds", "said"),
    [
        (replace(BOLT, value=1.0), True, "The joint holds. The most used"),
        (
            replace(BOLT, outcome="unknown", reason="no table"),
            True,
            "The joint holds as far as it is judged.",
        ),
        (
            replace(BOLT, outcome="unknown", reason="no", required=True),
            False,
            "Not known: yield of b: no.",
        ),
        (replace(BOLT, outcome="not met", value=3.0, limit=2.0), False, "hold: b, yield 3.000 of"),
    ],
)
def test_only_what_is_demanded_may_not_be_unknown(second, holds, said):
    verdict = joint_verdict([BOLT, second], UNITS)
    assert verdict.holds is holds
    assert said in verdict.sentence


def test_reasons_are_told_once_with_what_differs_between_parts():
    checks = [
        replace(BOLT, part=name, quantity="fatigue", outcome="unknown", reason=f"{why}: count")
        for name, why in (("a", "borne 1 times"), ("b", "borne 2 times"))
    ]
    assert joint_verdict([BOLT, *checks], UNITS).open_questions == (
        "fatigue of b (borne 2 times), a (borne 1 times): count",
    )
    failed = [replace(BOLT, part=name, outcome="not met", reason="thicker") for name in "ab"]
    assert joint_verdict(failed, UNITS).advice == ("yield of a, b: thicker",)


def test_the_only_interface_is_not_named_with_each_check():
    opening = replace(BOLT, quantity="opening at face")
    face = Check(part="face", kind="interface", quantity="slip", outcome="met", utilisation=0.1)
    ((_, _, _, by, *_), _) = verdict_rows(joint_verdict([opening, face], UNITS))
    assert by == "opening"
    second = replace(face, part="other")
    ((_, _, _, by, *_), *_) = verdict_rows(joint_verdict([opening, face, second], UNITS))
    assert by == "opening at face"


def test_a_joint_that_was_not_judged_does_not_hold():
    verdict = joint_verdict((), UNITS, "it met what nobody foresaw")
    assert not verdict.holds
    assert "not judged: it met what nobody foresaw" in verdict.sentence
    assert joint_verdict((), UNITS).holds
