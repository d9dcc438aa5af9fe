"""A joint at both ends of the scatter of its preloads."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from faying._typing import Vector
from faying.assessment.case_metrics import bent_bolts
from faying.assessment.joint_record import CaseState
from faying.assessment.strength.tightening import PreloadRange
from faying.joint.system import System, initial_bolt_forces
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.bolts_by_force import BoltsByForce
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.static import AT_REST, solve_static_inputs
from faying.simulation.without_friction import smooth_joint

LEAST, MOST = "P_p,min", "P_p,max"
"""What the ends of the scatter are called."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PreloadEnd:
    """A joint with all its preloads at one end of their scatter.

    Attributes
    ----------
    name
        Of the end; empty where nothing scatters.
    rest
        As tightened.
    cases
        Load case to what it makes of it.
    solved
        Load cases that were solved anew; the bolt forces of others are moved by as much as the
        preloads, which is exact where nothing opens, closes or slips.
    tightened : [force]
        Bolt to the force it was tightened to, where that was more than it has at rest.
    """

    name: str
    rest: CaseState
    cases: Mapping[str, CaseState]
    solved: frozenset[str] = frozenset()
    tightened: Mapping[str, float] = field(default_factory=dict)

    def preload(self, bolt: str) -> float:
        """Return the force of a bolt while it was tightened."""
        return self.tightened.get(bolt, float(self.rest.bolt_forces[bolt][0]))


def preload_ends(
    system: System,
    rest: CaseState,
    cases: Mapping[str, CaseState],
    loads: Mapping[str, Load],
    ranges: Mapping[str, PreloadRange],
    tightened: Mapping[str, float] = MappingProxyType({}),
) -> tuple[PreloadEnd, ...]:
    """Return a joint at both ends of its preloads, or as it is where they do not scatter.

    Parameters
    ----------
    system
        Preloaded full or reduced model.
    rest, cases
        At nominal preloads.
    loads
        Static load case without friction to its load: these are solved anew.
    ranges
        Bolt to the range of its preload.
    tightened : [force]
        Bolt to the nominal force it was tightened to, of those that lost some since.

    Raises
    ------
    ConvergenceError
        If the bolts cannot be brought to an end.

    Notes
    -----
    One contact problem for each end and one for each of its static load cases.
    """
    nominal = {name: float(force[0]) for name, force in rest.bolt_forces.items()}
    ranged = {name: spread for name, spread in ranges.items() if nominal.get(name, 0.0) > 0}
    ends: dict[str, dict[str, float]] = {LEAST: {}, MOST: {}}
    for name, spread in ranged.items():
        ends[LEAST][name] = spread.least(nominal[name])
        ends[MOST][name] = spread.most(nominal[name])
    if all(force == nominal[name] for end in ends.values() for name, force in end.items()):
        return (PreloadEnd(name="", rest=rest, cases=cases, tightened=tightened),)
    before: dict[str, dict[str, float]] = {LEAST: {}, MOST: {}}
    for name, force in tightened.items():
        spread = ranges.get(name, PreloadRange())
        before[LEAST][name], before[MOST][name] = spread.least(force), spread.most(force)
    return tuple(
        replace(
            _at(system, name, {**nominal, **forces}, rest, cases, loads), tightened=before[name]
        )
        for name, forces in ends.items()
    )


def _at(
    system: System,
    end: str,
    forces: Mapping[str, float],
    rest: CaseState,
    cases: Mapping[str, CaseState],
    loads: Mapping[str, Load],
) -> PreloadEnd:
    shifts = {name: force - float(rest.bolt_forces[name][0]) for name, force in forces.items()}
    moved = {name: _shifted(state, shifts) for name, state in cases.items()}
    if not loads:
        return PreloadEnd(name=end, rest=_shifted(rest, shifts), cases=moved)
    initial = initial_forces_at(system, forces)
    solution = solve_at(system, loads, initial)
    bent = [name for name in bent_bolts(system.bolts) if name in rest.bolt_moments]
    solved = {name: _state(solution, row, bent) for row, name in enumerate(loads, start=1)}
    return PreloadEnd(
        name=end,
        rest=_state(solution, 0, bent),
        cases={**moved, **solved},
        solved=frozenset(loads),
    )


def initial_forces_at(system: System, forces: Mapping[str, float]) -> Vector:
    """Return the initial forces (n_bolt,) at which bolts have forces at rest, without friction."""
    joint = smooth_joint(system.joint if isinstance(system, ReducedModel) else system)
    names, locked = list(joint.bolts), initial_bolt_forces(joint)
    chosen = np.array([names.index(name) for name, force in forces.items() if force > 0])
    goal = np.array([force for force in forces.values() if force > 0])
    if not len(chosen):
        return locked
    _, initial = BoltsByForce(joint=joint, bolts=chosen).solve(goal, locked, None, None)
    return initial


def solve_at(system: System, loads: Mapping[str, Load], initial: Vector) -> Solution:
    """Solve rest, then static loads, with bolts locked at initial forces (n_bolt,)."""
    start = np.zeros(1)
    every = [AT_REST, *loads.values()]
    inputs = np.concatenate([load.inputs(system, start) for load in every])
    inputs[:, system.port_compliance.bolts] = initial
    return solve_static_inputs(system, inputs, "ends of the preloads")


def _state(solution: Solution, row: int, bent: list[str]) -> CaseState:
    return CaseState(
        pressure=solution.pressure[row : row + 1],
        bolt_forces={
            name: np.asarray(solution.bolt_force(name))[row : row + 1]
            for name in solution.system.bolts
        },
        bolt_moments={name: solution.bolt_bending(name)[row : row + 1] for name in bent},
    )


def _shifted(state: CaseState, shifts: Mapping[str, float]) -> CaseState:
    forces = {name: force + shifts.get(name, 0.0) for name, force in state.bolt_forces.items()}
    return replace(state, bolt_forces=forces)
