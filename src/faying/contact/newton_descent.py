"""Newton's method for relative displacements, for contact with compliance under any law.

With the relative displacements y of the pairs, their values y_f without contact forces, z = G y +
z₀ at the points (z₀ holds the gap and minus the slip so far) and the contact forces λ(z) of the
laws, a problem is

    R(y) = Σ (y − y_f) + h − Gᵀ λ(G y + z₀) = 0,   Σ = S⁻¹,                                   (F8)

and a step solves (Σ + Gᵀ K G) d = −R with K = −∂λ/∂z (:mod:`~faying.contact.glued_pairs`). The
whole step is taken where that halves R, or its part dᵀR along the step; otherwise a length at
which dᵀR vanishes. Without friction R is the gradient of a convex energy, and the method always
converges. Coulomb's law has no energy: in place of a step that does not descend, and after a short
one, the bounds of tangential forces are fixed at the last normal forces, which is convex again
(Tresca).
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
"""Residual of a step's linear system over its right-hand side, per relative residual."""

LOOSE = 1e-2
"""Largest residual of a step's linear system over its right-hand side.

Increments of a flange with slip nearly everywhere took 16.1 s, 19.1 s with 1e-3 and 15.2 s with
5e-2, in as many steps.
"""

FORMED = 1e-4
"""Residual over the largest force below which the sums of all steps are formed once more.

With bodies on weak springs Σ and S agree to 1e-8, which limits the residual.
"""

SMALLEST_FORCE_SHARE = 1e-4
"""Smallest reference for residuals, over the largest force that would hold all points closed."""

LARGEST_REMAINDER = 0.5
"""Largest part of slope or residual that may remain after a whole step."""

FLAT = 0.1
"""Largest part of the slope that may remain after a step of another length."""

MOST_TRIALS = 8
"""Largest number of tried lengths of a step."""

SHORT_STEP = 0.15
"""Length of a step below which the next one fixes the friction bounds."""

MOST_SHORT = 8
"""Short steps with friction after which Newton's method is given up."""

MOST_ALONG_NORMALS = 12
"""Steps along normals alone between whole ones."""

SLIP_ON_SCALE = 1.0 + 1e-9
"""Factor of tangential displacements, so that points at their friction limit start slipping."""


class PairsOnSprings(Protocol):
    """Pairs on springs at their points."""

    @property
    def springs(self) -> Matrix:
        """K₀ (components, n_point) [force/length]."""

    def moved_by(self, forces: Vector) -> Vector:
        """Return (Σ + Gᵀ K₀ G)⁻¹ b for forces b (n_relative,)."""


class Steps(Protocol):
    """The solver of the linear systems of Newton's method."""

    @property
    def points(self) -> PointSprings:
        """G, displacements at the points (components n_point, n_relative)."""

    def step(
        self, K: Matrix, right: Vector, enough: float, factors: Any = None
    ) -> tuple[Vector, Vector, Any]:
        """Return d of (Σ + Gᵀ K G) d = b, Σ d, and factors for the next step."""


class Pairs(Steps, Protocol):
    """The structure between the pairs, as Newton's method uses it."""

    @property
    def glued(self) -> PairsOnSprings:
        """The pairs with all points closed and stuck."""

    @property
    def normal(self) -> NormalPairs | None:
        """The pairs along normals, where steps with them are much cheaper than whole ones."""

    def resisted(self, displacements: Vector) -> Vector:
        """Return Σ w of displacements w (n_relative,)."""


class Answers(Protocol):
    """Contact forces as a function of displacements."""

    def respond(self, moved: Matrix) -> tuple[Matrix, Matrix]:
        """Return λ (components, n_point) and K (n_point, components, components)."""


class Laws(Answers, Protocol):
    """Contact forces and closures of points, given their largest closures so far."""

    @property
    def components(self) -> int:
        """Components of force at a point."""

    def after(self, deepest: Vector | None) -> Self:
        """Return the laws of points with these largest closures so far, if any law remembers."""

    def closed_to(self, gap: Vector) -> Vector | None:
        """Return the largest closures (n_point,) after this gap; None if no law remembers them."""

    def yielded(self, forces: Matrix) -> Matrix:
        """Return closures of the laws under forces (components, n_point) [length]."""


