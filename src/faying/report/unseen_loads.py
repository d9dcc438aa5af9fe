"""Tables of what a run found beyond its load cases: unseen loads, mode counts."""

from faying.report.quantities import percent
from faying.report.tables import Cell, Table, table
from faying.report.verdict import grade
from faying.study.results import Results


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
