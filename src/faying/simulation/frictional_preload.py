"""Pretension with friction: bolts tightened along a path that remembers its slip."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import ConvergenceError
from faying.joint.system import System, initial_bolt_forces
from faying.simulation.load import Load
from faying.simulation.path import solve_path
from faying.simulation.preload import FORCE_TOLERANCE, Tightening, tighten
from faying.simulation.solution import Solution
from faying.simulation.without_friction import smooth_joint

MOST_TRIALS = 30
"""Initial forces tried until a bolt has its nominal force; 3 to 5 are usual."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FrictionalTightening:
    """How bolts were tightened with friction, and where that left the joint.

    Attributes
    ----------
    tightening
        Initial and reached forces.
    loads
        Initial forces of the bolts, increment by increment: the path that any other model of the
        joint follows.
    rest
        The joint at its end; one entry.
    """

    tightening: Tightening
    loads: tuple[Load, ...]
    rest: Solution


def tighten_with_friction(
    system: System, forces: Mapping[str, float], *, increments: int = 10
) -> FrictionalTightening:
    """Tighten bolts one after the other to their nominal final forces, with friction throughout.

    The joint starts unstressed and free of slip, bolts that are not named at the initial forces
    they are locked at. Each bolt is turned in equal increments of its initial force, the last of
    which is chosen so that it ends at its nominal force; a last increment on all of several bolts
    together restores what neighbours took away.

    Parameters
    ----------
    forces
        Bolt name to final axial force [force], in tightening order.
    increments
        Steps per bolt.

    Raises
    ------
    ModelError
        As :func:`faying.tighten`.
    ConvergenceError
        If an increment is not solved, or no initial force gives a nominal force.

    Notes
    -----
    The initial forces of frictionless tightening say where to go; a quasi-Newton method finds the
    last increment, at one solved increment for each trial.
    """
    smooth = tighten(smooth_joint(system), forces)
    state = initial_bolt_forces(system)
    path = _Path(system=system, loads=[], states=[])
    if state.any() or not forces:
        path = path.then(state)
    stages: list[str] = []
    names = list(system.bolts)
    for name, target in forces.items():
        chosen = np.array([names.index(name)], dtype=np.int64)
        start, end = state[chosen], smooth.initial_forces[name]
        for number in range(1, increments):
            state = state.copy()
            state[chosen] = start + (end - start) * number / increments
            path = path.then(state)
            stages.append(f"{name} to {number / increments:.0%} of N₀")
        path, state = _reach(path, state, chosen, np.array([target]), np.array([target / end]))
        stages.append(f"{name} to nominal")
    if len(forces) > 1:
        chosen = np.array([names.index(name) for name in forces])
        goal = np.array(list(forces.values()))
        slope = goal / np.array([smooth.initial_forces[name] for name in forces])
        path, state = _reach(path, state, chosen, goal, slope)
        stages.append("all to nominal")
    bolt_forces = path.bolt_forces[len(path.loads) - len(stages) :]
    return FrictionalTightening(
        tightening=Tightening(
            initial_forces=dict(zip(names, state.tolist(), strict=True)),
            bolts=tuple(names),
            stages=tuple(stages),
            bolt_forces=bolt_forces,
        ),
        loads=tuple(path.loads),
        rest=path.states[-1],
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _Path:
    """The increments of tightening so far: initial forces, and the states they led to."""

    system: System
    loads: list[Load]
    states: list[Solution]

    @property
    def bolt_forces(self) -> Matrix:
        """Forces of all bolts after each increment (n_increment, n_bolt)."""
        names = self.system.bolts
        found = [[state.bolt_force(name)[-1] for name in names] for state in self.states]
        return np.array(found, dtype=float).reshape(len(self.states), len(names))

    def then(self, state: Vector) -> "_Path":
        """Go on to other initial forces (n_bolt,) in one increment."""
        forces = dict(zip(self.system.bolts, state.tolist(), strict=True))
        load = Load(name="preload", bolt_forces=forces)
        here = self.states[-1] if self.states else None
        found = solve_path(self.system, [load], initial=here, name="preload")
        return _Path(system=self.system, loads=[*self.loads, load], states=[*self.states, found])


def _reach(
    path: _Path, state: Vector, chosen: Indices, goal: Vector, slope: Vector
) -> tuple[_Path, Vector]:
    """Find the increment after which the chosen bolts have their forces (Broyden's method)."""
    tolerance = FORCE_TOLERANCE * np.abs(goal).max()
    derivative: Matrix = np.diag(slope)
    tried = path.then(state)
    for _ in range(MOST_TRIALS):
        reached = tried.bolt_forces[-1][chosen]
        miss = goal - reached
        if np.abs(miss).max() <= tolerance:
            return tried, state
        change = np.linalg.solve(derivative, miss)
        state = state.copy()
        state[chosen] += change
        tried = path.then(state)
        unexpected = tried.bolt_forces[-1][chosen] - reached - derivative @ change
        derivative = derivative + np.outer(unexpected, change) / (change @ change)
    worst = int(np.abs(miss).argmax())
    message = (
        f"bolt '{list(path.system.bolts)[chosen[worst]]}' was not tightened to {goal[worst]:g} in "
        f"{MOST_TRIALS} trials with friction; tighten without it (friction_during_preload = false)"
    )
    raise ConvergenceError(message)
