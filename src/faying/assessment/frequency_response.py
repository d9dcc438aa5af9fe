"""Responses to harmonic loads by harmonics of a few modes: what friction and gaps make of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import final

import numpy as np

from faying._typing import ComplexMatrix, Matrix, Vector
from faying.assessment.backbone_response import LinearResponse
from faying.assessment.modal_cycles import AT_BOUND
from faying.assessment.response_curve import (
    ContactInMotion,
    FrequencyResponse,
    ResponseCurve,
    boundary_components,
)
from faying.assessment.stuck_modes import StuckModes, stuck_modes
from faying.contact.stuck_points import StuckPoints
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.system import System
from faying.simulation.harmonic_load import harmonic_inputs
from faying.simulation.load import Load
from faying.simulation.path import path_start, solve_path
from faying.simulation.periodic import ModalLoads, PeriodicProblem
from faying.simulation.periodic_curve import CurvePoint, solve_motion, trace
from faying.simulation.solution import Solution

SPAN = 1.5
"""Modes take part up to this multiple of the highest harmonic."""

FEWEST, MOST, MORE = 3, 15, 3
"""Harmonics that are tried first, at most, and besides."""

PER_HARMONIC, FEWEST_SAMPLES = 16, 64
"""Samples of a period: amplitudes at 64 and 128 differed by 0.3 %."""

MEETS = 0.3
"""How far (kω/ω_m)² is from one where harmonic k meets a mode."""

BALANCED = 0.02
"""Work of the load that damping and friction may miss before it is said."""


def frequency_response(
    system: System,
    load: Mapping[str, complex],
    frequencies: Sequence[float] | Vector,
    levels: Sequence[float] | Vector = (1.0,),
    *,
    harmonics: int | None = None,
    samples: int | None = None,
    tolerance: float = 0.01,
    initial: Solution | None = None,
    progress: Callable[[int], object] | None = None,
) -> FrequencyResponse:
    """Compute the periodic motion of a joint under a harmonic load, with stick, slip and opening.

    Parameters
    ----------
    system
        Full or reduced model.
    load
        ``"boundary.component"``, or the name of a load pattern, to its complex amplitude F,
        f(t) = Re(F exp(iωt)): ``{"tip.Fz": 1.0, "tip.Fy": 1j}`` turns.
    frequencies : (n,) [1/time]
        Rising. Where the curve bends there are points between, also past turning points.
    levels : (n_level,)
        Factors of the load.
    harmonics
        Of the inertia of the modes. By default past the first one that meets a mode, and three more
        until that changes the peak by less than ``tolerance``.
    samples
        Increments of a period; by default 16 for each harmonic, 64 at least.
    tolerance
        Change of the peak by three more harmonics, over it.
    initial
        State to vibrate about, the last one of a path; by default the bolts are tightened with
        friction in one increment.
    progress
        Called with 1 after each level.

    Raises
    ------
    ModelError
        If a number is out of range, contact is hard, or the load does not fit the system.

    Notes
    -----
    Inertia and damping are those of the modes up to 1.5 times the highest harmonic, everything else
    follows quasi-statically (F11). Each motion is two periods from the slip of the joint at rest;
    points that stick all the time keep what came before, so that steady states are a family, a
    narrow one (``docs/theory/friction.md``). Frequencies at which no motion was found are named in
    ``missed`` of their curve.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(
    ...     element_size=10.0,
    ...     hole_radius=0.0,
    ...     washer_radius=11.0,
    ...     damping=fy.Rayleigh(alpha=50.0),
    ... )
    >>> joint = joint.with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    >>> found = fy.frequency_response(joint, {"tip.Fz": 1.0}, [640.0, 645.0], [1.0], harmonics=3)
    >>> found.curves[0].missed
    ()
    """
    system.contact.check_forgetful("steady vibrations", "solve_cycles")
    asked = np.asarray(frequencies, dtype=float)
    factors = np.atleast_1d(np.asarray(levels, dtype=float))
    _check(asked, factors, harmonics, samples, tolerance)
    rest = solve_path(system, [Load()]) if initial is None else initial
    setting = _Setting.of(system, load, rest, asked)
    remarks, curves = list[str](), list[ResponseCurve]()
    for level in factors.tolist():
        curves.append(setting.curve(level, harmonics, samples, tolerance, remarks))
        if progress is not None:
            progress(1)
    return FrequencyResponse(
        load=dict(load),
        curves=tuple(curves),
        linear=setting.linear(1.0, np.linspace(asked[0], asked[-1], 300)),
        remarks=tuple(remarks),
        units=system.units,
    )


def _check(
    frequencies: Vector,
    levels: Vector,
    harmonics: int | None,
    samples: int | None,
    tolerance: float,
) -> None:
    wrong = []
    rising = frequencies.ndim == 1 and len(frequencies) and (np.diff(frequencies) > 0).all()
    if not rising or not ((frequencies > 0) & (frequencies < np.inf)).all():
        wrong.append(f"the frequencies are {frequencies.tolist()}; give rising positive numbers")
    if not len(levels) or not ((levels > 0) & (levels < np.inf)).all():
        wrong.append(f"the levels are {levels.tolist()}; give positive numbers")
    if harmonics is not None and harmonics < 1:
        wrong.append(f"found {harmonics} harmonics; give one or more")
    if samples is not None and samples < 4 * (harmonics or FEWEST):
        wrong.append(f"found {samples} samples of a period; give four for each harmonic or more")
    if not 0 < tolerance < 1:
        wrong.append(f"the tolerance is {tolerance:g}; give a number between 0 and 1")
    if wrong:
        raise ModelError("; ".join(wrong))


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class _Setting:
    """The joint at rest, its modes and the load.

    Attributes
    ----------
    modes
        Number of harmonics to the modes that take part, found once for all levels.
    """

    system: System
    stuck: StuckPoints
    inputs: "np.ndarray[tuple[int], np.dtype[np.complex128]]"
    frequencies: Vector
    modes: Callable[[int], StuckModes]

    @classmethod
    def of(
        cls, system: System, load: Mapping[str, complex], rest: Solution, frequencies: Vector
    ) -> "_Setting":
        inputs = harmonic_inputs(system, load)
        start = path_start(system, rest)
        solver = system.static_contact.increments
        stuck = StuckPoints.of(solver, start.increment.forces, start.slip, start.increment.moved)
        highest = float(frequencies[-1])
        modes = cache(lambda harmonics: stuck_modes(system, rest, SPAN * harmonics * highest))
        return cls(system=system, stuck=stuck, inputs=inputs, frequencies=frequencies, modes=modes)

    def linear(self, level: float, frequencies: Vector) -> ResponseCurve:
        """Return the curve of the stuck joint."""
        return LinearResponse.of(self.system, self.modes(2), self.inputs).curve(
            level, frequencies, {}
        )

    def curve(
        self,
        level: float,
        harmonics: int | None,
        samples: int | None,
        tolerance: float,
        remarks: list[str],
    ) -> ResponseCurve:
        """Return the curve of a level."""
        order = harmonics or self._first_order()
        while True:
            modes = self.modes(order)
            loads = ModalLoads.of(self.system, self.stuck, self.inputs, modes.shapes)
            problem = PeriodicProblem(
                stuck=self.stuck,
                local=self.stuck.local(self.stuck.first()),
                loads=loads,
                level=level,
                n_harmonic=order,
                samples=samples or max(FEWEST_SAMPLES, PER_HARMONIC * order),
            )
            linear = LinearResponse.of(self.system, modes, self.inputs)
            driven = 2 * np.pi * float(self.frequencies[0])
            modal = linear.circular**2 - driven**2 + 1j * driven * linear.damping
            first = np.zeros((order, len(modal)), dtype=complex)
            first[0] = level * linear.forced / modal
            traced = trace(problem, problem.packed(first), self.frequencies)
            change = self._change(traced.points, samples)
            if harmonics is not None or not change > tolerance or order + MORE > MOST:
                break
            order += MORE
        if change > tolerance:
            remarks.append(
                f"level {level:g}: {MORE} harmonics more than {order} change the peak by "
                f"{change:.1%}"
            )
        curve = _drawn(self.system, level, traced.points, traced.missed)
        if curve.contact is not None and len(curve.frequency):
            imbalance = np.abs(curve.contact.imbalance)
            if (imbalance > BALANCED).any():
                worst = int(np.argmax(imbalance))
                remarks.append(
                    f"level {level:g}: damping and friction miss {imbalance[worst]:.1%} of the "
                    f"work of the load at {curve.frequency[worst]:.6g}; take more samples"
                )
        remarks.extend(f"level {level:g}, {text}" for text in traced.missed)
        return curve

    def _first_order(self) -> int:
        """Return a number of harmonics past the first one that meets a mode."""
        modes = self.modes(MOST).frequencies
        for k in range(2, MOST - 1):
            low, high = k * self.frequencies[0], k * self.frequencies[-1]
            below, above = low / np.sqrt(1 + MEETS), high / np.sqrt(1 - MEETS)
            if ((modes > below) & (modes < above)).any():
                return max(FEWEST, k + 2)
        return FEWEST

    def _change(self, points: list[CurvePoint], samples: int | None) -> float:
        """Return how much more harmonics change the highest point, over it."""
        if not points:
            return 0.0
        worked = [_fundamental(point, slice(0, 2)) for point in points]
        size = [float(np.linalg.norm(one)) for one in worked]
        top = int(np.argmax(size))
        point = points[top]
        order = point.problem.n_harmonic + MORE
        modes = self.modes(order)
        problem = replace(
            point.problem,
            loads=ModalLoads.of(self.system, self.stuck, self.inputs, modes.shapes),
            n_harmonic=order,
            samples=samples or max(FEWEST_SAMPLES, PER_HARMONIC * order),
        )
        more = np.zeros((order, modes.shapes.shape[1]), dtype=complex)
        before = point.motion.harmonics
        more[: len(before), : before.shape[1]] = before
        try:
            again = solve_motion(problem, problem.packed(more), point.motion.circular)
        except ConvergenceError:
            return float("inf")
        change = _fundamental(again, slice(0, 2)) - worked[top]
        return float(np.linalg.norm(change)) / size[top]


def _fundamental(point: CurvePoint, rows: slice) -> ComplexMatrix:
    """Return the first harmonic of some outputs."""
    return np.asarray(_harmonics(point.motion.outputs[rows], 1)[1])


def _harmonics(values: Matrix, count: int) -> ComplexMatrix:
    """Return harmonics 0 … count (count + 1, n) of samples (n, N) that end with the period."""
    samples = values.shape[1]
    angle = 2 * np.pi * np.outer(np.arange(count + 1), np.arange(1, samples + 1)) / samples
    weights = np.where(np.arange(count + 1) > 0, 2.0, 1.0) / samples
    return np.asarray((weights[:, None] * np.exp(-1j * angle)) @ values.T)


def _drawn(
    system: System, level: float, points: list[CurvePoint], missed: tuple[str, ...]
) -> ResponseCurve:
    """Return the curve of motions."""
    names = boundary_components(system)
    rows = [_row(system, point) for point in points]
    parts = {
        name: np.array([row[name] for row in rows]) for name in ContactInMotion.__dataclass_fields__
    }
    count = max((point.problem.n_harmonic for point in points), default=1)
    harmonics = [_harmonics(point.motion.outputs[_boundaries(point)], count) for point in points]
    return ResponseCurve(
        level=level,
        components=names,
        frequency=np.array([point.motion.circular for point in points]) / (2 * np.pi),
        harmonics=np.array(harmonics).reshape(len(points), count + 1, len(names)),
        missed=missed,
        contact=ContactInMotion(**parts),
    )


def _boundaries(point: CurvePoint) -> slice:
    loads = point.problem.loads
    return slice(loads.n_column, loads.n_column + loads.n_boundary)


def _row(system: System, point: CurvePoint) -> dict[str, float | Vector]:
    """Return what contact and loads do in the last period of a motion."""
    problem, motion, contact = point.problem, point.motion, system.contact
    stuck, loads, N = problem.stuck, problem.loads, problem.samples
    k = len(stuck.springs)
    displaced = problem.displaced(motion)[:, -N:]
    moved = (contact.rows @ displaced).reshape(k, contact.n_points, N)
    forces = np.zeros((3, contact.n_points, N))
    forces[:k] = stuck.forces[:k, :, None] - stuck.springs[:, :, None] * moved
    steps = motion.steps[-N:]
    slips = np.zeros(contact.n_points, dtype=bool)
    if steps:
        watched = problem.local.points
        forces[:, watched] = np.stack([step.increment.forces for step in steps], axis=2)
        slack = np.array([step.increment.slack[1:] for step in steps])
        pressed = np.array([step.increment.forces[0] > 0 for step in steps])
        far = np.hypot(slack[:, 0], slack[:, 1])
        slips[watched] = ((far > AT_BOUND * far.max(initial=0.0)) & pressed).any(axis=0)
    closed = forces[0] > 0
    bound = (1 - AT_BOUND) * contact.coefficients[:, None] * forces[0]
    sticks = closed & (np.hypot(forces[1], forces[2]) < bound)
    weights = contact.weights
    area = np.maximum(weights @ closed, np.finfo(float).tiny)
    ever, at_rest = closed.any(axis=1), stuck.forces[0] > 0
    inputs, damping = motion.outputs[:2], motion.outputs[2 + loads.n_mode : loads.n_column]
    # f du and q̇ Φᵀ C du over a period, by the first harmonics and those of the modes.
    orders = np.arange(1, problem.n_harmonic + 1)[:, None]
    velocity = 1j * orders * motion.harmonics
    damped = _harmonics(damping, problem.n_harmonic)[1:]
    first = _harmonics(inputs, 1)[1]
    bolts = motion.outputs[loads.n_column + loads.n_boundary :]
    return {
        "load_work": -np.pi * problem.level * float(first[0].imag - first[1].real),
        "damping_energy": np.pi
        * motion.circular
        * float((velocity.conj() * 1j * orders * damped).real.sum()),
        "friction_energy": float(sum(step.dissipation for step in steps)),
        "peak_pressure": float((forces[0] / weights[:, None]).max(initial=0.0)),
        "stick_share": float((weights @ sticks / area).min()),
        "slip_share": float(weights[slips].sum() / max(weights[ever].sum(), 1e-300)),
        "open_share": float(
            (weights[at_rest] @ ~closed[at_rest]).max() / max(weights[at_rest].sum(), 1e-300)
        ),
        "bolt_force_range": loads.bolt_stiffness * np.ptp(bolts, axis=1),
        "error": point.error,
    }
