"""Studies of joints with friction: keys, refusals, increments in the results, methods compared."""

import json
import re
import shutil
import sys
from dataclasses import asdict, replace

import h5py
import numpy as np
import pytest

import faying as fy
from faying import cli
from faying.contact.laws import Coulomb, Hard, Penalty
from faying.display.quantities import number
from faying.exceptions import FormatError, ModelError, StudyError
from faying.export.formats import export
from faying.files.flattening import flattened
from faying.report.figures.album import Album
from faying.report.figures.maps import SLIP_STATES
from faying.report.figures.surface_map import draw_states
from faying.report.html import write_report
from faying.report.questions import questions
from faying.report.slip import demand_table, friction_table, slip_sentence, slipping
from faying.report.style import new_figure
from faying.simulation.start import last_of, released_state
from faying.study.inputs.load_model import build
from faying.study.inputs.loads import case_load
from faying.study.judgement.comparison import state_of_case
from faying.study.judgement.verdict import run_verdict
from faying.study.keys.load_files import read_load_factors
from faying.study.keys.schema import parse_study, read_study
from faying.study.results.store import read_results
from faying.study.stages.path_cases import rest_state
from faying.units import units_of
from faying.workflow.run import run
from lap_joints import tiny_lap
from small_study import NO_REPORT, reduction, static, tiny_joint
from table_cells import cells

FIRST = "first point slips at [× load]"
"""Column of the load factor at which the first point slips."""

CASES = """
[[load_case]]
name = "pull"
kind = "static"
increments = 4
forces = [{ boundary = "tip", component = "Fx", value = 600.0 }]

[[load_case]]
name = "way"
kind = "path"
factors = "way.csv"
forces = [
    { boundary = "tip", component = "Fx", value = 600.0 },
    { boundary = "tip", component = "Fz", value = -50.0 },
]

[[load_case]]
name = "shake"
kind = "cycle"
increments = 4
amplitudes = [1.5, 0.5]
forces = [{ boundary = "tip", component = "Fx", value = 600.0 }]

[requirement]
min_opening_factor = 1.0
min_slip_safety = 1.0
min_sliding_factor = 1.0

"""
STUDY = (
    tiny_joint("penalty = 1e6\nfriction = 0.2\ntangential_penalty = 8e5\n")
    + reduction("compliance")
    + CASES
    + NO_REPORT
)
WAY = "tip.Fx,tip.Fz,bolt\n0.5,0,1\n1,1,1\n\n1,1,0.7  # loosened\n-0.5,0,1\n"


def write(folder, text=STUDY, way=WAY):
    (folder / "way.csv").write_text(way)
    path = folder / "slip.toml"
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return read_study(write(tmp_path_factory.mktemp("study")))


@pytest.fixture(scope="module")
def finished(study, tmp_path_factory):
    out = tmp_path_factory.mktemp("finished")
    assert run(study, out)["converged"]
    return out


@pytest.fixture(scope="module")
def results(finished):
    return read_results(finished / "results.h5")


def test_two_safeties_against_slip_are_told_apart(results):
    """By sums friction carries all of the load; followed, the bolt carries its share of it."""
    found = results.assessment
    opening, sums, sliding = found.verdicts
    slip = found.interfaces["joint"].slip
    assert list(slip.safety) == ["pull", "shake, forth", "shake, back"]
    # The pull's line of action goes through the centre of pressure, by symmetry.
    assert slip.safety["pull"] == pytest.approx(0.2 * slip.clamp_force["pull"] / 600.0, rel=1e-6)
    assert sums.value == slip.safety["shake, forth"]
    assert (sums.requirement, sums.place, sums.case) == ("min_slip_safety", "joint", "shake, forth")
    reserves = {name: results.cases[name].reserve for name in ("pull", "shake")}
    assert {one.slides for one in reserves.values()} == {"joint"}
    assert (sliding.requirement, sliding.place) == ("min_sliding_factor", "joint")
    assert sliding.value == min(one.gross_slip for one in reserves.values())
    # All slips along one motion by nine tenths: without much of a bolt that is nearly the same.
    assert sliding.value > 0.89 * slip.safety["pull"]
    assert cells(demand_table(results))["joint"]["safety S_G"] == number(sums.value)
    (check,) = (one for one in run_verdict(results).parts[-1].checks if one.quantity == "sliding")
    assert (check.case, check.value) == (sliding.case, sliding.value)
    assert opening.requirement == "min_opening_factor"
    assert found.interfaces["joint"].opening == {"pull": reserves["pull"].openings[0]}


