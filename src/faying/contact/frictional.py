"""Increments of frictional contact: a semismooth Newton method on forces, exact at any penalty.

With x = (λ_n, λ_t) at the points, y the relative displacement that contact forces make, c(x) what
the law yields, the slack z = y + c(x) + z_free (z_free holds the gap, the loads and minus the slip
so far) and any r > 0, an increment solves (Alart & Curnier 1991, doi:10.1016/0045-7825(91)90022-X)

    F(x) = x − admissible(x − r z) = 0,                                                       (F1)

with Coulomb's law, for example, F_n = λ_n − ⟨λ_n − r_n z_n⟩; z_t is then the slip of the increment.
What is admissible, what yields, and their derivatives come from the laws; a Newton step is a linear
system between pairs (:mod:`~faying.contact.newton_steps`). Without friction this is the primal-dual
active set.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix, Vector, read_only
from faying.contact.active_set import ROUND_OFF
from faying.contact.contact import Contact
from faying.contact.fixed_bounds import MOST_STEPS, FixedBounds
from faying.contact.forced_laws import Admitting, ForcedLaws
from faying.contact.forced_springs import ForcedSprings
from faying.contact.increment import Increment, displaced
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.newton_steps import NewtonSteps
from faying.digits import SOLVED
from faying.exceptions import ConvergenceError

MOST_HALVINGS = 12
"""Halvings of a Newton step."""

STEPS_TO_FALL = 5
"""Steps among which the residual must fall where it cannot fall in every one.

A residual that may rise between takes twice the steps in easy increments (42 for 17 at μ = 0.3 and
c_n = 1e6 N/mm³), but arrives where the other stops (μ = 1 at 1e7), as in Grippo, Lampariello &
Lucidi 1986, doi:10.1137/0723046.
"""

TANGENTIAL_SCALE = 10.0
"""r over the diagonal of H, of tangential components.

Steps of increments of a tenth of the load that make the default cantilever slip: 8.2 in the mean
and 12 at most, with 1 9.5 and 15, with 100 more again.
"""

LARGEST_RISE = 1e3
"""How often its first residual the next ones may be where residuals may rise."""

SOFTEST, MOST_PROXIMAL = 1.0, 40
"""First yield of proximal points over that of the structure, and how many of them are tried."""

MOST_STIFFENED = 12
"""Times that what points yield is divided by ten."""

MOST_BOUNDS = 40
"""Fixed friction bounds tried where Newton's method on Coulomb's law stalls.

