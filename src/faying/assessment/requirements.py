"""Requirements on a joint under every load case, and their verdicts."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from faying.exceptions import ModelError

OPEN_BELOW = 0.5
"""Default share of the area pressed at rest below which an area is open."""


@dataclass(frozen=True, kw_only=True)
class ClosedRing:
    """A ring around a hole that must stay closed, see :mod:`faying.assessment.sealing`.

    Attributes
    ----------
    around : [length]
        A point in the hole; the hole with the nearest edge is taken.
    pressure : [force/length²]
        Least pressure of the ring, above zero in any case.
    interface
        Interface of the ring; None is the only one.

    Examples
    --------
    >>> import faying as fy
    >>> ring = fy.ClosedRing(around="bolt", pressure=2.0)
    >>> len(fy.Requirements(closed_ring=(ring,)).closed_ring)
    1
    """

    around: tuple[float, float, float]
    pressure: float = 0.0
    interface: str | None = None


@dataclass(frozen=True, kw_only=True)
class Requirements:
    """Requirements in every load case; None is no requirement.

    Attributes
    ----------
    min_clamp_force : [force]
        Least total normal force of an interface, or one for each named interface.
    max_pressure : [force/length²]
        Largest pressure of a contact point.
    max_nodal_pressure : [force/length²]
        Largest average pressure around a node.
    no_opening_within : [length]
        Distance from the axis of a bolt within which all points under preload pressure stay closed.
    min_opening_factor
        Least factor of a static load at which an interface, or its part nearest to a bolt, opens.
    open_below
        Share of the area under preload pressure below which it is open; by default half.
    min_slip_safety
        Least S_G = μ / μ_needed under static loads, without lateral forces of bolts.
    min_sliding_factor
        Least factor of a static load or cycle with friction at which an interface slides as a
        whole, with lateral forces of bolts.
    slip_friction
        μ for the check of interfaces without friction, or one for each named interface.
    closed_ring
        Rings around holes that must stay closed.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> demanded = fy.Requirements(min_clamp_force=8e3)
    >>> fy.assess(joint, [fy.Load({"tip.Fz": -100.0})], demanded).met
    True
    """

    min_clamp_force: float | Mapping[str, float] | None = None
    max_pressure: float | None = None
    max_nodal_pressure: float | None = None
    no_opening_within: float | None = None
    min_opening_factor: float | None = None
    open_below: float | None = None
    min_slip_safety: float | None = None
    min_sliding_factor: float | None = None
    slip_friction: float | Mapping[str, float] | None = None
    closed_ring: tuple[ClosedRing, ...] = ()

    @property
    def open_share(self) -> float:
        """Share of the area pressed at rest below which an area is open."""
        return OPEN_BELOW if self.open_below is None else self.open_below


def misnamed(
    requirements: Requirements, interfaces: Sequence[str], smooth_interfaces: Sequence[str]
) -> Iterator[tuple[str, str]]:
    """Yield the requirements on unknown interfaces, and a message for each.

    Smooth interfaces have no friction law.
    """
    limits, frictions = requirements.min_clamp_force, requirements.slip_friction
    named = [("min_clamp_force", n) for n in (limits if isinstance(limits, Mapping) else ())]
    named += [
        ("closed_ring", ring.interface) for ring in requirements.closed_ring if ring.interface
    ]
    for key, name in named:
        if name not in interfaces:
            yield key, f"there is no interface '{name}'; there are {', '.join(interfaces)}"
    if len(interfaces) > 1 and any(ring.interface is None for ring in requirements.closed_ring):
        names = ", ".join(interfaces)
        yield "closed_ring", f"there are several interfaces, {names}; add 'interface'"
    for name in frictions if isinstance(frictions, Mapping) else ():
        if name not in smooth_interfaces:
            names = ", ".join(smooth_interfaces) or "none"
            yield (
                "slip_friction",
                f"there is no interface '{name}' without friction; there are {names}",
            )


def check_names(
    requirements: Requirements, interfaces: Sequence[str], smooth_interfaces: Sequence[str]
) -> None:
    """Refuse requirements on unknown interfaces."""
    wrong = [
        f"{key}: {text}" for key, text in misnamed(requirements, interfaces, smooth_interfaces)
    ]
    if wrong:
        raise ModelError("\n".join(wrong))


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """The verdict on one requirement in its most critical place and case.

    Attributes
    ----------
    requirement
        Its key in the study.
    met
        Whether it is met; None if unknown.
    place
        Interface or bolt.
    case
        Load case.
    value
        Most critical value, in the unit of the key; for openings the smallest pressure near a
        bolt, which must stay above zero; NaN if unknown.
    limit
        Limit in the study.
    reason
        Why it is unknown; empty if it is known.
    """

    requirement: str
    met: bool | None
    place: str
    case: str
    value: float
    limit: float
    reason: str = ""

    @classmethod
    def at_least(
        cls, requirement: str, location: str, case: str, value: float, limit: float
    ) -> "Verdict":
        """Return the verdict on a value with a lower limit."""
        met = value >= limit
        return cls(
            requirement=requirement, met=met, place=location, case=case, value=value, limit=limit
        )

    @classmethod
    def unknown(cls, requirement: str, limit: float, reason: str, location: str = "") -> "Verdict":
        """Return the verdict on a requirement that cannot be judged."""
        return cls(
            requirement=requirement,
            met=None,
            place=location,
            case="",
            value=math.nan,
            limit=limit,
            reason=reason,
        )
