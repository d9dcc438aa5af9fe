"""Cycles of a load about the preloaded joint, repeated until they no longer change."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.increment import IncrementSolver
from faying.digits import ROUND_OFF
from faying.exceptions import refuse_model
from faying.joint.system import System, input_forces
from faying.simulation.load import Load
from faying.simulation.path import (
    assembled,
    moved_alone,
    path_inputs,
    path_start,
    solve_path,
)
from faying.simulation.path_steps import PathStep, follow
from faying.simulation.solution import Solution

STATIONARY = 1e-3
"""Relative change of the energy per cycle below which a cycle repeats the one before; also of the
work of traction on the change of slip."""

MOST_CYCLES = 30
"""Most cycles, after which the last one is returned even if it still changes; 2 to 5 are usual."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Cycles:
    """Cycles of a load between ± amplitude times its nominal value.

    Attributes
    ----------
    amplitude
        Load factor at the reversals.
    factors : (n_increment,)
        Load factors of the last cycle: from the amplitude down to its opposite and up again.
    cycle
        The last cycle; every array has the increments as its first axis.
    start
        State at the start of the last cycle: one entry, at the amplitude.
    energies : (n_cycle,) [force·length]
        Energy dissipated by friction in each cycle.
    stationary
        Whether cycles repeat: the last two dissipate alike, or the last ends where it began.
    """

    amplitude: float
    factors: Vector
    cycle: Solution
    start: Solution
    energies: Vector
    stationary: bool


def solve_cycles(
    system: System,
    load: Load,
    amplitude: float = 1.0,
    initial: Solution | None = None,
    *,
    increments: int = 10,
    count: int | None = None,
) -> Cycles:
    """Cycle a load about the preloaded joint until its cycles repeat.

    The load first rises to the amplitude, then full cycles follow.

    Parameters
    ----------
    system
        Full or reduced model; without friction cycles dissipate nothing.
    load
        Load at factor one, of constant forces.
    amplitude
        Positive load factor of the reversals.
    initial
        Preloaded state to start from; by default the bolts are tightened first, in one increment
        with friction.
    increments
        Increments of a quarter of a cycle.
    count
        Number of cycles to solve; by default until they repeat.

    Raises
    ------
    ModelError
        If amplitude or increments are not positive, or the load is a history.
    ConvergenceError
        As :func:`faying.solve_path`.

    Notes
    -----
    Four times ``increments`` for each cycle.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
    >>> joint = joint.with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    >>> cycles = fy.solve_cycles(joint, fy.Load({"tip.Fz": 50.0}))
    >>> bool(cycles.energies[-1] > 0.0), cycles.stationary
    (True, True)
    """
    if not 0 < amplitude < np.inf or increments < 1:
        refuse_model(
            f"found an amplitude of {amplitude:g} and {increments} increments; give a positive "
            "factor of the load and one or more"
        )
    rise = np.arange(1, increments + 1) / increments
    steps = np.arange(1, 2 * increments + 1) / increments
    factors = amplitude * np.concatenate([1 - steps, steps - 1])
    start = path_start(system, solve_path(system, [Load()]) if initial is None else initial)
    solver = system.static_contact.increments.about(start.increment)
    risen, cycle = (
        path_inputs(system, [load.scaled(factor) for factor in way])
        for way in ((amplitude * rise).tolist(), factors.tolist())
    )
    *_, start = follow(solver, moved_alone(system, risen), start)
    repeated = repeat(solver, moved_alone(system, cycle), start, count)
    return Cycles(
        amplitude=amplitude,
        factors=factors,
        cycle=assembled(system, cycle, repeated.steps[1:], load.name),
        start=assembled(system, risen[-1:], repeated.steps[:1], load.name),
        energies=repeated.energies,
        stationary=repeated.stationary,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Repeated:
    """The last cycle of a repeated sequence of loads, with the energies of all cycles.

    Attributes
    ----------
    steps
        State at the start of the last cycle, and after each of its loads.
    energies : (n_cycle,) [force·length]
        Energy dissipated by friction in each cycle.
    stationary
        Whether the last cycle repeats the one before.
    """

    steps: list[PathStep]
    energies: Vector
    stationary: bool


def repeat(
    solver: IncrementSolver, relative: Matrix, start: PathStep, count: int | None = None
) -> Repeated:
    """Repeat a cycle of loads until it no longer changes, or ``count`` times.

    ``relative`` (n_load, n_relative) [length] are displacements of the pairs under the loads alone.
    """
    steps, energies, stationary = [start], list[float](), False
    most = MOST_CYCLES if count is None else count
    while len(energies) < most and not (stationary and count is None):
        before = steps if energies else ()
        steps = [steps[-1], *follow(solver, relative, steps[-1], before=before)]
        energies.append(float(np.sum([step.dissipation for step in steps[1:]])))
        stationary = repeats(solver.contact, steps, energies)
    return Repeated(steps=steps, energies=np.array(energies), stationary=stationary)


def repeats(contact: Contact, steps: Sequence[PathStep], energies: Sequence[float]) -> bool:
    """Return whether a cycle dissipated as much as the one before, or ends where it began."""
    begun, turned, end = (steps[at] for at in (0, len(steps) // 2, -1))
    left = np.abs((end.slip - begun.slip) * end.increment.forces[1:]).sum()
    change = min([*np.abs(np.diff(energies[-2:])), left])
    forces = end.increment.forces - turned.increment.forces
    moved = end.increment.moved - turned.increment.moved
    work = np.abs(contact.at_pairs(forces[0], forces[1:]) * moved).sum()
    alike = change <= max(STATIONARY * energies[-1], ROUND_OFF * work)
    return bool(alike) and not _closes_further(begun, end)


def _closes_further(before: PathStep, later: PathStep) -> bool:
    """Return whether a cycle closed gaskets further than all cycles before."""
    earlier, now = before.increment.deepest, later.increment.deepest
    if earlier is None or now is None:
        return now is not None
    return bool((now - earlier).max() > STATIONARY * np.abs(now).max())


def load_work(path: Solution, load: Load) -> Vector:
    """Return Σ f u (n_increment,), the work of a load on the displacements [force·length].

    For a single force this is the force times the displacement along it. The area that this
    encloses over the load factor is the energy supplied.
    """
    system, start = path.system, np.zeros(1)
    unit = load.inputs(system, start) - Load(bolt_forces=load.bolt_forces).inputs(system, start)
    work: Vector = np.atleast_2d(path.states) @ input_forces(system, unit)[0]
    return work


def loop_area(cycles: Cycles, load: Load) -> float:
    """Return the area of the last loop of load and displacement [force·length].

    By the trapezoidal rule between increments; it tends to the dissipated energy as they shrink.
    """
    factors = np.concatenate([[cycles.amplitude], cycles.factors])
    along = np.concatenate([load_work(cycles.start, load)[-1:], load_work(cycles.cycle, load)])
    return float(np.trapezoid(factors, along))
