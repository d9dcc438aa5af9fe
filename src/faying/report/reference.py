"""What the errors of a report are against, in words."""

from collections.abc import Iterable

from faying.study.results.values import CaseResult, Results


def against(cases: Iterable[CaseResult]) -> str:
    """Return "the full model", or "the reference" where a load case has another."""
    return "the full model" if all(case.is_full for case in cases) else "the reference"


def reference_note(results: Results) -> str:
    """Say what the load cases were compared with in place of the full model; empty if with it."""
    reduced = {name: case for name, case in results.cases.items() if not case.is_full}
    if not reduced:
        return ""
    models = ", ".join(dict.fromkeys(case.reference_model for case in reduced.values()))
    reason = f" ({results.reference_reason})" if results.reference_reason else ""
    moving = [name for name, case in reduced.items() if case.times is not None]
    confirmed = [name for name, case in results.cases.items() if case.is_full]
    said = (
        f"The full model did not solve {', '.join(reduced)}{reason}: the reference there is the "
        f"reduced model {models}. Static solutions of it are the full model's up to round-off, and "
        "all static errors are certified."
    )
    if confirmed:
        said += f" The full model confirmed the worst static cases: {', '.join(confirmed)}."
    if moving:
        said += (
            f" In {', '.join(moving)} errors tell how far the normal modes of the study are from "
            "twice as many; what both miss shows in the difference to recovered pressures."
        )
    return said
