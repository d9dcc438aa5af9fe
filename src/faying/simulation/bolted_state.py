"""Joints while their bolts are turned: some loose, the others locked or known by their forces."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.increment import Increment
from faying.digits import SOLVED
from faying.exceptions import ConvergenceError
from faying.iterations import MOST_TRIALS
from faying.joint.system import Joint
from faying.simulation.bolts_by_force import BoltsByForce, forces_of_bolts


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class BoltedState:
    """A joint on its way.

    Attributes
    ----------
    nuts : (n_bolt,) [force]
        Initial forces as the nuts stand.
    initial : (n_bolt,) [force]
        The same, but of loose bolts what takes their force to zero.
    loose : (n_bolt,)
        Whether a bolt would have to push: its nut has come off its seat.
    slip : (2, n_point) [length]
        So far.
    contact
        Where it stands; None before anything was turned.
    """

    joint: Joint
    nuts: Vector
    initial: Vector
    loose: Mask
    slip: Matrix
    contact: Increment | None

    def locked_at(self, nuts: Vector) -> "BoltedState":
        """Return the joint with its nuts elsewhere (n_bolt,)."""
        return self._settled(nuts, np.empty(0, dtype=np.int64), np.empty(0))

    def brought(self, bolts: Indices, forces: Vector) -> "BoltedState":
        """Return the joint with bolts (n,) tightened together to forces (n,)."""
        return self._settled(self.nuts, bolts, forces)

    @property
    def forces(self) -> Vector:
        """Of all bolts (n_bolt,)."""
        if self.contact is None:
            return np.zeros(len(self.nuts))
        forces = forces_of_bolts(self.joint, self.initial, self.contact)
        return np.where(self.loose, 0.0, forces)

    def _settled(self, nuts: Vector, bolts: Indices, forces: Vector) -> "BoltedState":
        """Find which bolts are loose, and where contact stands with them."""
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
    """Return an unstressed joint after its bolts were locked at initial forces (n_bolt,)."""
    start = BoltedState(
        joint=joint,
        nuts=initial,
        initial=initial,
        loose=np.zeros(len(initial), dtype=bool),
        slip=np.zeros((2, joint.contact.n_points)),
        contact=None,
    )
    return start.locked_at(initial) if initial.any() else start
