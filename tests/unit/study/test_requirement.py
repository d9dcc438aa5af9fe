"""Requirements of a study: judged over its load cases, kept, reported, and told by the status."""

import json
from dataclasses import replace

import pytest
from typer.testing import CliRunner

import faying as fy
from faying.assessment import joint_judge as assessing
from faying.cli import app
from faying.exceptions import ConvergenceError, StudyError
from faying.report.html import write_report
from faying.report.slip import demand_table
from faying.study.judgement.verdict import run_verdict
from faying.study.keys.schema import parse_study
from faying.study.results.store import read_results
from faying.workflow.run import run
from small_study import (
    BEND,
    JUMP,
    NO_REPORT,
    SMALL_JOINT,
    UNCHECKED,
    reduction,
    static,
    tiny_joint,
)
from table_cells import cells

STUDY = (
    SMALL_JOINT
    + reduction("compliance")
    + f"{UNCHECKED}[requirement]\nREQUIREMENT\n\n"
    + BEND
    + JUMP
    + NO_REPORT
)


THREAD = 'thread = { diameter = 6.0, pitch = 1.0, grade = "8.8" }'


SCATTER = "preload_scatter = { tightening_factor = 1.4, samples = 20 }\n"


def outcome(folder, requirement, thread=""):
    text = SCATTER * bool(thread) + STUDY.replace("REQUIREMENT", requirement).replace(
        "5e3\n", f"5e3\n{thread}\n", 1
    )
    study = parse_study(text, folder / "joint.toml")
    summary = run(study, folder / "out")
    return summary, read_results(folder / "out" / "results.h5")


@pytest.mark.long
def test_requirements_are_judged_over_static_cases_and_transients(tmp_path):
    summary, results = outcome(tmp_path, "min_clamp_force = 4e3\nmax_pressure = 10.0", THREAD)
    found = results.assessment
    assert json.loads((tmp_path / "out" / "summary.json").read_text()) == summary
    peaks = {name: case.reference.pressure.max() for name, case in results.cases.items()}
    worst = max(peaks, key=peaks.get)
    clamp, pressure = found.verdicts
    assert (pressure.requirement, pressure.case, pressure.met) == ("max_pressure", worst, False)
    assert pressure.value == pytest.approx(peaks[worst], rel=1e-12)
    forces = [case.reference.contact_forces["joint"].min() for case in results.cases.values()]
    assert found.interfaces["joint"].least_clamp == pytest.approx(min(forces), rel=1e-12)
    most = [case.reference.contact_forces["joint"].max() for case in results.cases.values()]
    assert found.interfaces["joint"].most_clamp == pytest.approx(max(most), rel=1e-12)
    around = found.bolts["bolt"].clamp_around["joint"]
    assert around.least == pytest.approx(min(forces), rel=1e-12)
    assert summary["assessment"]["bolts"]["bolt"]["clamp_around"]["joint"]["most"] == around.most
    assert clamp.met
    assert summary["assessment"]["verdicts"][1]["met"] is False
    static = fy.assess(
        fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 5e3}),
        [fy.Load({"tip.Fz": -150.0}, name="bend")],
    )
    followed = found.interfaces["joint"].opening
    assert followed == pytest.approx(static.interfaces["joint"].opening, rel=1e-6)
    spread = {(one.case, one.metric): one for one in found.scatter}["bend", "clamp_force.joint"]
    assert spread.least < spread.meant < spread.most
    assert summary["assessment"]["scatter"][0]["case"] == "bend"
    assert summary["timings"]["stages"]["preload scatter"] > 0  # a stage that shows its progress
    stress = found.bolts["bolt"].thread
    assert stress.proof == pytest.approx(640.0, rel=1e-12)
    assert summary["assessment"]["bolts"]["bolt"]["thread"]["axial"] == stress.axial
    page = write_report(results, tmp_path / "out").read_text()
    assert "stress amplitude [MPa]" in page
    assert f"The joint does not hold: joint, pressure {pressure.value:.4g} of 10 MPa" in page
    assert '<th scope="row" class="poor"><span class="mark">✗</span> joint</th>' in page
    assert '<th scope="row" class="good"><span class="mark">✓</span> bolt</th>' in page
    assert page.index('id="joint"') < page.index('id="view"') < page.index('id="bolts"')
    (check,) = (one for one in run_verdict(results).parts[1].checks if one.quantity == "pressure")
    if worst == "jump":
        at = results.cases["jump"].reference.pressure.max(axis=1).argmax()
        assert check.instant == results.cases["jump"].times[at]


