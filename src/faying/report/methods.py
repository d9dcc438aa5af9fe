"""Judgement of methods by their pressure errors on the load cases of a run."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from faying.display.quantities import number, percent
from faying.reduction.methods import METHODS
from faying.report.style import label
from faying.study.judgement.remarks import jumps
from faying.study.judgement.step_check import step_check
from faying.study.results.values import CaseResult, MethodResult, Results


def against(cases: Iterable[CaseResult]) -> str:
    """Return "the full model", or "the reference" if a load case has another reference."""
    return "the full model" if all(case.is_full for case in cases) else "the reference"


def reference_note(results: Results) -> str:
    """Return a note on the reduced reference of load cases; empty if it is the full model."""
    reduced = {name: case for name, case in results.cases.items() if not case.is_full}
    if not reduced:
        return ""
    models = ", ".join(dict.fromkeys(case.reference_model for case in reduced.values()))
    reason = f" ({results.reference_reason})" if results.reference_reason else ""
    moving = [name for name, case in reduced.items() if case.times is not None]
    confirmed = [name for name, case in results.cases.items() if case.is_full]
    said = (
        f"{', '.join(reduced)} were not solved with the full model{reason}: their reference is the "
        f"reduced model {models}. Its static solutions equal the full model's up to round-off, and "
        "all static errors are certified."
    )
    if confirmed:
        said += f" The full model confirmed the worst static cases: {', '.join(confirmed)}."
    if moving:
        said += (
            f" In {', '.join(moving)} errors compare the normal modes of the study with "
            "twice as many; errors of both show in the difference to recovered pressures."
        )
    return said


GOOD_ERROR = 0.05
"""Largest trustworthy relative pressure error: the paper's method B with 20 modes."""
FAIR_ERROR = 0.10
"""Largest relative pressure error that is usable with care; the paper rejects method A above it."""


@dataclass(frozen=True, kw_only=True)
class MethodVerdict:
    """The judgement of a method on all load cases.

    Attributes
    ----------
    method
    joint_modes
        Judged number: the smallest from which on all numbers are good, otherwise the best.
    worst
        Largest relative pressure error over the load cases; infinite if one has no solution.
    case
        Load case of the worst error.
    grade
        ``"good"``, ``"fair"`` or ``"poor"``.
    sentence
    only
        Load cases on which the method was compared; empty if on all.
    """

    method: str
    joint_modes: int
    worst: float
    case: str
    grade: str
    sentence: str
    only: str = ""


def grade(error: float) -> str:
    """Return the grade of a largest relative pressure error."""
    if error <= GOOD_ERROR:
        return "good"
    return "fair" if error <= FAIR_ERROR else "poor"


def verdicts(results: Results) -> list[MethodVerdict]:
    """Return the judgements of all methods, the best first."""
    names = dict.fromkeys(name for case in results.cases.values() for name in case.methods)
    judged = [verdict for name in names if (verdict := _judged(results.cases, name)) is not None]
    return sorted(judged, key=lambda verdict: verdict.worst)


def _judged(cases: Mapping[str, CaseResult], method: str) -> MethodVerdict | None:
    # Pressures of backbones belong to the preloaded joint and say nothing about vibrations.
    cases = {name: case for name, case in cases.items() if case.kind != "backbone"} or cases
    counts = sorted({n for case in cases.values() for n in case.methods.get(method, {})})
    if not counts:
        return None
    asked = cases
    if any(case.remedy and case.remedy.taken.method == method for case in cases.values()):
        asked = {name: case for name, case in cases.items() if method in case.methods}
    if not _is_transient(method):
        asked = {name: case for name, case in asked.items() if case.times is None}
    only = _only(method, asked, cases)
    worst = {count: _worst(asked, method, count) for count in counts}
    good = [
        count
        for count in counts
        if all(worst[more][0] <= GOOD_ERROR for more in counts if more >= count)
    ]
    chosen = good[0] if good else min(counts, key=lambda count: worst[count][0])
    error, case = worst[chosen]
    return MethodVerdict(
        method=method,
        joint_modes=chosen,
        worst=error,
        case=case,
        grade=grade(error),
        sentence=_sentence(asked, method, chosen, error, case, only, has_sizes=len(counts) > 1),
        only=only,
    )


def _only(method: str, asked: Mapping[str, CaseResult], cases: Mapping[str, CaseResult]) -> str:
    """Return the load cases on which a method was compared, as text; empty if on all."""
    if not _is_transient(method):
        return "static loads"
    return "" if len(asked) == len(cases) else ", ".join(asked)


def _is_transient(method: str) -> bool:
    """Return whether a method applies to transients; some of the literature do not."""
    return method not in METHODS or METHODS[method].transient


def _worst(cases: Mapping[str, CaseResult], method: str, count: int) -> tuple[float, str]:
    """Return the largest error over the load cases, infinite without a solution, and its case."""
    worst = (0.0, "")
    for name, case in cases.items():
        result = case.methods.get(method, {}).get(count)
        error = result.accuracy.max_relative_error if result else float("inf")
        if error >= worst[0]:
            worst = (error, name)
    return worst


def _sentence(
    cases: Mapping[str, CaseResult],
    method: str,
    count: int,
    error: float,
    case: str,
    only: str,
    *,
    has_sizes: bool,
) -> str:
    if error == float("inf"):
        return f"{label(method, count)}: no solution in {case}; not to be trusted."
    ratios = [result.accuracy.max_pressure_ratio for result in _all(cases, method, count)]
    reference = against(cases.values())
    span = f"largest pressure {_span(ratios)} × {reference}'s"
    size = f"max relative pressure error against {reference} {percent(error)} ({case}), {span}"
    size += _recovery(_all(cases, method, count))
    these = only or "these load cases" if _is_transient(method) else "these static load cases"
    if error <= GOOD_ERROR:
        modes = f" from {_modes(count)} on" if count and has_sizes else ""
        return f"can be trusted for pressure on {these}{modes}: {size}."
    best = f"at best, with {_modes(count)}, " if count and has_sizes else ""
    if error <= FAIR_ERROR:
        return f"usable with care: {best}{size}."
    return f"not to be trusted for pressure on {these}: {best}{size}."