@pytest.mark.parametrize("name", ["pull", "way", "shake"])
def test_nodes_move_as_those_of_the_full_model(results, name):
    """With what friction moves behind the residual compliance."""
    case = results.cases[name]
    exact = case.reference.nodal_displacement
    found = case.methods["compliance"][0].response.nodal_displacement
    # Both paths end to the same 1e-10 of the largest force.
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-8 * np.abs(exact).max())


def test_check_shows_friction_and_what_loads_do(call, study):
    status, out, _ = call("check", study.path)
    assert status == 0
    assert re.search(r"joint +0\.2 +800000", out)
    assert "increments of way.csv" in out
    assert "cycles of 1.5, 0.5 times the loads until they repeat" in out
    assert "None" not in out


def test_the_summary_tells_what_friction_does(finished):
    summary = json.loads((finished / "summary.json").read_text())
    assert summary["interfaces"]["joint"]["friction"] == 0.2
    assert summary["warnings"] == []
    for name, case in summary["load_cases"].items():
        assert 0 < case["max_traction"] <= 0.2 * case["reference"]["max_pressure"] * (1 + 1e-9)
        assert 0 <= case["stick_fraction"] + case["slip_fraction"] <= 1 + 1e-12
        assert case["slip_fraction"] > 0
        assert case["dissipated_energy"] > 0
        errors = case["methods"]["compliance"]["0"]
        # The residual compliance makes paths exact; 1e-10 is measured.
        assert errors["max_relative_error"] < 1e-8, name
        assert errors["max_traction_error"] < 1e-7, name
        assert errors["dissipation_error"] < 1e-7, name
        assert "certified_bound" not in errors
        if name != "shake":
            # Round-off in the square root of an energy, and of the largest force.
            assert errors["certified_increment_error"] < 1e-6
            assert errors["law_residual"] < 1e-8
    cases = summary["load_cases"]
    assert cases["pull"]["first_slip_factor"] == cases["pull"]["slip_reserve"]["first_slip"]
    assert cases["pull"]["slip_onset_factor"] == cases["pull"]["slip_reserve"]["onset"]
    assert cases["pull"]["slip_reserve"]["share"] == 0.5
    assert cases["way"]["first_slip_factor"] is None
    assert set(cases["shake"]["cycles"]) == {"0.5", "1.5"}
    large = cases["shake"]["cycles"]["1.5"]
    assert large["energy_per_cycle"] == cases["shake"]["dissipated_energy"]
    assert large["energy_per_cycle"] > cases["shake"]["cycles"]["0.5"]["energy_per_cycle"]
    assert large["stationary"]


def test_increments_are_those_of_a_path_in_python(study, results):
    model = build(study).with_bolt_forces({"bolt": results.bolts["bolt"].initial_force})
    tight = fy.solve_path(
        model,
        [fy.Load(bolt_forces={"bolt": float(f)}) for f in tightening(results)],
    )
    assert tight.bolt_force("bolt")[-1] == pytest.approx(5e3, rel=1e-9)
    load = case_load(study.load_cases[0])
    path = fy.solve_path(model, [load.scaled(f) for f in (0.25, 0.5, 0.75, 1.0)], initial=tight)
    record = results.cases["pull"].reference.path
    assert record.factors.ravel().tolist() == [0.25, 0.5, 0.75, 1.0]
    assert record.loads == ("factor",)
    for name in ("pressure", "traction", "slip", "dissipation"):
        mine, exact = getattr(record, name), getattr(path, name)
        # One path on one structure, its tightening found by other trials.
        np.testing.assert_allclose(mine, exact, rtol=0, atol=1e-7 * np.abs(exact).max())
    np.testing.assert_array_equal(results.cases["pull"].reference.pressure, record.pressure[-1])
    judged, bent = state_of_case(results.cases["pull"]), path.bolt_bending("bolt")
    np.testing.assert_allclose(judged.bolt_forces["bolt"], path.bolt_force("bolt"), rtol=1e-7)
    small = 1e-7 * np.abs(bent).max()
    np.testing.assert_allclose(judged.bolt_moments["bolt"], bent, rtol=0, atol=small)
    assert record.status.shape == record.pressure.shape
    assert set(np.unique(record.status)) <= {0, 1, 2}


