"""Histories of transients side by side, and the memory for them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix
from faying.exceptions import refuse_model
from faying.joint.system import System
from faying.linalg.memory import require_room
from faying.simulation.integrators import Motion
from faying.simulation.path_steps import PathStep
from faying.simulation.solution import Solution

MOST_TIME_STEPS = 10**9
"""Most steps of a response: 20 minutes at a microsecond each, the least time of a step, and eight
gigabytes for their times alone."""


def check_times(step: float, duration: float) -> None:
    """Refuse a step that is not positive or is longer than the duration."""
    if not 0 < step <= duration:
        refuse_model(
            f"the time step is {step:g} and the duration {duration:g}; "
            "the step must be positive and no longer than the duration"
        )
    if not duration / step <= MOST_TIME_STEPS:
        refuse_model(
            f"the duration {duration:g} takes {duration / step:.4g} steps of {step:g}, and "
            f"{MOST_TIME_STEPS} are the most; enlarge the step"
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Instants:
    """Histories of transients side by side; every array begins with case and instant.

    Without friction the arrays of shear and slip have no rows.
    """

    states: Matrix
    velocities: Matrix
    accelerations: Matrix
    forces: Matrix
    gaps: Matrix
    iterations: Indices
    shear: Matrix
    slip: Matrix
    dissipation: Matrix

    @classmethod
    def empty(cls, n_case: int, n_time: int, system: System) -> "Instants":
        """Return uninitialized histories for some cases and instants of a system."""
        shape, n_dof, n_point = (n_case, n_time), system.K.shape[0], system.contact.n_points
        along = (*shape, system.contact.components - 1, n_point)
        return cls(
            states=np.zeros((*shape, n_dof)),
            velocities=np.zeros((*shape, n_dof)),
            accelerations=np.zeros((*shape, n_dof)),
            forces=np.zeros((*shape, n_point)),
            gaps=np.zeros((*shape, n_point)),
            iterations=np.zeros(shape, dtype=np.int64),
            shear=np.zeros(along),
            slip=np.zeros(along),
            dissipation=np.zeros(shape),
        )

    def begin(self, motion: Motion, starts: Sequence[Solution]) -> None:
        """Write the first instant, at which the transients start."""
        self.states[:, 0], self.accelerations[:, 0] = motion.u.T, motion.a.T
        self.forces[:, 0] = [start.contact_forces for start in starts]
        self.gaps[:, 0] = [start.gap for start in starts]
        self.shear[:, 0] = [start.shear_forces for start in starts]
        self.slip[:, 0] = [start.shear_slip for start in starts]

    def of_case(self, case: int) -> "Instants":
        """Return the histories of one case, as views to write to."""
        parts = {name: array[case : case + 1] for name, array in vars(self).items()}
        return Instants(**parts)

    def instants(self, first: int, end: int) -> "Instants":
        """Return the histories of some instants, as views to write to."""
        return Instants(**{name: array[:, first:end] for name, array in vars(self).items()})

    def note(self, n: int, motion: Motion, ends: Sequence[PathStep]) -> None:
        """Write an instant; the gaps hold slacks, from which penetrations are subtracted later."""
        self.states[:, n], self.velocities[:, n] = motion.u.T, motion.v.T
        self.accelerations[:, n] = motion.a.T
        along = slice(self.shear.shape[2])
        for case, end in enumerate(ends):
            contact = end.increment
            self.forces[case, n], self.gaps[case, n] = contact.forces[0], contact.slack[0]
            self.iterations[case, n] = end.iterations
            self.shear[case, n], self.slip[case, n] = contact.forces[1:][along], end.slip[along]
            self.dissipation[case, n] = end.dissipation


def require_history_room(n_case: int, n_time: int, system: System) -> None:
    """Refuse histories that exceed memory: displacement, its derivatives, forces and contact.

    Raises
    ------
    NotEnoughMemoryError
        With their size.
    """
    n_dof, n_point = system.K.shape[0], system.contact.n_points
    require_room(
        8.0 * n_case * n_time * (4 * n_dof + 2 * system.contact.components * n_point),
        f"histories of {n_case} responses with {n_time} instants of {n_dof} degrees of freedom "
        f"and {n_point} contact points",
        "shorten them, enlarge the step, or stream them in Python (stream_transient)",
    )


HISTORY_BYTES = 2 * 2**30
"""Memory that the histories of responses stepped side by side may take.

The same on every machine, because round-off depends on the number of responses.
"""


def runs_at_once(system: System, n_time: int, n_states: int | None = None) -> int:
    """Return how many histories of ``n_time`` instants fit into memory, at least one.

    Displacements and their derivatives are in memory at ``n_states`` instants together; by
    default at all.
    """
    contact, n_states = system.contact, n_time if n_states is None else n_states
    numbers = 3 * n_states * system.K.shape[0] + 2 * n_time * contact.components * contact.n_points
    return max(1, HISTORY_BYTES // (8 * int(numbers)))
