"""Newton's method on relative displacements, for contact of points that yield under any law.

With the relative displacements y of the pairs, y_f of them without contact forces, z = G y + z₀
at the points (z₀ holds the gap and minus the slip so far) and λ(z) what the laws answer, a problem
is

    R(y) = Σ (y − y_f) + h − Gᵀ λ(G y + z₀) = 0,   Σ = S⁻¹,                                   (F8)

and a step solves (Σ + Gᵀ K G) d = −R with K = −∂λ/∂z (:mod:`~faying.contact.glued_pairs`). It is
taken whole where that halves R, or its part dᵀR along the step; otherwise as far as dᵀR vanishes.
Without friction R is the slope of a convex energy, and the method always arrives. Coulomb's law has
none: where a step does not descend, or goes a short way, the next one holds tangential forces to
the bounds of the last normal ones, which is convex again (Tresca).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, Protocol, Self

import numpy as np

from faying._typing import Mask, Matrix, SparseMatrix, Vector
from faying.contact.held_pairs import NormalPairs
from faying.contact.increment import Increment
from faying.contact.point_springs import PointSprings
from faying.digits import SOLVED
from faying.exceptions import ConvergenceError
from faying.iterations import MOST_STEPS

ROUND_OFF = 2e-15
"""Residual over the largest force at which a problem is solved."""

QUADRATIC = 0.05
"""Residual of a step's system, over the residual that it begins with, per what this is itself."""

LOOSE = 1e-2
"""Largest residual of a step's system, over the one that it begins with.

Increments of a flange of which nearly all slips took 16.1 s, 19.1 with 1e-3 and 15.2 with 5e-2, in
as many steps.
"""

FORMED = 1e-4
"""Residual over the largest force from which what steps summed up is formed once more.

Where weak springs hold bodies Σ and S agree to 1e-8, of which so much is left in what follows.
"""

SMALLEST_FORCE_SHARE = 1e-4
"""Part of what would hold all points closed below which the largest force is no measure."""

LARGEST_REMAINDER = 0.5
"""Part of slope or residual that a whole step may leave."""

FLAT = 0.1
"""Part of the slope that a step of another length may leave."""

MOST_TRIALS = 8
"""Lengths of a step that are tried."""

SHORT_STEP = 0.15
"""Length of a step below which the next one fixes the friction bounds."""

MOST_SHORT = 8
"""Short steps with friction after which Newton's method has gone astray."""

MOST_ALONG_NORMALS = 12
"""Steps along normals alone between whole ones."""

SLIP_ON_SCALE = 1.0 + 1e-9
"""What tangential displacements are scaled by, so that points at their bound slip on at first."""


class PairsOnSprings(Protocol):
    """Pairs on springs at their points."""

    @property
    def springs(self) -> Matrix:
        """K₀ (components, n_point) [force/length]."""
        ...

    def moved_by(self, forces: Vector) -> Vector:
        """Return (Σ + Gᵀ K₀ G)⁻¹ b of forces (n_relative,)."""
        ...


class Steps(Protocol):
    """What solves the systems of Newton's method."""

    @property
    def points(self) -> PointSprings:
        """G, displacements at the points (components n_point, n_relative)."""
        ...

    def step(
        self, K: Matrix, right: Vector, enough: float, factors: Any = None
    ) -> tuple[Vector, Vector, Any]:
        """Return d of (Σ + Gᵀ K G) d = b, Σ d, and what the next step takes as factors."""
        ...


class Pairs(Steps, Protocol):
    """What Newton's method asks of the structure between the pairs."""

    @property
    def glued(self) -> PairsOnSprings:
        """The pairs where points are closed and stick."""
        ...

    @property
    def normal(self) -> NormalPairs | None:
        """The pairs along normals, where steps along these take little beside whole ones."""
        ...

    def resisted(self, displacements: Vector) -> Vector:
        """Return Σ w of displacements w (n_relative,)."""
        ...


class Answers(Protocol):
    """What points answer to displacements."""

    def respond(self, moved: Matrix) -> tuple[Matrix, Matrix]:
        """Return λ (components, n_point) and K (n_point, components, components)."""
        ...


class Laws(Answers, Protocol):
    """What points answer and yield, as far as they have been closed so far."""

    @property
    def components(self) -> int:
        """Components of force at a point."""
        ...

    def after(self, deepest: Vector | None) -> Self:
        """Return the laws of points that have been closed so far, if any remembers that."""
        ...

    def closed_to(self, gap: Vector) -> Vector | None:
        """Return the largest closures (n_point,) once the gap is so; None if nothing remembers."""
        ...

    def yielded(self, forces: Matrix) -> Matrix:
        """Return what the laws yield to forces (components, n_point) [length]."""
        ...