Of 24 random paths of few points that 10 do not solve 40 solve three, the only elastic one of them
(μ = 1, after 16 bounds) and two of the rigid ones.
"""

SOLVABLE = "contact yields everywhere, so that there is a solution"
"""What an increment that is not solved says of solutions, as docs/theory/friction.md shows."""

CONTRADICTORY = (
    "points of hard contact may contradict each other where they are more than the displacements "
    "beneath them; with a penalty there always is a solution"
)
"""What it says where contact is hard."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class FrictionalContact:
    """Solver of increments of a system with friction.

    Attributes
    ----------
    contact
        Gaps, tangential displacements and laws.
    S : (n_relative, n_relative) [length/force]
        Compliance between pairs.
    springs
        Those that are known by their forces, if any: points behind all others, where initial forces
        make elongations.
    """

    contact: Contact
    S: Matrix
    springs: ForcedSprings | None = None

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p (n_relative,) [length] of forces between the pairs."""
        return np.asarray(self.S @ forces)

    @cached_property
    def laws(self) -> LawsAtPoints:
        """What the contact points admit and yield."""
        return LawsAtPoints(contact=self.contact)

    @cached_property
    def _laws(self) -> Admitting:
        """What points admit and yield, and springs."""
        return self.laws if self.springs is None else ForcedLaws(self.laws, self.springs.stiffness)

    @cached_property
    def steps(self) -> NewtonSteps:
        """The linear systems of Newton steps."""
        rows, n = self.contact.rows, 3 * self.contact.n_points
        if rows.shape[0] < n:
            rows = sp.vstack([rows, sp.csr_array((n - rows.shape[0], rows.shape[1]))]).tocsr()
        if self.springs is None:
            return NewtonSteps(G=read_only(rows), S=self.S)
        springs = self.springs
        k, shape = len(springs.stiffness), (len(springs.stiffness), rows.shape[1])
        parts = [rows[first : first + n // 3] for first in range(0, n, n // 3)]
        elongations = [sp.eye_array(k), sp.csr_array((k, k)), sp.csr_array((k, k))]
        blocks = [
            block
            for part, own in zip(parts, elongations, strict=True)
            for block in ([part, None], [sp.csr_array(shape), own])
        ]
        S = np.block([[self.S, -springs.columns.T], [-springs.columns, springs.between]])
        return NewtonSteps(G=read_only(sp.block_array(blocks).tocsr()), S=S)

    @property
    def G(self) -> SparseMatrix:
        """Rows (3 n_point, n_relative): all normal ones, first tangents, second tangents."""
        return self.steps.G

    @cached_property
    def D(self) -> Matrix:
        """What the laws yield per force, to the first of it (3, n_point) [length/force]."""
        return self._laws.closure(np.zeros_like(self.steps.own))[1]

    @property
    def friction(self) -> Vector:
        """Coefficients of friction (n_point,)."""
        return self.contact.coefficients

    @cached_property
    def scale(self) -> Matrix:
        """Factors r of (F1) (3, n_point) [force/length], one over the diagonal of H and more."""
        total = self.steps.own + np.maximum(self.D, 0.0)
        usable = (total > 0) & np.isfinite(total)
        scale = np.where(usable, 1.0 / np.where(usable, total, 1.0), 1.0)
        scale[1:] *= TANGENTIAL_SCALE
        return np.asarray(scale)

    @cached_property
    def _softness(self) -> Matrix:
        """What proximal points yield (3, n_point) [length/force]: as much as the structure."""
        return np.where(self.D < 0, 0.0, self.steps.own)

    def about(self, state: Increment) -> "FrictionalContact":  # noqa: ARG002
        """Return itself: forces are unknowns wherever a path is."""
        return self

    def solve(self, free: Vector, offset: Matrix, start: Increment | None = None) -> Increment:
        """Solve one increment; see :meth:`.IncrementSolver.solve`."""
        z_free = self.contact.moved(free) + offset
        increment = self.solve_slack(z_free, None if start is None else start.forces)
        return replace(increment, moved=displaced(self, free, increment.forces))

    def loosened(self, springs: ForcedSprings) -> "LoosenedFrictional":
        """Return the solver with springs that are known by their forces."""
        return LoosenedFrictional(solver=replace(self, springs=springs), columns=springs.columns)

    def solve_slack(self, z_free: Matrix, start: Matrix | None = None) -> Increment:
        """Solve one increment whose points move by z_free (3, n_point) without contact forces.

        It begins with forces (3, n_point), those of the increment before; by default all points
        that are pressed together close and stick.

        Notes
        -----
        Coulomb's law is not associated: there is no energy to minimize. Where contact yields there
        is a solution for any coefficient, but for large ones maybe several
        (docs/theory/friction.md). What is returned solves (F1) to its residual.
        """
        start = np.zeros_like(z_free) if start is None else start
        x, steps, left = self._newton(z_free, start, None)
        for fallback in (self._with_fixed_bounds, self._by_proximal_points, self._by_stiffening):
            if left > SOLVED:
                x, more, _ = fallback(z_free, x)
                steps += more
                left = _relative(self._residual(x, self._slack(x, z_free), None), x)
        if left > SOLVED:
            message = (
                f"an increment with friction was not solved in {steps} Newton steps (natural "
                f"residual {left:.1e} of the largest force); take smaller increments, or a smaller "
                f"coefficient of friction: {SOLVABLE if self.D[0].all() else CONTRADICTORY}"
            )
            if not start[:, : self.contact.n_points].any():
                message += (
                    "; a joint that friction alone holds while it is tightened can be tightened "
                    "without (friction_during_preload = false in a study)"
                )
            raise ConvergenceError(message)
        return Increment(
            forces=x,
            slack=self._slack(x, z_free),
            moved=np.zeros(len(self.steps.S)),
            iterations=steps,
            residual=left,
        )

    def _slack(self, x: Matrix, z_free: Matrix, added: float = 0.0) -> Matrix:
        slack: Matrix = self.steps.moved(x) + self._laws.closure(x)[0] + z_free
        return slack + added * self._softness * x if added else slack

    def _residual(self, x: Matrix, z: Matrix, pressing: Vector | None) -> Matrix:
        """F of (F1), with tangential forces held by fixed normal ones where they are given."""
        return np.asarray(x - self._laws.admissible(x - self.scale * z, pressing))

    def _newton(
        self,
        z_free: Matrix,
        x: Matrix,
        pressing: Vector | None,
        watched: int = 1,
        added: float = 0.0,
    ) -> tuple[Matrix, int, float]:
        """Return forces, Newton steps, and the residual that is left over the largest force.

        Steps are halved until the residual is below the largest of those of the last ``watched``;
        where these are several, the first of them may rise by far. ``added`` lets every point
        yield by so much of what the structure yields at it.
        """
        z, step = self._slack(x, z_free, added), 0
        wrong = self._residual(x, z, pressing)
        norms = [float(np.linalg.norm(wrong)) * (LARGEST_RISE if watched > 1 else 1.0)]
        while step < MOST_STEPS:
            step += 1
            try:
                dx = self._step(x, z, wrong, pressing, added)
            except la.LinAlgError:
                break
            fraction, accepted = 1.0, None
            for _ in range(MOST_HALVINGS):
                tried = x + fraction * dx
                slack = self._slack(tried, z_free, added)
                residual = self._residual(tried, slack, pressing)
                if np.linalg.norm(residual) < (1 - 1e-4 * fraction) * max(norms[-watched:]):
                    accepted = tried, slack, residual
                    break
                fraction /= 2
            if accepted is None:
                break
            x, z, wrong = accepted
            norms.append(float(np.linalg.norm(wrong)))
            if _relative(wrong, x) <= ROUND_OFF:
                break
        return x, step, _relative(wrong, x)

    def _step(
        self,
        x: Matrix,
        z: Matrix,
        wrong: Matrix,
        pressing: Vector | None,
        added: float = 0.0,
    ) -> Matrix:
        """Return the Newton step dx (3, n_point)."""
        slope = self._laws.derivative(x - self.scale * z, pressing)
        compliance = self._laws.closure(x)[1] + added * self._softness
        return self.steps.step(wrong, slope, self.scale, compliance)

    def _by_proximal_points(self, z_free: Matrix, x: Matrix) -> tuple[Matrix, int, float]:
        """Let points yield as much as the structure does, from where they are, then less and less.

        Each problem is better conditioned than the one wanted, and begins near its solution
        (Rockafellar 1976, doi:10.1137/0314056).
        """
        steps, added, left = 0, SOFTEST, np.inf
        for _ in range(MOST_PROXIMAL):
            shifted = z_free - added * self._softness * x
            candidate, more, left = self._newton(shifted, x, None, STEPS_TO_FALL, added=added)
            steps += more
            x = candidate if left <= SOLVED else x
            added *= 0.1 if left <= SOLVED else 20.0
            if added > 1e3:
                break
            if added < 1e-3 and left <= SOLVED:
                candidate, more, left = self._newton(z_free, x, None)
                steps += more
                if left <= SOLVED:
                    return candidate, steps, left
        return x, steps, _relative(self._residual(x, self._slack(x, z_free), None), x)

    def _by_stiffening(self, z_free: Matrix, x: Matrix) -> tuple[Matrix, int, float]:
        """Let points yield as much as the structure does, then less and less, as penalties rise.

        Without the forces that proximal points begin from, forces settle where hard contact has a
        solution near those of penalties, and rise with the penalty where it has none.
        """
        steps, x = 0, np.zeros_like(x)
        for added in SOFTEST * 10.0 ** -np.arange(MOST_STIFFENED):
            x, more, left = self._newton(z_free, x, None, STEPS_TO_FALL, added=added)
            candidate, last, exact = self._newton(z_free, x, None)
            steps += more + last
            if exact <= SOLVED:
                return candidate, steps, exact
            if left > SOLVED:
                break
        return x, steps, np.inf

    def _with_fixed_bounds(self, z_free: Matrix, x: Matrix) -> tuple[Matrix, int, float]:
        """Solve with the friction bounds of the forces so far, again and again (Tresca).

        Newton's method on Coulomb's law goes on from each solution.
        """
        steps, left = 0, np.inf
        for _ in range(MOST_BOUNDS):
            about = self._laws.admissible(x, None)
            bounded = FixedBounds(steps=self.steps, laws=self._laws, z_free=z_free, about=about)
            x, bounded_steps = bounded.solve()
            candidate, more, left = self._newton(z_free, x, None)
            steps += bounded_steps + more
            if left <= SOLVED:
                return candidate, steps, left
        return x, steps, left


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class LoosenedFrictional:
    """The same with springs that are known by their forces, whose initial ones move pairs."""

    solver: FrictionalContact
    columns: Matrix

    def solve(
        self,
        free: Vector,
        offset: Matrix,
        elongations: Vector,
        about: Vector,
        start: Increment | None = None,
    ) -> tuple[Increment, Vector]:
        """Solve one increment; see :meth:`.ForcedContact.solve`."""
        solver, n = self.solver, self.solver.contact.n_points
        z_free, x = np.zeros((2, 3, n + len(about)))
        z_free[:, :n], z_free[0, n:] = solver.contact.moved(free) + offset, elongations
        x[:, :n], x[0, n:] = 0.0 if start is None else start.forces, about
        found = solver.solve_slack(z_free, x)
        forces, initial = found.forces[:, :n], found.forces[0, n:]
        moved = displaced(solver, free, forces) - initial @ self.columns
        return replace(found, forces=forces, slack=found.slack[:, :n], moved=moved), initial


def _relative(wrong: Matrix, x: Matrix) -> float:
    """Return the natural residual over the largest force; one where it exceeds all forces."""
    largest, left = float(np.abs(x).max(initial=0.0)), float(np.abs(wrong).max(initial=0.0))
    return left / max(largest, left, np.finfo(float).tiny)
