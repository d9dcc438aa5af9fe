"""Pretension: bolts tightened in sequence to their nominal final forces, then locked."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.state import ContactState
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.model import Model
from faying.joint.sticking import sticking_stiffness, stuck_pairs
from faying.joint.system import Joint, initial_bolt_forces
from faying.simulation.static import port_forces, solve_static

NO_RESISTANCE = 1e-9
"""Bolt force per initial force below which nothing is clamped yet."""

CLAMPS_NOTHING = 1e-9
"""Gap closed per elongation of the bolt under its own force, at or below which it is round-off."""

SURPLUS = 1e-6
"""Relative excess of a bolt's stiffness over all that resists it; more than rounding is wrong."""

LIMIT = 100
"""Newton steps per increment; two or three are usual."""

LAST_DIGITS = 1e-15
"""What round-off leaves of a bolt force, over the initial force: some units in the last place."""

FORCE_TOLERANCE = 1e-10
"""Deviation of a bolt force from its target over the largest target, at which Newton stops.

Round-off leaves 1e-12 where contact alone holds a part and springs of 1 N/mm its rigid motion.
"""


@dataclass(frozen=True, kw_only=True)
class Sticking:
    """Where the parts are taken to stick together in tangential direction (§15.4.2).

    Attributes
    ----------
    threshold
        Fraction of an interface's largest preload pressure above which node pairs stick.
    stiffness : [force/length]
        Tangential penalty of each pair, in both directions.
    """

    threshold: float = 0.5
    stiffness: float = 1e6

    def __post_init__(self) -> None:
        if not (0 <= self.threshold < 1 and self.stiffness > 0):
            message = (
                f"sticking: threshold {self.threshold:g} must lie in [0, 1) and stiffness "
                f"{self.stiffness:g} must be positive"
            )
            raise ModelError(message)


@dataclass(frozen=True, eq=False, kw_only=True)
class Tightening:
    """How the bolts were tightened.

    Attributes
    ----------
    initial_forces
        Bolt name to the initial force N₀ it is locked at.
    bolts
        Names in the order of the columns of ``bolt_forces``.
    stages
        What was done in each row of ``bolt_forces``.
    bolt_forces : (n_stage, n_bolt) [force]
        Forces of all bolts after each increment; shows how tightening one relaxes another.
    """

    initial_forces: Mapping[str, float]
    bolts: tuple[str, ...]
    stages: tuple[str, ...]
    bolt_forces: Matrix


def tighten(system: Joint, forces: Mapping[str, float], *, increments: int = 10) -> Tightening:
    """Tighten bolts one after the other, in increments, to their nominal final forces.

    Each bolt is brought to its nominal force while those before it stay locked; a last pass on all
    of them together restores what the neighbours took away, so every bolt ends at its nominal
    force. Bolts not named keep the initial force they are locked at.

    Parameters
    ----------
    forces
        Bolt name to final axial force [force], in tightening order.
    increments
        Steps per bolt.

    Raises
    ------
    ModelError
        If a bolt does not exist, is stiffer than K allows or closes no gap, or a force is not
        finite and positive.
    ConvergenceError
        If no initial force gives the nominal force, e.g. because a bolt clamps nothing.

    Notes
    -----
    Semismooth Newton on the initial forces with the exact derivative on the active set; all in
    the compliance between ports, so no finite element solution is needed.
    """
    names = list(system.bolts)
    _check(forces, names)
    _check_stiffness(system)
    _check_clamping(system, forces)
    state = initial_bolt_forces(system)
    contact: ContactState | None = None
    stages: list[str] = []
    history: list[Vector] = []
    for name, target in forces.items():
        chosen = np.array([names.index(name)], dtype=np.int64)
        for fraction in np.arange(1, increments + 1) / increments:
            goal = np.array([fraction * target])
            state, contact, reached = _reach(system, chosen, goal, state, contact)
            stages.append(f"{name} to {fraction:.0%}")
            history.append(reached)
    if not forces:
        return Tightening(
            initial_forces=dict(zip(names, state.tolist(), strict=True)),
            bolts=tuple(names),
            stages=(),
            bolt_forces=np.empty((0, len(names))),
        )
    chosen = np.array([names.index(name) for name in forces])
    goal = np.array(list(forces.values()))
    state, contact, reached = _reach(system, chosen, goal, state, contact)
    return Tightening(
        initial_forces=dict(zip(names, state.tolist(), strict=True)),
        bolts=tuple(names),
        stages=(*stages, "all to nominal"),
        bolt_forces=np.array([*history, reached]),
    )


def preload(
    model: Model,
    forces: Mapping[str, float],
    *,
    sticking: Sticking | None = None,
    increments: int = 10,
) -> Model:
    """Return the model with its bolts tightened to final forces and locked.

    Parameters
    ----------
    forces
        Bolt name to final axial force [force], in tightening order.
    sticking
        If given, pairs pressed hard enough are tied in tangential direction and the bolts are
        tightened again, so that their forces are final in the model that is returned.

    Raises
    ------
    ModelError, ConvergenceError
        As :func:`tighten`.

    Notes
    -----
    Ties change the stiffness: with ``sticking`` the structure is factorized once more.
    """
    tightened = tighten(model, forces, increments=increments)
    locked = model.with_bolt_forces(tightened.initial_forces)
    if sticking is None:
        return locked
    tied = with_sticking(locked, sticking)
    return tied.with_bolt_forces(tighten(tied, forces, increments=1).initial_forces)


