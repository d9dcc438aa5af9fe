"""A joint at rest, its modes and a harmonic load: what the levels of a frequency response share."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import final

import numpy as np

from faying._typing import ComplexMatrix, ComplexVector, Matrix, Vector
from faying.assessment.backbone_response import LinearResponse
from faying.assessment.response_curve import ContactInMotion, ResponseCurve, boundary_components
from faying.assessment.slip import ON_THE_BOUND
from faying.assessment.stuck_modes import StuckModes, stuck_modes
from faying.contact.stuck_points import StuckPoints
from faying.exceptions import ConvergenceError
from faying.joint.system import System
from faying.simulation.harmonic_load import harmonic_inputs
from faying.simulation.path import path_start
from faying.simulation.periodic import ModalLoads, PeriodicProblem
from faying.simulation.periodic_curve import CurvePoint, Traced, solve_motion, trace
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


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class ForcedJoint:
    """The joint at rest, its modes and the load.

    Attributes
    ----------
    system
    stuck
        Its points, those that are closed sticking.
    inputs : (n_input,)
        Complex amplitudes at level one.
    frequencies : (n,) [1/time]
        Rising.
    modes
        Number of harmonics to the modes that take part, found once for all levels.
    """

    system: System
    stuck: StuckPoints
    inputs: ComplexVector
    frequencies: Vector
    modes: Callable[[int], StuckModes]

    @classmethod
    def of(
        cls, system: System, load: Mapping[str, complex], state: Solution, frequencies: Vector
    ) -> "ForcedJoint":
        """Return it for a load and the state to vibrate about.

        Raises
        ------
        ModelError
            If contact is hard, or the load does not fit the system.
        """
        inputs = harmonic_inputs(system, load)
        start = path_start(system, state)
        solver = system.static_contact.increments
        stuck = StuckPoints.of(solver, start.increment.forces, start.slip, start.increment.moved)
        highest = float(frequencies[-1])
        modes = cache(lambda harmonics: stuck_modes(system, state, SPAN * harmonics * highest))
        return cls(system=system, stuck=stuck, inputs=inputs, frequencies=frequencies, modes=modes)

    def linear(self, level: float, frequencies: Vector) -> ResponseCurve:
        """Return the curve of the stuck joint."""
        response = LinearResponse.of(self.system, self.modes(2), self.inputs)
        return response.curve(level, frequencies, {})

    def curve(
        self,
        level: float,
        *,
        harmonics: int | None = None,
        samples: int | None = None,
        tolerance: float = 0.01,
        progress: Callable[[int], object] | None = None,
    ) -> ResponseCurve:
        """Return the curve of a level.

        Parameters
        ----------
        harmonics, samples, tolerance
            As of :func:`faying.frequency_response`.
        progress
            Called with 1 after each frequency asked for.
        """
        order, remarks = harmonics or self._first_order(), list[str]()
        traced = self._traced(level, order, samples, progress)
        finer, change = self._finer(traced.points, samples)
        first = order
        while harmonics is None and change > tolerance and finer and order + MORE <= MOST:
            order += MORE
            finer, change = self._finer([finer], samples)
        if order > first:
            traced = self._traced(level, order, samples, None)
            finer, change = self._finer(traced.points, samples)
        if traced.points and finer is None:
            remarks.append(f"no motion was found at the peak with {order + MORE} harmonics")
        elif change > tolerance:
            remarks.append(f"{MORE} harmonics more than {order} change the peak by {change:.1%}")
        curve = _drawn(self.system, level, traced.points, traced.missed)
        if curve.contact is not None and len(curve.frequency):
            imbalance = np.abs(curve.contact.imbalance)
            if (imbalance > BALANCED).any():
                worst = int(np.argmax(imbalance))
                remarks.append(
                    f"damping and friction miss {imbalance[worst]:.1%} of the work of the load at "
                    f"{curve.frequency[worst]:.6g}; take more samples"
                )
            sliding = curve.frequency[curve.contact.stick_share == 0]
            if len(sliding):
                remarks.append(
                    f"all that is closed slips at once between {sliding.min():.6g} and "
                    f"{sliding.max():.6g}: modes of the stuck joint know little of the inertia of "
                    "what then moves; compare with a transient"
                )
        return replace(curve, remarks=tuple(remarks))

    def _traced(
        self,
        level: float,
        order: int,
        samples: int | None,
        progress: Callable[[int], object] | None,
    ) -> Traced:
        """Return the motions with so many harmonics."""
        problem = self._problem(level, order, samples)
        linear = LinearResponse.of(self.system, self.modes(order), self.inputs)
        driven = 2 * np.pi * float(self.frequencies[0])
        modal = linear.circular**2 - driven**2 + 1j * driven * linear.damping
        first = np.zeros((order, len(modal)), dtype=complex)
        first[0] = level * linear.forced / modal
        return trace(problem, problem.packed(first), self.frequencies, progress)

    def _problem(self, level: float, order: int, samples: int | None) -> PeriodicProblem:
        shapes = self.modes(order).shapes
        return PeriodicProblem(
            stuck=self.stuck,
            local=self.stuck.local(self.stuck.first()),
            loads=ModalLoads.of(self.system, self.stuck, self.inputs, shapes),
            level=level,
            n_harmonic=order,
            samples=samples or max(FEWEST_SAMPLES, PER_HARMONIC * order),
        )

    def _first_order(self) -> int:
        """Return a number of harmonics past the first one that meets a mode."""
        modes = self.modes(MOST).frequencies
        for k in range(2, MOST - 1):
            low, high = k * self.frequencies[0], k * self.frequencies[-1]
            below, above = low / np.sqrt(1 + MEETS), high / np.sqrt(1 - MEETS)
            if ((modes > below) & (modes < above)).any():
                return max(FEWEST, k + 2)
        return FEWEST

    def _finer(
        self, points: list[CurvePoint], samples: int | None
    ) -> tuple[CurvePoint | None, float]:
        """Return the highest point with more harmonics, and how much it changes, over it."""
        if not points:
            return None, 0.0
        worked = [_fundamental(point, slice(0, 2)) for point in points]
        size = [float(np.linalg.norm(work)) for work in worked]
        top = int(np.argmax(size))
        point, coarse = points[top], points[top].motion.harmonics
        order = point.problem.n_harmonic + MORE
        problem = replace(
            self._problem(point.problem.level, order, samples), local=point.problem.local
        )
        begun = np.zeros((order, problem.loads.n_mode), dtype=complex)
        begun[: len(coarse), : coarse.shape[1]] = coarse
        try:
            fine = solve_motion(problem, problem.packed(begun), point.motion.circular)
        except ConvergenceError:
            return None, float("inf")
        change = _fundamental(fine, slice(0, 2)) - worked[top]
        return fine, float(np.linalg.norm(change)) / size[top]


def linear_range(frequencies: Vector) -> Vector:
    """Return frequencies (n,) that draw a linear curve over the range of others."""
    return np.linspace(frequencies[0], frequencies[-1], 300)


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
    path, watched = motion.path, problem.local.points
    forces[:k, watched] = np.moveaxis(path.forces[-N:], 0, 2)
    far = np.hypot(*np.moveaxis(path.slack[-N:], 1, 0))
    pressed = path.forces[-N:, 0] > 0
    slips = np.zeros(contact.n_points, dtype=bool)
    slips[watched] = ((far > ON_THE_BOUND * far.max(initial=0.0)) & pressed).any(axis=0)
    closed = forces[0] > 0
    bound = (1 - ON_THE_BOUND) * contact.coefficients[:, None] * forces[0]
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
        "friction_energy": float(path.dissipation[-N:].sum()),
        "motion_energy": (motion.circular * np.linalg.norm(motion.harmonics[0])) ** 2 / 2,
        "peak_pressure": float((forces[0] / weights[:, None]).max(initial=0.0)),
        "stick_share": float((weights @ sticks / area).min()),
        "slip_share": float(weights[slips].sum() / max(weights[ever].sum(), 1e-300)),
        "open_share": float(
            (weights[at_rest] @ ~closed[at_rest]).max() / max(weights[at_rest].sum(), 1e-300)
        ),
        "bolt_force_range": loads.bolt_stiffness * np.ptp(bolts, axis=1),
        "error": point.error,
    }
