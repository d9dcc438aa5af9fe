"""Periodic motions over frequency: Newton's method with exact derivatives along the curve.

A step goes along the tangent and ends at the next given frequency if the curve allows it, else on a
plane across the tangent (pseudo-arclength; E. L. Allgower & K. Georg, Introduction to Numerical
Continuation Methods, 2003, §6), so that turning points are passed. Steps of Newton's method are
judged by the next step with the same factors (natural monotonicity; P. Deuflhard, Newton Methods
for Nonlinear Problems, 2011, §3.3), because residuals are no measure at a resonance. Derivatives
serve as long as steps shrink fast, corrected along the steps taken (Broyden's method; §3.2.3).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import cast

import numpy as np
import scipy.linalg as la

from faying._typing import Indices, Matrix, Vector
from faying.digits import SOLVED
from faying.exceptions import ConvergenceError
from faying.iterations import MOST_TRIALS
from faying.simulation.local_path import OffSprings
from faying.simulation.path_steps import MOST_DIVISIONS
from faying.simulation.periodic import PERIODS, Derivatives, Motion, PeriodicProblem

LARGEST_ERROR = 1e-6
"""Next step of Newton's method over the unknowns at which a motion is accepted at the limit of
round-off; it is solved where that is as small as :data:`~faying.digits.SOLVED`."""

FAST_CONVERGENCE = 0.2
"""Largest next step over the last one for which derivatives are used again: new ones take as long
as one to four paths. A lap joint of 464 points and seven harmonics took one or two of them and
seven to nine paths a frequency; with 0.03, three and six, which take a tenth longer."""

LARGEST_STEP = 0.5
"""Step of Newton's method over the unknowns that is taken whole."""

LARGEST_BEND = 0.4
"""Largest relative difference of a point from the one before."""

LAST_STEP = 1.5
"""What the step to the next frequency may be over the longest, so that as many steps lead there as
rounding gives: a flange, 1.8 of them away, came there by two motions, the last of three being a
hundredth of a step."""

SHORTEST = 1e-4
"""Step along the curve, over BEND, below which it is given up."""

RISE, LEAST_RISE = 0.25, 0.01
"""Steps of the level towards a first motion, over it: the first one and the least."""

LARGEST_DETOUR = 0.5
"""Largest detour of a curve on its way to the next frequency, over the frequency at its start."""