def _modes(count: int) -> str:
    return f"{count} joint mode{'s' if count > 1 else ''}"


def _recovery(results: list[MethodResult]) -> str:
    """Return the error of pressures recovered from the motion of transients, as text."""
    errors = [r.recovered_error for r in results if r.recovered_error is not None]
    if not errors:
        return ""
    return f"; pressures recovered from its motion in transients are off by {percent(max(errors))}"


def _all(cases: Mapping[str, CaseResult], method: str, count: int) -> list[MethodResult]:
    return [
        case.methods[method][count]
        for case in cases.values()
        if count in case.methods.get(method, {})
    ]


def _span(values: list[float]) -> str:
    low, high = number(min(values)), number(max(values))
    return low if low == high else f"{low} to {high}"


def headline(judged: list[MethodVerdict], results: Results) -> str:
    """Return one or two sentences on whether pressures of reduced models can be trusted."""
    if not coarse_steps(results):
        return _answer(judged)
    reference = against(results.cases.values()).capitalize()
    answer, doubt = _answer(judged), "own pressures are not converged in time in all load cases"
    return f"{answer} {reference}'s {doubt}."


def _answer(judged: list[MethodVerdict]) -> str:
    if not judged:
        return "No reduced model was compared with the full model."
    good = [
        label(v.method, v.joint_modes) + (f" ({v.only} only)" if v.only else "")
        for v in judged
        if v.grade == "good"
    ]
    rejected = [v.method for v in judged if v.grade != "good"]
    bound = f"max relative pressure error at most {100 * GOOD_ERROR:g} % on every load case"
    if not good:
        best = judged[0]
        return (
            f"No method meets the mark ({bound}); the nearest is "
            f"{label(best.method, best.joint_modes)} with {percent(best.worst)}."
        )
    others = f" Not: {', '.join(rejected)}." if rejected else ""
    return f"Can be trusted for pressure here ({bound}): {'; '.join(good)}.{others}"


def coarse_steps(results: Results) -> list[str]:
    """Return warnings about load cases whose time step is too large for the pressure."""
    return [
        f"{name}: the time step is too large for the pressure: with half of it, pressures of "
        f"the {case.reference_model} change by up to {percent(check.largest)} of the peak "
        f"({percent(check.change.rms_relative_error)} root mean square), the peak itself by "
        f"{percent(check.peak_change)}"
        for name, case in results.cases.items()
        if (check := step_check(case)) is not None and check.largest > GOOD_ERROR
    ]


def reservations(results: Results) -> list[str]:
    """Return reservations about the errors, the important ones first."""
    said = [*filter(None, [reference_note(results)])]
    said.extend(jumps(results))
    said.extend(_undetermined(results))
    said.extend(_unseen(results))
    said.extend(_fewer_modes(results))
    said.append(
        f"Errors compare each reduced model with {against(results.cases.values())} on the same "
        "mesh, contact law, "
        "quadrature and time step, for these load cases only. They say nothing about other loads, "
        "nor about the discretization error of the full model."
    )
    return said


def _undetermined(results: Results) -> list[str]:
    """Return warnings about interfaces whose hard contact does not determine point pressures."""
    return [
        f"{name}: hard contact at {len(record.weights)} points of {len(record.pairs)} node pairs "
        "determines nodal forces, not the pressures of single points, nor their averages: another "
        "solution with equal forces may have other pressures. A stiff penalty has unique pressures."
        for name, record in results.interfaces.items()
        if record.penalty == np.inf and len(record.weights) > len(record.pairs)
    ]


def _fewer_modes(results: Results) -> list[str]:
    """Return warnings about methods whose training gave too few joint modes."""
    try:
        asked = results.study_tables["reduction"]["joint_modes"]
        highest = max(count for count in asked if isinstance(count, int))
    except (KeyError, TypeError, ValueError):
        return []
    counts = {
        method: max(sizes)
        for case in results.cases.values()
        for method, sizes in case.methods.items()
        if max(sizes, default=0) > 0
    }
    return [
        f"{method}: {highest} joint modes were requested, but training gave only {_modes(count)}; "
        "add sides or levels to the training box, or subareas for method A."
        for method, count in counts.items()
        if count < highest
    ]


def _unseen(results: Results) -> list[str]:
    """Return warnings about methods that are good on the load cases but not beyond them."""
    said = []
    for verdict in verdicts(results):
        elsewhere = _elsewhere(results, verdict)
        if verdict.grade == "good" and elsewhere > GOOD_ERROR:
            said.append(
                f"{label(verdict.method, verdict.joint_modes)}: good on the load cases, but "
                f"{percent(elsewhere)} off at the worst static load beyond them."
            )
    return said


def _elsewhere(results: Results, verdict: MethodVerdict) -> float:
    """Return the largest error of a judged method at random loads."""
    validation = results.validation
    sizes = validation.load_space.methods.get(verdict.method, {}) if validation.load_space else {}
    errors = [sizes[verdict.joint_modes].worst_error] if verdict.joint_modes in sizes else []
    return max(errors, default=0.0)


def meanings(results: Results) -> dict[str, str]:
    """Return descriptions of the methods of a run, in the order of the study."""
    names = dict.fromkeys(name for case in results.cases.values() for name in case.methods)
    return {name: METHODS[name].meaning for name in names if name in METHODS}
