"""Ring-down of a mode of a joint with friction, and frequency and damping of the decay."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from faying._typing import Frozen, Vector
from faying.assessment.modal_cycles import measured
from faying.assessment.stuck_modes import stuck_mode
from faying.exceptions import ModelError, naming, refuse_model
from faying.joint.load_pattern import LoadPattern
from faying.joint.model import Model
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.compiled import warn_of_compiled
from faying.simulation.cycles import MOST_CYCLES, Repeated, repeat
from faying.simulation.integrators.energy_decaying import EnergyDecaying
from faying.simulation.integrators.integrator import Integrator
from faying.simulation.load import Load
from faying.simulation.path import assembled, moved_alone, path_inputs, path_start, solve_path
from faying.simulation.solution import Solution
from faying.simulation.transient import solve_transient

FEWEST_SWINGS = 3
"""Fewest half periods for a damping ratio, and fewest periods for several."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Decay:
    """A free motion, period by period.

    Attributes
    ----------
    times : (n,) [time]
        Middle of each period.
    amplitude : (n,)
        Half the peak-to-peak value there, in the unit of the motion.
    frequency : (n,) [1/time]
        Frequency of the damped motion.
    damping_ratio : (n,)
        ζ = δ/√(4π² + δ²) of the logarithmic decrement δ of that period.
    """

    times: Vector
    amplitude: Vector
    frequency: Vector
    damping_ratio: Vector


def free_decay(times: Vector, motion: Vector) -> Decay:
    """Return frequency and damping of a free motion in one mode.

    The motion is followed from extreme to extreme, so that it may come to rest away from zero, as
    a joint does after slip.

    Parameters
    ----------
    times : (n_time,) [time]
    motion : (n_time,)
        A modal coordinate, φᵀ M (u − u₀) with the mode φ, or a displacement in one mode.

    Raises
    ------
    ModelError
        If it has too few periods, is constant, or holds NaN or infinity.

    Notes
    -----
    Extremes are those of parabolas through three instants: for a motion in one mode alone, 20 steps
    a period give a damping ratio of 1e-2 with a relative error of 1e-5.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 5, 1000)
    >>> decay = free_decay(t, 0.3 + np.exp(-0.1 * t) * np.cos(20 * t))
    >>> bool(abs(decay.damping_ratio[0] - 0.1 / 20) < 1e-4)
    True
    """
    t, x = np.asarray(times, dtype=float), np.asarray(motion, dtype=float)
    if t.shape != x.shape or t.ndim != 1 or not np.isfinite(x).all():
        refuse_model(
            f"the motion has shape {x.shape} and the times {t.shape}; give one finite number for "
            "each instant"
        )
    instants, extremes = _extremes(t, x)
    swings = np.abs(np.diff(extremes)) / 2
    if len(swings) < FEWEST_SWINGS or not (swings > 0).all():
        refuse_model(
            f"the motion has {len(swings)} half swings, and its decay is told from "
            f"{FEWEST_SWINGS} on; take a longer time, or a coordinate that the mode moves"
        )
    decrement = np.log(swings[:-2] / swings[2:])
    middle = (instants[1:] + instants[:-1]) / 2
    return Decay(
        times=middle[1:-1],
        amplitude=swings[1:-1],
        frequency=1 / (middle[2:] - middle[:-2]),
        damping_ratio=decrement / np.hypot(2 * np.pi, decrement),
    )


def _extremes(t: Vector, x: Vector) -> tuple[Vector, Vector]:
    """Return instants and values of the extremes in between, refined by parabolas."""
    if len(x) < FEWEST_SWINGS:
        return t[:0], x[:0]
    rise_before, rise_after = x[1:-1] - x[:-2], x[2:] - x[1:-1]
    inner = (
        np.flatnonzero((rise_before * rise_after < 0) | ((rise_before != 0) & (rise_after == 0)))
        + 1
    )
    low, high = x[inner] - x[inner - 1], x[inner + 1] - x[inner]
    offset = 0.5 * (low + high) / (low - high)
    step = (t[inner + 1] - t[inner - 1]) / 2
    return t[inner] + offset * step, x[inner] + 0.25 * (low + high) * offset


@dataclass(frozen=True, eq=False, kw_only=True)
class RingDown(Frozen):
    """A mode that rings down.

    Attributes
    ----------
    mode
        Number of the mode, from 1.
    small_frequency : [1/time]
        Frequency of small vibrations, with every closed point stuck.
    measured_at
        The boundary, or one of its components, of ``motion``.
    motion : (n_time,) [length]
        Modal coordinate φᵀ M (u − u₀) times the displacement of the mode there.
    decay
        Frequency and damping ratio of ``motion``, period by period.
    solution
        The transient, of the system with the inertia load of the mode as another load.
    energies : (n_cycle,) [force·length]
        Energy dissipated by friction in each cycle before the release.
    remarks : (n_remark,)
        Remarks for the reader.
    """

    mode: int
    small_frequency: float
    measured_at: str
    motion: Vector
    decay: Decay
    solution: Solution
    energies: Vector = field(default_factory=lambda: np.zeros(0))
    remarks: tuple[str, ...] = ()


