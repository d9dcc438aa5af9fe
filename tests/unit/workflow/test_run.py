"""A whole run on a tiny joint: what it leaves behind, and how it resumes."""

import json
import sys
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from faying.exceptions import ConvergenceError, StudyError
from faying.execution.checkpoint import open_checkpoint
from faying.export import vtk
from faying.joint import structure
from faying.simulation.solution_parts import arrays_of
from faying.simulation.transient import solve_transient
from faying.sources import lap_joint
from faying.study.inputs.loads import case_load
from faying.study.keys.schema import read_study
from faying.study.results.store import read_results
from faying.study.stages import (
    books,
    case_solution,
    cases,
    full_transients,
    offline,
    record,
    validation,
    worker_tasks,
)
from faying.study.stages.books import Books
from faying.study.stages.offline import check_same_joint
from faying.workflow import run as runs
from faying.workflow.run import run
from small_study import BEND, JUMP, NO_REPORT, SMALL_JOINT, TINY_JOINT, reduction, training

METHODS = '"craig-bampton", "jim-a", "jim-b", "compliance", "nmf"'
STUDY = (
    'title = "Tiny joint"\n'
    + SMALL_JOINT
    + "[sticking]\nstiffness = 1e6\n\n"
    + reduction("craig-bampton", "jim-a", "jim-b", "compliance", "nmf", joint_modes=[2, 4])
    + training(levels=3)
    + BEND
    + JUMP
    + NO_REPORT
)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "tiny.toml"
    path.write_text(STUDY)
    return read_study(path)