def test_reduced_models_of_results_know_friction(study, results, finished, tmp_path):
    rom = results.reduced["compliance"][0]
    tight = fy.solve_path(
        rom, [fy.Load(bolt_forces={"bolt": float(f)}) for f in tightening(results)]
    )
    load = case_load(study.load_cases[0])
    path = fy.solve_path(rom, [load.scaled(f) for f in (0.25, 0.5, 0.75, 1.0)], initial=tight)
    record = results.cases["pull"].reference.path
    for name in ("pressure", "traction", "slip"):
        mine, exact = getattr(path, name), getattr(record, name)
        # The residual compliance is formed anew from what the file keeps.
        np.testing.assert_allclose(mine, exact, rtol=0, atol=1e-7 * np.abs(exact).max())
    with np.load(export(finished, "npz", out=tmp_path / "joint.npz")[0]) as joint:
        assert set(joint["mu"]) == {0.2}
        np.testing.assert_allclose(joint["ct"], 8e5, rtol=1e-12)
        weight = joint["w"].sum()
    assert weight == pytest.approx(results.interfaces["joint"].weights.sum())


def tightening(results):
    """Initial forces along the tightening: nine tenths in equal parts of the frictionless one."""
    smooth = build_smooth(results)
    last = results.bolts["bolt"].initial_force
    return [*(smooth * np.arange(1, 10) / 10), last]


def build_smooth(results):
    model = tiny_lap(penalty=1e6)
    return fy.tighten(model, {"bolt": 5e3}).initial_forces["bolt"]


@pytest.mark.long
def test_tractions_are_recovered_from_a_history(finished, tmp_path, monkeypatch, capsys):
    """From boundary loads, as in Python; in file, table and pictures."""
    out = tmp_path / "run"
    shutil.copytree(finished, out)
    history = tmp_path / "pull.csv"
    history.write_text("time,tip.Fx\n0,0\n4e-5,600\n2e-4,900\n")
    monkeypatch.setattr(
        sys, "argv", ["faying", "recover", str(out), str(history), "--step", "2e-5"]
    )
    monkeypatch.setenv("COLUMNS", "200")
    with pytest.raises(SystemExit, match="0"):
        cli.main()
    said = capsys.readouterr().out
    rom = read_results(out / "results.h5").reduced["compliance"][0]
    times = np.array([0.0, 4e-5, 2e-4])
    exact = fy.recover_from_boundary_loads(
        rom, times, {"tip.Fx": np.array([0.0, 600.0, 900.0])}, step=2e-5
    )
    size = np.linalg.norm(exact.traction, axis=-1)
    assert size.max() > 0
    with h5py.File(out / "recovered_pull.h5") as file:
        np.testing.assert_array_equal(file["traction"][()], exact.traction)
        np.testing.assert_array_equal(file["slip"][()], exact.slip)
    assert "largest traction [MPa]" in said
    assert f"{size.max():.5g}" in said
    assert "largest traction over time [MPa]" in (out / "recovered_pull_joint.vtu").read_text()


def test_a_path_follows_its_file(results):
    record = results.cases["way"].reference.path
    assert record.loads == ("tip.Fx", "tip.Fz", "bolt")
    assert record.factors.tolist() == [[0.5, 0, 1], [1, 1, 1], [1, 1, 0.7], [-0.5, 0, 1]]
    bolt = record.bolt_forces["bolt"]
    assert bolt[2] < 0.8 * bolt[1]  # loosened
    assert record.displacements["tip"][3, 0] < 0 < record.displacements["tip"][2, 0]


def test_cycles_keep_their_last_loop_and_fretting(results):
    shake = results.cases["shake"].reference
    large = shake.cycles["1.5"]
    factors = large.increments.factors[:, 0]
    assert (factors[3], factors[7], factors[-1]) == (0.0, -1.5, 1.5)
    assert large.increments.dissipation.sum() == pytest.approx(large.energies[-1], rel=1e-12)
    np.testing.assert_array_equal(shake.pressure, large.increments.pressure[-1])
    slipping = large.slip_range > 1e-9 * large.slip_range.max()
    assert (large.fretting[slipping] > 0).all()


