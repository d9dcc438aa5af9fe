"""Runs of studies: every method on every load case, compared with the full model."""

import json
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

from faying.assessment.joint_verdict import MOST_NAMED
from faying.assessment.transient_error import EXACT, REMEDY
from faying.execution.checkpoint import finished_before, results_in, stamp_of
from faying.execution.executor import Executor
from faying.files.atomic import write_text
from faying.joint.model import Model
from faying.linalg.threads import one_thread
from faying.reduction.method import CLASSIC
from faying.study.inputs.load_model import LoadedModel
from faying.study.inputs.study_files import study_mark
from faying.study.judgement.summary import summarize
from faying.study.keys.tables import Study
from faying.study.results.metric_table import write_frequency_tables
from faying.study.results.store import write_results
from faying.study.results.values import CaseResult, Results
from faying.study.stages.books import Books, ProgressBar
from faying.study.stages.cases import CaseRunner
from faying.study.stages.frequency_cases import frequency_records
from faying.study.stages.full_transients import case_groups
from faying.study.stages.normal_modes import normal_modes_of
from faying.study.stages.offline import (
    Models,
    assembled,
    build_bases,
    choose_counts,
    joint_mark,
    prepare_joint,
    reduced_models,
)
from faying.study.stages.record import Kept, kept_models, record
from faying.study.stages.reference import reference_of
from faying.study.stages.run_assessment import assess_run
from faying.study.stages.validation import validate
from faying.study.stages.worker_tasks import compute_pieces

Solved = dict[str, tuple[CaseResult, list[str]]]
"""Result of each load case by name, and sentences about solutions that did not converge."""


def run(
    study: Study,
    out: Path,
    *,
    resume: bool = False,
    progress: ProgressBar | None = None,
    executor: Executor | None = None,
    since: float | None = None,
) -> Mapping[str, Any]:
    """Compute a study, write its results to a folder, and return the contents of ``summary.json``.

    Parameters
    ----------
    out
        Receives ``results.h5``, ``summary.json``, ``study.toml``, interface and report files.
    resume
        Continue an interrupted run of the same study; of a finished one, compute nothing.
    executor
        Computes transients of the full model beforehand.
    since
        Instant of ``time.perf_counter`` at which the program started, from which the run is timed.

    Raises
    ------
    FayingError
        If the study, its model or its loads do not fit together, or another run is writing to
        the folder. Solutions that do not converge
        are recorded instead, and so is validation that fails.
    """
    mark, built = study_mark(study), None
    if resume and (out / "results.h5").exists() and not (out / "unfinished").exists():
        # A deck may include files that the study does not name.
        built = assembled(study)
        before = finished_before(out, mark + joint_mark(built[1]))
        if before is not None:
            return before
    with results_in(out, mark, resume=resume) as checkpoint, ExitStack() as limits:
        books = Books(progress, since, checkpoint)
        # Loaded after the folder was opened, since libraries print messages on a full disk.
        with books.timed("libraries"):
            limits.enter_context(one_thread())
        results = _computed(study, books, executor, built)
        stamp = stamp_of(mark + str(checkpoint.get("joint")["mark"]))
        results = replace(results, provenance={**results.provenance, "mark": stamp})
        _write_files(study, results, out, books)
        # Written again with the time of the report.
        return _write_summary(replace(results, timings=books.account()), out)


def _computed(
    study: Study,
    books: Books,
    executor: Executor | None,
    built: tuple[LoadedModel, Model] | None,
) -> Results:
    """Compute all results of a study; ``built`` is as in :func:`prepare_joint`."""
    if executor is not None:
        compute_pieces(study, executor, books)
    joint = prepare_joint(study, books, built)
    chosen = normal_modes_of(joint)
    trained = build_bases(joint, chosen.modes)
    choices = choose_counts(joint, trained)
    bare = reduced_models(joint, trained, choices)
    recoverable: Kept = {}
    title = study.title or study.path.stem
    with books.stage("recovery matrices"), books.attempt("matrices for recovery and export"):
        recoverable = kept_models(joint.model, bare, trained.bases[CLASSIC], title)
    models = {name: {**sizes, **recoverable.get(name, {})} for name, sizes in bare.items()}
    reference = reference_of(joint, len(chosen.modes.frequencies))
    full = reference.kind == "full"
    runner = CaseRunner(
        joint=joint,
        models=models,
        groups=case_groups(study.load_cases, half_step=study.validation.half_step) if full else [],
        reference=reference,
        classic=trained.bases[CLASSIC],
    )
    solved = {case.name: runner.solve(case) for case in study.load_cases}
    if reference.kind == "worst":
        solved |= _confirmed(study, runner, solved)
    cases = {name: result for name, (result, _) in solved.items()}
    failures = [failure for _, failed in solved.values() for failure in failed]
    if runner.built is not None:
        with books.stage("recovery matrices"), books.attempt("matrices for recovery and export"):
            more: Models = {**bare, REMEDY: {0: runner.built}}
            recoverable = kept_models(joint.model, more, trained.bases[CLASSIC], title)
    validation = validate(joint, models, choices)
    exact = recoverable[EXACT][0] if EXACT in recoverable else joint.model
    frequencies = frequency_records(joint, recoverable.get(EXACT, {}).get(0))
    failures += [text for name, swept in frequencies.items() for text in swept.missed(name)]
    assessment = assess_run(joint, cases, frequencies, exact)
    with books.stage("records"):
        results = record(joint, recoverable, trained, cases, validation, failures, reference)
    results = replace(
        results, frequencies=frequencies, assessment=assessment, mode_choices=chosen.choices
    )
    return replace(results, timings=books.account())


def _confirmed(study: Study, runner: CaseRunner, solved: Solved) -> Solved:
    """Solve the static cases of the largest certified errors with the full model as well."""
    bounds = {
        case.name: _largest_bound(solved[case.name][0])
        for case in study.load_cases
        if case.kind == "static"
    }
    worst = sorted(bounds, key=lambda name: -bounds[name])[:MOST_NAMED]
    return {
        case.name: runner.solve(case, confirmed=True)
        for case in study.load_cases
        if case.name in worst
    }


def _largest_bound(case: CaseResult) -> float:
    """Return the largest certified energy error of all methods; infinite without a certificate."""
    bounds = [
        result.certified_energy_error
        for sizes in case.methods.values()
        for result in sizes.values()
    ]
    return max((float("inf") if bound is None else bound for bound in bounds), default=float("inf"))


def _write_files(study: Study, results: Results, out: Path, books: Books) -> None:
    """Write results, summary, tables and pictures, and the report last."""
    from faying.export.vtk import write_interface_vtu

    with books.stage("files"):
        write_results(results, out / "results.h5")
        _write_summary(results, out)
        write_text(out / "study.toml", study.text)
        write_frequency_tables(results.frequencies, out)
        write_interface_vtu(results, out)
    if study.output.report:
        with books.stage("report"):
            from faying.report.html import write_report

            write_report(results, out)


def _write_summary(results: Results, out: Path) -> Mapping[str, Any]:
    """Write and return the summary."""
    summary = summarize(results)
    write_text(out / "summary.json", json.dumps(summary, indent=2) + "\n")
    return summary
