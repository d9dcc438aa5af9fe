"""Contact that is hard, or nearly so, by an augmented Lagrangian method.

Displacements do not determine the forces of hard points. They do where points get a compliance d
that acts on the force beyond the multipliers λ_k (Simo & Laursen 1992,
doi:10.1016/0045-7949(92)90540-G),

    c(λ) + d λ = d λ_k − z,   λ admissible,   λ_{k+1} = λ,                                    (F1a)

with c(λ) the closure of the laws. Each stage is a problem (F8), solved about the displacements
under λ_k, so that few digits of those are needed. Stages are proximal points of the forces
(Rockafellar 1976, doi:10.1137/0314056): once λ stops changing, the compliance d has no effect,
and of several solutions at linearly dependent points the stages reach one. Where there is no
solution, forces rise from stage to stage.
"""

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.between_pairs import BetweenPairs
from faying.contact.between_solver import BetweenSolver
from faying.contact.contact import Contact
from faying.contact.forced_springs import ForcedSprings
from faying.contact.increment import Increment, check_gaps, displaced
from faying.contact.laws import Law
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.newton_descent import solve_yielding
from faying.contact.yielding import Across, YieldingContact, moved_singly
from faying.digits import ROUND_OFF, SOLVED
from faying.exceptions import ConvergenceError
from faying.iterations import MOST_STEPS, MOST_TRIALS
from faying.linalg.threads import threads_for

LEVELS, USUAL = tuple(10.0**n for n in range(-1, 8)), 4
"""Compliance of the structure at a point over d, from level to level, and the usual level."""

SMALL = 0.1
"""Change of forces over the largest force below which the next, harder level starts."""

SLOW = 0.3
"""Change of forces over that of the stage before above which the added compliance is reduced."""

SETTLED = 1e-6
"""Change of forces over the largest force above which forces may grow without limit.

At linearly dependent points round-off changes the force of each by 1e-7.
"""

CONTRADICTORY = (
    "points of hard contact may contradict each other where they are more than the displacements "
    "beneath them; with a penalty there always is a solution"
)
"""Message where stages do not converge."""


@dataclass(frozen=True, eq=False)
class SoftenedLaws:
    """Laws at points with an added compliance.

    Attributes
    ----------
    laws
    added : (3, n_point) [length/force]
        Added compliance d.
    """

    laws: LawsAtPoints
    added: Matrix

    @cached_property
    def _yields(self) -> Matrix:
        """Compliance c′ + d (3, n_point) at zero force."""
        return self.laws.closure(np.zeros_like(self.added))[1] + self.added

    @property
    def components(self) -> int:
        """Components of force at a point."""
        return self.laws.components

    @property
    def springs(self) -> Matrix:
        """Stiffness of points that are closed and stick (components, n_point) [force/length]."""
        with np.errstate(divide="ignore"):
            return np.asarray(1.0 / (1.0 / self.laws.springs + self.added[: self.components]))

    def after(self, deepest: Vector | None) -> Self:
        """Return the laws of points with these largest closures so far."""
        return replace(self, laws=self.laws.after(deepest))

    def closed_to(self, gap: Vector) -> Vector | None:
        """Return the largest closures (n_point,) after this gap; None if no law remembers them."""
        return self.laws.closed_to(gap)

    def respond(self, moved: Matrix) -> tuple[Matrix, Matrix]:
        """Return forces (components, n_point) at z − d λ_k, and their stiffness, by (F1a)."""
        forces = np.zeros_like(moved)
        stiffness = np.zeros((moved.shape[1], len(moved), len(moved)))
        for law, points in self.laws.members:
            at = slice(law.components), points
            yields = self._yields[at].copy()
            trial = -moved[at] / yields
            if not law.proportional:
                weights, added = self.laws.contact.weights[points], self.added[0, points]
                trial[0], yields[0] = _softened_force(law, weights, -moved[0, points], added)
            forces[at] = law.admissible(trial)
            answer = law.derivative(trial) / yields.T[:, None, :]
            stiffness[points, : len(yields), : len(yields)] = answer
        return forces, stiffness

    def yielded(self, forces: Matrix) -> Matrix:
        """Return closures under forces (components, n_point) [length]."""
        return np.asarray(self.laws.yielded(forces) + self.added[: len(forces)] * forces)


