"""One check of a bolt or an interface: how much of what it bears is used, and what decides."""

from dataclasses import dataclass, replace
from typing import Literal, final

import numpy as np

Outcome = Literal["met", "not met", "unknown"]
"""What a check says."""

PartKind = Literal["bolt", "interface"]
"""What is checked of a joint."""


@final
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
        What is checked, in an engineer's words: ``"yield"``, ``"fatigue"``, ``"slip"``.
    outcome
        Whether the check is met.
    utilisation : [1]
        Share of what is allowed that is used; above 1 the check is not met. None where it is
        unknown, or where the check is a yes or no.
    value
        What was found, in ``unit``.
    limit
        What is allowed, in ``unit``.
    unit
        Of value and limit; empty for ratios.
    case
        Name of the load case that decides.
    instant : [time]
        Instant of that case that decides; None for a static case.
    scatter
        End of the scatter that decides, ``"P_p,min"``; empty where nothing scatters.
    reason
        Why the outcome is unknown, or what to do where the check is not met.
    source
        Clause and equation of the standard that the check follows.
    required
        Whether the study demands it; strength is checked in any case.
    bound
        Whether the value bounds the discretized model over the scatter; else it is a sample.
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

    def at_most(self, value: float, limit: float) -> "Check":
        """Return the check that a value does not exceed a limit."""
        return replace(
            self,
            outcome="met" if value <= limit else "not met",
            utilisation=value / limit if limit > 0 else None,
            value=value,
            limit=limit,
        )

    def at_least(self, value: float, limit: float) -> "Check":
        """Return the check that a value reaches a limit; no case decides one that is infinite."""
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
    """Return the check that decides: not met before unknown before met, then most utilised."""
    order = {"not met": 2, "unknown": 1, "met": 0}
    return max(
        checks,
        key=lambda check: (order[check.outcome], check.utilisation or 0.0),
        default=None,
    )