@pytest.fixture(scope="module")
def finished(study, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("finished")
    assert run(study, out)["converged"]
    return out


def test_a_run_leaves_results_summary_study_and_pressures_for_viewing(finished):
    names = {path.name for path in finished.iterdir()}
    assert names == {"results.h5", "summary.json", "study.toml", "interface_joint.vtu"}
    assert (finished / "study.toml").read_text() == STUDY


def test_the_summary_has_the_keys_that_scripts_rely_on(finished):
    summary = json.loads((finished / "summary.json").read_text())
    counts = {"nodes", "elements", "dofs", "mass"}
    assert set(summary["model"]) == counts | {"factorization", "factor_bytes"}
    assert {"pairs", "points", "area", "penalty"} <= set(summary["interfaces"]["joint"])
    assert summary["bolts"]["bolt"]["preload"] == 5e3
    bend, jump = summary["load_cases"]["bend"], summary["load_cases"]["jump"]
    assert bend["kind"] == "static"
    assert {
        "max_pressure",
        "contact_force",
        "open_fraction",
        "max_penetration",
        "iterations",
    } <= set(bend["reference"])
    opening = bend["reference"]["opening"]["joint"]
    mesh_error = summary["load_cases"]["jump"]["reference"]["mesh_error"]["joint"]
    assert 0 < mesh_error["field"] < mesh_error["largest"] < 1
    assert set(opening) == {"opened_fraction", "closed_fraction", "max_gap", "max_gap_point"}
    # The joint is pressed around the bolt alone, so most of its area is open without any load.
    assert opening["opened_fraction"] < bend["reference"]["open_fraction"]
    assert opening["max_gap"] > 0
    assert 0 < summary["interfaces"]["joint"]["preload_open_fraction"] < 1
    assert set(bend["methods"]["jim-a"]) == {"2", "4"}
    assert set(bend["methods"]["compliance"]) == {"0"}
    assert {
        "max_relative_error",
        "rms_relative_error",
        "p999_relative_error",
        "max_pressure_ratio",
        "displacement_error",
    } <= set(jump["methods"]["jim-b"]["4"])
    assert "recovered_max_relative_error" in jump["methods"]["craig-bampton"]["0"]
    assert {"assembly", "factorization", "compliance", "normal_modes"} <= set(
        summary["timings"]["stages"]
    )
    assert {"offline", "per_static_case", "per_step"} == set(
        summary["timings"]["methods"]["compliance"]
    )
    # Methods that only know statics are absent from transients.
    assert summary["timings"]["methods"]["nmf"].keys() == {"offline", "per_static_case"}


@pytest.mark.long
def test_every_second_of_a_run_is_in_a_stage(study, tmp_path, monkeypatch):
    """By a clock of calls and returns, which are as many however busy the machine is."""
    calls = count()
    monkeypatch.setattr(books, "clock", lambda: float(next(calls)))
    sys.setprofile(lambda *_: next(calls))
    try:
        timings = run(study, tmp_path)["timings"]
    finally:
        sys.setprofile(None)
    taken = next(calls)
    assert sum(timings["stages"].values()) == pytest.approx(timings["run"], rel=1e-12)
    assert timings["run"] == pytest.approx(taken, rel=0.02)
    assert 0 <= timings["stages"]["other"] < 0.02 * taken


WORK = (
    (offline, "solve_static"),
    (offline, "certifier"),
    (cases, "accuracy"),
    (cases, "flattened"),
    (record, "contact_surfaces"),
    (runs, "write_results"),
    (vtk, "write_interface_vtu"),
)
"""What runs once did outside all stages; a certificate of many points took longer than the rest."""


@pytest.mark.long
def test_work_that_may_take_long_is_in_a_stage(study, tmp_path, monkeypatch):
    now = [0.0]

    def slow(function):
        def slowed(*arguments, **options):
            now[0] += 1.0
            return function(*arguments, **options)

        return slowed

    for module, name in WORK:
        monkeypatch.setattr(module, name, slow(getattr(module, name)))
    monkeypatch.setattr(books, "clock", lambda: now[0])
    timings = run(study, tmp_path)["timings"]
    assert timings["run"] == now[0] >= len(WORK)
    assert timings["stages"]["other"] == 0


def test_a_certified_bound_is_never_below_the_error(finished):
    methods = json.loads((finished / "summary.json").read_text())["load_cases"]["bend"]["methods"]
    figures = [entry for sizes in methods.values() for entry in sizes.values()]
    assert len(figures) == 8
    for entry in figures:
        # 1e-9: round-off of bound and error where both vanish.
        assert entry["certified_bound"] >= entry["max_relative_error"] - 1e-9
        assert entry["certified_energy_error"] >= 0
        assert entry["certified_force_error"] >= 0


def test_results_hold_what_the_run_validated(finished):
    validation = read_results(finished / "results.h5").validation
    assert validation.load_space.methods["compliance"][0].worst_error < 1e-8


@pytest.mark.long
def test_the_time_step_check_compares_fields_of_the_full_model(study, finished):
    results = read_results(finished / "results.h5")
    jump = results.cases["jump"]
    joint = offline.prepare_joint(study)
    load = next(case_load(case) for case in study.load_cases if case.name == "jump")
    coarse, fine = (
        solve_transient(joint.model, load, step=step, duration=jump.times[-1])
        for step in (jump.times[1], jump.half_step_times[1])
    )
    assert jump.half_step_times[1] == pytest.approx(jump.times[1] / 2, rel=1e-12)
    # Round-off of other starting points of the contact problems.
    np.testing.assert_allclose(jump.half_step.pressure, fine.pressure, atol=1e-8)
    moved = np.abs(fine.pressure[::2] - coarse.pressure).max() / coarse.pressure.max()
    said = json.loads((finished / "summary.json").read_text())["load_cases"]["jump"]
    assert said["half_step"]["max_relative_change"] == pytest.approx(moved, rel=1e-6)
    assert said["half_step_max_pressure"] == pytest.approx(fine.pressure.max(), rel=1e-9)
    assert said["step_check"] == "half step"


@pytest.mark.long
def test_a_study_may_leave_the_time_step_unchecked(tmp_path):
    path = tmp_path / "tiny.toml"
    path.write_text(
        STUDY.replace(
            "[[load_case]]", "[validation]\nhalf_step = false\n\n[[load_case]]", 1
        ).replace(METHODS, '"compliance"')
    )
    assert run(read_study(path), tmp_path / "out")["converged"]
    jump = read_results(tmp_path / "out" / "results.h5").cases["jump"]
    assert jump.half_step is None
    assert jump.half_step_times is None
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["load_cases"]["jump"]["step_check"] is None


@pytest.mark.long
def test_a_time_step_check_that_fails_costs_no_result(study, tmp_path, monkeypatch):
    original = cases.full_transients

    def fragile(joint, runs, progress=None):
        if runs[0].refinement == 2:
            message = "did not settle"
            raise ConvergenceError(message)
        return original(joint, runs, progress)

    monkeypatch.setattr(cases, "full_transients", fragile)
    outcome = run(study, tmp_path)
    assert outcome["converged"]
    assert outcome["warnings"] == ["jump, half the time step: did not settle"]
    assert outcome["load_cases"]["jump"]["methods"]["compliance"]["0"]


@pytest.mark.long
def test_validation_that_fails_is_named_and_costs_no_result(study, tmp_path, monkeypatch):
    def broken(*_, **__):
        message = "nobody foresaw this"
        raise ValueError(message)

    for module, name in (
        (validation, "solve_static_cases"),
        (offline, "certifier"),
        (case_solution, "recover_pressure"),
        (case_solution, "finer_model"),
        (cases, "mesh_errors"),
        (runs, "kept_models"),
    ):
        monkeypatch.setattr(module, name, broken)
    outcome = run(study, tmp_path)
    assert outcome["converged"]
    results = read_results(tmp_path / "results.h5")
    assert outcome["warnings"] == list(results.omissions)
    said = "\n".join(results.omissions)
    for extra in (
        "unseen loads: ValueError: nobody foresaw this",
        "certified bounds: ",
        "jump, compliance/0, recovered pressures: ",
        "jump, compliance/0, estimated error: ",
        "bend, mesh error: ",
        "matrices for recovery and export: ",
    ):
        assert extra in said
    assert results.reduced == {}
    assert results.validation.load_space is None
    found = results.cases["jump"].methods["compliance"][0]
    assert found.accuracy.max_relative_error < 0.5  # it is solved and compared, as without failures
    assert found.recovered_error is None
    assert results.cases["bend"].methods["jim-a"][4].certified_bound is None
    assert results.cases["bend"].mesh_errors == {}


@pytest.mark.long
def test_a_solution_without_contact_is_kept_though_nothing_compares_with_it(
    study, tmp_path, monkeypatch
):
    original = cases.respond

    def open_(solution, model, seconds, **more):
        response = original(solution, model, seconds, **more)
        return (
            replace(response, pressure=0 * response.pressure)
            if solution.times is None and solution.system is model
            else response
        )

    monkeypatch.setattr(cases, "respond", open_)
    outcome = run(study, tmp_path)
    assert "bend, compliance with 0 joint modes, comparison: the reference" in "\n".join(
        outcome["warnings"]
    )
    assert outcome["load_cases"]["bend"]["reference"]["max_pressure"] == 0.0
    assert outcome["load_cases"]["jump"]["methods"]["compliance"]["0"]


def test_workers_leave_a_piece_without_solution_to_the_run(study, tmp_path, monkeypatch):
    fail = _raise(ConvergenceError("did not settle"))
    monkeypatch.setattr(worker_tasks, "run_grouped_campaign", fail)
    checkpoint = open_checkpoint(tmp_path, study.text, resume=False)
    worker_tasks.compute_pieces(study, None, Books(checkpoint=checkpoint))


@pytest.mark.long
def test_hard_contact_of_quadratic_elements_runs_to_the_end(tmp_path):
    text = STUDY.replace("element_size = 5.0", 'element_size = 5.0, shape = "tet10"').replace(
        "[[bolt]]", '[[interface]]\nname = "joint"\npenalty = "hard"\n\n[[bolt]]', 1
    )
    text = text[: text.index("[reduction.training]")] + text[text.index("[[load_case]]") :]
    text = text[: text.index('[[load_case]]\nname = "jump"')] + "[output]\nreport = false\n"
    text = text.replace(METHODS, '"compliance"')
    path = tmp_path / "hard.toml"
    path.write_text(text)
    outcome = run(read_study(path), tmp_path / "out")
    assert outcome["converged"]
    assert outcome["warnings"] == []


@pytest.mark.long
def test_an_interrupted_run_resumes_without_solving_again(study, tmp_path, monkeypatch):
    solved = []
    original, together = case_solution.steps_of, full_transients.transient_windows

    def full(solver, loads, **options):
        solved.extend(load.name for load in loads)
        return together(solver, loads, **options)

    monkeypatch.setattr(full_transients, "transient_windows", full)

    def counted(system, case, step, *, most=None):
        if len(solved) == most:
            raise KeyboardInterrupt
        solved.append(case.name)
        return original(system, case, step)

    monkeypatch.setattr(case_solution, "steps_of", partial(counted, most=2))
    with pytest.raises(KeyboardInterrupt):
        run(study, tmp_path)
    assert not (tmp_path / "results.h5").exists()
    monkeypatch.setattr(case_solution, "steps_of", counted)
    assert run(study, tmp_path, resume=True)["converged"]
    # Full, craig-bampton, 2 × jim-a, 2 × jim-b, compliance and the half step, each once.
    assert len(solved) == 8
    assert not (tmp_path / "unfinished").exists()


def opened(folder, *, resume=False):
    return Books(checkpoint=open_checkpoint(folder, "", resume=resume))


@pytest.mark.parametrize(
    "more", ["[sticking]\nstiffness = 1e6", '[[interface]]\nname = "joint"\nfriction = 0.3']
)
def test_a_resumed_run_does_not_tighten_again(tmp_path, monkeypatch, more):
    path = tmp_path / "plain.toml"
    path.write_text(TINY_JOINT + more)
    study = read_study(path)
    before = offline.prepare_joint(study, opened(tmp_path))
    for name in ("tighten", "tightened_joint", "solve_static", "rest_state"):
        monkeypatch.setattr(offline, name, _raise(AssertionError(name)))
    monkeypatch.setattr(structure, "solved_gram", _raise(AssertionError("compliance")))
    after = offline.prepare_joint(study, opened(tmp_path, resume=True))
    for one, other in ((before.preload, after.preload), (before.rest, after.rest)):
        assert one.name == other.name
        for name, values in arrays_of(one).items():
            np.testing.assert_array_equal(getattr(other, name), values)
    assert {name: bolt.initial_force for name, bolt in after.model.bolts.items()} == {
        name: bolt.initial_force for name, bolt in before.model.bolts.items()
    }
    assert after.tightening.stages == before.tightening.stages
    np.testing.assert_array_equal(after.tightening.bolt_forces, before.tightening.bolt_forces)
    paths = [[load.bolt_forces for load in one.preload_path] for one in (before, after)]
    assert paths[0] == paths[1]


def test_resuming_with_another_deck_is_refused(tmp_path):
    """What was computed of one mesh says nothing of another, whatever the study's text."""
    folder = tmp_path / "out"
    checkpoint = open_checkpoint(folder, "", resume=False)
    joints = [lap_joint(element_size=size, hole_radius=0.0) for size in (10.0, 5.0)]
    check_same_joint(checkpoint, joints[0])
    check_same_joint(open_checkpoint(folder, "", resume=True), joints[0])
    with pytest.raises(StudyError, match="computed another joint: a deck, mesh or matrix"):
        check_same_joint(checkpoint, joints[1])


@pytest.mark.long
def test_a_resumed_run_repeats_the_warnings_of_what_it_takes_over(tmp_path, monkeypatch):
    path = tmp_path / "tiny.toml"
    path.write_text(STUDY.replace(METHODS, '"compliance"'))
    study, original = read_study(path), runs.validate
    monkeypatch.setattr(
        case_solution, "recover_pressure", _raise(ValueError("nobody foresaw this"))
    )
    monkeypatch.setattr(runs, "validate", _raise(KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        run(study, tmp_path)
    monkeypatch.setattr(runs, "validate", original)
    warnings = run(study, tmp_path, resume=True)["warnings"]
    failed = "jump, compliance/0, recovered pressures: ValueError: nobody foresaw this"
    assert warnings == [failed]


def test_a_finished_run_that_resumes_computes_nothing(tmp_path, monkeypatch):
    build = offline.build_loaded
    path, table = tmp_path / "tiny.toml", tmp_path / "way.csv"
    table.write_text("factor\n0.5\n1.0\n")
    text = STUDY.replace(METHODS, '"compliance"')
    text = text.replace('kind = "static"', 'kind = "path"\nfactors = "way.csv"', 1)
    path.write_text(text[: text.index('[[load_case]]\nname = "jump"')] + NO_REPORT)
    before = run(read_study(path), tmp_path / "out")
    with monkeypatch.context() as patch:
        patch.setattr(case_solution, "solve_static", _raise(AssertionError))
        patch.setattr(offline, "tighten", _raise(AssertionError))
        after = run(read_study(path), tmp_path / "out", resume=True)
    assert dict(after) == {**before, "remarks": after["remarks"]}
    assert "nothing was computed" in after["remarks"][-1]
    table.write_text("factor\n0.5\n2.0\n")
    built = []
    monkeypatch.setattr(offline, "build_loaded", lambda loaded: built.append(0) or build(loaded))
    more = run(read_study(path), tmp_path / "out", resume=True)
    assert more["mark"] != before["mark"]
    assert len(built) == 1  # to look for the mark, and to go on from


def test_resuming_with_another_table_of_loads_is_refused(tmp_path, monkeypatch):
    path, table = tmp_path / "tiny.toml", tmp_path / "way.csv"
    table.write_text("factor\n0.5\n1.0\n")
    path.write_text(STUDY.replace('kind = "static"', 'kind = "path"\nfactors = "way.csv"', 1))
    with monkeypatch.context() as patch:
        patch.setattr(runs, "validate", _raise(KeyboardInterrupt()))
        patch.setattr(offline, "tighten", _raise(KeyboardInterrupt()))
        with pytest.raises(KeyboardInterrupt):
            run(read_study(path), tmp_path / "out")
    table.write_text("factor\n0.5\n2.0\n")
    with pytest.raises(StudyError, match="of a file that it names"):
        run(read_study(path), tmp_path / "out", resume=True)


def test_resuming_another_study_is_refused(study, tmp_path, monkeypatch):
    monkeypatch.setattr(case_solution, "solve_static", _raise(KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        run(study, tmp_path)
    other = tmp_path / "other.toml"
    other.write_text(STUDY.replace("-150.0", "-160.0"))
    with pytest.raises(StudyError, match="without --resume"):
        run(read_study(other), tmp_path, resume=True)


@pytest.mark.long
def test_a_method_that_does_not_converge_is_recorded_and_the_rest_kept(
    study, tmp_path, monkeypatch
):
    original = case_solution.solve_static

    def fragile(system, load):
        if system.K.shape[0] == 6 + 4 + 1 + 2:  # jim-a and jim-b with two joint modes
            message = "did not settle"
            raise ConvergenceError(message)
        return original(system, load)

    monkeypatch.setattr(case_solution, "solve_static", fragile)
    outcome = run(study, tmp_path)
    assert not outcome["converged"]
    assert len(outcome["not_converged"]) == 2
    assert "bend, jim-a with 2 joint modes" in outcome["not_converged"][0]
    assert set(outcome["load_cases"]["bend"]["methods"]["jim-a"]) == {"4"}


def _raise(error: BaseException):
    def solve(*_, **__):
        raise error

    return solve


@pytest.mark.long
def test_hard_contact_with_a_training_box(tmp_path):
    text = STUDY.replace(
        "[[bolt]]", '[[interface]]\nname = "joint"\npenalty = "hard"\n\n[[bolt]]', 1
    )
    text = text.replace('"jim-a", "jim-b", "compliance", "nmf"', '"compliance"')
    path = tmp_path / "hard.toml"
    path.write_text(text)
    assert run(read_study(path), tmp_path)["converged"]
    load_space = read_results(tmp_path / "results.h5").validation.load_space
    assert load_space is not None
    assert (
        load_space.methods["compliance"][0].worst_error < 1e-6
    )  # exact, at the digits of hard contact
