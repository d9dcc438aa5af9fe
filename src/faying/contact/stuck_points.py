"""A contact problem of few points, with all other closed points stuck.

Closed, sticking points are springs B of the structure. With the displacements δ of the pairs from
rest, V their displacements under loads alone, and μ the forces of points c beyond those of their
springs,

    δ = T₀ (Σ V + G_cᵀ μ),   T₀ = (Σ + B)⁻¹ = (I + S B)⁻¹ S,                               (F10)

so that the points c alone are a contact problem with the compliance G_c T₀ G_cᵀ. This is exact as
long as all other points stay closed and stuck, or open.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, cast

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.contact import Contact
from faying.contact.glued_pairs import GluedPairs
from faying.contact.increment import IncrementSolver
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.point_springs import PointSprings
from faying.contact.yielding import YieldingContact
from faying.exceptions import ModelError

CLOSE_TO_BOUND = 0.9
"""Traction over its bound above which a stuck point is watched."""

LEAST_GIVEN_WAY = 0.01
"""Share of the structure in the stiffness at a point, spring included, above which I − B T has
enough digits in single precision: 0.24 on a flange."""


@dataclass(frozen=True, eq=False, kw_only=True)
class StuckPoints:
    """All contact points in the state at rest: closed ones on springs, the others open.

    Attributes
    ----------
    contact
        Contact of all points.
    forces, slip : (3, n_point), (2, n_point)
        At rest.
    moved : (n_relative,) [length]
        Relative displacements at rest.
    springs : (components, n_point) [force/length]
        B.
    compliance : (n_relative, n_relative) [length/force]
        T₀, without the effect of prescribed motions.
    prescribed : (n_relative, n)
        Columns h; prescribed motions reduce T₀ by h hᵀ.
    """

    contact: Contact
    forces: Matrix
    slip: Matrix
    moved: Vector
    springs: Matrix
    compliance: Matrix
    prescribed: Matrix

    @classmethod
    def of(
        cls, solver: IncrementSolver, forces: Matrix, slip: Matrix, moved: Vector
    ) -> "StuckPoints":
        """Return the stuck points of a joint at rest, by the solver of its increments."""
        contact = solver.contact
        if not contact.yields:
            message = (
                "contact is hard at some points, whose forces do not follow from displacements; "
                "give it a penalty"
            )
            raise ModelError(message)
        k, closed = contact.components, forces[0] > 0
        yields = LawsAtPoints(contact=contact).closure(forces)[1][:k]
        sprung = closed & (yields > 0)
        springs = np.where(sprung, 1.0 / np.where(sprung, yields, 1.0), 0.0)
        if isinstance(solver, YieldingContact) and solver.shapes is None:
            compliance = cast("GluedPairs", solver.pairs).glued_by(springs).glued.compliance
        else:
            block = (contact.rows.T @ sp.diags_array(springs.ravel()) @ contact.rows).tocsr()
            compliance = np.linalg.solve(np.eye(len(moved)) + solver.S @ block, solver.S)
        return cls(
            contact=contact,
            forces=forces,
            slip=slip,
            moved=moved,
            springs=springs,
            compliance=compliance,
            prescribed=np.zeros((len(moved), 0)),
        )

    def between(self, pairs: Indices, others: Indices) -> Matrix:
        """Return T₀ (n_pair, n_other) between some relative displacements."""
        taken = self.prescribed[pairs] @ self.prescribed[others].T
        return np.asarray(self.compliance[np.ix_(pairs, others)] - taken)

    def shared(self, pairs: Indices, forces: Matrix) -> Matrix:
        """Return T₀ times forces (n_pair, k) at some relative displacements (n_relative, k)."""
        taken = self.prescribed @ (self.prescribed[pairs].T @ forces)
        return np.asarray(self.compliance[:, pairs] @ forces - taken)

    def held_back(self, moved: Matrix) -> Matrix:
        """Return forces of the springs B between the pairs under displacements (n_relative, k)."""
        rows = self.contact.rows
        return np.asarray(rows.T @ (self.springs.reshape(-1, 1) * (rows @ moved)))

    def restrained(self, moved: Matrix) -> Matrix:
        """Return T₀ Σ V (n_relative, k) for displacements V under loads alone."""
        return np.asarray(moved - self.compliance @ self.held_back(moved))

    def first(self) -> Indices:
        """Return the points close to the friction limit at rest, as a first choice."""
        if not self.contact.proportional:
            return np.arange(self.contact.n_points)
        limit = self.contact.coefficients * self.forces[0]
        sheared = np.hypot(self.forces[1], self.forces[2])
        return np.flatnonzero((limit > 0) & (sheared > CLOSE_TO_BOUND * limit))

    def leaving(self, displaced: Matrix, watched: Indices) -> Indices:
        """Return points (n,) that leave their state at rest, with those close to leaving it.

        ``displaced`` is δ (n_relative, n_sample) [length]; the points c in ``watched`` are exempt.
        Empty where no other point leaves.
        """
        contact, k, n = self.contact, len(self.springs), self.contact.n_points
        moved = (contact.rows @ displaced).reshape(k, n, -1)
        force = self.forces[:k, :, None] - self.springs[:, :, None] * moved
        closed = self.forces[0] > 0
        gap = contact.moved(self.moved)[0] + contact.initial_gap

        def beyond(part: float) -> Mask:
            lifted = force[0].min(axis=1) < (1 - part) * self.forces[0]
            left = np.where(closed, lifted, gap + moved[0].min(axis=1) < (1 - part) * gap)
            if k > 1:
                sheared = np.hypot(force[1], force[2])
                limit = part * contact.coefficients[:, None] * np.maximum(force[0], 0.0)
                rubs = closed & (contact.coefficients > 0)
                left |= rubs & (sheared > limit).any(axis=1)
            left[watched] = False
            return np.asarray(left)

        if not beyond(1.0).any():
            return np.empty(0, dtype=np.int64)
        return np.flatnonzero(beyond(CLOSE_TO_BOUND))

    def local(self, points: Indices) -> "LocalContact":
        """Return the contact problem of some points (n,), in ascending order."""
        components = self.contact.n_points * np.arange(len(self.springs))
        part = self.contact.rows[(components[:, None] + points).ravel()]
        pairs = np.unique(part.indices)
        return LocalContact(
            whole=self, points=points, pairs=pairs, rows=sp.csr_array(part[:, pairs])
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class LocalContact:
    """Points that may leave their springs.

    Attributes
    ----------
    whole
        All points.
    points : (n_local,)
    pairs : (n_touched,)
        Pairs that they touch.
    rows : (components n_local, n_touched)
        G_c, displacements at the points from those of the pairs.
    """

    whole: StuckPoints
    points: Indices
    pairs: Indices
    rows: SparseMatrix

    @cached_property
    def contact(self) -> Contact:
        """Contact of these points alone."""
        contact, pairs = self.whole.contact, self.pairs
        chosen = np.zeros(contact.n_points, dtype=bool)
        chosen[self.points] = True
        slices, start = {}, 0
        for name, points_of_law in contact.slices.items():
            count = int(chosen[points_of_law].sum())
            slices[name] = slice(start, start + count)
            start += count
        rubbing = np.tile(chosen[contact.rubbing], 2)
        return replace(
            contact,
            relative_operator=contact.relative_operator[pairs],
            interpolation=contact.interpolation[self.points][:, pairs].tocsr(),
            initial_gap=contact.initial_gap[self.points],
            weights=contact.weights[self.points],
            slices=slices,
            residual_compliance=None,
            shear=contact.shear[rubbing][:, pairs].tocsr(),
            tangents=contact.tangents[:, self.points],
        )

    @property
    def components(self) -> int:
        """Components of force at a point."""
        return len(self.whole.springs)

    @cached_property
    def springs(self) -> Matrix:
        """Springs of the points (components, n_local) [force/length]."""
        return self.whole.springs[:, self.points]

    @cached_property
    def forces(self) -> Matrix:
        """Forces at rest (components, n_local)."""
        return self.whole.forces[: self.components, self.points]

    @cached_property
    def slip(self) -> Matrix:
        """Slip at rest (2, n_local) [length]."""
        return self.whole.slip[:, self.points]

    @cached_property
    def at_rest(self) -> Matrix:
        """Gap and tangential displacements at rest (components, n_local) [length]."""
        moved = self.contact.moved(self.whole.moved[self.pairs])
        return np.asarray((moved + self.contact.offset(self.slip))[: self.components])

    @cached_property
    def shares(self) -> PointSprings:
        """Map from the coordinates (pairs, or points where these are fewer) to the points."""
        n = self.rows.shape[0]
        G = self.rows if len(self.pairs) < n else sp.eye_array(n, format="csr")
        return PointSprings(G=G, components=self.components)

    def shares_coordinates(self, other: "LocalContact") -> bool:
        """Return whether the coordinates are those of other points."""
        in_pairs = all(len(some.pairs) < some.rows.shape[0] for some in (self, other))
        return in_pairs and np.array_equal(self.pairs, other.pairs)

    @cached_property
    def compliance(self) -> Matrix:
        """T of (F12), between the coordinates (n_coordinate, n_coordinate) [length/force]."""
        if len(self.pairs) < self.rows.shape[0]:
            return self._between
        return np.asarray(self.rows @ (self.rows @ self._between).T)

    @cached_property
    def for_steps(self) -> npt.NDArray[Any]:
        """T for Newton's steps: in single precision where that leaves enough digits."""
        G = self.shares.G
        moved = np.asarray((G * (G @ self.compliance)).sum(axis=1))
        given_way = 1.0 - self.springs.ravel() * moved
        single = (given_way > LEAST_GIVEN_WAY).all()
        return self.compliance.astype(np.float32 if single else np.float64)

    @cached_property
    def _between(self) -> Matrix:
        """T₀ between the touched pairs (n_touched, n_touched) [length/force]."""
        return self.whole.between(self.pairs, self.pairs)

    @cached_property
    def laws(self) -> LawsAtPoints:
        """Contact laws at the points."""
        return LawsAtPoints(contact=self.contact)
