"""A joint at both ends of the scatter of its preloads, and at its possible temperatures."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.case_metrics import bent_bolts
from faying.assessment.growth import DEFAULT_INCREMENTS
from faying.assessment.joint_record import CaseState
from faying.assessment.strength.thread import Thread
from faying.assessment.strength.tightening import PreloadRange
from faying.digits import DECK_DIGITS, SOLVED
from faying.joint.smooth_joint import smooth_joint
from faying.joint.system import Joint, System, initial_bolt_forces
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.bolts_by_force import BoltsByForce
from faying.simulation.load import Load, StaticLoad
from faying.simulation.path import solve_ramps, solve_static
from faying.simulation.solution import Solution
from faying.simulation.static import AT_REST

LEAST, MOST = "P_p,min", "P_p,max"
"""Names of the ends of the scatter."""

ENDS = "ends of the preloads"
"""Name of solutions at these ends."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PreloadEnd:
    """A joint with all its preloads at one end of their scatter.

    Attributes
    ----------
    name
        Name of the end; empty without scatter.
    rest
        State after tightening.
    cases
        Load case to its state.
    solved
        Load cases solved at this end. In all others bolt forces are shifted by the change of
        preload, and moments by the same share of those at rest: exact where nothing opens, closes
        or slips, and the preloads of all bolts change alike.
    rubs
        Whether they were solved with friction.
    tightened : [force]
        Bolt to its force during tightening, where larger than at rest.
    """

    name: str
    rest: CaseState
    cases: Mapping[str, CaseState]
    solved: frozenset[str] = frozenset()
    rubs: bool = False
    tightened: Mapping[str, float] = field(default_factory=dict)

    def preload(self, bolt: str) -> float:
        """Return the force of a bolt during tightening."""
        return self.tightened.get(bolt, float(self.rest.bolt_forces[bolt][0]))


def preload_ends(
    system: System,
    rest: CaseState,
    cases: Mapping[str, CaseState],
    loads: Mapping[str, StaticLoad],
    ranges: Mapping[str, PreloadRange],
    tightened: Mapping[str, float] = MappingProxyType({}),
    temperatures: Mapping[str, StaticLoad] = MappingProxyType({}),
    rubbing: Solution | None = None,
) -> tuple[PreloadEnd, ...]:
    """Return a joint at both ends of its preloads, or at nominal ones without scatter.

    ``rest`` and ``cases`` are at nominal preloads. Loads of static cases are solved anew where
    ranges change the preload, with each of the temperatures. ``rubbing`` is the preloaded state of
    a joint with friction, whose loads are solved at the lower end and at temperatures if its states
    are similar (:func:`similar_share`). ``tightened`` are higher forces during tightening of bolts
    that lost some of it since [force].

    Raises
    ------
    ConvergenceError
        If the bolts cannot reach an end.

    Notes
    -----
    One contact problem for each end, and one for each static load case at each end and temperature,
    ten with gaskets or friction.
    """
    nominal = {name: float(force[0]) for name, force in rest.bolt_forces.items()}
    scattered = ends_of(nominal, ranges)
    before = {"": dict(tightened)} | {
        end: {name: _at_end(ranges.get(name), force, end) for name, force in tightened.items()}
        for end in (LEAST, MOST)
    }
    ends = []
    for end, forces in scattered.items():
        shifts = {name: force - nominal[name] for name, force in forces.items()}
        moved = PreloadEnd(
            name=end,
            rest=_shift_state(rest, shifts, rest),
            cases={name: _shift_state(state, shifts, rest) for name, state in cases.items()},
            tightened=before[end],
        )
        share = None if rubbing is None else similar_share(rubbing, nominal, forces)
        if not loads or (not end and not temperatures) or (rubbing and share is None):
            ends.append(moved)
            continue
        initial = initial_forces_at(system, forces)
        for name, heated in {"": None, **temperatures}.items():
            if rubbing is None or share is None:
                solved = solved_end(moved, system, loads, initial, heated)
            elif end == LEAST or heated is not None:
                solved = similar_end(moved, rest, rubbing, loads, share, heated)
            else:
                solved = moved
            ends.append(replace(solved, name=", ".join(filter(None, (end, name)))))
    return tuple(ends)