@pytest.mark.long
def test_a_run_that_was_stopped_ends_with_the_same_numbers(study, finished, tmp_path, monkeypatch):
    """Within the cycles of the full model: their smaller amplitude is there, the larger is not."""
    from faying.study.stages import path_cases

    calls, cycled, reserved = [], [], []
    follow, cycle = path_cases.follow_path, path_cases.solve_cycles

    def followed(run, loads):
        calls.append(run.case.name)
        return follow(run, loads)

    def interrupted(system, load, amplitude, *more, **options):
        cycled.append(amplitude)
        if len(cycled) == 2:
            raise KeyboardInterrupt
        return cycle(system, load, amplitude, *more, **options)

    def reserve(system, load, *more, **options):
        reserved.append(load.name)
        return whole(system, load, *more, **options)

    whole = path_cases.slip_reserve
    monkeypatch.setattr(path_cases, "slip_reserve", reserve)
    monkeypatch.setattr(path_cases, "follow_path", followed)
    monkeypatch.setattr(path_cases, "solve_cycles", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(study, tmp_path)
    run(study, tmp_path, resume=True)
    # The larger amplitude again, and both by the reduced model; no path of loads but once a model.
    assert cycled == [0.5, 1.5, 1.5, 0.5, 1.5]
    assert calls == ["pull", "pull", "way", "way"]
    assert reserved == ["pull", "shake"]
    mine, other = (read_results(out / "results.h5") for out in (tmp_path, finished))
    for name, case in mine.cases.items():
        exact = other.cases[name].reference
        np.testing.assert_array_equal(case.reference.pressure, exact.pressure)
        if case.reserve is not None:
            assert asdict(case.reserve) == asdict(other.cases[name].reserve)
        for amplitude, one in case.reference.cycles.items():
            same = flattened(exact.cycles[amplitude])
            for member, value in flattened(one).items():
                np.testing.assert_array_equal(value, same[member], member)
        if exact.path is not None:
            np.testing.assert_array_equal(case.reference.path.slip, exact.path.slip)
            assert case.reference.path.bolt_forces.keys() == exact.path.bolt_forces.keys()


def test_the_joint_is_judged_over_all_increments(results):
    """A bolt that is loosened and tightened again along a path was loose."""
    way, bolt = results.cases["way"].reference.path, results.assessment.bolts["bolt"]
    assert bolt.least == way.bolt_forces["bolt"].min() < 0.8 * bolt.preload
    assert bolt.least_case == "way"
    # What the bolt loses where it is loosened is not due to the loads.
    assert set(bolt.axial_loads) == {"pull", "shake"}
    joint = results.assessment.interfaces["joint"]
    weights = results.interfaces["joint"].weights
    # Sums of a hundred numbers in another order.
    assert joint.least_clamp == pytest.approx((way.pressure @ weights).min(), rel=1e-12)
    assert joint.least_clamp_case == "way"
    tables = {part.title: part.tables for part in questions(results, Album(results))}
    told = cells(tables["Load cases"][0])["way"]
    assert told["largest bolt force [N]"] == number(way.bolt_forces["bolt"].max(), 5)
    assert told["least clamp force of joint [N]"] == number(joint.least_clamp, 5)
    assert told["largest pressure [MPa]"] == number(way.pressure.max(), 4)


@pytest.mark.long
def test_the_report_says_first_what_slips(results, tmp_path):
    page = write_report(results, tmp_path).read_text(encoding="utf-8")
    slips = re.search(r"<p>(The joint slips: up to [^.]*\.)", page)[1]
    assert page.index('id="slip"') < page.index(slips) < page.index('id="pressure"')
    assert page.count("The joint slips: ") == 1
    assert "macroslip" in slips
    names = {path.stem for path in (tmp_path / "figures").iterdir()}
    assert {"case_way_path", "case_shake_loops", "case_shake_fretting"} <= names
    assert "case_shake_path" not in names
    (drawn,) = (name for name in names if name.endswith("_slip"))  # where most slips
    assert drawn.removeprefix("case_").removesuffix("_slip") in slips
    rows = cells(friction_table(results))
    assert set(rows) == {"pull", "way", "shake"}
    reserve = results.cases["pull"].reserve
    assert reserve.first_slip < 1e-3  # tightening left points on their bound
    assert rows["pull"][FIRST] == "< 0.001"
    assert rows["pull"]["where"].startswith("joint (")
    assert rows["pull"]["slip begins at [× load]"] == number(reserve.onset, 4)
    assert rows["way"][FIRST] == "—"
    assert rows["shake"]["dissipated energy [N·mm]"] == "—"  # damping tells it, of a cycle
    assert page.index('id="damping"') < page.index("energy per cycle [N·mm]")


def test_slip_that_slides_nothing_is_told_from_sliding(results):
    case = results.cases["pull"]
    path = case.reference.path
    all_slip = replace(path, macroslip=np.ones_like(path.macroslip))

    def said(**reserve):
        one = replace(
            case,
            reference=replace(case.reference, path=all_slip),
            reserve=replace(case.reserve, **reserve),
        )
        only = replace(results, cases={"pull": one})
        return slip_sentence(only), cells(friction_table(only))["pull"]

    sentence, _ = said(gross_slip=0.8)
    assert sentence.endswith("(macroslip) in pull.")
    sentence, row = said(gross_slip=None, first_slip=1e-7)
    assert sentence.endswith(
        "in pull, in directions that cancel, so that nothing slides as a whole."
    )
    assert row[FIRST] == "< 0.001"
    assert row["slides as a whole at [× load]"].startswith("> ")


def test_reports_without_slip_say_nothing_of_it(results):
    sliding = {name: replace(one, friction=0.0) for name, one in results.interfaces.items()}
    smooth = replace(results, interfaces=sliding)
    assert slip_sentence(smooth) == ""
    assert not friction_table(smooth).rows
    case = results.cases["pull"]
    path = case.reference.path
    zero = np.zeros_like(path.slip_share)
    held = replace(path, slip_share=zero, macroslip=zero > 0)
    still = replace(case, reference=replace(case.reference, path=held))
    assert slip_sentence(replace(results, cases={"pull": still})) == (
        "Nothing slips in these load cases."
    )


def test_slip_states_are_drawn_where_they_are(results):
    record, path = results.interfaces["joint"], results.cases["pull"].reference.path
    figure = new_figure(6.0, 4.0)
    axes, units = figure.subplots(), units_of("mm-t-s")
    draw_states(record, path.status[-1], axes, units, SLIP_STATES)
    (image,) = axes.get_images()
    shown = set(np.unique(np.asarray(image.get_array())).tolist())
    assert shown == set(np.unique(path.status[-1]).astype(float).tolist())
    assert slipping(record, path.status[-1]) == pytest.approx(
        path.slip_share[-1] / (path.slip_share[-1] + path.stick_share[-1])
    )


@pytest.mark.long
def test_friction_after_tightening_begins_without_traction(tmp_path):
    text = "friction_during_preload = false\n" + STUDY.split("[[load_case]]")[0]
    case = "[[load_case]]".join(["", STUDY.split("[[load_case]]")[1]])
    study = read_study(write(tmp_path, text + case + "\n[output]\nreport = false"))
    run(study, tmp_path / "out")
    found = read_results(tmp_path / "out" / "results.h5")
    force = found.bolts["bolt"].initial_force
    assert force == pytest.approx(build_smooth(found), rel=1e-9)
    model = build(study).with_bolt_forces({"bolt": force})
    load = case_load(study.load_cases[0])
    loads = [load.scaled(f) for f in (0.25, 0.5, 0.75, 1.0)]
    path = fy.solve_path(model, loads, initial=released_state(model))
    traction = found.cases["pull"].reference.path.traction
    np.testing.assert_allclose(traction, path.traction, rtol=0, atol=1e-9 * np.abs(traction).max())
    np.testing.assert_allclose(
        rest_state(model, ()).pressure, found.interfaces["joint"].preload_pressure, rtol=1e-9
    )


@pytest.mark.parametrize("given", ["penalty", "friction"])
def test_hard_friction_at_more_points_than_pairs_is_refused(given):
    """Before anything is computed, whichever comes last; alone each is as good as any."""
    model = tiny_lap(penalty=1e5)
    model = model.with_friction(0.2) if given == "penalty" else model.with_penalty(np.inf)
    message = r"interface 'joint': .* hard, with friction, at 32 points .* 15 node pairs; .*'nodal'"
    with pytest.raises(ModelError, match=message):
        _ = model.with_penalty(np.inf) if given == "penalty" else model.with_friction(0.2)


def test_interfaces_may_have_laws_of_their_own(tmp_path):
    text = """
[model]
source = "lap-joint"
lap_joint = { element_size = 10.0, plates = 3, hole_radius = 0.0, washer_radius = 11.0 }
[[interface]]
name = "joint-1"
penalty = 1e6
friction = 0.2
tangential_penalty = 5e5
[[interface]]
name = "joint-2"
penalty = "hard"
friction = 0.1
[[bolt]]
name = "bolt"
preload = 1e3
"""
    model = build(parse_study(text, tmp_path / "s.toml"))
    first, second = (model.interfaces[name].law for name in ("joint-1", "joint-2"))
    assert first == Coulomb(Penalty(1e6), 0.2, 5e5)
    assert second == Coulomb(Hard(), 0.1, float("inf"))
    softer = model.with_penalty(1e5)  # keeps the friction
    assert softer.interfaces["joint-2"].law == replace(second, normal=Penalty(1e5))
    first, second = model.contact.slices.values()
    friction = np.zeros(model.contact.n_points)
    friction[model.contact.rubbing] = model.contact.friction
    assert set(friction[first]) == {0.2}
    assert set(friction[second]) == {0.1}


def test_interfaces_take_tangential_penalties_of_their_own():
    joint = tiny_lap(plates=3)
    model = joint.with_friction({"joint-1": 0.2, "joint-2": 0.1}, {"joint-1": 5e5})
    first, second = (model.interfaces[name].law for name in ("joint-1", "joint-2"))
    assert (first.friction, first.tangential_penalty) == (0.2, 5e5)
    other = joint.with_friction({"joint-2": 0.1})
    assert second == other.interfaces["joint-2"].law
    # What is not named stays.
    assert other.interfaces["joint-1"].law.friction == 0
    again = joint.with_friction(0.1).with_friction({"joint-1": 0.2}, {"joint-1": 5e5})
    assert [face.law for face in again.interfaces.values()] == [first, second]
    with pytest.raises(ModelError, match="'joint-1' has a tangential penalty and no coefficient"):
        joint.with_friction({"joint-2": 0.1}, tangential_penalty={"joint-1": 5e5})
    with pytest.raises(ModelError, match="there is no interface 'joint'"):
        joint.with_friction(0.1, tangential_penalty={"joint": 5e5})


def test_specs_and_models_take_the_same_friction():
    smooth = tiny_lap()
    spec = fy.InterfaceSpec(name="joint", friction=0.2)
    built = fy.build_model(smooth.assembly, interfaces=[spec])
    assert built.interfaces["joint"].law == smooth.with_friction(0.2).interfaces["joint"].law
    assert smooth.with_friction(0.2).with_friction(0.0).interfaces["joint"].law.components == 1
    for change, match in (
        ({"friction": -0.1}, r"interface 'joint': the coefficient of friction is -0\.1"),
        ({"friction": "rough"}, "coefficient of friction is 'rough'; give a number"),
        ({"friction": None}, "coefficient of friction is None; give a number"),
        ({"friction": 0.2, "tangential_penalty": None}, "tangential penalty is None; give a pos"),
        ({"friction": 20.0}, "coefficient of friction is 20; give a number from 0 to 10"),
        ({"friction": 0.2, "tangential_penalty": 0.0}, "tangential penalty is 0; give a positive"),
        ({"friction": 0.2, "tangential_penalty": "stiff"}, "tangential penalty is 'stiff'; give"),
    ):
        with pytest.raises(ModelError, match=match):
            fy.build_model(smooth.assembly, interfaces=[replace(spec, **change)])


def test_a_joint_that_nothing_but_friction_holds_is_refused_with_the_direction():
    smooth = tiny_lap()
    loose = replace(smooth.assembly, beams=(), rigid_couplings=smooth.assembly.rigid_couplings[:1])
    spec = fy.InterfaceSpec(name="joint", friction=0.5)
    model = fy.build_model(loose, interfaces=[spec])
    with pytest.raises(ModelError, match=r"unconstrained body: .* is held by nothing"):
        fy.solve_path(model, [fy.Load()])


MISTAKES = [
    ("friction = 0.2", "friction = -0.2", "found -0.2, expected 0 or more"),
    ("friction = 0.2", "friction = 30.0", "found 30.0, expected 10 or less"),
    ("8e5", "0.0", "found 0.0, expected a positive number or 'auto'"),
    ("friction = 0.2\n", "", "'tangential_penalty' .* the interface has no friction"),
    ("[reduction]", "[sticking]\nstiffness = 1e6\n[reduction]", "determines what sticks"),
    ('["compliance"]', '["jim-b"]', "method 'jim-b' is trained on|needs training loads"),
    ('kind = "path"\nfactors = "way.csv"', 'kind = "path"', "needs 'factors', a csv"),
    (
        'kind = "path"',
        'kind = "path"\nincrements = 3',
        'only kind = "static" or "cycle" or "backbone" has it',
    ),
    ("amplitudes = [1.5, 0.5]", "amplitudes = [1.5, 1.5]", "an amplitude occurs twice"),
    ("amplitudes = [1.5, 0.5]", "amplitudes = [-1.0]", "found -1.0, expected greater than 0"),
    ("increments = 4\nforces", "increments = 4\nstep = 1e-5\nforces", 'kind = "static" has no'),
    (
        "[output]",
        "[validation]\npenalty_sweep = true\n[output]",
        "sweep over the contact .* was removed",
    ),
    ("[output]", "[validation]\nbox = []\n[output]", "the search for the worst loads was removed"),
    ("friction = 0.2\ntangential_penalty = 8e5\n", "", "so one solution is enough; remove it"),
]


@pytest.mark.parametrize(("old", "new", "match"), MISTAKES)
def test_mistakes_are_said_with_their_place(tmp_path, old, new, match):
    assert old in STUDY
    path = write(tmp_path, STUDY.replace(old, new, 1))
    with pytest.raises(StudyError, match=match) as raised:
        build(read_study(path))
    assert re.search(r"slip\.toml \(line \d+\)", str(raised.value))


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "is empty"),
        ("0.5,1\n1,1\n", "line 1: found numbers, expected the names of the columns"),
        ("tip.Fx,tip.Fz\n1,\n", r"line 2: found '' in column 'tip\.Fz'"),
        ("tip.Fx,tip.Fz\n1,1\n1\n", "line 3: found 1 cells, expected 2"),
        ("tip.Fx,tip.Fz\nnan,1\n", r"line 2: found 'nan' in column 'tip\.Fx'"),
        ("tip.Fx,tip.Fz\none,1\n", r"found 'one' in column 'tip\.Fx'"),
        ("tip.Fx,tip.Fx,tip.Fz\n1,1,1\n", r"column 'tip\.Fx' occurs twice"),
        ("tip.Fx\n1\n", r"no column for 'tip\.Fz'; add it, or call the only column 'factor'"),
        ("tip.Fx,factor\n1,1\n", r"found 'factor' and 'tip\.Fx'; give one factor for all"),
        ("tip.Fx,,tip.Fz\n1,1,1\n", "a column has no name"),
        ("tip.Fx;tip.Fz\n1;1\n", "columns are separated by semicolons; separate them by commas"),
        ("tip.Fx,tip.Fz\n", "found 0 increments, expected 1 to"),
        ("tip.Fx\n1,2\nnan\n", r"(?s)line 2: found 2 cells.*line 3: .*'nan'"),
    ],
)
def test_path_files_with_mistakes_are_refused_at_once(tmp_path, text, match):
    path = write(tmp_path, way=text)
    with pytest.raises(StudyError, match=match) as raised:
        read_study(path)
    assert "way.csv" in str(raised.value)
    assert "'factors' in [[load_case]] number 2" in str(raised.value)


