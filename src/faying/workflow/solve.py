"""Many loads solved on a reduced model, piece by piece so that memory does not grow."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from faying import __version__
from faying.assessment.case_metrics import WEAK_SHARE, weak_warnings
from faying.assessment.joint_verdict import joint_verdict, summarized
from faying.assessment.requirements import Requirements, check_names
from faying.exceptions import refuse_study
from faying.execution.checkpoint import finished_before, results_in, stamp_of
from faying.execution.executor import Executor
from faying.files.atomic import write_text
from faying.files.names import file_names
from faying.linalg.threads import one_thread
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import History, Load
from faying.study.inputs.load_set import LoadSet
from faying.study.judgement.summary import plain
from faying.study.keys.errors import nearest
from faying.study.results.metric_table import check_table_format, write_metrics
from faying.study.results.solved_fields import SolvedFields, write_solved
from faying.study.stages.books import Books, ProgressBar
from faying.study.stages.path_cases import rest_state
from faying.units import Units
from faying.workflow.solve_cases import CaseSolver, SolveOptions
from faying.workflow.solved_assessment import demanded_of, solved_checks
from faying.workflow.solved_cases import SolvedCases


@one_thread()
def solve_loads(
    rom: ReducedModel,
    loads: LoadSet,
    out: Path,
    options: SolveOptions | None = None,
    *,
    tightening: Sequence[Load] | None = None,
    resume: bool = False,
    progress: ProgressBar | None = None,
    executor: Executor | None = None,
) -> Mapping[str, Any]:
    """Solve loads on a reduced model, and return the contents of ``summary.json``.

    Parameters
    ----------
    out
        Receives ``metrics.csv`` of the static cases, ``history_NAME.csv`` of each transient (or
        ``.parquet``), ``fields.h5`` and ``summary.json``.
    tightening
        Initial bolt forces of a joint with friction, increment by increment; all loads begin at
        their end. None where the joint was tightened without friction.
    resume
        Continue an interrupted call with the same model, loads and options,
        from its finished pieces of static cases and transients.
    executor
        Shares pieces of the static cases, and the transients, among its workers.

    Raises
    ------
    ModelError
        If a requirement names an unknown interface, or the tightening of a joint with friction
        is unknown.
    StudyError
        If a case to keep does not exist, or another call is writing to the folder. Cases that do
        not converge are recorded instead.

    Notes
    -----
    Each process holds one piece of the cases, the model, the loads and the table of static cases
    in memory. Pieces, and so the numbers, do not depend on earlier calls or on the
    executor.
    """
    chosen = options or SolveOptions()
    check_table_format(chosen.table)
    check_names(chosen.requirements, list(rom.interfaces), rom.contact.smooth_interfaces)
    unknown = [name for name in chosen.named if name not in loads.names]
    if unknown:
        remedy = nearest(unknown[0], loads.names[:20])
        refuse_study(f"the loads have no static case '{unknown[0]}' to keep; {remedy}")
    if tightening is None:
        rom.contact.check_frictionless(
            "so results depend on how the bolts were tightened, and the file does not tell "
            "how: write it again with faying reduce; in Python give solve_loads the bolt_loads "
            "of preload_path_of(file) as tightening, or follow the loads with faying.solve_path"
        )
    path = tuple(tightening or ())
    mark = _mark(rom, loads, chosen, path)
    before = finished_before(out, mark) if resume else None
    if before is not None:
        return before
    with results_in(out, mark, resume=resume) as checkpoint:
        books = Books(progress)
        rest = rest_state(rom, path)
        solver = CaseSolver(
            rom=rom,
            loads=loads,
            checkpoint=checkpoint,
            books=books,
            options=chosen,
            demanded=demanded_of(chosen, rom, rest),
            rest=rest,
        )
        if executor is not None:
            solver.share(executor)
        static = solver.static() if loads.names else None
        transients = {load.load.name: solver.transient(load) for load in loads.transients}
        assessment, units = None, rom.unit_set
        verdict = joint_verdict((), units, "see the warnings")
        with books.stage("requirements"), books.attempt("requirements"):
            verdicts, checks = solved_checks(solver, static, transients)
            verdict = joint_verdict(checks, units)
            assessment = {"verdicts": plain([asdict(demand) for demand in verdicts])}
        with books.stage("files"):
            files = _written(rom, static, transients, solver.named, out, chosen)
        summary = {
            "faying": __version__,
            "mark": stamp_of(mark),
            "model": {"name": rom.name, "method": rom.method, "joint_modes": rom.joint_modes},
            "units": rom.units,
            **files,
            "requirements": stated(chosen.requirements),
            "assessment": assessment,
            "verdict": plain(summarized(verdict)),
            "warnings": [*_barely_held(files), *books.failed],
            "timings": books.account(),
        }
        write_text(out / "summary.json", json.dumps(summary, indent=2) + "\n")
    return summary


def bolt_loads(path: Sequence[Mapping[str, float]]) -> list[Load]:
    """Return increments of initial bolt forces as loads."""
    return [Load(name="preload", bolt_forces=forces) for forces in path]


def stated(requirements: Requirements) -> list[str]:
    """Return the names of the requirements that are set."""
    return [name for name, value in vars(requirements).items() if value not in (None, ())]


def _written(
    rom: ReducedModel,
    static: SolvedCases | None,
    transients: Mapping[str, SolvedCases],
    named: Sequence[int],
    out: Path,
    options: SolveOptions,
) -> dict[str, Any]:
    """Write tables and fields, and return their entries of the summary."""
    units, count, ending = rom.unit_set, options.worst, options.table
    fields = None
    every = [*([] if static is None else [static]), *transients.values()]
    summary: dict[str, Any] = {
        "converged": not any(cases.failed for cases in every),
        "not_converged": [text for cases in every for text in cases.failed],
    }
    if static is not None:
        write_metrics(out / f"metrics.{ending}", "case", static.metrics, static.rows(), units)
        fields = _fields(static, count, named)
        summary["static"] = _worst(static, count)
    stems = file_names(transients)
    over_time: dict[str, SolvedFields] = {}
    for name, transient in transients.items():
        path = out / f"history_{stems[name]}.{ending}"
        write_metrics(path, "time", transient.metrics, transient.rows(), units)
        chosen = _fields(transient, count, [])
        over_time |= {} if chosen is None else {name: chosen}
        summary.setdefault("transients", {})[name] = _worst(transient, count)
    write_solved(rom, fields, over_time, out / "fields.h5")
    return {**summary, "metrics": _described(every, units)}


def _described(every: Sequence[SolvedCases], units: Units) -> dict[str, Any]:
    return {
        metric.name: {"unit": units.of(metric.dimension), "description": metric.description}
        for solved in every
        for metric in solved.metrics
    }


def _worst(solved: SolvedCases, count: int) -> dict[str, Any]:
    """Return the number of cases, and the worst cases of each metric."""
    worst = {
        metric: [{"case": solved.label(row), "value": plain(value)} for row, value in entries]
        for metric, entries in solved.worst(count).items()
    }
    return {"count": sum(len(part["metrics"]) for part in solved), "worst": worst}


def _barely_held(written: Mapping[str, Any]) -> list[str]:
    """Return warnings about cases in which weak springs carry too much."""
    static = {"": written["static"]} if "static" in written else {}
    shares: dict[str, dict[str, float]] = {}
    for name, figures in {**static, **written.get("transients", {})}.items():
        for metric, worst in figures["worst"].items():
            if metric.startswith(WEAK_SHARE) and worst:
                case = f"{name} at {worst[0]['case']}" if name else str(worst[0]["case"])
                share = inf if worst[0]["value"] is None else worst[0]["value"]
                shares.setdefault(metric.removeprefix(WEAK_SHARE), {})[case] = share
    return weak_warnings(shares)


def _fields(solved: SolvedCases, count: int, named: Sequence[int]) -> SolvedFields | None:
    """Return the fields of the worst and the named rows; None where nothing was solved."""
    envelope = solved.envelope()
    if envelope is None:
        return None
    how = {entry.name: entry.worst for entry in solved.metrics}
    reasons: dict[int, list[str]] = {}
    for metric, entries in solved.worst(count).items():
        for row, _ in entries:
            reasons.setdefault(row, []).append(f"{how[metric]} {metric}")
    for row in named:
        reasons.setdefault(row, []).append("named")
    rows, pressure, gap = solved.fields(sorted(reasons))
    return SolvedFields(
        names=tuple(map(solved.label, rows)),
        reasons=tuple(", ".join(reasons[row]) for row in rows),
        pressure=pressure,
        gap=gap,
        envelope=envelope,
    )


def _mark(rom: ReducedModel, loads: LoadSet, options: SolveOptions, path: Sequence[Load]) -> str:
    """Return a hash of a model, its loads and options."""
    mark, contact = hashlib.sha256(), rom.contact
    model = (rom.K, rom.M, rom.C, contact.relative_operator, contact.initial_gap)
    for array in (*model, contact.flexibility, loads.inputs):
        mark.update(np.ascontiguousarray(array).tobytes())
    for timed in loads.transients:
        mark.update(repr((timed.load.name, timed.step, timed.duration, timed.integrator)).encode())
        for key, value in timed.load.forces.items():
            mark.update(key.encode())
            parts = [value.times, value.values] if isinstance(value, History) else [[value]]
            mark.update(b"".join(np.asarray(part, dtype=float).tobytes() for part in parts))
    tightened = [dict(load.bolt_forces) for load in path]
    mark.update(repr((loads.names, options, tightened)).encode())
    return mark.hexdigest()
