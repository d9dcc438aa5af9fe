"""Restarts of transients, one by one and side by side."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

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