@dataclass(frozen=True, eq=False)
class State:
    """Where Newton's method stands: displacements, structure's forces, points, laws."""

    y: Vector
    p: Vector
    z: Matrix
    forces: Matrix
    K: Matrix
    G_T: SparseMatrix | Matrix
    least: float

    @cached_property
    def rest(self) -> Vector:
        """R (n_relative,) [force]."""
        return np.asarray(self.p - self.G_T @ self.forces.ravel())

    @cached_property
    def left(self) -> float:
        """R over the largest force, or over that which counts where nothing presses."""
        return float(
            np.abs(self.rest).max(initial=0.0) / np.abs(self.forces).max(initial=self.least)
        )


def solve_yielding(
    laws: Laws,
    pairs: Pairs,
    free: Vector,
    offset: Matrix,
    start: Increment | None = None,
    *,
    pull: Vector | None = None,
    moved_by: Callable[[Vector], Vector] | None = None,
) -> Increment:
    """Solve (F8).

    Given are y_f (n_relative,) [length], the offset z₀ (3, n_point) [length] and the pull h
    (n_relative,) [force]. It begins with a solution of the increment before or a similar case; by
    default all points close and stick. The solution is corrected by ``moved_by``, which returns S p
    (n_relative,) [length] of forces between the pairs, for Σ has fewer digits where weak springs
    hold bodies.
    """
    k = laws.components
    laws = laws.after(None if start is None else start.deepest)
    law_offset = offset[:k]
    pulled = np.zeros(len(free)) if pull is None else pull
    begun = _begun(laws, pairs, free, law_offset, start, pulled)
    form = partial(_formed, laws, pairs, free, law_offset, pull=pulled, moved_by=moved_by)
    normal = pairs.normal
    press = None if normal is None else partial(_pressed, laws, pairs, normal)
    state, steps, _ = descend(laws, pairs, begun, press=press, form=form)
    forces, slack = np.zeros(offset.shape), offset.copy()
    forces[:k] = state.forces
    slack[:k] = state.z + laws.yielded(state.forces)
    return Increment(
        forces=forces,
        slack=slack,
        moved=state.y,
        iterations=steps,
        residual=state.left,
        deepest=laws.closed_to(state.z[0]),
    )


def descend(
    laws: Answers,
    pairs: Steps,
    state: State,
    *,
    press: Callable[[State], State] | None = None,
    form: Callable[[State], State] | None = None,
    factors: Any = None,
    solved: float = ROUND_OFF,
) -> tuple[State, int, Any]:
    """Return the state in which Newton's method ends, its steps, and the factors of the last.

    Points close and open by ``press`` between steps; what these summed up is formed once more by
    ``form``. Factors may be those of a similar problem.

    Raises
    ------
    ConvergenceError
        If more than :data:`SOLVED` is left.
    """
    G, k = pairs.points.G, len(state.z)
    state = state if press is None else press(state)
    steps, short, bounded, previous = 0, 0, False, np.inf
    while steps < MOST_STEPS and short < MOST_SHORT and np.isfinite(state.left):
        if form is not None and state.left <= FORMED:
            # What Newton's method summed up step by step is formed once more, by S or by Σ: S
            # beside rigid motions on weak springs leaves 1e-5, which later steps take away.
            state, form = form(state), None
        if state.left <= solved or steps_ended(state.left, previous):
            break
        previous = state.left
        K = state.K
        if bounded:
            K = K.copy()
            K[:, 1:, 0] = 0.0
        # No step leaves less than it changes the laws, nor need the last one leave less than that.
        enough = min(LOOSE, max(QUADRATIC * state.left, 0.5 * ROUND_OFF / state.left))
        d, resisted, factors = pairs.step(K, -state.rest, enough, factors)
        moved = np.asarray((G @ d).reshape(state.z.shape))
        trial, length, descends = _along(laws, state, d, resisted, moved)
        bounded = k > 1 and not bounded and (not descends or length < SHORT_STEP)
        short += k > 1 and length < SHORT_STEP
        state, steps = trial if press is None else press(trial), steps + 1
    if not state.left <= SOLVED:
        message = (
            f"contact was not solved in {steps} Newton steps (residual {state.left:.1e} of the "
            "largest force)"
        )
        if k > 1:
            message += "; take smaller increments, or a smaller coefficient of friction"
        raise ConvergenceError(message)
    return state, steps, factors


def steps_ended(left: float | Vector, previous: float | Vector) -> bool | Mask:
    """Say of residuals over the largest force, each, whether further steps leave no less."""
    return (left <= ROUND_OFF) | ((left <= SOLVED) & (left > LARGEST_REMAINDER * previous))


