"""Pretension with friction: bolts tightened along a path that remembers its slip."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.contact.increment import Increment
from faying.joint.system import System, initial_bolt_forces
from faying.simulation.bolted_state import BoltedState
from faying.simulation.bolts_by_force import BoltsByForce, forces_of_bolts
from faying.simulation.load import Load
from faying.simulation.path import PathStep, assembled, follow, moved_alone, path_start
from faying.simulation.preload import (
    NOTHING_LOST,
    Tightening,
    checked_bolts,
    say_open,
    tightening_stages,
)
from faying.simulation.preload_loss import PreloadLoss, loses
from faying.simulation.solution import Solution


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
    system: System,
    forces: Mapping[str, float],
    *,
    increments: int = 10,
    losses: Mapping[str, PreloadLoss] = NOTHING_LOST,
) -> FrictionalTightening:
    """Tighten bolts one after the other to their nominal final forces, with friction throughout.

    The joint starts unstressed and free of slip, bolts that are not named at the initial forces
    they are locked at. Each bolt is turned in equal increments of its force while the others stay
    locked; a last increment on all of several bolts together restores what neighbours took away.
    Forces [force] are final axial ones in tightening order. After all are tightened bolts lose
    their losses, in an increment each of relaxation and embedding.

    Raises
    ------
    ModelError
        As :func:`faying.tighten`.
    ConvergenceError
        If an increment is not solved, or nothing resists a bolt.

    Notes
    -----
    One increment of friction each: initial forces are unknown beside the contact forces (T1).
    """
    names, state = checked_bolts(system, forces), initial_bolt_forces(system)
    path = [path_start(system, None)]
    inputs: list[Vector] = []
    if state.any() or not forces:
        inputs.append(_inputs(system, state))
        path += follow(
            system.static_contact.increments, moved_alone(system, inputs[-1][None]), path[-1]
        )
    reached: list[tuple[str, Vector]] = []
    problem, alike = BoltsByForce(joint=system, bolts=np.empty(0, dtype=np.int64)), 0
    for stage, chosen, goal in _stages(names, forces, increments):
        step = path[-1]
        start = step.increment if step.increment.begun else None
        if not np.array_equal(problem.bolts, chosen):
            problem, alike = BoltsByForce(joint=system, bolts=chosen), 0
        if start is not None and (alike > 1 or (alike and not path[-2].increment.begun)):
            # What the bolt moved in its increment before, it moves about once more.
            start = replace(start, moved=2.0 * start.moved - path[-2].increment.moved)
        alike += 1
        increment, state = problem.solve(goal, state, step.slip, start)
        inputs.append(_inputs(system, state))
        path.append(_step(system, inputs[-1], increment, step.slip + increment.slack[1:]))
        reached.append((stage, forces_of_bolts(system, state, increment)))
    if reached:
        say_open(system, path[-1].increment)
    if losses:
        done = BoltedState(
            joint=system,
            nuts=state,
            initial=state,
            loose=np.zeros(len(names), dtype=bool),
            slip=path[-1].slip,
            contact=path[-1].increment,
        )
        for stage, loss_state in loses(done, losses):
            state = loss_state.initial
            inputs.append(_inputs(system, state))
            contact = cast("Increment", loss_state.contact)
            path.append(_step(system, inputs[-1], contact, loss_state.slip))
            reached.append((stage, loss_state.forces))
    loads = [
        Load(name="preload", bolt_forces=dict(zip(names, row.tolist(), strict=True)))
        for row in (row_inputs[system.port_compliance.bolts] for row_inputs in inputs)
    ]
    return FrictionalTightening(
        tightening=Tightening.of(names, state, reached),
        loads=tuple(loads),
        rest=assembled(system, np.array(inputs[-1:]), path[-1:], "preload"),
    )


def _stages(
    names: Sequence[str], forces: Mapping[str, float], increments: int
) -> Iterator[tuple[str, Indices, Vector]]:
    """Yield the stages of all bolts; of one bolt alone the last pass would change nothing."""
    every = list(tightening_stages(names, forces, increments))
    yield from every[:-1] if len(forces) == 1 else every


def _step(system: System, inputs: Vector, contact: Increment, slip: Matrix) -> PathStep:
    """Return an increment of tightening as a step of a path."""
    return PathStep(
        relative=moved_alone(system, inputs[None])[0],
        increment=contact,
        slip=slip,
        iterations=contact.iterations,
        dissipation=contact.dissipation,
    )


def _inputs(system: System, initial: Vector) -> Vector:
    """Return the inputs (n_input,) of initial forces alone."""
    ports = system.port_compliance
    inputs = np.zeros(len(ports.input_rows))
    inputs[ports.bolts] = initial
    return inputs
