"""A check of a bolt or an interface: value, limit, utilisation, and the decisive case."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

Outcome = Literal["met", "not met", "unknown"]
"""Outcome of a check."""

PartKind = Literal["bolt", "interface"]
"""Kinds of checked parts of a joint."""


@dataclass(frozen=True, kw_only=True)
class Check:
    """One check of one part of a joint.

    Attributes
    ----------
    part
        Name of the bolt or the interface.
    kind
        Whether the part is a bolt or an interface.
    quantity
        Checked quantity, in an engineer's words: ``"yield"``, ``"fatigue"``, ``"slip"``.
    outcome
        Whether the check is met.
    utilisation : [1]
        Value over limit; above 1 the check is not met. None where it is unknown, or where the
        check has no number.
    value
        Computed value, in ``unit``.
    limit
        Allowed value, in ``unit``.
    unit
        Unit of value and limit; empty for ratios.
    case
        Name of the decisive load case.
    instant : [time]
        Decisive instant of that case; None for a static case.
    scatter
        Decisive end of the scatter, ``"P_p,min"``; empty without scatter.
    reason
        Why the outcome is unknown, or a remedy where the check is not met.
    source
        Clause and equation of the standard that the check follows.
    required
        Whether the study requires the check; strength is checked in any case.
    bound
        Whether the value is a bound over the scatter for the discretized model; else a sample.
    beyond
        Whether the value is the largest load factor that was tried, and the true one is above.
    """

    part: str
    kind: PartKind
    quantity: str
    outcome: Outcome = "unknown"
    utilisation: float | None = None
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    case: str = ""
    instant: float | None = None
    scatter: str = ""
    reason: str = ""
    source: str = ""
    required: bool = False
    bound: bool = False
    beyond: bool = False

    def at_most(self, value: float, limit: float) -> "Check":
        """Return the check of a value against an upper limit."""
        return replace(
            self,
            outcome="met" if value <= limit else "not met",
            utilisation=value / limit if limit > 0 else None,
            value=value,
            limit=limit,
        )

    def at_least(self, value: float, limit: float) -> "Check":
        """Return the check of a value against a lower limit; an infinite value has no case."""
        finite = bool(np.isfinite(value))
        return replace(
            self,
            outcome="met" if value >= limit else "not met",
            utilisation=limit / value if value > 0 else np.inf,
            value=value if finite else None,
            limit=limit,
            case=self.case if finite else "",
        )


def worst_check(checks: tuple[Check, ...]) -> Check | None:
    """Return the decisive check: not met before unknown before met, then by utilisation."""
    order = {"not met": 2, "unknown": 1, "met": 0}
    return max(
        checks,
        key=lambda check: (order[check.outcome], check.utilisation or 0.0),
        default=None,
    )
