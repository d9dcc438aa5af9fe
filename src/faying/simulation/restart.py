"""Where transients stand, one by one and side by side."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

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
