"""Tables of what a run found beyond its load cases: unseen loads, worst loads, mode counts."""

from faying.report.quantities import number, percent
from faying.report.tables import Cell, Table, table
from faying.report.verdict import grade
from faying.study.results import Results
from faying.study.validation_record import WorstCaseRecord
from faying.units import Units, units_of


def load_space_table(results: Results) -> Table:
    """Return errors at unseen loads; no rows without a load space."""
    record = results.validation.load_space
    rows = (
        (
            name,
            f"{count}" if count else "none",
            percent(result.median_error),
            Cell(text=percent(result.worst_error), grade=grade(result.worst_error)),
        )
        for name, sizes in (record.methods.items() if record else ())
        for count, result in sorted(sizes.items())
    )
    return table(
        ("method", "joint modes", "median load's max error", "worst load's max error"), rows
    )


def worst_case_table(results: Results) -> Table:
    """Return the load each method gets most wrong; no rows without a validation box."""
    units = units_of(results.units)
    rows = (
        (
            name,
            f"{case.joint_modes}" if case.joint_modes else "none",
            _worst_load(case, units),
            percent(case.bound),
            Cell(text=percent(case.max_relative_error), grade=grade(case.max_relative_error)),
            percent(case.certified_bound),
            f"{case.evaluations}",
        )
        for name, case in results.validation.worst_cases.items()
    )
    columns = (
        "method", "joint modes", "worst load found", "certified energy error there",
        "max error there, by a full solution", "certified max error there", "loads searched",
    )  # fmt: skip
    return table(columns, rows)


def _worst_load(case: WorstCaseRecord, units: Units) -> str:
    if case.within_round_off:
        return "none: exact to round-off at all"
    return ", ".join(_force(key, value, units) for key, value in case.forces.items())


def _force(target: str, value: float, units: Units) -> str:
    is_moment = target.rpartition(".")[2].startswith("M")
    unit = f"{units.force}·{units.length}" if is_moment else units.force
    return f"{target} = {number(value)} {unit}"


def choice_table(results: Results) -> Table:
    """Return numbers of joint modes chosen automatically; no rows where none were."""
    rows = (
        (
            name,
            f"{choice.count}",
            f"{choice.measure.replace('_', ' ')} at most {percent(choice.tolerance)}",
            "certified" if choice.met else "not reached with all there are",
        )
        for name, choice in results.validation.choices.items()
    )
    return table(("basis", "joint modes chosen", "asked for", "outcome"), rows)
