"""Where contact stands after an increment, and what is asked of a solver of increments."""

from dataclasses import dataclass
from typing import Protocol, Self, final

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.forced_springs import ForcedSprings
from faying.contact.laws_at_points import LawsAtPoints
from faying.exceptions import ModelError


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Increment:
    """Where contact stands after an increment.

    Attributes
    ----------
    forces : (3, n_point) [force]
        λ_n and both tangential components, zero where there is no friction.
    slack : (3, n_point) [length]
        z: the gap plus what the law yields, and the slip of the increment.
    moved : (n_relative,) [length]
        y, the relative displacements of the pairs.
    iterations
        Newton steps.
    residual
        Residual of the equations solved over the largest force.
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
        """Whether anything presses, or is remembered: what follows can start from here."""
        return bool(self.forces[0].any()) or self.deepest is not None

    @property
    def dissipation(self) -> float:
        """Energy that friction took in the increment, −Σ λ_t · z_t [force·length]."""
        return float(-(self.forces[1:] * self.slack[1:]).sum())


class IncrementSolver(Protocol):
    """Solves increments of one compliance between pairs; it remembers nothing of them."""

    @property
    def contact(self) -> Contact:
        """Gaps, tangential displacements and laws."""
        ...

    @property
    def S(self) -> Matrix:
        """Compliance between pairs (n_relative, n_relative) [length/force]."""
        ...

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p (n_relative,) [length] of forces between the pairs."""
        ...

    @property
    def laws(self) -> LawsAtPoints:
        """What the contact points answer."""
        ...

    def about(self, state: Increment) -> Self:
        """Return the solver of many increments about a state."""
        ...

    def loosened(self, springs: ForcedSprings) -> "ForcedContact":
        """Return the solver of increments with springs that are known by their forces."""
        ...

    def solve(self, free: Vector, offset: Matrix, start: Increment | None = None) -> Increment:
        """Solve one increment.

        Without contact forces pairs move by ``free`` (n_relative,). The offset z₀ (3, n_point)
        [length] is the initial gap, and minus the slip so far (:meth:`.Contact.offset`). The start
        is the increment before, or a similar one; by default all points close and stick at first.

        Raises
        ------
        ConvergenceError
            If the increment is not solved.
        """
        ...


class ForcedContact(Protocol):
    """Solves increments with springs that are known by their forces, of other forces each."""

    def solve(
        self,
        free: Vector,
        offset: Matrix,
        elongations: Vector,
        about: Vector,
        start: Increment | None = None,
    ) -> tuple[Increment, Vector]:
        """Return where contact stands, and the initial forces N₀ (n_spring,) of the springs.

        Elongations are T/k − e₀ (n_spring,) [length] of (T1a), and initial forces are sought about
        some (n_spring,). All else is as of :meth:`.IncrementSolver.solve`.

        Raises
        ------
        LinAlgError
            If nothing resists the springs.
        ConvergenceError
            If the increment is not solved.
        """
        ...


def check_gaps(moved: Vector) -> None:
    """Refuse what points or pairs move by without contact forces (n,) where it is not finite."""
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

    Without them they are ``free`` (n_relative,) [length].
    """
    pressed = solver.contact.at_pairs(forces[0], forces[1:])
    return np.asarray(free + solver.moved_by(pressed))
