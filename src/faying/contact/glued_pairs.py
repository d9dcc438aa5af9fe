"""Node pairs on the springs of closed, sticking points: the solver of Newton steps.

With Σ = S⁻¹, the stiffness of the structure between pairs, and B = Gᵀ K G, that of the points, a
Newton step is (Σ + B) d = b. Two inverses U = (Σ + B₀)⁻¹ serve every step. One has all points
closed and stuck. The other has all points open but a few that hold parts on weak springs; it is
formed at the first step that needs it. Where the points whose ΔB = B − B₀ does not vanish act
along rows r of it and feel its columns c,

    (I + ΔB_rc U_cr) m = ΔB_rc (U b)_c,   d = U (b − m),                                    (F7)

and the inverse with fewer such rows is taken. U exists also where bolts and contact alone hold a
part.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Protocol

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.contact.held_pairs import (
    HeldPairs,
    NormalPairs,
    anchored_pairs,
    change_from,
    symmetric_product,
)
from faying.contact.pair_factors import IN_CACHE, LU, Factors, PairSystem, Room, WholeFactors
from faying.contact.point_springs import PointSprings
from faying.linalg.gmres import corrected

ACCURATE = 1e-5
"""Relative residual of (F7): single precision leaves 1e-6, Newton's method corrects the rest."""

DIRECT = 500
"""Pairs up to which Σ + Gᵀ K G itself is factorized: its products cost more than (F7) saves."""

MOST_CORRECTIONS = 15
"""Products of GMRES, which take as long as a factorization."""

FEWEST_ALIKE = 8
"""Fewest cases side by side that are worth an inverse of their own, which takes as long as two."""


class Condensed(Protocol):
    """A structure between its pairs whose dense matrices fit into memory."""

    @property
    def stiffness(self) -> Matrix:
        """Σ (n_relative, n_relative) [force/length]."""

    @property
    def compliance_for_steps(self) -> Matrix:
        """S (n_relative, n_relative) [length/force] for Newton steps, which correct its errors."""