def similar_share(
    rubbing: Solution, nominal: Mapping[str, float], forces: Mapping[str, float]
) -> float | None:
    """Return the share s of the nominal preloads where states with friction are similar, or None.

    Without gaps, and with closures in proportion to pressure, equations and inequalities of contact
    and Coulomb's friction are homogeneous: with s times all preloads, s times the loads lead to s
    times the state (Johnson, Contact Mechanics, 1985, 7.1).
    """
    contact = rubbing.system.contact
    gaps = float(np.abs(contact.initial_gap).max(initial=0.0))
    shares = [forces[name] / force for name, force in nominal.items() if force > 0]
    alike = shares and max(shares) - min(shares) <= SOLVED * max(shares)
    if not alike or shares[0] <= 0 or not contact.proportional:
        return None
    return shares[0] if gaps <= DECK_DIGITS * float(np.abs(rubbing.gap).max()) else None


def least_share(
    rubbing: Solution | None, rest: CaseState, ranges: Mapping[str, PreloadRange]
) -> float | None:
    """Return the share of preloads at P_p,min where states with friction are similar, or None."""
    nominal = {name: float(force[0]) for name, force in rest.bolt_forces.items()}
    forces = ends_of(nominal, ranges).get(LEAST, nominal)
    return None if rubbing is None else similar_share(rubbing, nominal, forces)


def similar_end(
    moved: PreloadEnd,
    rest: CaseState,
    rubbing: Solution,
    loads: Mapping[str, StaticLoad],
    share: float,
    heated: StaticLoad | None,
) -> PreloadEnd:
    """Return an end with its static load cases followed with friction (:func:`similar_share`)."""
    system, start = rubbing.system, np.zeros(1)
    begun = np.atleast_2d(rubbing.inputs)[-1]
    added = np.concatenate([load.inputs(system, start) for load in loads.values()]) - begun
    if heated is not None:
        added += heated.inputs(system, start) - AT_REST.inputs(system, start)
    ramps = solve_ramps(
        system, begun + added / share, rubbing, increments=DEFAULT_INCREMENTS, name=ENDS
    )
    bent = [name for name in bent_bolts(system.bolts) if name in rest.bolt_moments]
    loaded = [state_of(ramps, slice(row, row + 1), bent).scaled(share) for row in range(len(loads))]
    return replace(
        moved,
        rest=rest.scaled(share),
        cases={**moved.cases, **dict(zip(loads, loaded, strict=True))},
        solved=frozenset(loads),
        rubs=True,
    )


def ends_of(
    nominal: Mapping[str, float], ranges: Mapping[str, PreloadRange]
) -> dict[str, dict[str, float]]:
    """Return the forces of all bolts at both ends, or the nominal ones without scatter."""
    ends = {
        end: {
            name: _at_end(ranges.get(name), force, end) if force > 0 else force
            for name, force in nominal.items()
        }
        for end in (LEAST, MOST)
    }
    same = all(forces == nominal for forces in ends.values())
    return {"": dict(nominal)} if same else ends


def _at_end(spread: PreloadRange | None, nominal: float, end: str) -> float:
    if spread is None:
        return nominal
    return spread.least(nominal) if end == LEAST else spread.most(nominal)


def solved_end(
    moved: PreloadEnd,
    system: System,
    loads: Mapping[str, StaticLoad],
    initial: Vector,
    heated: StaticLoad | None,
) -> PreloadEnd:
    """Return an end with its static load cases solved, under a temperature as well."""
    start = np.zeros(1)
    rest = AT_REST.inputs(system, start)
    inputs = np.concatenate([rest, *(load.inputs(system, start) for load in loads.values())])
    if heated is not None:
        inputs[1:] += heated.inputs(system, start) - rest
    locked = with_initial(system, inputs, initial)
    bent = [name for name in bent_bolts(system.bolts) if name in moved.rest.bolt_moments]
    tightened, *loaded = _states_at(system, locked, bent)
    return replace(
        moved,
        rest=tightened,
        cases={**moved.cases, **dict(zip(loads, loaded, strict=True))},
        solved=frozenset(loads),
    )