@dataclass(frozen=True, eq=False, kw_only=True)
class Level:
    """One size of the added compliance of stages.

    Attributes
    ----------
    contact, between
        As in :class:`AugmentedContact`.
    hardness
        Compliance of the structure at a point over d.
    """

    contact: Contact
    between: BetweenPairs
    hardness: float

    @cached_property
    def laws(self) -> SoftenedLaws:
        """The laws of points with the added compliance of this level."""
        contact = self.contact
        k, added = contact.components, np.zeros((3, contact.n_points))
        added[:k] = moved_singly(contact.rows, self.between).reshape(k, -1)
        added[1:k] = added[1:k].sum(axis=0) / 2  # independent of the directions of the tangents
        added[:k][added[:k] == 0.0] = added.max(initial=0.0) or 1.0  # where nothing moves
        return SoftenedLaws(LawsAtPoints(contact=contact), added / self.hardness)

    @cached_property
    def held(self) -> YieldingContact:
        """The solver of the structure on the springs of the softened points."""
        # On a fixed number of threads, so that digits do not depend on the first caller.
        with threads_for(self.contact.n_points):
            return YieldingContact.on_springs(self.contact, self.between, self.laws.springs)


@dataclass(frozen=True, eq=False)
class Stage:
    """One stage: the problem with fixed multipliers on one level.

    Attributes
    ----------
    level
    springs
        Springs of prescribed force.
    """

    level: Level
    springs: ForcedSprings

    @cached_property
    def _across(self) -> Across:
        return self.level.held.across(self.springs)

    def solve(
        self,
        slack: Matrix,
        elongations: Vector,
        forces: Matrix,
        initial: Vector,
        begun: Vector | None,
        *,
        anew: bool,
    ) -> tuple[Increment, Vector]:
        """Return the solution of the stage, and initial forces N₀ (n_spring,) of the springs.

        ``slack`` z (3, n_point) [length] is the displacement of points without the forces λ_k
        (3, n_point) and N₀. The solution starts from relative displacements ``begun`` (n_relative,)
        due to contact, by default those under λ_k; if ``anew``, with all points closed and stuck.
        """
        held, laws, across = self.level.held, self.level.laws, self._across
        pressed = held.contact.at_pairs(forces[0], forces[1:])
        p = pressed if held.shapes is None else held.shapes.T @ pressed
        moved = held.moved_by(pressed) if held.shapes is None else p
        moved = moved - initial @ across.columns
        missed = self.springs.yields @ initial + across.columns @ p - elongations
        offset = slack - laws.added * forces
        offset[: laws.components] += (across.pairs.points.G @ moved).reshape(-1, slack.shape[1])
        nothing = np.zeros(len(p))
        further = nothing if begun is None else held.coordinates(begun) - moved
        about = Increment(forces=forces, slack=slack, moved=further, iterations=0, residual=0.0)
        start, pull = None if anew else about, p - across.shapes.T @ across.taken(missed)
        following = solve_yielding(laws, across.pairs, nothing, offset, start, pull=pull)
        return following, initial - across.taken(missed + across.shapes @ following.moved)


@dataclass(frozen=True, eq=False, kw_only=True)
class AugmentedContact(BetweenSolver):
    """Augmented Lagrangian solver of the contact problems of one structure, for any law."""

    @cached_property
    def levels(self) -> tuple[Level, ...]:
        """Levels, from the softest to the hardest."""
        return tuple(
            Level(contact=self.contact, between=self.between, hardness=hardness)
            for hardness in LEVELS
        )

    @cached_property
    def _alone(self) -> "LoosenedAugmented":
        return self.loosened(ForcedSprings.of_none(self.contact.interpolation.shape[1]))

    def about(self, state: Increment) -> "AugmentedContact":  # noqa: ARG002
        """Return the solver itself, whose stages are solved about their multipliers anyway."""
        return self

    def solve(self, free: Vector, offset: Matrix, start: Increment | None = None) -> Increment:
        """Solve one problem; see :meth:`.IncrementSolver.solve`.

        Notes
        -----
        Four to eight stages. The first takes as many Newton steps as a problem of compliant points;
        each of the last ones takes one step.
        """
        none = np.zeros(0)
        return self._alone.solve(free, offset, none, none, start)[0]

    def loosened(self, springs: ForcedSprings) -> "LoosenedAugmented":
        """Return the solver with springs of prescribed force."""
        return LoosenedAugmented(solver=self, springs=springs)