def with_sticking(model: Model, sticking: Sticking) -> Model:
    """Return a preloaded model with tangential penalties where the parts stick (§15.4.2)."""
    pressure = solve_static(model).pressure
    stuck: dict[str, Mask] = {}
    added = sp.csr_array(model.K.shape)
    for name, points in model.contact.slices.items():
        interface = model.interfaces[name]
        stuck[name] = stuck_pairs(interface, pressure[points], sticking.threshold)
        added = added + sticking_stiffness(interface, stuck[name], sticking.stiffness)
    return model.with_stiffness(added, stuck, sticking.stiffness)


def _check(forces: Mapping[str, float], names: list[str]) -> None:
    for name, force in forces.items():
        if name not in names:
            message = f"there is no bolt '{name}'; the bolts are {', '.join(names) or 'none'}"
            raise ModelError(message)
        if not (np.isfinite(force) and force > 0):
            message = f"bolt '{name}': the preload is {force:g}; give a positive force"
            raise ModelError(message)


def _reach(
    system: Joint, chosen: Indices, goal: Vector, state: Vector, contact: ContactState | None
) -> tuple[Vector, ContactState, Vector]:
    """Newton on the initial forces of the chosen bolts until their forces meet the goal.

    Bolt forces are the gradient of a convex function of the initial forces, piecewise linear, so
    a Newton step that is halved until it helps always gets there. A bolt force never exceeds its
    initial force, which makes the goal a start; where no contact resists yet, the slope vanishes
    and initial forces are doubled instead.
    """
    state = state.copy()
    state[chosen] = np.maximum(state[chosen], goal)
    tolerance = FORCE_TOLERANCE * np.abs(goal).max()
    forces, slope, contact = _bolt_forces(system, state, contact)
    for _ in range(LIMIT):
        miss = goal - forces[chosen]
        # A bolt force is what a gap leaves of the initial one, whose last digits decide.
        if np.abs(miss).max() <= max(tolerance, LAST_DIGITS * np.abs(state).max()):
            return state, contact, forces
        resistance = slope[np.ix_(chosen, chosen)]
        if np.linalg.eigvals(resistance).real.min() < NO_RESISTANCE:
            state[chosen] *= 2
            forces, slope, contact = _bolt_forces(system, state, contact)
            continue
        change = np.linalg.solve(resistance, miss)
        start, distance = state.copy(), np.abs(miss).max()
        for halving in range(30):
            state = start.copy()
            state[chosen] += change / 2**halving
            forces, slope, contact = _bolt_forces(system, state, contact)
            if np.abs(goal - forces[chosen]).max() < distance:
                break
    worst = int(np.abs(miss).argmax())
    message = (
        f"bolt '{list(system.bolts)[chosen[worst]]}' cannot be tightened to {goal[worst]:g}: what "
        "it pulls at gives way; check that it clamps an interface"
    )
    raise ConvergenceError(message)


def _check_stiffness(system: Joint) -> None:
    """Refuse bolts of given matrices that are stiffer than the structure they are part of.

    K ⪰ k eᵀe exactly where k e K⁻¹ eᵀ ≤ 1; bolts faying assembled itself always satisfy it.
    """
    ports = system.port_compliance
    for number, bolt in enumerate(system.bolts.values()):
        row = ports.n_boundary + number
        flexibility = float(ports.input_rows[row, row])
        if bolt.stiffness * flexibility > 1 + SURPLUS:
            message = (
                f"bolt '{bolt.name}': its stiffness {bolt.stiffness:g} is not contained in K, "
                f"which resists its elongation with {1 / flexibility:.6g} in all; give EA/L of "
                "what K holds between its nodes"
            )
            raise ModelError(message)


def _check_clamping(system: Joint, forces: Mapping[str, float]) -> None:
    """Refuse bolts whose tension closes no gap."""
    ports = system.port_compliance
    for name in forces:
        row = ports.n_boundary + list(system.bolts).index(name)
        closing = system.contact.interpolation @ ports.contact_columns[row]
        if closing.max(initial=0.0) <= CLAMPS_NOTHING * ports.input_rows[row, row]:
            message = (
                f"bolt '{name}' clamps nothing: its tension closes no interface; check that head "
                "and nut are on the far sides of one, and that its direction is not reversed"
            )
            raise ModelError(message)


def _bolt_forces(
    system: Joint, state: Vector, start: ContactState | None
) -> tuple[Vector, Matrix, ContactState]:
    """Bolt forces, their derivative by the initial forces, and where contact stands."""
    ports, contact = system.port_compliance, system.contact
    inputs = np.concatenate([np.zeros(ports.n_boundary), state, np.zeros(ports.n_pattern)])
    signed = port_forces(ports, inputs)
    gap = system.static_contact.free_gap(signed @ ports.contact_columns)
    solution, start = system.static_contact.solve(gap, start)

    stiffness = np.array([bolt.stiffness for bolt in system.bolts.values()])
    bolt_rows = ports.contact_columns[ports.bolts]
    elongation = ports.input_rows[ports.bolts] @ signed
    elongation = elongation + bolt_rows @ (contact.interpolation.T @ solution.forces)

    closed = np.flatnonzero(solution.active)
    coupling = (contact.interpolation @ bolt_rows.T)[closed]
    relieved = coupling.T @ system.static_contact.solve_active(coupling, solution.active)
    own = ports.input_rows[ports.bolts, ports.bolts]
    slope = np.eye(len(state)) - stiffness[:, None] * (own - relieved)
    return stiffness * elongation + state, slope, start
