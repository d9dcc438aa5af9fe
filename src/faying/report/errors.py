"""The page on methods: errors in each load case and beyond, what bounds are worth, and cost."""

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
"""Errors and seconds have none of the study."""


def _share(value: float | None) -> float | None:
    """Return a share in percent; None where there is none."""
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
"""Errors of one method in one load case, the sharpest bounds first."""


def error_table(case: CaseResult) -> Table:
    """Return the errors of every method and size in one load case."""
    if case.reference.backbones:
        return backbone_error_table(case)
    return described("method", _by_size(case.methods), ERRORS, NO_UNITS)


def _by_size(methods: Mapping[str, Mapping[int, Any]]) -> Iterator[tuple[str, Any]]:
    """Yield what belongs to methods of all sizes, by what these are called."""
    for name, sizes in methods.items():
        for count, result in sorted(sizes.items()):
            yield label(name, count), result


def backbone_error_table(case: CaseResult) -> Table:
    """Return how far the backbones of every method are from those of the full model."""
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
    """Return errors at unseen loads; no rows without a load space."""
    record = results.validation.load_space
    rows = _by_size(record.methods if record else {})
    columns = (
        Column("median load's max error", lambda space: _share(space.median_error), "%", 3),
        Column("worst load's max error", lambda space: _judged(space.worst_error), "%"),
    )
    return described("method", rows, columns, NO_UNITS)


def choice_table(results: Results) -> Table:
    """Return numbers of joint modes chosen automatically; no rows where none were."""
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
            lambda choice: "certified" if choice.met else "not reached with all there are",
        ),
    )
    return described("basis", results.validation.choices.items(), columns, NO_UNITS)


def timing_table(results: Results) -> Table:
    """Return what the full model and each method cost."""
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
    """Return the wall time of every stage, and of the run until its report was drawn."""
    times = {name: float(value) for name, value in results.timings.items()}
    if times:
        times["all of it, without files and report"] = sum(times.values())
    return described(
        "stage", times.items(), (Column("wall time", lambda seconds: seconds, "s", 3),), NO_UNITS
    )


def estimate_note(results: Results) -> str:
    """Say what the estimated errors of transients are; empty where there are none."""
    if not any(
        result.response.estimate is not None
        for case in results.cases.values()
        for sizes in case.methods.values()
        for result in sizes.values()
    ):
        return ""
    low, high = (number(factor, 2) for factor in OBSERVED_RATIOS)
    said = (
        "Estimated max error, of transients: how far the pressures move when the shapes that the "
        "transient's own contact forces excite are given their inertia. It takes no full solution "
        "and is an estimate, no bound; what the time step adds is not in it. Against full "
        f"solutions of {OBSERVED_ON} it was {low} to {high} times the true max error"
    )
    said += f", {TRACTIONS_OBSERVED}, over the largest traction."
    return f"{said} {hint(results)}".rstrip()


def doubtful_references(results: Results) -> list[str]:
    """Name the transients whose reduced reference is itself estimated to be off."""
    return [
        f"{name}: pressures of the {case.reference_model}, which the errors of this load case are "
        f"against, are themselves estimated to be off by up to {percent(error)} of the "
        "peak. Read the estimated errors of the methods, not their differences to it."
        for name, case in results.cases.items()
        if not case.is_full
        and case.reference.estimate is not None
        and (error := case.reference.estimate.max_relative_error) > GOOD_ERROR
    ]