@dataclass(frozen=True, eq=False, kw_only=True)
class GluedPairs:
    """Solves (Σ + Gᵀ K G) d = b.

    Attributes
    ----------
    points
        G, displacements at the points (components n_point, n_relative).
    structure : (n_relative, n_relative) [force/length]
        Σ.
    glued
        Pairs with all points closed and stuck.
    form_open
        Function that returns :attr:`opened`.
    room
        Memory for the systems of steps; factors of a solution last until the next one begins.
    """

    points: PointSprings
    structure: Matrix
    glued: HeldPairs
    form_open: Callable[[], HeldPairs | None]
    room: Room

    @classmethod
    def of(
        cls,
        G: SparseMatrix | Matrix,
        springs: Matrix,
        between: Condensed,
        pressed: Callable[[], Vector | None] | None = None,
    ) -> "GluedPairs":
        """Return the pairs of a structure, whose S is formed where steps need it.

        ``springs`` K (components, n_point) [force/length] are the stiffnesses of closed, sticking
        points. Points (n_point,) outside ``pressed`` start open, so that fewer change later.

        Raises
        ------
        LinAlgError
            If S is not positive definite beyond round-off.

        Notes
        -----
        One inverse, n³ multiplications for n relative displacements.
        """
        structure = between.stiffness
        points = PointSprings(G=G, components=len(springs))
        held = None if pressed is None else pressed()
        glued = springs if held is None else springs * held
        hold = HeldPairs.on_springs if factorized_whole(G) else HeldPairs.for_steps
        return cls(
            points=points,
            structure=structure,
            glued=hold(points, glued, structure),
            form_open=partial(_open_pairs, points, springs, between),
            room=Room(len(structure)),
        )

    def about(self, springs: Matrix) -> "GluedPairs":
        """Return the pairs for Newton steps about other springs (components, n_point).

        Springs are as in :meth:`glued_by`. Pairs that are factorized whole need no reference.
        """
        if self.whole:
            return self
        return self._on(HeldPairs.for_steps(self.points, springs, self.structure))

    def glued_by(self, springs: Matrix) -> "GluedPairs":
        """Return the pairs on other springs (components, n_point) [force/length].

        Raises
        ------
        LinAlgError
            If structure and springs leave a pair free to move.
        """
        return self._on(HeldPairs.on_springs(self.points, springs, self.structure))

    def _on(self, held: HeldPairs) -> "GluedPairs":
        return replace(self, glued=held, form_open=partial(getattr, self, "opened"))

    @cached_property
    def opened(self) -> HeldPairs | None:
        """Pairs with points open, except a few that hold free parts; None if there are none."""
        return self.form_open()

    @property
    def fewest_alike(self) -> float:
        """Least number of cases side by side that are worth an inverse of their own."""
        return FEWEST_ALIKE

    @property
    def own_stiffness(self) -> Vector:
        """Diagonal of Σ (n_relative,) [force/length]."""
        return np.diag(self.structure)

    @property
    def whole(self) -> bool:
        """Whether Σ + B is factorized as a whole."""
        return factorized_whole(self.points.G)

    def resisted(self, displacements: Vector) -> Vector:
        """Return Σ w of displacements w (n_relative,)."""
        return symmetric_product(self.structure, displacements)

    @cached_property
    def normal(self) -> NormalPairs | None:
        """The pairs along normals; None where tangents are coupled in or a step is cheap anyway."""
        if self.whole or self.points.components == 1:
            return None
        normal = NormalPairs.of(self.points, self.structure)
        return normal if 2 * len(normal.felt) <= len(self.structure) else None

    def loosened(self, shapes: Matrix, yields: Matrix) -> "GluedPairs":
        """Return the pairs of the structure without the springs across it (T1).

        Shapes z (n_spring, n_relative) are forces between pairs per initial force of each spring;
        ``yields`` M (n_spring, n_spring) [length/force] are the compliances with the pairs held.
        """
        return replace(
            self,
            structure=self.structure - shapes.T @ np.linalg.solve(yields, shapes),
            glued=self.glued.loosened(self.structure, shapes, yields),
            form_open=partial(self._open_loosened, shapes, yields),
        )

    def _open_loosened(self, shapes: Matrix, yields: Matrix) -> HeldPairs | None:
        opened = self.opened
        try:
            return None if opened is None else opened.loosened(self.structure, shapes, yields)
        except LinAlgError:  # these springs alone hold a part
            return None

    def step(
        self, K: Matrix, right: Vector, enough: float, factors: Factors | WholeFactors | None = None
    ) -> tuple[Vector, Vector, Factors | WholeFactors | None]:
        """Return d, Σ d, and the factors used, if a later step can use them.

        Springs ``K`` are (n_point, components, components) [force/length], ``enough`` is the
        residual over b that suffices for Newton's method, and ``factors`` come from the step
        before.

        Notes
        -----
        Two products with U or S, and factors of as many rows as change.
        """
        moved, factors = self._solve_step(K, right, enough, factors)
        return moved, self.resisted(moved), factors

    def _solve_step(
        self, K: Matrix, right: Vector, enough: float, factors: Factors | WholeFactors | None
    ) -> tuple[Vector, Factors | WholeFactors | None]:
        if self.whole:
            if not (isinstance(factors, WholeFactors) and np.array_equal(K, factors.K)):
                both = self.structure.copy()
                self.points.add_to(both, K)
                factors = WholeFactors(K, LU.of(both))
            return factors.lu.solve(right), factors
        changed = self._changed(K, right)
        if not len(changed.rows):
            return changed.moved, factors
        enough = max(enough, ACCURATE) * float(np.linalg.norm(right))
        # Overflow in single precision is followed by a solution in double.
        with np.errstate(over="ignore", invalid="ignore"):
            if isinstance(factors, Factors) and factors.reference is changed.reference:
                updated = factors.updated(K, changed.rows, self.points)
                if updated is not None:
                    system = changed.system(updated.system.rows, self.room, factors.system)
                    answer = changed.solve(replace(updated, system=system), enough)
                    if answer is not None:
                        return answer
            system = changed.system(changed.rows, self.room)
            try:
                answer = changed.solve(Factors.of(changed.reference, K, system, self.room), enough)
            except LinAlgError:
                answer = None
        if answer is not None:
            return answer
        whole = np.empty((len(system.rows),) * 2)
        exact = system.factorized(whole).solve(changed.shared(system))
        return changed.moved_by(changed.rows, exact), None

    def _changed(self, K: Matrix, right: Vector) -> "_ChangedPairs":
        """Return K and b as a change of the reference pairs that need fewer rows."""
        nearest, change = self.glued, change_from(self.glued.springs, K)
        rows, columns = self.points.touched(change)
        if len(self.points.touched(K)[0]) < len(rows):
            opened = self.opened
            other = change if opened is None else change_from(opened.springs, K)
            if opened and len(self.points.touched(other)[0]) < len(rows):
                nearest, change = opened, other
                rows, columns = self.points.touched(change)
        block = self.points.between_pairs(change)[:, columns]
        return _ChangedPairs(nearest, rows, columns, block, right, nearest.moved_by(right))