@dataclass(frozen=True, eq=False)
class State:
    """An iterate of Newton's method: displacements, forces of the structure, points, laws."""

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
        """The largest entry of R over the largest force, or over ``least`` without contact."""
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

    Arguments are y_f (n_relative,) [length], the offset z₀ (3, n_point) [length] and the pull h
    (n_relative,) [force]. ``start`` is a solution of the increment before or of a similar case; by
    default all points start closed and stuck. ``moved_by`` returns S p (n_relative,) [length] for
    forces p between the pairs. It corrects the solution, because Σ has fewer digits where weak
    springs hold bodies.
    """
    k = laws.components
    laws = laws.after(None if start is None else start.deepest)
    law_offset = offset[:k]
    pulled = np.zeros(len(free)) if pull is None else pull
    begun = _first_state(laws, pairs, free, law_offset, start, pulled)
    form = partial(_formed_anew, laws, pairs, free, law_offset, pull=pulled, moved_by=moved_by)
    normal = pairs.normal
    press = None if normal is None else partial(_contact_along_normals, laws, pairs, normal)
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
    """Return the last state of Newton's method, the number of steps, and the last factors.

    ``press`` closes and opens points between steps. ``form`` forms the displacements anew once,
    without the round-off summed up over steps. Factors may come from a similar problem.

    Raises
    ------
    ConvergenceError
        If the residual stays above :data:`SOLVED`.
    """
    G, k = pairs.points.G, len(state.z)
    state = state if press is None else press(state)
    steps, short, bounded, previous = 0, 0, False, np.inf
    while steps < MOST_STEPS and short < MOST_SHORT and np.isfinite(state.left):
        if form is not None and state.left <= FORMED:
            # The sums of Newton's steps are formed once more, by S or by Σ: S with rigid
            # motions on weak springs leaves a residual of 1e-5, which later steps remove.
            state, form = form(state), None
        if state.left <= solved or steps_ended(state.left, previous):
            break
        K = state.K
        if bounded:
            K = K.copy()
            K[:, 1:, 0] = 0.0
        # The change of laws bounds the residual of a step below; round-off that of the last one.
        enough = min(LOOSE, max(QUADRATIC * state.left, 0.5 * ROUND_OFF / state.left))
        d, resisted, factors = pairs.step(K, -state.rest, enough, factors)
        steps += 1
        if k > 1 and not bounded and d @ state.rest >= 0:
            bounded = True
            continue
        moved = np.asarray((G @ d).reshape(state.z.shape))
        trial, length = _line_search(laws, state, d, resisted, moved)
        bounded = k > 1 and not bounded and length < SHORT_STEP
        short += k > 1 and length < SHORT_STEP
        previous, state = state.left, trial if press is None else press(trial)
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
    """Return whether further steps would not reduce each residual (over the largest force)."""
    return (left <= ROUND_OFF) | ((left <= SOLVED) & (left > LARGEST_REMAINDER * previous))


def _formed_anew(
    laws: Laws,
    pairs: Pairs,
    free: Vector,
    offset: Matrix,
    state: State,
    *,
    pull: Vector,
    moved_by: Callable[[Vector], Vector] | None,
) -> State:
    """Return the state with displacements and forces of the structure consistent."""
    if moved_by is None:
        return replace(state, p=pairs.resisted(state.y - free) + pull)
    y = free + moved_by(state.p - pull)
    z = _z_at(pairs.points.G, y, offset)
    return State(y, state.p, z, *laws.respond(z), pairs.points.transposed, state.least)


def _first_state(
    laws: Laws,
    pairs: Pairs,
    free: Vector,
    offset: Matrix,
    start: Increment | None,
    pull: Vector,
) -> State:
    """Return the first state of Newton's method."""
    G, shape = pairs.points.G, offset.shape
    if start is None:
        # All points start closed and stuck; points in tension open in the steps that follow.
        glued = pairs.glued
        pressed = pull + pairs.points.transposed @ (glued.springs * _z_at(G, free, offset)).ravel()
        moved = glued.moved_by(-pressed)
        y, p = free + moved, pairs.resisted(moved) + pull
    else:
        y = start.moved
        p = pairs.resisted(y - free) + pull
    z = _z_at(G, y, offset)
    forces, K = laws.respond(z)
    if start is not None and shape[0] > 1:
        onward = z.copy()
        onward[1:] *= SLIP_ON_SCALE
        K = laws.respond(onward)[1]
    floor = max(SMALLEST_FORCE_SHARE * float(np.abs(p).max(initial=0.0)), np.finfo(float).tiny)
    return State(y, p, z, forces, K, pairs.points.transposed, floor)


def _contact_along_normals(laws: Answers, pairs: Pairs, normal: NormalPairs, state: State) -> State:
    """Return the state after points have closed and opened along normals, with tangents held.

    Whole steps grow or shrink a contact zone by one row of points each. Steps along normals have a
    third of the unknowns and take less than a tenth of the time. They go on while they leave most
    of the residual.
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
        state, _ = _line_search(laws, state, d, pairs.resisted(d), along)
    return state


def _z_at(G: SparseMatrix | Matrix, y: Vector, offset: Matrix) -> Matrix:
    """Return z (components, n_point) at the displacements y."""
    return np.asarray((G @ y).reshape(offset.shape) + offset)


def _line_search(
    laws: Answers, state: State, d: Vector, resisted: Vector, moved: Matrix
) -> tuple[State, float]:
    """Return the state after a step d, and its length.

    ``resisted`` is Σ d (n_relative,) [force], ``moved`` is G d (components, n_point) [length].
    """
    at_first, curvature = float(d @ state.rest), float(d @ resisted)

    def reached(length: float) -> State:
        z = state.z + length * moved
        y, p = state.y + length * d, state.p + length * resisted
        return State(y, p, z, *laws.respond(z), state.G_T, state.least)

    def slope(trial: State, length: float) -> float:
        return at_first + length * curvature + float((moved * (state.forces - trial.forces)).sum())

    length, trial = 1.0, reached(1.0)
    last = slope(trial, 1.0)
    fits = abs(last) <= LARGEST_REMAINDER * abs(at_first)
    if fits or np.linalg.norm(trial.rest) <= LARGEST_REMAINDER * np.linalg.norm(state.rest):
        return trial, length
    if not at_first < 0 < last:
        return trial, length
    low, high, below, above = 0.0, 1.0, at_first, last
    for _ in range(MOST_TRIALS):
        # A chord that ends at a jump of the slope would stay there: keep away from both ends.
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
    return trial, length