@pytest.mark.parametrize("factor", ["-1", "10000"])
def test_a_path_turns_no_bolt_into_a_press_or_a_crane(tmp_path, factor):
    study = read_study(write(tmp_path, way=WAY.replace("0.7", factor)))
    with pytest.raises(StudyError, match=rf"column 'bolt' has {factor}, expected a factor from 0"):
        build(study)


@pytest.mark.long
def test_motions_start_from_what_tightening_left(tmp_path):
    text = (
        "friction_during_preload = false\n"
        + STUDY.split("[[load_case]]")[0]
        + """
[[load_case]]
name = "jump"
kind = "step"
forces = [{ boundary = "tip", component = "Fx", value = 600.0 }]
step = 2e-5
duration = 2e-4
[validation]
half_step = true
[output]
report = false
"""
    )
    study = read_study(write(tmp_path, text))
    assert run(study, tmp_path / "out")["converged"]
    found = read_results(tmp_path / "out" / "results.h5")
    assert found.omissions == ()
    model = build(study).with_bolt_forces({"bolt": found.bolts["bolt"].initial_force})
    load, times = case_load(study.load_cases[0]), {"step": 2e-5, "duration": 2e-4}
    motion = fy.solve_transient(model, load, initial=last_of(released_state(model)), **times)
    jump, top = found.cases["jump"], motion.pressure.max()
    # The same steps from the same state.
    np.testing.assert_allclose(jump.reference.pressure, motion.pressure, rtol=0, atol=1e-9 * top)
    reduced = jump.methods["compliance"][0].response.pressure
    # The residual compliance makes the state at rest exact.
    np.testing.assert_allclose(reduced[0], motion.pressure[0], rtol=0, atol=1e-8 * top)
    # Tightened with friction it rests on tractions, and moves otherwise.
    other = fy.solve_transient(model, load, **times)
    assert np.abs(other.pressure - motion.pressure).max() > 1e-5 * top  # 8e-5 is measured
    _check_what_friction_does(found, motion, tmp_path / "out")