@dataclass(frozen=True, eq=False)
class _ChangedPairs:
    """The linear system (F7) for some K.

    Attributes
    ----------
    reference
        U, B₀.
    rows, columns
        r and c.
    block : (n_relative, n_column) sparse
        ΔB of columns c.
    right, moved
        b and U b.
    """

    reference: HeldPairs
    rows: Indices
    columns: Indices
    block: SparseMatrix
    right: Vector
    moved: Vector

    def system(self, rows: Indices, room: Room, previous: PairSystem | None = None) -> PairSystem:
        """Return the system at some rows; a previous system may hold its U_cr already."""
        alike = previous is not None and np.array_equal(rows, previous.rows)
        if previous is not None and alike and np.array_equal(self.columns, previous.columns):
            return replace(previous, block=self.block[rows])
        compliance = self.reference.compliance
        between = room.between(len(self.columns), len(rows), compliance)
        for first in range(0, len(between), IN_CACHE):
            strip = compliance[self.columns[first : first + IN_CACHE]]
            between[first : first + IN_CACHE] = strip.take(rows, axis=1)
        return PairSystem(rows, self.columns, self.block[rows], between)

    def shared(self, system: PairSystem) -> Vector:
        """Return ΔB_rc (U b)_c."""
        return np.asarray(system.block @ self.moved[self.columns])

    def moved_by(self, rows: Indices, taken: Vector) -> Vector:
        """Return d for the solution m at some rows."""
        forces = self.right.copy()
        forces[rows] -= taken
        return self.reference.moved_by(forces)

    def solve(self, factors: Factors, enough: float) -> tuple[Vector, Factors] | None:
        """Return d and the factors, to a residual [force]; None without convergence."""
        system, solve = factors.system, factors.solve
        taken = corrected(system.times, solve, self.shared(system), enough, MOST_CORRECTIONS)
        return None if taken is None else (self.moved_by(system.rows, taken), factors)


def _open_pairs(points: PointSprings, springs: Matrix, between: Condensed) -> HeldPairs | None:
    if factorized_whole(points.G):
        return None
    try:
        return anchored_pairs(points, springs, between.compliance_for_steps)
    except LinAlgError:  # the points alone hold a part
        return None


def factorized_whole(G: SparseMatrix | Matrix) -> bool:
    """Return whether Σ + B is factorized as a whole: few pairs, or dense point rows."""
    return int(G.shape[1]) <= DIRECT or isinstance(G, np.ndarray)