def _states_at(system: System, inputs: Matrix, bent: Sequence[str]) -> list[CaseState]:
    """Return the state at the first of inputs (n_case, n_input), tightened, and at the others."""
    tightened = inputs[0, system.port_compliance.bolts]
    bolts = dict(zip(system.bolts, tightened.tolist(), strict=True))
    rest = solve_static(system, Load(bolt_forces=bolts, name=ENDS))
    ramps = solve_ramps(system, inputs[1:], rest, increments=DEFAULT_INCREMENTS, name=ENDS)
    loaded = [state_of(ramps, slice(row, row + 1), bent) for row in range(len(inputs) - 1)]
    return [state_of(rest, slice(1), bent), *loaded]


def loosest_forces(
    system: System, rest: CaseState, ranges: Mapping[str, PreloadRange]
) -> Vector | None:
    """Return the initial forces (n_bolt,) at P_p,min of all bolts; None without scatter."""
    nominal = {name: float(force[0]) for name, force in rest.bolt_forces.items()}
    ends = ends_of(nominal, ranges)
    return initial_forces_at(system, ends[LEAST]) if LEAST in ends else None


def with_initial(joint: Joint, inputs: Matrix, initial: Vector | None) -> Matrix:
    """Return inputs (n_case, n_input) with bolts locked at other initial forces (n_bolt,)."""
    if initial is None:
        return inputs
    locked = inputs.copy()
    locked[:, joint.port_compliance.bolts] = initial
    return locked


def initial_forces_at(system: System, forces: Mapping[str, float]) -> Vector:
    """Return the initial forces (n_bolt,) for given bolt forces at rest, without friction."""
    joint = smooth_joint(system.joint if isinstance(system, ReducedModel) else system)
    names, locked = list(joint.bolts), initial_bolt_forces(joint)
    chosen = np.array([names.index(name) for name, force in forces.items() if force > 0])
    goal = np.array([force for force in forces.values() if force > 0])
    if not len(chosen):
        return locked
    _, initial = BoltsByForce(joint=joint, bolts=chosen).solve(goal, locked, 0.0, None)
    return initial


def state_of(solution: Solution, rows: slice, bent: Iterable[str]) -> CaseState:
    """Return cases or increments of a solution as a state, with the bending of some bolts."""
    system = solution.system
    return CaseState(
        pressure=solution.pressure.reshape(-1, system.contact.n_points)[rows],
        bolt_forces={name: np.ravel(solution.bolt_force(name))[rows] for name in system.bolts},
        bolt_moments={name: solution.bolt_bending(name).reshape(-1, 2, 2)[rows] for name in bent},
    )


def _shift_state(state: CaseState, shifts: Mapping[str, float], rest: CaseState) -> CaseState:
    forces = {name: force + shifts.get(name, 0.0) for name, force in state.bolt_forces.items()}
    moments = dict(state.bolt_moments)
    for name in moments.keys() & rest.bolt_moments.keys() & shifts.keys():
        share = shifts[name] / rest.bolt_forces[name][0] if shifts[name] else 0.0
        moments[name] = moments[name] + share * rest.bolt_moments[name][:1]
    return replace(state, bolt_forces=forces, bolt_moments=moments)


@dataclass(frozen=True, kw_only=True)
class BoltStrengths:
    """Data for the strength of bolts.

    Attributes
    ----------
    threads
        Threads of the bolts with known size and grade.
    ranges
        Ranges of the preloads.
    tightened : [force]
        Bolt to its force during tightening.
    temperatures
        Name to a temperature that may act with every static load case.
    smallest_friction
        Smallest coefficients of the interfaces with friction, where they scatter.
    """

    threads: Mapping[str, Thread] = field(default_factory=dict)
    ranges: Mapping[str, PreloadRange] = field(default_factory=dict)
    tightened: Mapping[str, float] = field(default_factory=dict)
    temperatures: Mapping[str, StaticLoad] = field(default_factory=dict)
    smallest_friction: float | None = None
