"""A joint at rest, its modes and a harmonic load, common to the levels of a frequency response."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import scipy.linalg as la

from faying._typing import ComplexMatrix, Indices, Mask, Matrix, SparseMatrix, Vector
from faying.assessment.drawn_curve import drawn_curve, harmonics_of
from faying.assessment.response_curve import ResponseCurve, boundary_components
from faying.assessment.stuck_modes import (
    StuckModes,
    slipping_stiffness,
    stuck_modes,
    with_released_modes,
)
from faying.contact.stuck_points import StuckPoints
from faying.digits import DECK_DIGITS
from faying.exceptions import ConvergenceError
from faying.joint.system import System, input_forces
from faying.simulation.load import harmonic_inputs
from faying.simulation.path import path_start
from faying.simulation.periodic import PERIODS, ModalLoads, PeriodicProblem
from faying.simulation.periodic_curve import CurvePoint, Traced, solve_motion, trace
from faying.simulation.solution import Solution
from faying.simulation.stuck_rest import StuckRest

FEWEST, MOST, MORE = 3, 15, 3
"""First and largest number of harmonics, and the number added."""

MODE_SPAN = 1.5
"""Modes take part up to this multiple of the highest harmonic, or of harmonic FEWEST if higher."""

PER_HARMONIC, FEWEST_SAMPLES = 16, 64
"""Samples of a period: amplitudes at 64 and 128 differed by 0.3 %."""

MEETING_WIDTH = 0.3
"""Largest distance of (kω/ω_m)² from one at which harmonic k meets a mode."""

LARGEST_IMBALANCE = 0.02
"""Relative imbalance of work and dissipation above which there is a remark."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ForcedJoint:
    """The joint at rest, its modes and the load.

    Attributes
    ----------
    system
    stuck
        Its points, with closed ones stuck.
    load : (n_dof, 2)
        Real and imaginary part of the load at level one.
    frequencies : (n,) [1/time]
        Rising.
    modes
        Number of harmonics to the modes that take part, found once for all levels.
    slipping : (n_dof, n_dof)
        Stiffness of the joint of which all that is closed slips.
    loads
        Number of harmonics, and whether a level slides and opens as a whole, to the loads of the
        modes: what a level that does needs is added to them (F11).
    rest
        The state it vibrates about, the last one of a path.
    """

    system: System
    stuck: StuckPoints
    load: Matrix
    frequencies: Vector
    modes: Callable[[int], StuckModes]
    slipping: SparseMatrix | Matrix
    loads: Callable[[int, "Released"], ModalLoads]
    rest: Solution

    @classmethod
    def of(
        cls, system: System, load: Mapping[str, complex], state: Solution, frequencies: Vector
    ) -> "ForcedJoint":
        """Return the joint under a load, and the state about which it vibrates.

        Raises
        ------
        ModelError
            If contact is hard, or the load does not fit the system.
        """
        inputs = harmonic_inputs(system, load)
        parts = input_forces(system, np.array([inputs.real, inputs.imag])).T
        start = path_start(system, state)
        solver = system.static_contact.increments
        stuck = StuckPoints.of(solver, start.increment.forces, start.slip, start.increment.moved)
        highest = float(frequencies[-1])
        slipping = slipping_stiffness(system, state)

        def span(harmonics: int) -> float:
            return MODE_SPAN * max(harmonics, FEWEST) * highest

        modes = cache(lambda harmonics: stuck_modes(system, state, span(harmonics)))

        @cache
        def loads(harmonics: int, released: Released) -> ModalLoads:
            shapes, between = modes(harmonics).shapes, (frequencies[0], span(harmonics))
            if released.slides:
                shapes = with_released_modes(system, shapes, slipping, between)
            if released.opens:
                shapes = with_released_modes(system, shapes, system.K, between)
            still = modes(harmonics)
            rest = StuckRest.of(system, still.stiffness, still.factor, shapes, parts)
            return ModalLoads.of(system, stuck, parts, rest)

        return cls(
            system=system,
            stuck=stuck,
            load=parts,
            frequencies=frequencies,
            modes=modes,
            slipping=slipping,
            loads=loads,
            rest=state,
        )

    def linear(self, level: float, frequencies: Vector) -> ResponseCurve:
        """Return the curve of the stuck joint."""
        loads, names = self.loads(FEWEST, Released()), boundary_components(self.system)
        moved = [level * loads.stuck(circular) for circular in (2 * np.pi * frequencies).tolist()]
        fundamental = np.array(moved).reshape(len(frequencies), len(names))
        return ResponseCurve(
            level=level,
            components=names,
            frequency=frequencies,
            harmonics=np.stack([np.zeros_like(fundamental), fundamental], axis=1),
        )

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
        begun, started = self._begun(level, order, samples)
        traced = self._traced(level, order, samples, begun, progress, started)
        released = begun.joined(drawn_curve(self.system, self.rest, level, traced))
        if not traced.missed and released != begun:
            more = self.loads(order, released).n_mode > self.loads(order, begun).n_mode
            top = _highest(traced.points) if more else None
            _, change = self._changed(top, order, samples, released)
            released = released if change > tolerance else begun
        if released != begun:
            traced = self._traced(level, order, samples, released)
        deviation: Vector | None = None
        if harmonics is None:
            deviation, checked, finer, change = self._checked(traced, order, samples, released)
            while change > tolerance and finer is not None and order + MORE <= MOST:
                # The worst motion alone tells how many harmonics all are computed with.
                while change > tolerance and finer is not None and order + MORE <= MOST:
                    order += MORE
                    finer, change = self._changed(finer, order + MORE, samples, released)
                first = None
                if not traced.missed:
                    first, _ = self._changed(traced.points[0], order, samples, released)
                traced = self._traced(level, order, samples, released, first=first)
                deviation, checked, finer, change = self._checked(traced, order, samples, released)
        else:
            # The user's choice is checked where the motion is largest.
            checked = _highest(traced.points)
            _, change = self._changed(checked, order + MORE, samples, released)
        if checked is not None and change > tolerance:
            at = f"{checked.motion.circular / (2 * np.pi):.6g}"
            remarks.append(
                f"{MORE} harmonics more than {order} change the motion at {at} by {change:.1%}"
                if np.isfinite(change)
                else f"no motion was found at {at} with {order + MORE} harmonics"
            )
        curve = drawn_curve(self.system, self.rest, level, traced)
        if curve.contact is not None and len(curve.frequency):
            imbalance = np.abs(curve.contact.imbalance)
            if (imbalance > LARGEST_IMBALANCE).any():
                worst = int(np.argmax(imbalance))
                remarks.append(
                    f"damping and friction miss {imbalance[worst]:.1%} of the work of the load at "
                    f"{curve.frequency[worst]:.6g}; take more samples"
                )
            sliding = curve.frequency[curve.contact.stick_share == 0]
            if len(sliding):
                remarks.append(
                    "all that is closed on an interface slips at once between "
                    f"{sliding.min():.6g} and {sliding.max():.6g}"
                )
        shown = curve.harmonics[:, : order + 1]
        return replace(curve, harmonics=shown, remarks=tuple(remarks), deviation=deviation)

    def _traced(
        self,
        level: float,
        order: int,
        samples: int | None,
        released: "Released",
        progress: Callable[[int], object] | None = None,
        first: CurvePoint | None = None,
    ) -> Traced:
        """Return the motions with so many harmonics."""
        problem = self._problem(level, order, samples, released)
        starts = self._starts(problem, released)
        return trace(problem, starts, self.frequencies, progress, first)

    def _begun(
        self, level: float, order: int, samples: int | None
    ) -> tuple["Released", CurvePoint | None]:
        """Return the first motion, or that the joint may slide if that of the stuck one fails.

        Few harmonics come first and twice as many after them, from which Newton's method goes on.
        """
        count = min(FEWEST, order)
        problem = self._problem(level, count, samples, Released())
        (start,) = self._starts(problem, Released())
        driven = 2 * np.pi * float(self.frequencies[0])
        try:
            point: CurvePoint | None = solve_motion(problem, start, driven)
        except ConvergenceError:
            return Released(slides=True), None
        while point is not None and count < order:
            count = min(2 * count, order)
            point, _ = self._changed(point, count, samples, Released())
        return Released(), point

    def _starts(self, problem: PeriodicProblem, released: "Released") -> list[Vector]:
        """Return first guesses of the unknowns, the closest first."""
        driven, rest = 2 * np.pi * float(self.frequencies[0]), problem.loads.rest
        first = np.zeros(problem.pairs.shape, dtype=complex)
        first[1] = problem.level * rest.swung(driven)[: rest.n_mode]
        starts = [problem.packed(first)]
        if released.slides:
            # Where slip prevails over stick, the motion without friction is closer.
            shapes, C = rest.shapes, self.system.C
            slipping = shapes.T @ (self.slipping @ shapes) + 1j * driven * (shapes.T @ (C @ shapes))
            slipping = slipping - driven**2 * np.eye(len(slipping))
            forced = rest.forced[: rest.n_mode]
            first[1] = problem.level * np.linalg.solve(slipping, forced)
            starts.insert(0, problem.packed(first))
        return starts

    def _problem(
        self,
        level: float,
        order: int,
        samples: int | None,
        released: "Released",
        points: Indices | None = None,
    ) -> PeriodicProblem:
        loads = self.loads(order, released)
        count = samples or max(FEWEST_SAMPLES, PER_HARMONIC * order)
        return PeriodicProblem.of(
            self.stuck,
            self.stuck.first() if points is None else points,
            loads,
            level=level,
            pairs=self._pairs(loads.rest, order, count),
            samples=count,
        )

    def _pairs(self, rest: StuckRest, order: int, samples: int) -> Mask:
        """Return the harmonics of shapes that move (H + 1, n_mode), with so many samples.

        To an order all do, and past it those that inertia moves more than it holds, k²ω² < 2 ω_m²
        at any frequency, as far as a harmonic has eight samples.
        """
        k = np.arange(max(order, samples // 8) + 1)[:, None]
        driven = 2 * np.pi * float(self.frequencies[0])
        squares = np.diag(rest.stiffness)[: rest.n_mode]
        pairs = (k <= order) | ((k * driven) ** 2 < 2 * squares)
        return np.asarray(pairs[: int(np.flatnonzero(pairs.any(axis=1))[-1]) + 1])

    def _first_order(self) -> int:
        """Return the number of harmonics past the first that meets an excited mode."""
        modes = self.modes(MOST)
        reached = np.abs(modes.shapes.T @ self.load).max(axis=1)
        frequencies = modes.frequencies[reached > DECK_DIGITS * reached.max(initial=0.0)]
        for k in range(2, MOST - 1):
            low, high = k * self.frequencies[0], k * self.frequencies[-1]
            below, above = low / np.sqrt(1 + MEETING_WIDTH), high / np.sqrt(1 - MEETING_WIDTH)
            if ((frequencies > below) & (frequencies < above)).any():
                return max(FEWEST, k + 2)
        return FEWEST

    def _checked(
        self, traced: Traced, order: int, samples: int | None, released: "Released"
    ) -> tuple[Vector, CurvePoint | None, CurvePoint | None, float]:
        """Return how more harmonics change all motions, the worst one, and what becomes of it.

        That one is solved for, and its change comes last. Those of the others are in proportion to
        it, by one step of Newton's method for each, among the points watched so far.
        """
        steps = [self._first_step(at, order + MORE, samples, released) for at in traced.points]
        worst = traced.points[int(np.argmax(steps))] if steps else None
        finer, change = self._changed(worst, order + MORE, samples, released)
        largest = max(steps, default=0.0)
        told = change / largest if 0 < largest < np.inf and np.isfinite(change) else 1.0
        return told * np.array(steps), worst, finer, change

    def _first_step(
        self, point: CurvePoint, order: int, samples: int | None, released: "Released"
    ) -> float:
        """Return the first step of Newton's method with other harmonics, modes and samples."""
        problem, begun, guess = self._richer(point, order, samples, released)
        try:
            motion = problem.follow(begun, point.motion.circular, [guess])
        except ConvergenceError:
            return float("inf")
        slopes = problem.derivatives(motion).residual[:, :-1]
        step = problem.unpacked(la.solve(slopes, problem.residual(motion)))
        return float(np.linalg.norm(step[1]) / np.linalg.norm(motion.harmonics[1]))

    def _richer(
        self, point: CurvePoint, order: int, samples: int | None, released: "Released"
    ) -> tuple[PeriodicProblem, Vector, Matrix]:
        """Return a point's problem with other harmonics or modes, and guesses of x and μ."""
        coarse, watched = point.problem.moved(point.motion), point.problem.local.points
        problem = self._problem(point.problem.level, order, samples, released, watched)
        old, new = point.problem.loads.rest.directions, problem.loads.rest.shapes
        begun = np.zeros(problem.pairs.shape, dtype=complex)
        n = min(len(begun), len(coarse))
        begun[:n] = coarse[:n] @ (old.T @ (self.system.M @ new))
        forces, ratio = point.problem.begun(point.motion), point.problem.samples / problem.samples
        instants = np.rint((np.arange(PERIODS * problem.samples) + 1) * ratio - 1).astype(int)
        return problem, problem.packed(begun), forces[np.maximum(instants, 0)]

    def _changed(
        self, point: CurvePoint | None, order: int, samples: int | None, released: "Released"
    ) -> tuple[CurvePoint | None, float]:
        """Return a point with other harmonics or modes, and its relative change."""
        if point is None:
            return None, 0.0
        worked = _work(point)
        problem, begun, guess = self._richer(point, order, samples, released)
        try:
            fine = solve_motion(problem, begun, point.motion.circular, None, [guess])
        except ConvergenceError:
            return None, float("inf")
        change = float(np.linalg.norm(_work(fine) - worked))
        return fine, change / float(np.linalg.norm(worked))


@dataclass(frozen=True, kw_only=True)
class Released:
    """Whether an interface slides or opens as a whole in a motion."""

    slides: bool = False
    opens: bool = False

    def joined(self, curve: ResponseCurve) -> "Released":
        """Return this state combined with all motions of a curve; missed ones may slide."""
        contact = curve.contact
        if contact is None:
            return self
        slides = bool(curve.missed) or bool((contact.stick_share == 0).any())
        opens = bool((contact.open_share == 1).any())
        return Released(slides=self.slides or slides, opens=self.opens or opens)


def linear_range(frequencies: Vector) -> Vector:
    """Return frequencies (n,) over the range of others, for a linear curve."""
    return np.linspace(frequencies[0], frequencies[-1], 300)


def _work(point: CurvePoint) -> ComplexMatrix:
    """Return the first harmonic of the displacements along both parts of the load."""
    return np.asarray(harmonics_of(point.motion.outputs[:2], 1)[1])


def _highest(points: Sequence[CurvePoint]) -> CurvePoint | None:
    """Return the point of the largest displacement along the load."""
    return max(points, key=lambda point: float(np.linalg.norm(_work(point))), default=None)