def _check_what_friction_does(found, motion, out):
    """Compare what a run keeps of friction in a motion with the motion, and look for it."""
    record = found.cases["jump"].reference.friction
    for name in ("traction", "slip", "dissipation"):
        mine, exact = getattr(record, name), getattr(motion, name)
        # The same steps from the same state.
        np.testing.assert_allclose(mine, exact, rtol=0, atol=1e-9 * np.abs(exact).max())
    assert record.status.shape == motion.pressure.shape
    np.testing.assert_array_equal(record.status == 0, motion.pressure <= 0)
    # Nothing has slipped in the first instant; who slips has a traction on the bound after that.
    assert record.slip_share[0] == 0
    assert record.slip_share.max() > 0
    slips = record.status == 2
    size = np.linalg.norm(motion.traction, axis=-1)
    np.testing.assert_allclose(size[slips], 0.2 * motion.pressure[slips], rtol=2e-6)
    summary = json.loads((out / "summary.json").read_text())["load_cases"]["jump"]
    assert summary["max_traction"] == pytest.approx(size.max(), rel=1e-9)
    assert summary["dissipated_energy"] == pytest.approx(motion.dissipation.sum(), rel=1e-9)
    assert summary["slip_fraction"] == record.slip_share.max()
    errors = summary["methods"]["compliance"]["0"]
    mine = found.cases["jump"].methods["compliance"][0].response.friction
    apart = np.linalg.norm(mine.traction - motion.traction, axis=-1).max()
    assert errors["max_traction_error"] == pytest.approx(apart / size.max(), rel=1e-9)
    energy = motion.dissipation.sum()
    apart = abs(mine.dissipation.sum() - energy)
    assert errors["dissipation_error"] == pytest.approx(apart / energy, rel=1e-6)
    assert 0 < summary["half_step"]["max_traction_change"] < 1
    assert 0 < summary["half_step"]["dissipation_change"] < 1
    page = write_report(found, out).read_text(encoding="utf-8")
    assert "<p>The joint slips: up to " in page
    assert {"case_jump_slip", "case_jump_friction"} <= {p.stem for p in out.glob("figures/*.png")}
    (row,) = friction_table(found).rows
    assert row[0].text == "jump"
    with h5py.File(out / "results.h5", "a") as file:
        group = file["cases/jump/reference/friction"]
        short = {name: group[name][:-1] for name in group}
        for name, values in short.items():
            del group[name]
            group[name] = values
    with pytest.raises(FormatError, match="/cases/jump/reference/friction/traction' has shape"):
        read_results(out / "results.h5")