@dataclass(frozen=True, eq=False, kw_only=True)
class LoosenedAugmented:
    """Augmented contact with springs of prescribed force, if any."""

    solver: AugmentedContact
    springs: ForcedSprings

    @cached_property
    def _stages(self) -> tuple[Stage, ...]:
        return tuple(Stage(level, self.springs) for level in self.solver.levels)

    def solve(
        self,
        free: Vector,
        offset: Matrix,
        elongations: Vector,
        about: Vector,
        start: Increment | None = None,
    ) -> tuple[Increment, Vector]:
        """Solve one increment; see :meth:`.ForcedContact.solve`."""
        check_gaps(free)
        solver, contact = self.solver, self.solver.contact
        slack = contact.moved(free) + offset
        forces = np.zeros_like(slack) if start is None else start.forces
        begun = None if start is None else start.moved - free
        initial = about
        level, anew, steps, left, residual = USUAL, start is None, 0, np.inf, np.inf
        for _ in range(MOST_TRIALS):
            try:
                following, initial_forces = self._stages[level].solve(
                    slack, elongations, forces, initial, begun, anew=anew
                )
            except ConvergenceError:
                if not level:
                    break
                level -= 1
                continue
            change = _relative_change(forces, following.forces)
            if left <= SETTLED and residual <= ROUND_OFF and change >= left:
                break  # round-off: further stages gain nothing
            previous, left = left, change
            residual = max(left / solver.levels[level].hardness, following.residual)
            if begun is not None and left <= 10.0 * ROUND_OFF:
                break  # a problem that starts at its solution keeps its last digits
            forces, initial, begun, anew = following.forces, initial_forces, None, False
            steps += following.iterations
            if left <= ROUND_OFF:
                break
            if left <= SMALL and (level < USUAL or left > SLOW * previous):
                level = min(level + 1, len(LEVELS) - 1)
        if left > SETTLED or residual > SOLVED:
            if start is not None and start.begun:
                # The state of another load may lead to contradictory points.
                with suppress(ConvergenceError):
                    return self.solve(free, offset, elongations, about)
            raise ConvergenceError(_no_convergence(contact, steps, left, start))
        moved = displaced(solver, free, forces) - initial @ self.springs.columns
        slack = contact.moved(moved) + offset + solver.laws.closure(forces)[0]
        # Closed points have no gap and sticking ones no slip, to the last digit.
        slack[0] = np.where(forces[0] > 0, 0.0, np.maximum(slack[0], 0.0))
        slack[1:, contact.sticking(forces[0], forces[1:])] = 0.0
        increment = Increment(
            forces=forces, slack=slack, moved=moved, iterations=steps, residual=residual
        )
        return increment, initial


def _no_convergence(contact: Contact, steps: int, left: float, start: Increment | None) -> str:
    """Return the message that the stages did not converge."""
    message = (
        f"contact was not solved in {steps} Newton steps: its forces still change by {left:.1e}"
        " of the largest one"
    )
    if contact.components > 1:
        message += "; take smaller increments, or a smaller coefficient of friction"
        if start is None or not start.forces.any():
            message += (
                "; a joint that friction alone holds while it is tightened can be tightened "
                "without (friction_during_preload = false in a study)"
            )
    return message if contact.yields else f"{message}; {CONTRADICTORY}"


def _softened_force(
    law: Law, weights: Vector, closed: Vector, added: Vector
) -> tuple[Vector, Vector]:
    """Return λ with c(λ) + d λ = ``closed`` (n_point,) [length], and the slope c′ + d there.

    By Newton's method from λ = 0, between bounds that halve where a step leaves them; λ is
    negative where points are open.
    """
    force, low, high = np.zeros_like(closed), np.zeros_like(closed), np.full_like(closed, np.inf)
    for _ in range(MOST_STEPS):
        pressed = np.maximum(force, 0.0)
        closure, slope = (part[0] for part in law.normal.closure(pressed[None], weights))
        yields, left = slope + added, closed - closure - added * pressed
        low, high = np.where(left < 0.0, low, pressed), np.where(left < 0.0, pressed, high)
        opened = (pressed == 0.0) & (left <= 0.0)
        force = pressed + left / yields
        force = np.where(opened | (low <= force) & (force <= high), force, 0.5 * (low + high))
        if (opened | (np.abs(left) <= ROUND_OFF * np.maximum(np.abs(closed), closure))).all():
            break
    return force, yields


def _relative_change(forces: Matrix, following: Matrix) -> float:
    """Return the largest change of forces over the largest force."""
    largest = float(np.abs(following).max(initial=0.0))
    return float(np.abs(following - forces).max(initial=0.0)) / (largest or 1.0)
