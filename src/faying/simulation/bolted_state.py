"""The state of a joint while its bolts are turned: some loose, others locked or of known force."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.increment import Increment
from faying.digits import SOLVED
from faying.exceptions import ConvergenceError
from faying.iterations import MOST_TRIALS
from faying.joint.system import Joint
from faying.simulation.bolts_by_force import BoltsByForce, forces_of_bolts


@dataclass(frozen=True, eq=False, kw_only=True)
class BoltedState:
    """The state of a joint between two turns of its bolts.

    Attributes
    ----------
    nuts : (n_bolt,) [force]
        Initial forces set by the nuts.
    initial : (n_bolt,) [force]
        The same, except for loose bolts: the initial force of zero bolt force.
    loose : (n_bolt,)
        Whether a bolt would be in compression: its nut has lifted off its seat.
    slip : (2, n_point) [length]
        Slip so far.
    contact
        Contact state; None before the first turn.
    """

    joint: Joint
    nuts: Vector
    initial: Vector
    loose: Mask
    slip: Matrix
    contact: Increment | None

    def locked_at(self, nuts: Vector) -> "BoltedState":
        """Return the state after the nuts are set to other initial forces (n_bolt,)."""
        return self._equilibrium(nuts, np.empty(0, dtype=np.int64), np.empty(0))

    def tightened_to(self, bolts: Indices, forces: Vector) -> "BoltedState":
        """Return the state after bolts (n,) are tightened together to forces (n,)."""
        return self._equilibrium(self.nuts, bolts, forces)

    @property
    def forces(self) -> Vector:
        """Forces of all bolts (n_bolt,)."""
        if self.contact is None:
            return np.zeros(len(self.nuts))
        forces = forces_of_bolts(self.joint, self.initial, self.contact)
        return np.where(self.loose, 0.0, forces)

    def _equilibrium(self, nuts: Vector, bolts: Indices, forces: Vector) -> "BoltedState":
        """Return the state in equilibrium, with the bolts that are loose in it."""
        begun = self.contact is not None and self.contact.begun
        previous, loose = self.contact if begun else None, self.loose.copy()
        for _ in range(MOST_TRIALS):
            loose[bolts] = False
            by_force = np.append(np.flatnonzero(loose), bolts)
            goal = np.append(np.zeros(len(by_force) - len(bolts)), forces)
            problem = BoltsByForce(joint=self.joint, bolts=by_force)
            contact, initial = (
                problem.solve(goal, nuts, self.slip, previous)
                if len(by_force)
                else (problem.at(nuts, self.slip, previous), nuts)
            )
            nuts = np.where(np.isin(np.arange(len(nuts)), bolts), initial, nuts)
            reached = forces_of_bolts(self.joint, initial, contact)
            pushing = ~loose & (reached < -SOLVED * np.abs(reached).max())
            pulling = loose & (nuts > initial)
            if not (pushing | pulling).any():
                return BoltedState(
                    joint=self.joint,
                    nuts=nuts,
                    initial=initial,
                    loose=loose,
                    slip=self.slip + contact.slack[1:],
                    contact=contact,
                )
            loose = (loose | pushing) & ~pulling
        message = (
            f"bolts {', '.join(np.array(list(self.joint.bolts))[pushing | pulling])} come loose "
            "and tight again without end; tighten in smaller steps"
        )
        raise ConvergenceError(message)


def bolted_state(joint: Joint, initial: Vector) -> BoltedState:
    """Return the state of an unstressed joint with bolts locked at ``initial`` (n_bolt,)."""
    start = BoltedState(
        joint=joint,
        nuts=initial,
        initial=initial,
        loose=np.zeros(len(initial), dtype=bool),
        slip=np.zeros((2, joint.contact.n_points)),
        contact=None,
    )
    return start.locked_at(initial) if initial.any() else start