def _formed(
    laws: Laws,
    pairs: Pairs,
    free: Vector,
    offset: Matrix,
    state: State,
    *,
    pull: Vector,
    moved_by: Callable[[Vector], Vector] | None,
) -> State:
    """Return the state in which pairs and the structure's forces tell each other."""
    if moved_by is None:
        return replace(state, p=pairs.resisted(state.y - free) + pull)
    y = free + moved_by(state.p - pull)
    z = _at(pairs.points.G, y, offset)
    return State(y, state.p, z, *laws.respond(z), pairs.points.transposed, state.least)


def _begun(
    laws: Laws,
    pairs: Pairs,
    free: Vector,
    offset: Matrix,
    start: Increment | None,
    pull: Vector,
) -> State:
    """Return where Newton's method begins."""
    G, shape = pairs.points.G, offset.shape
    if start is None:
        # As if every point were closed and stuck: what then pulls opens in the steps that follow.
        glued = pairs.glued
        pressed = pull + pairs.points.transposed @ (glued.springs * _at(G, free, offset)).ravel()
        moved = glued.moved_by(-pressed)
        y, p = free + moved, pairs.resisted(moved) + pull
    else:
        y = start.moved
        p = pairs.resisted(y - free) + pull
    z = _at(G, y, offset)
    forces, K = laws.respond(z)
    if start is not None and shape[0] > 1:
        onward = z.copy()
        onward[1:] *= SLIP_ON_SCALE
        K = laws.respond(onward)[1]
    floor = max(SMALLEST_FORCE_SHARE * float(np.abs(p).max(initial=0.0)), np.finfo(float).tiny)
    return State(y, p, z, forces, K, pairs.points.transposed, floor)


def _pressed(laws: Answers, pairs: Pairs, normal: NormalPairs, state: State) -> State:
    """Return the state once points have closed and opened along normals, tangents held.

    Where a contact zone grows or shrinks whole steps take it on by a row of points each. Along
    normals, a third of the unknowns, they are solved in less than a tenth of the time; as long as
    these leave most of the residual.
    """
    for _ in range(MOST_ALONG_NORMALS):
        rest = np.abs(state.rest)
        if state.left <= FORMED or rest[normal.felt].max(initial=0.0) < rest.max(initial=0.0):
            break
        moved = normal.moved_by(-state.rest[normal.felt], state.K[:, 0, 0])
        if moved is None:
            break
        d = np.zeros_like(state.y)
        d[normal.felt] = moved
        along = (pairs.points.G @ d).reshape(state.z.shape)
        state, _, _ = _along(laws, state, d, pairs.resisted(d), along)
    return state


def _at(G: SparseMatrix | Matrix, y: Vector, offset: Matrix) -> Matrix:
    """Return z (components, n_point)."""
    return np.asarray((G @ y).reshape(offset.shape) + offset)


def _along(
    laws: Answers, state: State, d: Vector, resisted: Vector, moved: Matrix
) -> tuple[State, float, bool]:
    """Return the state after a step d, its length, and whether it descends.

    The step is resisted by Σ d (n_relative,) [force] and has moved points by G d (components,
    n_point) [length].
    """
    at_first, curvature = float(d @ state.rest), float(d @ resisted)

    def reached(length: float) -> State:
        z = state.z + length * moved
        y, p = state.y + length * d, state.p + length * resisted
        return State(y, p, z, *laws.respond(z), state.G_T, state.least)

    def slope(trial: State, length: float) -> float:
        return at_first + length * curvature + float((moved * (state.forces - trial.forces)).sum())

    length, trial = 1.0, reached(1.0)
    last, descends = slope(trial, 1.0), at_first < 0
    fits = abs(last) <= LARGEST_REMAINDER * abs(at_first)
    if fits or np.linalg.norm(trial.rest) <= LARGEST_REMAINDER * np.linalg.norm(state.rest):
        return trial, length, descends
    if not (descends and last > 0):
        return trial, length, descends
    low, high, below, above = 0.0, 1.0, at_first, last
    for _ in range(MOST_TRIALS):
        # A chord that ends where the slope jumps would stay there: away from both ends.
        chord = low - below * (high - low) / (above - below)
        length = float(np.clip(chord, low + 0.1 * (high - low), high - 0.1 * (high - low)))
        trial = reached(length)
        trial_slope = slope(trial, length)
        if abs(trial_slope) <= FLAT * abs(at_first):
            break
        if trial_slope > 0:
            high, above = length, trial_slope
        else:
            low, below = length, trial_slope
    return trial, length, descends
