"""Tightening: bolts brought in sequence to their nominal final forces, then locked."""

import logging
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import cast

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.contact.increment import Increment
from faying.digits import DECK_DIGITS, SOLVED
from faying.exceptions import check_known, refuse_model
from faying.joint.system import Joint, System, initial_bolt_forces
from faying.simulation.bolted_state import BoltedState
from faying.simulation.bolts_by_force import BoltsByForce, forces_of_bolts
from faying.simulation.load import Load
from faying.simulation.path import left_by, moved_alone, unstressed
from faying.simulation.path_steps import PathStep, follow
from faying.simulation.preload_loss import PreloadLoss, loses
from faying.simulation.solution import Solution

_log = logging.getLogger("faying")

NOTHING_LOST: Mapping[str, PreloadLoss] = MappingProxyType({})


@dataclass(frozen=True, eq=False, kw_only=True)
class Tightening:
    """The course of tightening.

    Attributes
    ----------
    initial_forces
        Bolt name to the initial force N₀ it is locked at.
    bolts
        Names in the order of the columns of ``bolt_forces``.
    stages
        Action of each row of ``bolt_forces``.
    bolt_forces : (n_stage, n_bolt) [force]
        Forces of all bolts after each increment; shows how tightening one relaxes another.
    path : (n_load, n_bolt) [force]
        Initial forces of all bolts, increment by increment, that bring any model of the joint to
        the same state. The last row alone where contact has no history.
    """

    initial_forces: Mapping[str, float]
    bolts: tuple[str, ...]
    stages: tuple[str, ...]
    bolt_forces: Matrix
    path: Matrix

    @property
    def loads(self) -> tuple[Load, ...]:
        """The path as loads."""
        return tuple(
            Load(name="preload", bolt_forces=dict(zip(self.bolts, row, strict=True)))
            for row in self.path.tolist()
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class TightenedJoint:
    """A joint and its state after tightening.

    Attributes
    ----------
    joint
    tightening
    end
        The last step of its path.
    """

    joint: Joint
    tightening: Tightening
    end: PathStep

    def rest(self, system: System) -> Solution:
        """Return the state of the system after tightening; one entry.

        Where it was tightened without the friction of the system, friction starts there.
        """
        inputs = _inputs(system, self.tightening.path[-1])
        return left_by(system, self.joint, inputs, self.end, "preload")


def tighten(
    system: Joint,
    forces: Mapping[str, float],
    *,
    increments: int = 10,
    losses: Mapping[str, PreloadLoss] = NOTHING_LOST,
) -> Tightening:
    """Tighten bolts in sequence to their nominal final forces.

    The joint starts unstressed and free of slip; bolts that are not named have the initial forces
    they are locked at. Each bolt is turned to its nominal force while the others stay locked. A
    last pass on several bolts together restores the force lost to neighbours, so every bolt ends
    at its nominal force. Then the losses follow: relaxation, then embedding.

    Parameters
    ----------
    forces
        Bolt name to final axial force [force], in tightening order.
    increments
        Equal parts of each force, where contact depends on the path.
    losses
        Bolt name to its loss after all are tightened.

    Raises
    ------
    ModelError
        If a bolt does not exist, is stiffer than K allows or closes no gap, or a force is not
        finite and positive.
    ConvergenceError
        If an increment is not solved, or no initial force gives the nominal force, e.g. because a
        bolt clamps nothing.

    Notes
    -----
    One contact problem between pairs for each increment, whose unknowns are initial forces and
    contact forces (T1). With friction a model that is only locked at the initial forces is not in
    the state after tightening: :func:`faying.solve_path` with ``loads`` leads there.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(
    ...     element_size=5.0, hole_radius=None, bolt_positions=((-10.0, 0.0), (10.0, 0.0))
    ... )
    >>> tightened = fy.tighten(joint, {"bolt-1": 10e3, "bolt-2": 10e3})
    >>> tightened.stages, tightened.bolt_forces[-1].round(6)
    (('bolt-1 to 100%', 'bolt-2 to 100%', 'all to nominal'), array([10000., 10000.]))
    """
    return tightened_joint(system, forces, increments=increments, losses=losses).tightening


def tightened_joint(
    system: Joint,
    forces: Mapping[str, float],
    *,
    increments: int = 10,
    losses: Mapping[str, PreloadLoss] = NOTHING_LOST,
) -> TightenedJoint:
    """Tighten bolts as :func:`tighten` does; return the joint with its state after it."""
    names, state = checked_bolts(system, forces), initial_bolt_forces(system)
    steps, path = [unstressed(system)], list[Vector]()
    if state.any() or not forces:
        relative = moved_alone(system, _inputs(system, state)[None])
        steps += follow(system.static_contact.increments, relative, steps[-1])
        path.append(state)
    reached: list[tuple[str, Vector]] = []
    problem, alike = BoltsByForce(joint=system, bolts=np.empty(0, dtype=np.int64)), 0
    for stage, chosen, goal in _stages(names, forces, system.contact.increments(increments)):
        step = steps[-1]
        start = step.increment if step.increment.begun else None
        if not np.array_equal(problem.bolts, chosen):
            problem, alike = BoltsByForce(joint=system, bolts=chosen), 0
        if start is not None and (alike > 1 or (alike and not steps[-2].increment.begun)):
            # Prediction: the bolt moves the joint as in its increment before.
            start = replace(start, moved=2.0 * start.moved - steps[-2].increment.moved)
        alike += 1
        increment, state = problem.solve(goal, state, step.slip, start)
        steps.append(_step(system, state, increment, step.slip + increment.slack[1:]))
        path.append(state)
        reached.append((stage, forces_of_bolts(system, state, increment)))
    if reached:
        for text in open_interfaces(system.contact.slices, steps[-1].increment.forces[0]):
            _log.warning("%s", text)
    tight = BoltedState(
        joint=system,
        nuts=state,
        initial=state,
        loose=np.zeros(len(names), dtype=bool),
        slip=steps[-1].slip,
        contact=steps[-1].increment,
    )
    for stage, lost in loses(tight, losses):
        state = lost.initial
        steps.append(_step(system, state, cast("Increment", lost.contact), lost.slip))
        path.append(state)
        reached.append((stage, lost.forces))
    tightening = Tightening(
        initial_forces=dict(zip(names, state.tolist(), strict=True)),
        bolts=tuple(names),
        stages=tuple(stage for stage, _ in reached),
        bolt_forces=np.array([row for _, row in reached]).reshape(len(reached), len(names)),
        path=np.array(path[-system.contact.increments(len(path)) :]),
    )
    return TightenedJoint(joint=system, tightening=tightening, end=steps[-1])


def open_interfaces(points: Mapping[str, slice], pressed: Vector) -> Iterator[str]:
    """Yield a message for each interface that stays open at all points under the bolts.

    ``points`` are those of each interface, ``pressed`` pressures or forces (n_point,).
    """
    for name, own in points.items():
        if not pressed[own].any():
            yield (
                f"interface '{name}' is open everywhere after tightening: no bolt presses it; if "
                "one should, check its gap, and that the bolt draws its head and nut together"
            )


def _stages(
    names: Sequence[str], forces: Mapping[str, float], increments: int
) -> Iterator[tuple[str, Indices, Vector]]:
    """Yield each action, its bolts (n_chosen,), and their forces after it."""
    for name, target in forces.items():
        chosen = np.array([names.index(name)], dtype=np.int64)
        for number in range(1, increments + 1):
            share = number / increments
            yield f"{name} to {share:.0%}", chosen, np.array([share * target])
    if len(forces) > 1:
        every = np.array([names.index(name) for name in forces], dtype=np.int64)
        yield "all to nominal", every, np.array(list(forces.values()))


def _step(joint: Joint, initial: Vector, contact: Increment, slip: Matrix) -> PathStep:
    """Return the increment for initial forces (n_bolt,) as a step of a path."""
    return PathStep(
        relative=moved_alone(joint, _inputs(joint, initial)[None])[0],
        increment=contact,
        slip=slip,
        iterations=contact.iterations,
        dissipation=contact.dissipation,
    )


def _inputs(joint: Joint, initial: Vector) -> Vector:
    """Return the inputs (n_input,) for initial forces (n_bolt,) alone."""
    ports = joint.port_compliance
    inputs = np.zeros(len(ports.input_rows))
    inputs[ports.bolts] = initial
    return inputs


def checked_bolts(system: Joint, forces: Mapping[str, float]) -> list[str]:
    """Return the names of all bolts; refuse forces that cannot be tightened."""
    names = list(system.bolts)
    _check_forces(forces, names)
    _check_stiffness(system)
    _check_clamping(system, forces)
    return names


def _check_forces(forces: Mapping[str, float], names: list[str]) -> None:
    for name, force in forces.items():
        check_known(name, names, "bolt")
        if not (np.isfinite(force) and force > 0):
            refuse_model(f"bolt '{name}': the preload is {force:g}; give a positive force")


def _check_stiffness(system: Joint) -> None:
    """Refuse bolts of given matrices that are stiffer than the structure that contains them.

    K ⪰ k eᵀe exactly where k e K⁻¹ eᵀ ≤ 1; bolts assembled by faying always satisfy it.
    """
    ports = system.port_compliance
    for number, bolt in enumerate(system.bolts.values()):
        row = ports.n_boundary + number
        flexibility = float(ports.input_rows[row, row])
        if bolt.stiffness * flexibility > 1 + DECK_DIGITS:
            refuse_model(
                f"bolt '{bolt.name}': its stiffness {bolt.stiffness:g} is not contained in K, "
                f"which resists its elongation with {1 / flexibility:.6g} in all; give EA/L of "
                "what K holds between its nodes"
            )


def _check_clamping(system: Joint, forces: Mapping[str, float]) -> None:
    """Refuse bolts whose tension closes no gap."""
    ports = system.port_compliance
    for name in forces:
        row = ports.n_boundary + list(system.bolts).index(name)
        closing = system.contact.interpolation @ ports.contact_columns[row]
        if closing.max(initial=0.0) <= SOLVED * ports.input_rows[row, row]:
            refuse_model(
                f"bolt '{name}' clamps nothing: its tension closes no interface; check that head "
                "and nut are on the far sides of one, and that its direction is not reversed"
            )