@pytest.mark.long
@pytest.mark.parametrize(
    ("friction", "quantity", "said"),
    [("", "opening", "1 needed"), ("friction = 0.3", "open area", "70.00 of 50 % of what")],
)
def test_a_joint_that_opens_is_told_so_with_friction_too(tmp_path, friction, quantity, said):
    """Half of what the preload presses, unless it is said; the joint was told to hold."""
    text = tiny_joint(friction) + reduction("compliance") + static("bend", "Fz", -1600.0)
    (tmp_path / "study.toml").write_text(text + NO_REPORT, encoding="utf-8")
    verdict = run(read_study(tmp_path / "study.toml"), tmp_path / "out")["verdict"]
    assert not verdict["holds"]
    assert f"joint, {quantity} " in verdict["sentence"]
    assert said in verdict["sentence"]
    text = text.replace("[[load_case]]", "[requirement]\nopen_below = 0.2\n[[load_case]]")
    (tmp_path / "study.toml").write_text(text + NO_REPORT, encoding="utf-8")
    assert run(read_study(tmp_path / "study.toml"), tmp_path / "less")["verdict"]["holds"]


def test_columns_that_are_nothing_are_refused(tmp_path):
    path = write(tmp_path, way="factor,bold\n1,1\n")
    with pytest.raises(StudyError, match=r"way\.csv: column 'bold' .* did you mean 'bolt'\?"):
        build(read_study(path))


def test_one_column_multiplies_all_loads(tmp_path):
    (tmp_path / "one.csv").write_text("# a comment\nfactor\n0.5\n")
    found = read_load_factors(tmp_path / "one.csv", ["tip.Fx", "tip.Fz"])
    assert found.names == ("factor",)
    assert found.values.tolist() == [[0.5]]
