"""Joints whose bolts are known by their forces: initial forces are unknown beside contact.

A bolt of stiffness k whose force is T has the initial force N₀ = T − k e (e its elongation): the
structure without the bolt's spring, pulled together by T. With y₀ and e₀ what everything else does
and c, ι the displacement of pairs and bolt per initial force, one contact problem gives both,

    Σ (y − y₀) + z N₀ = Gᵀ λ,   zᵀ (y − y₀) + M N₀ = T/k − e₀,                               (T1)
    z = Σ c,   M = 1/k − ι + cᵀ Σ c,

so that Σ becomes Σ − z M⁻¹ zᵀ: a change of rank one for each bolt.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import cast, final

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Indices, Matrix, Vector
from faying.contact.glued_pairs import GluedPairs
from faying.contact.increment import Increment
from faying.contact.newton_descent import solve_yielding
from faying.contact.sparse_pairs import SparsePairs
from faying.contact.yielding import YieldingContact
from faying.exceptions import ConvergenceError
from faying.joint.system import Joint

MOST_TRIALS = 30
"""Initial forces tried until bolts have their forces; 3 to 5 are usual."""

FORCE_TOLERANCE = 1e-10
"""Deviation of a bolt force from its target over the largest target, at which trials end.

Round-off leaves 1e-12 where contact alone holds a part and springs of 1 N/mm its rigid motion.
"""

LAST_DIGITS = 1e-15
"""What round-off leaves of a bolt force, over the initial force: some units in the last place."""

LEAST_SHARE = 1e-3
"""Bolt force per initial force at least, of a bolt that must close a gap first."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class BoltsByForce:
    """The contact problem of a joint some of whose bolts are known by their forces.

    Attributes
    ----------
    joint
        Without a reduced set of contact forces.
    bolts : (n_known,)
        Their numbers.
    """

    joint: Joint
    bolts: Indices

    def solve(
        self, forces: Vector, locked: Vector, slip: Matrix | float, start: Increment | None
    ) -> tuple[Increment, Vector]:
        """Return where contact stands, and the initial forces of all bolts (n_bolt,).

        Forces T (n_known,) [force] are known; of locked bolts the initial forces (n_bolt,) [force]
        are. Slip so far is (2, n_point) [length]. The start is the increment before, or a similar
        one.

        Raises
        ------
        ConvergenceError
            If nothing resists the bolts, or contact is not solved.

        Notes
        -----
        One contact problem. Where contact is hard, or the compliance between pairs singular, one
        for each of some trials.
        """
        others = locked.copy()
        others[self.bolts] = 0.0
        try:
            increment = self._at_once(forces, others, slip, start)
        except (LinAlgError, ConvergenceError):
            increment = None
        return self._by_trial(forces, locked, slip, start) if increment is None else increment

    def _at_once(
        self, forces: Vector, others: Vector, slip: Matrix | float, start: Increment | None
    ) -> tuple[Increment, Vector] | None:
        """Solve (T1) where contact yields and Σ exists."""
        ports, solver = self.joint.port_compliance, self.joint.static_contact.increments
        if not isinstance(solver, YieldingContact) or solver.shapes is not None:
            return None
        free = -others @ ports.contact_columns[ports.bolts]
        rows = ports.input_rows[ports.bolts, ports.bolts]
        elongations = forces / self._stiffness + rows[self.bolts] @ others
        pairs, shapes, yields = self._loosened
        pull = shapes.T @ np.linalg.solve(yields, elongations)
        offset = self.joint.contact.offset(slip)
        increment = solve_yielding(solver.laws, pairs, free, offset, start, pull=pull)
        initial = others.copy()
        initial[self.bolts] = np.linalg.solve(
            yields, elongations - shapes @ (increment.moved - free)
        )
        return increment, initial

    def _by_trial(
        self, forces: Vector, locked: Vector, slip: Matrix | float, start: Increment | None
    ) -> tuple[Increment, Vector]:
        """Find the initial forces by a quasi-Newton method, a contact problem for each trial.

        C. G. Broyden, Math. Comp. 19 (1965) 577, doi:10.1090/S0025-5718-1965-0198670-6.
        """
        initial, slope = locked.copy(), np.eye(len(self.bolts))
        initial[self.bolts] = np.maximum(initial[self.bolts], forces)
        tolerance = FORCE_TOLERANCE * np.abs(forces).max()
        increment = self.at(initial, slip, start)
        reached = forces_of_bolts(self.joint, initial, increment)[self.bolts]
        for trial in range(MOST_TRIALS):
            miss = forces - reached
            if np.abs(miss).max() <= max(tolerance, LAST_DIGITS * np.abs(initial).max()):
                return increment, initial
            if trial == 0:
                # Without gaps forces are in proportion to initial ones.
                slope = np.diag(np.maximum(reached / initial[self.bolts], LEAST_SHARE))
            change = np.linalg.solve(slope, miss)
            initial = initial.copy()
            initial[self.bolts] += change
            increment, previous = self.at(initial, slip, start), reached
            reached = forces_of_bolts(self.joint, initial, increment)[self.bolts]
            unexpected = reached - previous - slope @ change
            slope = slope + np.outer(unexpected, change) / (change @ change)
        worst = int(np.abs(miss).argmax())
        message = (
            f"bolt '{list(self.joint.bolts)[self.bolts[worst]]}' cannot be tightened to "
            f"{forces[worst]:g}: what it pulls at gives way; check that it clamps an interface"
        )
        raise ConvergenceError(message)

    def at(self, initial: Vector, slip: Matrix | float, start: Increment | None) -> Increment:
        """Return where contact stands with all initial forces (n_bolt,) given."""
        ports, contact = self.joint.port_compliance, self.joint.contact
        free, offset = -initial @ ports.contact_columns[ports.bolts], contact.offset(slip)
        return self.joint.static_contact.increments.solve(free, offset, start)

    @property
    def _stiffness(self) -> Vector:
        """K (n_known,)."""
        every = list(self.joint.bolts.values())
        return np.array([every[bolt].stiffness for bolt in self.bolts])

    @cached_property
    def _loosened(self) -> tuple[GluedPairs | SparsePairs, Matrix, Matrix]:
        """The pairs without the springs of the known bolts, z and M."""
        pairs = cast("YieldingContact", self.joint.static_contact.increments).pairs
        ports, bolts = self.joint.port_compliance, self.bolts
        columns = ports.contact_columns[ports.bolts][bolts]
        rows = ports.input_rows[ports.bolts, ports.bolts]
        shapes = np.array([pairs.resisted(column) for column in columns])
        core = np.diag(1.0 / self._stiffness) - rows[np.ix_(bolts, bolts)]
        yields = core + columns @ shapes.T
        return pairs.loosened(shapes, yields), shapes, yields


def forces_of_bolts(system: Joint, initial: Vector, contact: Increment) -> Vector:
    """Return the forces of all bolts (n_bolt,), locked at initial forces where contact stands."""
    ports = system.port_compliance
    pressed = system.contact.at_pairs(contact.forces[0], contact.forces[1:])
    elongation = ports.contact_columns[ports.bolts] @ pressed
    elongation = elongation - ports.input_rows[ports.bolts, ports.bolts] @ initial
    stiffness = np.array([bolt.stiffness for bolt in system.bolts.values()])
    return np.asarray(stiffness * elongation + initial)