MOST_POINTS = 100
"""Most points of a curve between two given frequencies."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CurvePoint:
    """A solved motion on the curve, with its derivatives.

    Attributes
    ----------
    problem
        With the points that had to be watched.
    motion
    derivatives
        Derivatives at the last step of Newton's method.
    error
        Next step of Newton's method over the unknowns.
    """

    problem: PeriodicProblem
    motion: Motion
    derivatives: Derivatives
    error: float

    @property
    def unknowns(self) -> Vector:
        """Real unknowns (size,)."""
        return self.problem.packed(self.motion.harmonics)

    def behind(self) -> "CurvePoint":
        """Return the point without the factors and derivatives that the next point starts from."""
        path = replace(self.motion.path, factors=())
        motion, derivatives = replace(self.motion, path=path), replace(self.derivatives, excess=())
        return replace(self, motion=motion, derivatives=derivatives)

    def tangent(self) -> Vector:
        """Return d(unknowns)/dω and 1 (size + 1,), not normalized."""
        slopes = self.derivatives.residual
        moved = la.solve(slopes[:, :-1], -slopes[:, -1])
        return np.append(moved, 1.0)


def solve_motion(
    problem: PeriodicProblem,
    unknowns: Vector,
    circular: float,
    across: Vector | None = None,
    guesses: Sequence[Matrix] = (),
    kept: Sequence[OffSprings | None] = (),
) -> CurvePoint:
    """Solve for the motion at a frequency, or on the plane through a guess across a tangent.

    The normal of the plane (size + 1,) is in unknowns and circular frequency; by default the
    frequency stays. Guesses are what the forces beside those of springs may be along the path
    (PERIODS N, components n_local), and factors may be kept from a path that is close.
    """
    x = np.append(unknowns, circular)
    border = np.append(np.zeros(problem.size), 1.0) if across is None else across
    problem, _, motion = _followed(problem, x, guesses, kept)
    derivatives = problem.derivatives(motion)
    factors, taken = _factors(derivatives, border), list[Vector]()

    def step(reached: Motion) -> Vector:
        right = -np.append(problem.residual(reached), 0.0)
        change = np.asarray(la.lu_solve(factors, right, check_finite=False))
        for before, after in pairwise(taken):
            change += _share(change, before) * after
        return change

    # Across a steep curve steps change the frequency most, and the motion with it.
    slope = np.linalg.norm(border[:-1]) * (np.linalg.norm(unknowns) / circular) ** 2 / border[-1]

    def length(change: Vector) -> float:
        return float(np.hypot(np.linalg.norm(change[:-1]), slope * change[-1]))

    change = step(motion)
    for _ in range(MOST_TRIALS):
        far, size = length(change), float(np.linalg.norm(x[:-1]))
        error = far / max(size, np.finfo(float).tiny)
        if not np.isfinite(error):
            break
        point = CurvePoint(problem=problem, motion=motion, derivatives=derivatives, error=error)
        part, left, ends = LARGEST_STEP / max(error, LARGEST_STEP), np.inf, error <= SOLVED
        fresh = not taken
        taken.append(change)
        while not ends and part >= 0.5**MOST_DIVISIONS:
            trial = x + part * change
            if trial[-1] > 0:
                guess = problem.begun(motion, part * change, derivatives)
                watching, rows, moved = _followed(problem, trial, [guess], motion.path.factors)
                onward = step(moved)
                left = length(onward)
                # The step was computed without the added points.
                if left <= (1 - part / 4) * far or len(rows) < watching.local.springs.size:
                    break
            # At the limit of round-off the motion is solved; old derivatives do not tell.
            ends, part = fresh and error <= LARGEST_ERROR, part / 2 if fresh else 0.0
        if ends:
            trial, guess = x, problem.begun(motion)
            if not len(_leaving(problem, x, guess)):
                return point
            watching, rows, moved = _followed(problem, x, [guess])
        elif part < 0.5**MOST_DIVISIONS and fresh:
            break
        elif part == 0:
            trial, watching, rows, moved = x, problem, np.arange(problem.local.springs.size), motion
        x, motion, problem, derivatives = trial, moved, watching, derivatives.at(rows)
        if ends or part < 1.0 or left > FAST_CONVERGENCE * far:
            derivatives = problem.derivatives(motion)
            factors, taken = _factors(derivatives, border), []
            change = step(motion)
        else:
            change = onward / (1 - _share(onward, change))
    message = f"no periodic motion was found at {motion.circular / (2 * np.pi):.6g}"
    raise ConvergenceError(message)


def _followed(
    problem: PeriodicProblem,
    x: Vector,
    guesses: Sequence[Matrix] = (),
    kept: Sequence[OffSprings | None] = (),
) -> tuple[PeriodicProblem, Indices, Motion]:
    """Return the motion along all periods; points that leave their springs are added to watch.

    The new rows of μ are returned too.
    """
    n = problem.local.springs.size
    guess = guesses[0] if guesses else np.zeros((PERIODS * problem.samples, n))
    leaving, rows = _leaving(problem, x, guess), np.arange(n)
    if len(leaving):
        before = problem.local
        problem, rows = problem.watching(leaving)
        spread = np.zeros((len(guesses), len(guess), problem.local.springs.size))
        for new, old in zip(spread, guesses, strict=True):
            new[:, rows] = old
        guesses = list(spread)
        if not problem.local.shares_coordinates(before):
            kept = ()
    return problem, rows, problem.follow(x[:-1], float(x[-1]), guesses, kept)


def _leaving(problem: PeriodicProblem, x: Vector, guess: Matrix) -> Indices:
    """Return points that leave their springs in a motion, periodic or not yet."""
    displaced = problem.displaced(x[:-1], float(x[-1]), guess)
    return problem.stuck.leaving(displaced, problem.local.points)


def _share(change: Vector, before: Vector) -> float:
    """Return the part of a step along another one, over that one."""
    return float(change[:-1] @ before[:-1]) / float(before[:-1] @ before[:-1])


def _factors(derivatives: Derivatives, border: Vector) -> tuple[Matrix, Indices]:
    factors: tuple[Matrix, Indices] = la.lu_factor(
        np.vstack([derivatives.residual, border]), check_finite=False
    )
    return factors


def trace(
    problem: PeriodicProblem,
    starts: Sequence[Vector],
    frequencies: Vector,
    progress: Callable[[int], object] | None = None,
    first: CurvePoint | None = None,
) -> "Traced":
    """Follow the curve from the first of some frequencies (n,) [1/time] to the last.

    ``starts`` are guesses of the unknowns (size,), tried in sequence where the ``first`` point is
    not given; ``progress`` is called with 1 after each frequency.
    """
    points, missed = list[CurvePoint](), list[str]()
    # Without a solution, the next frequency is tried from the linear motion.
    point: CurvePoint | None = None
    for number, target in enumerate((2 * np.pi * frequencies).tolist()):
        try:
            if point is None:
                passed = [first or _started(problem, starts, target)]
            else:
                passed = _onward(point, target)
            # Only the last point starts the next one.
            points = [*map(CurvePoint.behind, [*points, *passed[:-1]]), passed[-1]]
            point = passed[-1]
        except ConvergenceError as error:
            missed.append(f"{frequencies[number]:.6g}: {error}")
            point = points[-1] if points else None
        if point is not None:
            problem = point.problem
        if progress is not None:
            progress(1)
    return Traced(points=points, missed=tuple(missed))


def _started(problem: PeriodicProblem, starts: Sequence[Vector], circular: float) -> CurvePoint:
    """Solve for a first motion, by rising load levels where all starts are too far away."""
    for unknowns in starts:
        try:
            return solve_motion(problem, unknowns, circular)
        except ConvergenceError:
            continue
    reached, rise, point = 0.0, RISE, None
    while reached < 1.0:
        share = min(reached + rise, 1.0)
        begun = starts[-1] * share if point is None else point.unknowns * share / reached
        rising = problem if point is None else point.problem
        try:
            point = solve_motion(replace(rising, level=share * problem.level), begun, circular)
        except ConvergenceError:
            rise /= 2
            if rise < LEAST_RISE:
                raise
            continue
        reached, rise = share, min(2 * rise, RISE)
    return cast("CurvePoint", point)


@dataclass(frozen=True, eq=False, kw_only=True)
class Traced:
    """Points of a curve, and the frequencies without a solution."""

    points: list[CurvePoint]
    missed: tuple[str, ...]


def _onward(point: CurvePoint, target: float) -> list[CurvePoint]:
    """Return the points of the curve from one up to and including a circular frequency."""
    begin, points, reach = point.motion.circular, list[CurvePoint](), 1.0
    way, span = np.sign(target - begin), abs(target - begin)
    far = min(max(LARGEST_DETOUR * begin, 2 * span), begin)
    direction = way * point.tangent()
    if not np.isfinite(direction).all():
        message = "the curve is vertical"
        raise ConvergenceError(message)
    while len(points) < MOST_POINTS:
        x = np.append(point.unknowns, point.motion.circular)
        size = float(np.linalg.norm(x[:-1]))
        scale = np.append(np.full(len(x) - 1, 1 / size), 1 / x[-1])
        bent = float(np.linalg.norm(direction[:-1])) / size
        length = min(reach * LARGEST_BEND / max(bent, np.finfo(float).tiny), 2 * span)
        ahead = (target - x[-1]) * direction[-1] > 0
        lands = ahead and LAST_STEP * length * abs(direction[-1]) >= abs(target - x[-1])
        if lands:
            length = abs((target - x[-1]) / direction[-1])
        guess = x + length * direction
        guess[:-1], later = point.problem.turned(point.motion, length * direction[:-1])
        across = None if lands else scale**2 * direction
        try:
            if not begin - far < guess[-1] < begin + far:
                message = "the curve leads elsewhere"
                raise ConvergenceError(message)
            solved = solve_motion(
                point.problem,
                guess[:-1],
                target if lands else float(guess[-1]),
                None if across is None else across / np.abs(across).max(),
                [later, point.problem.begun(point.motion, length * direction, point.derivatives)],
                point.motion.path.factors,
            )
            off = np.linalg.norm(solved.unknowns - guess[:-1]) / size
            if off > LARGEST_BEND:
                message = "the curve bends too much"
                raise ConvergenceError(message)
        except ConvergenceError:
            reach = (length * bent / LARGEST_BEND) / 2
            if reach < SHORTEST:
                raise
            continue
        if (target - x[-1]) * (target - solved.motion.circular) < 0:
            return [*points, _between(point, solved, target)]
        if lands:
            return [*points, solved]
        points.append(solved.behind())
        reach = min(1.0, 2 * reach if off < LARGEST_BEND / 4 else reach)
        onward = solved.tangent()
        # The curve continues in its direction: past a turning point the frequency falls.
        same = float((scale**2 * direction) @ onward)
        direction, point = onward if same > 0 else -onward, solved
    message = f"more than {MOST_POINTS} points before the next frequency"
    raise ConvergenceError(message)


def _between(start: CurvePoint, finish: CurvePoint, target: float) -> CurvePoint:
    """Return the point at a circular frequency between two others."""
    begin, end = start.motion.circular, finish.motion.circular
    share = (target - begin) / (end - begin)
    guess = (1 - share) * start.unknowns + share * finish.unknowns
    change = np.append(guess - finish.unknowns, target - end)
    begun = finish.problem.begun(finish.motion, change, finish.derivatives)
    return solve_motion(finish.problem, guess, target, None, [begun], finish.motion.path.factors)
