"""Where transients stand, one by one and side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.state import ContactState
from faying.simulation.energy_guard import EnergyLedger
from faying.simulation.integrators import Motion

MOST_LEVELS = 3
"""Step lengths whose contact is handed on: an interval tries two, and may go back to a third.

A factor of each is in memory, n_pair (n_pair + n_point) numbers.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class Handed:
    """What the contact problems of steps of one length hand on.

    Attributes
    ----------
    contact
        Points that they expect in contact, and what was made for them.
    trend : (n_point,) [length]
    """

    contact: ContactState
    trend: Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class Restart:
    """Where a transient stands: all that the steps to come depend on.

    Attributes
    ----------
    done
        Steps behind it.
    motion
        Displacement, velocity, acceleration, force and contact forces there.
    contact
        Points expected in contact at the next instant, and what their solver hands on.
    trend : (n_point,) [length]
        How forces and slacks changed, see :func:`~.instants.expected`; NaN before the first step.
    ledger
        Of its energy; None before the first step.
    level
        Halvings of the next step to begin with, where steps are divided.
    peak
        Largest pressure so far, where steps are divided [force/length²].
    levels
        Where steps are divided: what those of some numbers of halvings have handed on, those
        taken last at the end.
    """

    done: int
    motion: Motion
    contact: ContactState
    trend: Vector
    ledger: EnergyLedger | None = None
    level: int = 0
    peak: float = 0.0
    levels: Mapping[int, Handed] = field(default_factory=dict)


def side_by_side(motions: Sequence[Motion]) -> Motion:
    """Return the motions of all cases as one, with one case a column."""
    names = [one.name for one in fields(Motion)]
    return Motion(*(np.array([getattr(motion, name) for motion in motions]).T for name in names))


def each_of(
    done: int, motion: Motion, states: Sequence[ContactState], trend: Matrix
) -> list[Restart]:
    """Return where each of the transients side by side stands."""
    columns = zip(*(values.T for values in vars(motion).values()), strict=True)
    return [
        Restart(done=done, motion=Motion(*parts), contact=state, trend=past)
        for parts, state, past in zip(columns, states, trend, strict=True)
    ]


def kept_restart(restart: Restart) -> dict[str, Matrix]:
    """Return arrays from which :func:`restart_from` makes the same restart; numbers are 0-d.

    The compliance that contact was last solved with is not among them: it is formed again.
    """
    contact = restart.contact
    arrays: dict[str, Any] = vars(restart.motion) | {
        **_kept_points(contact),
        "trend": restart.trend,
        "done": restart.done,
        "level": restart.level,
        "peak": restart.peak,
    }
    if contact.slip is not None and contact.forces is not None:
        arrays |= {"slip": contact.slip, "forces": contact.forces}
    if contact.moved is not None:
        arrays |= {"pairs_moved": contact.moved}
    if contact.at_end is not None:
        arrays |= {f"end_{name}": kept for name, kept in _kept_points(contact.at_end).items()}
    if restart.levels:
        arrays |= _kept_levels(restart.levels)
    if restart.ledger is not None:
        arrays |= asdict(restart.ledger)
    return {name: np.asarray(value) for name, value in arrays.items()}


def restart_from(arrays: Mapping[str, Any]) -> Restart:
    """Return the restart that :func:`kept_restart` kept, with an energy ledger."""
    return Restart(
        done=int(arrays["done"]),
        motion=Motion(**{one.name: arrays[one.name] for one in fields(Motion)}),
        contact=replace(
            _points_from(arrays),
            slip=arrays.get("slip"),
            forces=arrays.get("forces"),
            moved=arrays.get("pairs_moved"),
            at_end=_points_from(arrays, "end_") if "end_active" in arrays else None,
        ),
        trend=arrays["trend"],
        ledger=EnergyLedger(**{one.name: float(arrays[one.name]) for one in fields(EnergyLedger)}),
        # Histories of earlier versions know of no divided steps.
        level=int(arrays.get("level", 0)),
        peak=float(arrays.get("peak", 0.0)),
        levels=_levels_from(arrays) if "levels" in arrays else {},
    )


def _kept_points(contact: ContactState) -> dict[str, Any]:
    supported = contact.active if contact.supported is None else contact.supported
    return {
        "active": contact.active,
        "supported": supported,
        "steady": contact.steady,
        "is_supported": contact.supported is not None,
    }


def _points_from(arrays: Mapping[str, Any], prefix: str = "") -> ContactState:
    names = ("active", "supported", "steady", "is_supported")
    active, supported, steady, is_supported = (arrays[prefix + name] for name in names)
    return ContactState(
        active=active, supported=supported if is_supported else None, steady=bool(steady)
    )


def _kept_levels(levels: Mapping[int, Handed]) -> dict[str, Any]:
    """Return arrays of as many rows whatever is handed on, for a file is written over."""
    kept = [
        {**_kept_points(one.contact), "trend": one.trend, "levels": level}
        for level, one in levels.items()
    ]
    rows = kept + [{**kept[0], "levels": -1}] * (MOST_LEVELS - len(kept))
    return {
        name if name == "levels" else f"level_{name}": np.array([row[name] for row in rows])
        for name in kept[0]
    }


def _levels_from(arrays: Mapping[str, Any]) -> dict[int, Handed]:
    rows = {name: kept for name, kept in arrays.items() if name.startswith("level_")}
    return {
        int(level): Handed(
            contact=_points_from({name: kept[row] for name, kept in rows.items()}, "level_"),
            trend=rows["level_trend"][row],
        )
        for row, level in enumerate(arrays["levels"])
        if level >= 0
    }