@pytest.mark.long
def test_each_requirement_is_judged_alone(tmp_path):
    """What cannot be judged is unknown, with the reason; bolts and all else are there."""
    demanded = "min_slip_safety = 1.5\nno_opening_within = 0.5\nmin_clamp_force = 1e3"
    path = tmp_path / "joint.toml"
    path.write_text(STUDY.replace("REQUIREMENT", demanded))
    done = CliRunner().invoke(app, ["check", str(path)])
    assert "min_slip_safety cannot be judged: it is judged by" in " ".join(done.output.split())
    done = CliRunner().invoke(app, ["run", str(path), "--out", str(tmp_path / "out")])
    assert done.exit_code == 3, done.output
    assert "the preload presses no" in " ".join(done.output.split())
    results = read_results(tmp_path / "out" / "results.h5")
    clamp, around, slip = results.assessment.verdicts
    assert (clamp.met, around.met, slip.met) == (True, None, None)
    assert "add what is missing" in slip.reason
    assert results.assessment.bolts["bolt"].preload > 0
    said = run_verdict(results).sentence
    assert said.startswith("Not known: pressed within 0.5 mm of bolt: the preload presses no")
    assert "; slip of joint: it is judged by" in said
    kept = json.loads((tmp_path / "out" / "summary.json").read_text())["assessment"]["verdicts"]
    assert [one["met"] for one in kept] == [True, None, None]


@pytest.mark.parametrize(
    ("demanded", "message"),
    [
        ("min_clamp_force = { jiont = 1e3 }", "there is no interface 'jiont'"),
        ("slip_friction = { jiont = 0.1 }", "no interface 'jiont' without friction"),
        ('closed_ring = [{ around = [0, 0, 0], interface = "x" }]', "no interface 'x'"),
    ],
)
def test_requirements_on_what_is_not_there_are_refused_before_the_run(tmp_path, demanded, message):
    path = tmp_path / "joint.toml"
    path.write_text(STUDY.replace("REQUIREMENT", demanded))
    for command in ("check", "run"):
        done = CliRunner().invoke(app, [command, str(path), "--out", str(tmp_path / "out")])
        assert isinstance(done.exception, StudyError)
        assert message in str(done.exception)
        assert "joint.toml (line " in str(done.exception)


@pytest.mark.parametrize(("limit", "status"), [(4e3, 0), (9e9, 3)])
def test_status_tells_whether_they_are_met(tmp_path, limit, status):
    path = tmp_path / "joint.toml"
    path.write_text(STUDY.replace("REQUIREMENT", f"min_clamp_force = {{ joint = {limit} }}"))
    done = CliRunner().invoke(app, ["run", str(path), "--out", str(tmp_path / "out")])
    assert done.exit_code == status, done.output
    assert ("does not hold" in done.output) == (status == 3)


@pytest.mark.long
def test_slip_without_friction_is_judged_by_sums(tmp_path):
    wanted = "slip_friction = 0.15\nmin_slip_safety = 1.0"
    study = STUDY.replace('component = "Fz", value = -150.0', 'component = "Fx", value = 900.0')
    (tmp_path / "joint.toml").write_text(study.replace("REQUIREMENT", wanted))
    done = CliRunner().invoke(
        app, ["run", str(tmp_path / "joint.toml"), "--out", str(tmp_path / "out")]
    )
    assert done.exit_code == 3, done.output
    results = read_results(tmp_path / "out" / "results.h5")
    found = results.assessment.interfaces["joint"].slip
    assert list(found.safety) == ["bend"]
    clamp = float(results.cases["bend"].reference.contact_forces["joint"])
    # The pull's line of action goes through the centre of pressure, by symmetry.
    assert found.safety["bend"] == pytest.approx(0.15 * clamp / 900.0, rel=1e-6)
    (verdict,) = results.assessment.verdicts
    assert (verdict.met, verdict.value) == (False, found.safety["bend"])
    around = results.assessment.bolts["bolt"].slip_around["joint"]
    assert around.needed_friction == pytest.approx(found.needed_friction, rel=1e-9)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["assessment"]["interfaces"]["joint"]["slip"]["safety"] == found.safety
    row = cells(demand_table(results))["joint"]
    assert (row["friction given"], row["friction needed, load case"]) == ("0.150", "bend")
    # As it is printed.
    assert float(row["safety S_G"]) == pytest.approx(found.safety["bend"], rel=1e-2)
    pressed = replace(found, needed_friction={"bend": 1e-13}, safety={})
    joint = replace(results.assessment.interfaces["joint"], slip=pressed)
    alone = replace(results, assessment=replace(results.assessment, interfaces={"joint": joint}))
    assert not {"safety S_G", "friction needed"} & set(cells(demand_table(alone))["joint"])
    (slip,) = (one for one in run_verdict(alone).parts[1].checks if one.quantity == "slip")
    assert (slip.outcome, slip.utilisation) == ("met", 0.0)  # nothing to carry
    (slip,) = (one for one in run_verdict(results).parts[1].checks if one.quantity == "slip")
    assert (slip.outcome, slip.value, slip.limit) == ("not met", found.safety["bend"], 1.0)


