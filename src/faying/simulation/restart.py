"""Where transients stand, one by one and side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.state import ContactState
from faying.simulation.energy_guard import EnergyLedger
from faying.simulation.integrators import Motion


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
    """

    done: int
    motion: Motion
    contact: ContactState
    trend: Vector
    ledger: EnergyLedger | None = None
    level: int = 0
    peak: float = 0.0


def side_by_side(motions: Sequence[Motion]) -> Motion:
    """Return the motions of all cases as one, with one case a column."""
    names = [field.name for field in fields(Motion)]
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
    supported = contact.active if contact.supported is None else contact.supported
    arrays: dict[str, Any] = vars(restart.motion) | {
        "active": contact.active,
        "supported": supported,
        "trend": restart.trend,
        "done": restart.done,
        "level": restart.level,
        "peak": restart.peak,
        "steady": contact.steady,
        "is_supported": contact.supported is not None,
    }
    if contact.slip is not None and contact.forces is not None:
        arrays |= {"slip": contact.slip, "forces": contact.forces}
    if restart.ledger is not None:
        arrays |= asdict(restart.ledger)
    return {name: np.asarray(value) for name, value in arrays.items()}


def restart_from(arrays: Mapping[str, Any]) -> Restart:
    """Return the restart that :func:`kept_restart` kept, with an energy ledger."""
    return Restart(
        done=int(arrays["done"]),
        motion=Motion(**{field.name: arrays[field.name] for field in fields(Motion)}),
        contact=ContactState(
            active=arrays["active"],
            supported=arrays["supported"] if arrays["is_supported"] else None,
            steady=bool(arrays["steady"]),
            slip=arrays.get("slip"),
            forces=arrays.get("forces"),
        ),
        trend=arrays["trend"],
        ledger=EnergyLedger(
            **{field.name: float(arrays[field.name]) for field in fields(EnergyLedger)}
        ),
        # Histories of earlier versions know of no divided steps.
        level=int(arrays.get("level", 0)),
        peak=float(arrays.get("peak", 0.0)),
    )
