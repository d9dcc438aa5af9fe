"""Tables of the page on methods: errors in load cases and beyond, certified bounds, and cost."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from faying.assessment.transient_error import OBSERVED_ON, OBSERVED_RATIOS, TRACTIONS_OBSERVED
from faying.display.quantities import number, percent
from faying.display.table import Cell, Column, Table, described, graded
from faying.report.methods import GOOD_ERROR, grade
from faying.report.style import label
from faying.study.judgement.comparison import backbone_errors
from faying.study.judgement.remarks import hint
from faying.study.judgement.summary import timings
from faying.study.results.values import CaseResult, MethodResult, Results
from faying.units import units_of

NO_UNITS = units_of("")
"""Units of errors and seconds, which do not depend on the study."""


def _share(value: float | None) -> float | None:
    """Return a share in percent; None where it is missing or infinite."""
    return None if value is None or not np.isfinite(value) else 100 * value


def _judged(error: float | None) -> Cell | None:
    return None if error is None else graded(error, grade(error))


def _ratio(result: MethodResult) -> Cell:
    ratio = result.accuracy.max_pressure_ratio
    return Cell(text=f"{ratio:.4g}", value=ratio, grade=grade(abs(ratio - 1.0)))


def _estimate(result: MethodResult, name: str) -> float | None:
    estimate = result.response.estimate
    return None if estimate is None else getattr(estimate, name)


ERRORS = (
    Column("max error", lambda row: _judged(row.accuracy.max_relative_error), "%"),
    Column("rms error", lambda row: _share(row.accuracy.rms_relative_error), "%", 3),
    Column("99.9th percentile", lambda row: _share(row.accuracy.p999_relative_error), "%", 3),
    Column("peak pressure ratio", _ratio),
    Column("displacement error", lambda row: _share(row.accuracy.displacement_error), "%", 3),
    Column("max error of recovered pressures", lambda row: _judged(row.recovered_error), "%"),
    Column("estimated max error", lambda row: _judged(_estimate(row, "max_relative_error")), "%"),
    Column("estimated, tractions", lambda row: _share(_estimate(row, "max_traction_error")), "%"),
    Column("certified: energy error", lambda row: _share(row.certified_energy_error), "%", 3),
    Column("certified: clamp force error", lambda row: _share(row.certified_force_error), "%", 3),
    Column("certified: max error", lambda row: _share(row.certified_bound), "%", 3),
    Column(
        "certified: energy, increment",
        lambda row: _share(row.response.increment_error),
        "%",
        3,
    ),
    Column("residual of friction", lambda row: _share(row.response.law_residual), "%", 3),
    Column("coordinates", lambda row: row.n_modes),
)
"""Columns of the errors of a method in a load case."""


def error_table(case: CaseResult) -> Table:
    """Return the table of errors of every method and size in a load case."""
    if case.reference.backbones:
        return backbone_error_table(case)
    return described("method", _by_size(case.methods), ERRORS, NO_UNITS)


def _by_size(methods: Mapping[str, Mapping[int, Any]]) -> Iterator[tuple[str, Any]]:
    """Yield label and entry of methods of all sizes."""
    for name, sizes in methods.items():
        for count, result in sorted(sizes.items()):
            yield label(name, count), result


def backbone_error_table(case: CaseResult) -> Table:
    """Return the table of backbone errors of every method against the full model."""
    rows = {
        name: (errors, result)
        for name, result in _by_size(case.methods)
        if (errors := backbone_errors(result.response, case.reference)) is not None
    }
    columns = (
        Column("frequency off by at most", lambda pair: _share(pair[0].frequency), "%", 3),
        Column("damping ratio off by at most", lambda pair: _share(pair[0].damping), "%", 3),
        Column("coordinates", lambda pair: pair[1].n_modes),
    )
    return described("method", rows.items(), columns, NO_UNITS)


def load_space_table(results: Results) -> Table:
    """Return the table of errors at random loads; without rows if there is no load space."""
    record = results.validation.load_space
    rows = _by_size(record.methods if record else {})
    columns = (
        Column("median load's max error", lambda space: _share(space.median_error), "%", 3),
        Column("worst load's max error", lambda space: _judged(space.worst_error), "%"),
    )
    return described("method", rows, columns, NO_UNITS)


def choice_table(results: Results) -> Table:
    """Return the table of automatic numbers of joint modes; without rows if none were chosen."""
    columns = (
        Column("joint modes chosen", lambda choice: choice.count),
        Column(
            "asked for",
            lambda choice: (
                f"{choice.measure.replace('_', ' ')} at most {percent(choice.tolerance)}"
            ),
        ),
        Column(
            "outcome",
            lambda choice: "certified" if choice.met else "not reached with all modes",
        ),
    )
    return described("basis", results.validation.choices.items(), columns, NO_UNITS)


def timing_table(results: Results) -> Table:
    """Return the table of wall times of the full model and each method."""
    cost = timings(results)
    full = cost["full"]

    def over(key: str) -> Any:
        return lambda times: (
            full[key] / times[key]
            if times is not full and full.get(key) and times.get(key)
            else None
        )

    columns = (
        Column("offline", lambda times: times.get("offline"), "s", 3),
        Column("per static case", lambda times: times.get("per_static_case"), "s", 3),
        Column("full model's time over it", over("per_static_case"), "", 2),
        Column("per time step", lambda times: times.get("per_step"), "s", 3),
        Column("full model's time per step over it", over("per_step"), "", 2),
    )
    return described("model", {"full model": full, **cost["methods"]}.items(), columns, NO_UNITS)


def stage_table(results: Results) -> Table:
    """Return the table of wall times of every stage, and of the run without files and report."""
    times = {name: float(value) for name, value in results.timings.items()}
    if times:
        times["total without files and report"] = sum(times.values())
    return described(
        "stage", times.items(), (Column("wall time", lambda seconds: seconds, "s", 3),), NO_UNITS
    )


def estimate_note(results: Results) -> str:
    """Return a note that explains estimated errors of transients; empty without any."""
    if not any(
        result.response.estimate is not None
        for case in results.cases.values()
        for sizes in case.methods.values()
        for result in sizes.values()
    ):
        return ""
    low, high = (number(factor, 2) for factor in OBSERVED_RATIOS)
    said = (
        "Estimated max error, of transients: the change of pressures when the shapes that the "
        "contact forces excite are given inertia. It needs no full solution "
        "and is an estimate, not a bound; errors of the time step are not in it. Against full "
        f"solutions of {OBSERVED_ON} it was {low} to {high} times the true max error"
    )
    said += f", {TRACTIONS_OBSERVED}, over the largest traction."
    return f"{said} {hint(results)}".rstrip()


def doubtful_references(results: Results) -> list[str]:
    """Return warnings about transients whose reduced reference has a large estimated error."""
    return [
        f"{name}: the reference of the errors of this load case is the {case.reference_model}, "
        f"whose pressures have an estimated error of up to {percent(error)} of the "
        "peak. Use the estimated errors of the methods, not their differences to it."
        for name, case in results.cases.items()
        if not case.is_full
        and case.reference.estimate is not None
        and (error := case.reference.estimate.max_relative_error) > GOOD_ERROR
    ]