def ring_down(
    system: Model | ReducedModel,
    mode: int,
    amplitude: float,
    *,
    at: str | None = None,
    path: Sequence[Load] = (Load(),),
    increments: int = 20,
    cycles: int | None = None,
    periods: float = 4.0,
    steps_per_period: int = 100,
    integrator: Integrator | None = None,
    compiled: bool | None = None,
) -> RingDown:
    """Displace a joint in one of its modes, release it, and return the damping of the decay.

    The preloaded joint is loaded by α M φ in cycles until they repeat, as in
    :func:`faying.backbone`; after release it rings down in the mode φ and in motions excited by
    friction.

    Parameters
    ----------
    system
        Full or reduced model with friction.
    mode
        Number of the mode of small vibrations about the preloaded joint, from 1.
    amplitude : [length]
        Initial displacement at the measured place of the joint without slip.
    at
        A boundary, or one of its components as ``"tip.rx"``; by default the boundary that the mode
        moves most. The release is on its positive side, with ``"-tip.rx"`` on the negative.
    path
        Loads that lead to the state of vibration, of which the last one stays on. By default the
        bolts are tightened with friction in one increment.
    increments
        Number of increments of a quarter of a cycle.
    cycles
        Number of cycles before the release; by default until they repeat, 30 at most. Without
        cycles a joint settles during the ring-down: its first periods have more slip.
    periods, steps_per_period
        Duration in periods of small vibrations, and time steps of each.
    integrator
        By default :class:`faying.EnergyDecaying` at 0.8, with negligible numerical damping; hard
        contact with friction needs another one.
    compiled
        Deprecated, without effect.

    Raises
    ------
    ModelError
        Without friction, if a number is out of range, or the measured place does not move.
    ConvergenceError
        If an increment or a step is not solved.

    Notes
    -----
    Damping by decay and by cycles agrees within 5 to 9 % at small amplitudes where neighbouring
    modes follow quasi-statically, and differs by up to several times where a multiple of the
    frequency meets another mode (``docs/theory/friction.md``).

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
    >>> rubbing = joint.with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    >>> found = fy.ring_down(rubbing, 1, 0.1, periods=3)
    >>> bool((found.decay.damping_ratio > 0).all())
    True
    """
    _check(system, mode, amplitude, increments, cycles, periods, steps_per_period)
    preloaded = solve_path(system, path)
    stuck = stuck_mode(system, preloaded, mode)
    with naming(f"mode {mode}"):
        stuck, measure = measured(system, stuck, at)
    name = _unused_name(system, f"mode {mode}")
    inertia = LoadPattern(name=name, forces=np.asarray(system.M @ stuck.shape))
    pushed = replace(system, load_patterns={**system.load_patterns, name: inertia})
    circular, last = 2 * np.pi * stuck.frequency, path[-1]
    load = circular**2 * amplitude / measure.unit
    shares = np.arange(1, increments + 1) / increments

    def pushing(factors: Vector) -> list[Load]:
        return [
            replace(last, forces={**last.forces, name: load * factor})
            for factor in factors.tolist()
        ]

    displaced = solve_path(pushed, [*path, *pushing(shares)])
    inputs = path_inputs(pushed, pushing(np.concatenate([1 - shares, -shares, shares - 1, shares])))
    start = path_start(pushed, displaced)
    solver = pushed.static_contact.increments.about(start.increment)
    repeated = repeat(solver, moved_alone(pushed, inputs), start, cycles)
    if cycles != 0:
        displaced = assembled(pushed, inputs, repeated.steps[1:], name)
    warn_of_compiled(compiled)
    solution = solve_transient(
        pushed,
        last,
        initial=displaced,
        step=1 / stuck.frequency / steps_per_period,
        duration=periods / stuck.frequency,
        integrator=EnergyDecaying(0.8) if integrator is None else integrator,
    )
    motion = measure.unit * ((solution.states - preloaded.states[-1]) @ inertia.forces)
    decay = free_decay(np.asarray(solution.times), motion)
    return RingDown(
        mode=mode,
        small_frequency=stuck.frequency,
        measured_at=measure.name,
        motion=motion,
        decay=decay,
        solution=solution,
        energies=repeated.energies,
        remarks=_remarks(decay, repeated, cycles),
    )


def _remarks(decay: Decay, repeated: Repeated, cycles: int | None) -> tuple[str, ...]:
    remarks = []
    if cycles is None and not repeated.stationary:
        less = 1 - repeated.energies[-1] / repeated.energies[-2]
        remarks.append(
            f"cycles still changed after {MOST_CYCLES}, in the last one friction took {less:.1%} "
            "less than in the one before: part of the decay is the joint settling"
        )
    grown = int(np.count_nonzero(decay.damping_ratio <= 0))
    if grown:
        remarks.append(
            f"the swing grew in {grown} of {len(decay.damping_ratio)} periods, to which other "
            "modes gave energy or in which they are seen: damping ratios of single periods mean "
            "nothing here; take smaller amplitudes, or the mean over many periods"
        )
    return tuple(remarks)


def _check(
    system: Model | ReducedModel,
    mode: int,
    amplitude: float,
    increments: int,
    cycles: int | None,
    periods: float,
    steps_per_period: int,
) -> None:
    system.contact.check_rubs()
    wrong = []
    if mode not in range(1, system.K.shape[0]):
        wrong.append(f"there is no mode {mode}; modes are whole numbers from 1")
    if not 0 < amplitude < np.inf:
        wrong.append(f"the amplitude is {amplitude:g}; give a positive number")
    if increments < 1:
        wrong.append(f"found {increments} increments; give one or more")
    if cycles is not None and cycles < 0:
        wrong.append(f"found {cycles} cycles; give none or more")
    if not FEWEST_SWINGS <= periods < np.inf or steps_per_period < 20:
        wrong.append(
            f"found {periods:g} periods of {steps_per_period} steps; give {FEWEST_SWINGS} periods "
            "or more of 20 steps or more"
        )
    if wrong:
        raise ModelError("; ".join(wrong))


def _unused_name(system: Model | ReducedModel, name: str) -> str:
    """Return a name that no load pattern has yet."""
    while name in system.load_patterns:
        name += "'"
    return name
