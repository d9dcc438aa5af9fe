"""Tightening plans: the force to which each bolt is tightened in turn, so that all meet targets.

Tightening a bolt closes the joint beside it and relaxes the bolts before it (elastic interaction).
Final forces depend on the initial forces N₀ alone, which turns of the nuts set. The plan solves for
the N₀ of all targets together (T1), turns each nut straight to its N₀, and reports the bolt force
at its turn. A bolt that would be in compression meanwhile is loose. With friction final forces
depend on the sequence too: the plan follows the whole sequence until the targets are met.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Frozen, Indices, Matrix, Vector
from faying.digits import SHOWN_DIGITS
from faying.exceptions import ConvergenceError, refuse_model
from faying.iterations import MOST_TRIALS
from faying.joint.smooth_joint import smooth_joint
from faying.joint.system import Joint, initial_bolt_forces
from faying.simulation.bolted_state import BoltedState, bolted_state
from faying.simulation.bolts_by_force import BoltsByForce
from faying.simulation.tightening import checked_bolts


@dataclass(frozen=True, eq=False, kw_only=True)
class TighteningPlan(Frozen):
    """A sequence of turns, each of one bolt, that brings all bolts to their targets.

    Attributes
    ----------
    targets : [force]
        Bolt to its final force, in the order of each pass.
    bolts
        All bolts of the joint, in the order of the columns of forces.
    turned
        Bolt of each turn.
    passes : (n_turn,)
        Pass of each turn, from 1.
    settings : (n_turn,) [force]
        Force of the bolt at the end of its turn: the setting of wrench or tensioner.
    bolt_forces : (n_turn, n_bolt) [force]
        Forces of all bolts after each turn.
    unplanned : (n_target, n_bolt) [force]
        The same without a plan: each bolt is tightened to its target once, in the same order.
    initial_forces : [force]
        Bolt to the N₀ it is locked at in the end.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(
    ...     element_size=5.0, hole_radius=None, bolt_positions=((-10.0, 0.0), (10.0, 0.0))
    ... )
    >>> plan = fy.tightening_plan(joint, {"bolt-1": 10e3, "bolt-2": 10e3})
    >>> plan.targets
    {'bolt-1': 10000.0, 'bolt-2': 10000.0}
    """

    targets: Mapping[str, float]
    bolts: tuple[str, ...]
    turned: tuple[str, ...]
    passes: Indices
    settings: Vector
    bolt_forces: Matrix
    unplanned: Matrix
    initial_forces: Mapping[str, float]

    @property
    def shares(self) -> Vector:
        """Setting of each turn over the target of its bolt (n_turn,)."""
        return np.asarray(self.settings / [self.targets[name] for name in self.turned])

    @property
    def reached(self) -> Vector:
        """Final forces over the targets (n_target,)."""
        return self._over_targets(self.bolt_forces)

    @property
    def reached_unplanned(self) -> Vector:
        """Final forces without the plan over the targets (n_target,)."""
        return self._over_targets(self.unplanned)

    def _over_targets(self, forces: Matrix) -> Vector:
        columns = [self.bolts.index(name) for name in self.targets]
        return np.asarray(forces[-1, columns] / list(self.targets.values()))


def tightening_plan(
    system: Joint, forces: Mapping[str, float], *, passes: int = 1, increments: int = 10
) -> TighteningPlan:
    """Plan the force to which each bolt is tightened in turn, so that all meet their targets.

    Parameters
    ----------
    system
        Model before tightening: nuts are finger-tight until their turn. Bolts that are not named
        keep the initial force they are locked at.
    forces
        Bolt name to final axial force [force], in the order of every pass.
    passes
        Number of rounds. A largest setting over target of m in one round becomes about
        1 / (1 − rᴾ), r = 1 − 1/m, in P rounds: initial forces rise to shares (1 − rᵖ) / (1 − rᴾ)
        of the final ones, so that settings are equal in all rounds if forces are proportional.
    increments
        Steps of each turn with friction, as in :func:`faying.preload`.

    Raises
    ------
    ModelError
        As :func:`faying.tighten`, or if there is no bolt to tighten or no pass.
    ConvergenceError
        If contact is not solved, or friction keeps the targets from being met.

    Notes
    -----
    Without friction a contact problem for each turn and one for all bolts together. With friction
    ``increments`` problems for each turn, two to four times over, and one for each bolt.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(
    ...     element_size=5.0, hole_radius=None, bolt_positions=((-10.0, 0.0), (10.0, 0.0))
    ... )
    >>> plan = fy.tightening_plan(joint, {"bolt-1": 10e3, "bolt-2": 10e3})
    >>> plan.turned, bool(abs(plan.reached - 1).max() < 1e-9)
    (('bolt-1', 'bolt-2'), True)
    """
    names = checked_bolts(system, forces)
    if not forces or passes < 1 or increments < 1:
        refuse_model("a plan takes one bolt to tighten, one pass and one increment at least")
    chosen = np.array([names.index(name) for name in forces], dtype=np.int64)
    targets = np.array(list(forces.values()))
    sequence = _TurnSequence(system=system, bolts=chosen, increments=increments)
    single = sequence.initial_forces_for(targets)
    one_pass = sequence.bolt_forces_along(single, np.ones(1))
    highest = float((one_pass[np.arange(len(chosen)), chosen] / targets).max())
    shortfall = max(1.0 - 1.0 / highest, 0.0)
    shares = np.array(
        [(1.0 - shortfall**n) / (1.0 - shortfall**passes) for n in range(1, passes + 1)]
    )
    initial, reached = sequence.meet(targets, single, shares)
    return TighteningPlan(
        targets=dict(forces),
        bolts=tuple(names),
        turned=tuple(forces) * passes,
        passes=np.repeat(np.arange(1, passes + 1), len(chosen)),
        settings=reached[np.arange(len(reached)), np.tile(chosen, passes)],
        bolt_forces=reached,
        unplanned=sequence.unplanned_forces(targets),
        initial_forces=dict(zip(names, initial.tolist(), strict=True)),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _TurnSequence:
    """Sequences of turns of bolts, from the locked joint.

    Attributes
    ----------
    bolts : (n_target,)
        Numbers of the bolts that are turned, in order.
    """

    system: Joint
    bolts: Indices
    increments: int

    def initial_forces_for(self, targets: Vector) -> Vector:
        """Return initial forces (n_bolt,) of the targets together, without friction."""
        problem = BoltsByForce(joint=smooth_joint(self.system), bolts=self.bolts)
        return problem.solve(targets, initial_bolt_forces(self.system), 0.0, None)[1]

    def meet(self, targets: Vector, initial: Vector, shares: Vector) -> tuple[Vector, Matrix]:
        """Return initial forces whose sequence meets the targets, and the bolt forces on the way.

        With friction by a quasi-Newton method that starts with the slope without friction.
        """
        reached, slope = self.bolt_forces_along(initial, shares), None
        for _ in range(MOST_TRIALS):
            miss = targets - reached[-1, self.bolts]
            if (np.abs(miss) <= SHOWN_DIGITS * targets).all():
                return initial, reached
            if slope is None:
                columns = [
                    (self.initial_forces_for(targets + nudge) - initial)[self.bolts] / nudge.sum()
                    for nudge in np.diag(SHOWN_DIGITS * targets)
                ]
                slope = np.column_stack(columns)
            change = slope @ miss
            initial = initial.copy()
            initial[self.bolts] += change
            previous, reached = reached[-1, self.bolts], self.bolt_forces_along(initial, shares)
            moved = reached[-1, self.bolts] - previous
            # Broyden's update of the inverse (Math. Comp. 19 (1965) 577).
            along = change @ slope
            slope = slope + np.outer(change - slope @ moved, along) / (along @ moved)
        worst = int(np.abs(miss / targets).argmax())
        message = (
            f"bolt '{list(self.system.bolts)[self.bolts[worst]]}' misses {targets[worst]:g} by "
            f"{abs(miss[worst] / targets[worst]):.2%} however the sequence is changed; tighten in "
            "more passes or with more increments"
        )
        raise ConvergenceError(message)

    def bolt_forces_along(self, initial: Vector, shares: Vector) -> Matrix:
        """Return bolt forces (n_turn, n_bolt) after each turn to a share of the initial forces."""
        state, rows = self._start, []
        start = state.nuts
        for share in shares.tolist():
            for bolt in self.bolts.tolist():
                begin, end = state.nuts[bolt], start[bolt] + share * (initial - start)[bolt]
                for part in self._parts:
                    aim = state.nuts.copy()
                    aim[bolt] = begin + part * (end - begin)
                    state = state.locked_at(aim)
                rows.append(state.forces)
        return np.array(rows)

    def unplanned_forces(self, targets: Vector) -> Matrix:
        """Return bolt forces (n_target, n_bolt) after each bolt is tightened to its target once."""
        state, rows = self._start, []
        for bolt, target in zip(self.bolts.tolist(), targets.tolist(), strict=True):
            for part in self._parts:
                state = state.tightened_to(np.array([bolt]), np.array([part * target]))
            rows.append(state.forces)
        return np.array(rows)

    @property
    def _start(self) -> BoltedState:
        return bolted_state(self.system, initial_bolt_forces(self.system))

    @property
    def _parts(self) -> Sequence[float]:
        n = self.system.contact.increments(self.increments)
        return [number / n for number in range(1, n + 1)]
