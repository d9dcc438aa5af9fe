"""Restarts of transients, one by one and side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np

from faying._typing import Matrix
from faying.contact.state import ContactState
from faying.simulation.energy_guard import EnergyLedger
from faying.simulation.integrators import Motion


@dataclass(frozen=True, eq=False, kw_only=True)
class Restart:
    """The state of a transient that determines all steps to come.

    Attributes
    ----------
    done
        Steps done so far.
    motion
        Displacement, velocity, acceleration, force and contact forces there.
    contact
        Contact state, from which the next step starts.
    ledger
        Energy balance so far; None before the first step.
    level
        Halvings of the next step to begin with, where steps are divided.
    peak
        Largest pressure so far, where steps are divided [force/length²].
    """

    done: int
    motion: Motion
    contact: ContactState
    ledger: EnergyLedger | None = None
    level: int = 0
    peak: float = 0.0


def side_by_side(motions: Sequence[Motion]) -> Motion:
    """Return the motions of several cases as one motion, with one case a column."""
    names = [entry.name for entry in fields(Motion)]
    return Motion(*(np.array([getattr(motion, name) for motion in motions]).T for name in names))


def each_of(done: int, motion: Motion, states: Sequence[ContactState]) -> list[Restart]:
    """Return the restart of each transient from a motion of all."""
    columns = zip(*(values.T for values in vars(motion).values()), strict=True)
    return [
        Restart(done=done, motion=Motion(*parts), contact=state)
        for parts, state in zip(columns, states, strict=True)
    ]


def kept_restart(restart: Restart) -> dict[str, Matrix]:
    """Return a restart as arrays for :func:`restart_from`; numbers are 0-d."""
    contact = restart.contact
    arrays: dict[str, Any] = vars(restart.motion) | {
        "active": contact.active,
        "done": restart.done,
        "level": restart.level,
        "peak": restart.peak,
    }
    names = {"slip": "slip", "forces": "forces", "pairs_moved": "moved", "supported": "supported"}
    arrays_of_contact = {name: getattr(contact, attribute) for name, attribute in names.items()}
    arrays |= {name: value for name, value in arrays_of_contact.items() if value is not None}
    if restart.ledger is not None:
        arrays |= asdict(restart.ledger)
    return {name: np.asarray(value) for name, value in arrays.items()}


def restart_from(arrays: Mapping[str, Any]) -> Restart:
    """Return the restart stored by :func:`kept_restart`, with its energy ledger."""
    return Restart(
        done=int(arrays["done"]),
        motion=Motion(**{entry.name: arrays[entry.name] for entry in fields(Motion)}),
        contact=ContactState(
            active=arrays["active"],
            supported=arrays.get("supported"),
            slip=arrays.get("slip", 0.0),
            forces=arrays.get("forces"),
            moved=arrays.get("pairs_moved"),
        ),
        ledger=EnergyLedger(
            **{entry.name: float(arrays[entry.name]) for entry in fields(EnergyLedger)}
        ),
        # Histories of earlier versions have no divided steps.
        level=int(arrays.get("level", 0)),
        peak=float(arrays.get("peak", 0.0)),
    )
