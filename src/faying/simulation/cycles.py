"""Cycles of a load about the preloaded joint, repeated until they no longer change."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Vector
from faying.digits import ROUND_OFF
from faying.exceptions import ModelError
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
"""Change of the energy per cycle, over it, below which a cycle repeats the one before."""

MOST_CYCLES = 30
"""Cycles after which one that still changes is given as it is; 2 to 5 are usual."""


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
        Where it began: one entry, at the amplitude.
    energies : (n_cycle,) [force·length]
        What friction took in each cycle.
    stationary
        Whether the last two agree.
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
    """Let a load go to and fro about the preloaded joint until its cycles repeat.

    The load first rises to the amplitude, then full cycles follow.

    Parameters
    ----------
    system
        Full or reduced model; friction makes the difference between cycles.
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
        Cycles to solve whatever they do; by default until they repeat.

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
        message = (
            f"found an amplitude of {amplitude:g} and {increments} increments; give a positive "
            "factor of the load and one or more"
        )
        raise ModelError(message)
    rise = np.arange(1, increments + 1) / increments
    steps = np.arange(1, 2 * increments + 1) / increments
    factors = amplitude * np.concatenate([1 - steps, steps - 1])
    rest = solve_path(system, [Load()]) if initial is None else initial
    start, cycle, energies, stationary = _repeated(
        system, load, (amplitude * rise, factors), rest, count
    )
    return Cycles(
        amplitude=amplitude,
        factors=factors,
        cycle=cycle,
        start=start,
        energies=energies,
        stationary=stationary,
    )


def _repeated(
    system: System,
    load: Load,
    factors: tuple[Vector, Vector],
    rest: Solution,
    count: int | None,
) -> tuple[Solution, Solution, Vector, bool]:
    """Return where the last cycle starts, the cycle, the energies of all, and whether they repeat.

    Displacements are computed of the last cycle alone, and where the others reverse.
    """
    rise, cycle = (path_inputs(system, scaled_loads(load, factor)) for factor in factors)
    here = path_start(system, rest)
    solver = system.static_contact.increments.about(here.increment)
    steps = list(follow(solver, moved_alone(system, rise), here))
    relative = moved_alone(system, cycle)
    ends = cycle[[len(cycle) // 2 - 1, -1]]
    start, energies, stationary = steps[-1], list[float](), False
    before = list[PathStep]()
    while len(energies) < (count or MOST_CYCLES) and (count is not None or not stationary):
        start = steps[-1]
        steps = list(follow(solver, relative, start, before=before))
        before = [start, *steps]
        energies.append(float(np.sum([step.dissipation for step in steps])))
        reversals = assembled(system, ends, [steps[len(steps) // 2 - 1], steps[-1]], "reversals")
        work = float(np.ptp(load_work(reversals, load))) * float(np.abs(factors[1]).max())
        change = abs(energies[-1] - energies[-2]) if len(energies) > 1 else energies[-1]
        stationary = change <= max(STATIONARY * energies[-1], ROUND_OFF * work)
        stationary = stationary and not _deepened(start, steps[-1])
    begun = assembled(system, rise[-1:], [start], load.name)
    last = assembled(system, cycle, steps, load.name)
    return begun, last, np.array(energies), stationary


def _deepened(before: PathStep, later: PathStep) -> bool:
    """Say whether a cycle closed gaskets further than all before."""
    earlier, now = before.increment.deepest, later.increment.deepest
    if earlier is None or now is None:
        return now is not None
    return bool((now - earlier).max() > STATIONARY * np.abs(now).max())


def scaled_loads(load: Load, factors: Vector) -> list[Load]:
    """Return a load of constant forces times each of some factors.

    Raises
    ------
    ModelError
        If a force is a history.
    """
    return [load.scaled(float(factor)) for factor in factors]


def load_work(path: Solution, load: Load) -> Vector:
    """Return Σ f u (n_increment,), the displacement that a load does work on [force·length].

    Where the load is one force, this is that force times the displacement along it; the area it
    encloses over the load factor is the energy that goes in.
    """
    system, start = path.system, np.zeros(1)
    unit = load.inputs(system, start) - Load(bolt_forces=load.bolt_forces).inputs(system, start)
    work: Vector = np.atleast_2d(path.states) @ input_forces(system, unit)[0]
    return work


def loop_area(cycles: Cycles, load: Load) -> float:
    """Return the area of the last loop of load and displacement [force·length].

    Trapezoids between the increments: it agrees with the energy by slip as increments shrink.
    """
    factors = np.concatenate([[cycles.amplitude], cycles.factors])
    along = np.concatenate([load_work(cycles.start, load)[-1:], load_work(cycles.cycle, load)])
    return float(np.trapezoid(factors, along))
