"""Checks of bolts by safeties that a study demands, in the symbols of VDI 2230."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import final

from faying.assessment.check import Check


@final
@dataclass(frozen=True, kw_only=True)
class Safeties:
    """Least safeties.

    Attributes
    ----------
    yields
        S_F.
    fatigue
        S_D.
    pressure
        S_p, under the head.
    """

    yields: float = 1.0
    fatigue: float = 1.0
    pressure: float = 1.0


def with_safeties(checks: Iterable[Check], demanded: Safeties) -> Iterator[Check]:
    """Yield checks whose limits are what is borne over the safety that is demanded."""
    safeties = {
        "yield": demanded.yields,
        "fatigue": demanded.fatigue,
        "pressure under the head": demanded.pressure,
    }
    for check in checks:
        safety = safeties.get(check.quantity)
        if safety is None or check.value is None or check.limit is None:
            yield check
            continue
        judged = replace(check, required=True).at_most(check.value, check.limit / safety)
        unknown = check.outcome == "unknown"
        yield replace(judged, outcome="unknown", utilisation=None) if unknown else judged