def test_load_factors_that_are_left_out_are_said(tmp_path, monkeypatch):
    def lost(*_, **__):
        raise ConvergenceError("the contact does not settle")

    monkeypatch.setattr(assessing, "opening_factors", lost)
    summary, results = outcome(tmp_path, "min_clamp_force = 1e3\nmin_opening_factor = 1.0")
    assert [one.met for one in results.assessment.verdicts] == [True, None]
    assert results.assessment.interfaces["joint"].opening == {}
    assert "bend, load factors of opening: the contact does not settle" in summary["warnings"]


FRICTION = "preload_scatter = { thread_friction = [0.1, 0.2], head_friction = [0.1, 0.2] }\n"


@pytest.mark.parametrize(
    ("scatter", "message"),
    [
        (FRICTION, r"(?s)needs the size and grade of bolt 'bolt'; add size = "),
        (
            FRICTION.replace(", head_friction = [0.1, 0.2]", ""),
            "takes both thread_friction and head_friction",
        ),
        ("preload_scatter = { surface_friction = [0.3, 0.2] }\n", "goes from 0.3 to 0.2"),
    ],
)
def test_scatter_of_friction_that_makes_no_sense_is_refused(tmp_path, scatter, message):
    text = scatter + STUDY.replace("REQUIREMENT", "max_pressure = 10.0")
    with pytest.raises(StudyError, match=message):
        parse_study(text, tmp_path / "joint.toml")


def test_surfaces_without_friction_do_not_scatter(tmp_path):
    text = "preload_scatter = { surface_friction = [0.1, 0.2] }\n" + STUDY.replace(
        "REQUIREMENT", "max_pressure = 10.0"
    )
    with pytest.raises(StudyError, match="no interface has friction that could scatter"):
        run(parse_study(text, tmp_path / "joint.toml"), tmp_path / "out")


@pytest.mark.long
def test_friction_of_bolts_scatters_in_studies(tmp_path):
    thread = THREAD.replace(" }", ", head_diameter = 8.0 }")
    text = FRICTION.replace("preload_scatter = {", "preload_scatter = { samples = 20,")
    text += STUDY.replace("REQUIREMENT", "max_pressure = 10.0").replace(
        "5e3\n", f"5e3\n{thread}\n", 1
    )
    run(parse_study(text, tmp_path / "joint.toml"), tmp_path / "out")
    found = read_results(tmp_path / "out" / "results.h5").assessment.scatter
    force = {(one.case, one.metric): one for one in found}["bend", "bolt_force.bolt"]
    assert force.least < 0.9 * force.meant < 1.1 * force.meant < force.most


RUBBED = (
    tiny_joint("friction = 0.2\nEXTRA")
    + reduction("compliance")
    + "[requirement]\nmin_clamp_force = 2e3\nmin_opening_factor = 0.5\n\n"
    + static("pull", "Fx", 600.0)
    + static("bend", "Fz", -200.0)
    + NO_REPORT
)


CLAMPED = ("clamp force", "opening", "sliding")


def checked(folder, text):
    run(parse_study(text, folder / "joint.toml"), folder / "out")
    checks = [
        c
        for part in run_verdict(read_results(folder / "out/results.h5")).parts
        for c in part.checks
    ]
    return {check.quantity: check for check in checks}


@pytest.mark.long
def test_joints_with_friction_are_judged_at_the_least_preloads(tmp_path):
    """As a joint with these preloads; clamp, opening and sliding were judged at nominal ones."""
    text = RUBBED.replace("EXTRA", "")
    judged = checked(tmp_path / "scattered", SCATTER + text)
    alone = checked(tmp_path / "loose", text.replace("5e3", repr(5e3 * (1 - 0.4 / 2.4))))
    assert judged["clamp force"].value == pytest.approx(alone["clamp force"].value, rel=1e-6)
    for quantity in CLAMPED[1:]:
        # Increments of the load differ, and factors depend on them by 0.4 %.
        assert judged[quantity].value == pytest.approx(alone[quantity].value, rel=5e-3)
    assert {judged[name].scatter for name in CLAMPED} == {"P_p,min"}


@pytest.mark.long
def test_gaps_leave_joints_with_friction_unjudged_at_the_least_preloads(tmp_path):
    judged = checked(tmp_path, SCATTER + RUBBED.replace("EXTRA", "initial_gap = 1e-3"))
    outcomes = {name: (judged[name].outcome, judged[name].required) for name in CLAMPED}
    assert outcomes == dict(
        zip(CLAMPED, [("unknown", True)] * 2 + [("unknown", False)], strict=True)
    )
    assert "run the study at the smallest preloads" in judged["sliding"].reason
