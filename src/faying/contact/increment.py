"""The contact state after an increment, and the interface of increment solvers."""

from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.forced_springs import ForcedSprings
from faying.contact.laws_at_points import LawsAtPoints
from faying.exceptions import ModelError


@dataclass(frozen=True, eq=False, kw_only=True)
class Increment:
    """Contact forces and displacements after an increment.

    Attributes
    ----------
    forces : (3, n_point) [force]
        λ_n and both tangential components, zero where there is no friction.
    slack : (3, n_point) [length]
        z: the gap plus the closure of the law, and the slip of the increment.
    moved : (n_relative,) [length]
        y, the relative displacements of the pairs.
    iterations
        Newton steps.
    residual
        Residual of the equations over the largest force.
    deepest : (n_point,) or None [length]
        Largest closures so far, where some law remembers them.
    """

    forces: Matrix
    slack: Matrix
    moved: Vector
    iterations: int
    residual: float
    deepest: Vector | None = None

    def gap(self, laws: LawsAtPoints) -> Vector:
        """Return the gap (n_point,) [length], negative by the penetration where contact yields."""
        return np.asarray(self.slack[0] - laws.after(self.deepest).closure(self.forces)[0][0])

    @property
    def begun(self) -> bool:
        """Whether there is contact or history, from which a following increment can start."""
        return bool(self.forces[0].any()) or self.deepest is not None

    @property
    def dissipation(self) -> float:
        """Energy dissipated by friction in the increment, −Σ λ_t · z_t [force·length]."""
        return float(-(self.forces[1:] * self.slack[1:]).sum())


class IncrementSolver(Protocol):
    """Solver of increments for one compliance between pairs; it keeps no history."""

    @property
    def contact(self) -> Contact:
        """Gaps, tangential displacements and laws."""

    @property
    def S(self) -> Matrix:
        """Compliance between pairs (n_relative, n_relative) [length/force]."""

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p (n_relative,) [length] for forces p between the pairs."""

    @property
    def laws(self) -> LawsAtPoints:
        """Contact laws at the points."""

    def about(self, state: Increment) -> Self:
        """Return a solver that is faster for many increments about a state."""

    def loosened(self, springs: ForcedSprings) -> "ForcedContact":
        """Return the solver of increments with springs of prescribed force."""

    def solve(self, free: Vector, offset: Matrix, start: Increment | None = None) -> Increment:
        """Solve one increment.

        Without contact forces the pairs move by ``free`` (n_relative,) [length]. The offset z₀ (3,
        n_point) [length] is the initial gap, and minus the slip (:meth:`.Contact.offset`).
        ``start`` is the increment before, or a similar one; by default all points start closed,
        stuck.

        Raises
        ------
        ConvergenceError
            If the increment is not solved.
        """


class ForcedContact(Protocol):
    """Solver of increments with springs whose forces are prescribed anew in each."""

    def solve(
        self,
        free: Vector,
        offset: Matrix,
        elongations: Vector,
        about: Vector,
        start: Increment | None = None,
    ) -> tuple[Increment, Vector]:
        """Return the contact state, and the initial forces N₀ (n_spring,) of the springs.

        Elongations are T/k − e₀ (n_spring,) [length] of (T1a), and ``about`` (n_spring,) is a first
        guess of N₀. All other arguments are as in :meth:`.IncrementSolver.solve`.

        Raises
        ------
        LinAlgError
            If nothing resists the springs.
        ConvergenceError
            If the increment is not solved.
        """


def check_gaps(moved: Vector) -> None:
    """Refuse displacements without contact forces (n,) that are not finite."""
    if not np.isfinite(moved).all():
        message = "the gap without contact forces holds NaN or infinity; check loads and model"
        raise ModelError(message)


def check_flexibility(matrix: Matrix) -> Matrix:
    """Return a flexibility between points or pairs (n, n); refuse one that is not finite."""
    if not np.isfinite(matrix).all():
        message = "the contact flexibility holds NaN or infinity; check the model's matrices"
        raise ModelError(message)
    return matrix


def displaced(solver: IncrementSolver, free: Vector, forces: Matrix) -> Vector:
    """Return the relative displacements (n_relative,) under forces (3, n_point).

    ``free`` (n_relative,) [length] are the displacements without them.
    """
    pressed = solver.contact.at_pairs(forces[0], forces[1:])
    return np.asarray(free + solver.moved_by(pressed))
