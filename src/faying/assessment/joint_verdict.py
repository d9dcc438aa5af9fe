"""The verdict on a joint: a row for each bolt and each interface, and a sentence over all."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from faying.assessment.check import Check, Outcome, PartKind, worst_check
from faying.assessment.joint_record import REST
from faying.display.quantities import as_given, number, percent, quantity
from faying.units import Units

AT_LEAST = (
    "MS_",
    "clamp force",
    "opening",
    "slip",
    "sliding",
    "pressure on the ring",
    "fatigue safety",
)
"""Prefixes of checks with a lower limit."""

MOST_NAMED = 3
"""Worst checks that the sentence names, of all that the table has, and worst cases that the full
model confirms where it is not the reference of all."""


@dataclass(frozen=True, kw_only=True)
class PartVerdict:
    """One row of the verdict.

    Attributes
    ----------
    part
        Name of the bolt or the interface.
    kind
        Whether it is a bolt or an interface.
    checks
        All checks of the part.
    """

    part: str
    kind: PartKind
    checks: tuple[Check, ...]

    @property
    def counted(self) -> tuple[Check, ...]:
        """Checks that count: all except unknown ones that the study does not require."""
        return tuple(check for check in self.checks if check.required or check.outcome != "unknown")

    @property
    def worst(self) -> Check | None:
        """The decisive check; None where nothing could be judged."""
        return worst_check(self.counted)

    @property
    def outcome(self) -> Outcome:
        """Outcome of the decisive check."""
        return "unknown" if self.worst is None else self.worst.outcome


@dataclass(frozen=True, kw_only=True)
class JointVerdict:
    """The verdict on a joint.

    Attributes
    ----------
    parts
        Bolts, then interfaces.
    units
        Unit set of the study.
    missing
        Why the joint could not be judged; empty where it was.
    """

    parts: tuple[PartVerdict, ...]
    units: Units
    missing: str = ""

    @property
    def interfaces(self) -> tuple[str, ...]:
        """Names of its interfaces."""
        return tuple(part.part for part in self.parts if part.kind == "interface")

    @property
    def holds(self) -> bool:
        """Whether no check fails, and all required ones are known to be met."""
        return not self.missing and all(
            part.worst is None or part.outcome == "met" for part in self.parts
        )

    @property
    def decides(self) -> Check | None:
        """The decisive check over all bolts and interfaces."""
        return worst_check(tuple(part.worst for part in self.parts if part.worst is not None))

    @property
    def sentence(self) -> str:
        """The verdict in a sentence or two."""
        if self.missing:
            return f"The joint was not judged: {self.missing}."
        failed, unknown = (list(self._of(outcome)) for outcome in ("not met", "unknown"))
        said = [f"The joint does not hold: {_several(failed, self)}."] if failed else []
        if unknown:
            said.append(f"Not known: {'; '.join(_questions(unknown))}.")
        if said:
            return " ".join(said)
        worst = self.decides
        if worst is None:
            return "Nothing of the joint could be judged."
        used = "" if worst.utilisation is None else f" {share_used(worst)} of what is allowed"
        extent = " as far as it is judged" if self.open_questions else ""
        return (
            f"The joint holds{extent}. The most used is {worst.part}, by "
            f"{shown_quantity(worst, self.interfaces)}:{used}"
            f"{_where(worst, self.units)}."
        )

    def _of(self, outcome: Outcome) -> Iterator[Check]:
        """Yield the checks of all parts with an outcome, the most used first."""
        found = [check for part in self.parts for check in part.counted if check.outcome == outcome]
        yield from sorted(found, key=lambda check: -(check.utilisation or np.inf))

    @property
    def open_questions(self) -> tuple[str, ...]:
        """Quantities that cannot be judged from the study and are not required."""
        return _questions(
            check for part in self.parts for check in part.checks if check not in part.counted
        )

    @property
    def advice(self) -> tuple[str, ...]:
        """Remedies for checks that are not met, each once."""
        return _questions(check for check in self._of("not met") if check.reason)


def joint_verdict(checks: Iterable[Check], units: Units, missing: str = "") -> JointVerdict:
    """Return the verdict from the checks of all bolts and interfaces, in their order."""
    parts: dict[tuple[PartKind, str], list[Check]] = {}
    for check in checks:
        parts.setdefault((check.kind, check.part), []).append(check)
    return JointVerdict(
        parts=tuple(
            PartVerdict(part=name, kind=kind, checks=tuple(found))
            for (kind, name), found in parts.items()
        ),
        units=units,
        missing=missing,
    )


COLUMNS = ("part", "verdict", "used", "by", "where", "all checks")
"""Columns of the table of a verdict."""


def verdict_rows(verdict: JointVerdict) -> list[tuple[str, ...]]:
    """Return the rows of the table of a verdict, as text."""
    return [tuple(_row(part, verdict.interfaces, verdict.units)) for part in verdict.parts]


def _row(part: PartVerdict, interfaces: Sequence[str], units: Units) -> Iterator[str]:
    worst = part.worst
    yield part.part
    yield part.outcome
    if worst is None:
        yield from ("—", "—", "—")
    else:
        yield share_used(worst)
        amount = amount_of(worst) if worst.outcome == "not met" else ""
        shown = shown_quantity(worst, interfaces)
        yield f"{shown}: {amount}" if amount else shown
        yield place_of(worst, units) or "—"
    shares = (f"{shown_quantity(check, interfaces)} {share_used(check)}" for check in part.checks)
    yield ", ".join(shares) or "—"


def shown_quantity(check: Check, interfaces: Sequence[str]) -> str:
    """Return the checked quantity, without the name of the only interface of a joint."""
    (name,) = interfaces if len(interfaces) == 1 else ("",)
    return check.quantity.removesuffix(f" at {name}") if name else check.quantity


def share_used(check: Check) -> str:
    """Return the utilisation in percent, or the outcome of a check without one."""
    if check.utilisation is None:
        amount = amount_of(check) if check.outcome == "unknown" else ""
        return f"{check.outcome} ({amount})" if amount else check.outcome
    if not np.isfinite(check.utilisation):
        return "lost"
    under = "< " if check.beyond else ""
    return f"{under}{percent(check.utilisation)}" if check.utilisation < 1e3 else "> 1000 ×"


def amount_of(check: Check) -> str:
    """Return value and limit as text; empty where a check has no value."""
    if check.value is None or check.limit is None:
        return ""
    value, limit = number(check.value, 4), as_given(check.limit)
    if check.quantity.startswith(AT_LEAST):
        return f"{quantity(check.value, check.unit, 4)}, {limit} needed"
    return f"{value} of {limit} {check.unit}".rstrip()


def place_of(check: Check, units: Units) -> str:
    """Return the decisive load case, instant and end of the scatter."""
    instant = "" if check.instant is None else f"at {quantity(check.instant, units.time)}"
    return ", ".join(filter(None, (f"{check.case} {instant}".strip(), check.scatter)))


def _where(check: Check, units: Units) -> str:
    place = place_of(check, units)
    return f", {place if place.startswith(REST) else f'in {place}'}" if place else ""


def _questions(checks: Iterable[Check]) -> tuple[str, ...]:
    """Return sentences on unknown quantities, their parts and reasons, each reason once."""
    parts: dict[tuple[str, str], dict[str, str]] = {}
    for check in checks:
        detail, colon, remedy = check.reason.rpartition(": ")
        parts.setdefault((check.quantity, remedy), {})[check.part] = detail + colon
    return tuple(_question(*key, details) for key, details in parts.items())


def _question(quantity: str, remedy: str, details: Mapping[str, str]) -> str:
    """Return a sentence on parts, with differences between them in brackets."""
    if len({*details.values()}) == 1:
        return f"{quantity} of {', '.join(details)}: {next(iter(details.values()))}{remedy}"
    names = (f"{part} ({detail.rstrip(': ')})" for part, detail in details.items())
    return f"{quantity} of {', '.join(names)}: {remedy}"


def _several(checks: Sequence[Check], verdict: JointVerdict) -> str:
    """Return a text on checks that are not met, with their utilisations."""
    said = [
        f"{check.part}, {shown_quantity(check, verdict.interfaces)} "
        f"{amount_of(check) or 'not met'}{_where(check, verdict.units)}"
        for check in checks[:MOST_NAMED]
    ]
    more = len(checks) - MOST_NAMED
    return "; ".join(said) + (f"; and {more} more below" if more > 0 else "")


def summarized(verdict: JointVerdict) -> dict[str, Any]:
    """Return the verdict in the form of ``summary.json``."""
    return {
        "holds": verdict.holds,
        "sentence": verdict.sentence,
        "advice": list(verdict.advice),
        "open_questions": list(verdict.open_questions),
        "table": [dict(zip(COLUMNS, row, strict=True)) for row in verdict_rows(verdict)],
        "parts": [
            {
                "part": part.part,
                "kind": part.kind,
                "outcome": part.outcome,
                "decides": None if part.worst is None else asdict(part.worst),
                "checks": [asdict(check) for check in part.checks],
            }
            for part in verdict.parts
        ],
    }
