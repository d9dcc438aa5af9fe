"""Contact as solvers see it: relative displacements, gaps at points, and a local law."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector, frozen, read_only
from faying.contact.laws import Law
from faying.digits import DECK_DIGITS, SOLVED
from faying.exceptions import ModelError
from faying.linalg.budget import default_budget, points_fit
from faying.linalg.sparse_compliance import Compliance

NOT_CARRIED = (
    "which is not carried here: tighten bolts by tighten, or by preload before with_friction; "
    "solve by solve_static, solve_path or solve_transient; take certificates of the model "
    "without it"
)
"""Default reason in refusals of friction."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Contact:
    """The contact data of all interfaces of a system, stacked.

    Attributes
    ----------
    relative_operator : (n_relative, n_dof)
        P, relative displacements of the node pairs; sparse for a full model, dense (PΦ) for a
        reduced one. Reduction changes nothing else.
    interpolation : (n_point, n_relative) sparse
        N, gaps at the contact points from relative displacements.
    initial_gap, weights : (n_point,)
    laws
        Interface name to the contact law of its points.
    slices
        Interface name to its contact points.
    residual_compliance : (n_relative, n_relative) or None
        Relative displacement per contact force that the basis of a reduced model cannot express.
    shear : (2, n_rubbing, n_relative) sparse, stacked
        Tangential displacements of the points of interfaces with friction, all along the first
        tangents, then all along the second; no rows by default.
    tangents : (2, n_point, 3)
        Directions of the tangential components; zeros by default.
    dense_budget
        Memory that dense matrices between pairs or contact points may take [bytes].
    """

    relative_operator: SparseMatrix | Matrix
    interpolation: SparseMatrix
    initial_gap: Vector
    weights: Vector
    laws: Mapping[str, Law]
    slices: Mapping[str, slice]
    residual_compliance: Compliance | None = None
    shear: SparseMatrix = field(default_factory=lambda: sp.csr_array((0, 0)))
    tangents: Matrix = field(default_factory=lambda: np.zeros((2, 1, 3)))
    dense_budget: int = field(default_factory=default_budget)

    def __post_init__(self) -> None:
        n_relative, shape = self.interpolation.shape[1], (2, self.n_points, 3)
        if self.components == 1:
            object.__setattr__(self, "shear", sp.csr_array((0, n_relative)))
        object.__setattr__(self, "tangents", np.broadcast_to(self.tangents, shape))

    @property
    def gap_operator(self) -> SparseMatrix | Matrix:
        """G = N P (n_point, n_dof), Eq. (15.3)."""
        return self.interpolation @ self.relative_operator

    @cached_property
    def transposed(self) -> tuple[SparseMatrix, SparseMatrix | Matrix]:
        """Nᵀ and Pᵀ, which map forces at the contact points to the degrees of freedom."""
        at_pairs, P = read_only(self.interpolation.T.tocsr()), self.relative_operator
        return at_pairs, P.T if isinstance(P, np.ndarray) else read_only(P.T.tocsr())

    @cached_property
    def flexibility(self) -> Vector:
        """Diagonal of D [length/force], the compliance of the laws; 1 / (c_n w), zero where hard.

        Raises
        ------
        ModelError
            If the closure of some law is not proportional to force.
        """
        self.check_proportional()
        return frozen(self._compliance(0))

    @cached_property
    def rubbing(self) -> Indices:
        """Contact points (n_rubbing,) of interfaces with friction."""
        indices = [
            np.arange(points.start, points.stop)
            for name, points in self.slices.items()
            if self.laws[name].components > 1
        ]
        return np.concatenate([np.empty(0, dtype=np.int64), *indices])

    @cached_property
    def rows(self) -> SparseMatrix:
        """G (components n_point, n_relative): gaps, then displacements along both tangents."""
        if self.components == 1:
            return self.interpolation.tocsr()
        n, half = self.n_points, len(self.rubbing)
        where = sp.csr_array((np.ones(half), (self.rubbing, np.arange(half))), shape=(n, half))
        parts = [self.interpolation, where @ self.shear[:half], where @ self.shear[half:]]
        rows = sp.vstack(parts).tocsr()
        # Some operations sort entries in place, and the order of a sum decides its last digits.
        rows.sum_duplicates()
        return read_only(rows)

    @property
    def components(self) -> int:
        """Components of the force at a point: 1, or 3 where some interface has friction."""
        return 3 if len(self.rubbing) else 1

    @property
    def rubbing_interfaces(self) -> list[str]:
        """Names of the interfaces with friction."""
        return [name for name, law in self.laws.items() if law.friction > 0]

    @property
    def smooth_interfaces(self) -> list[str]:
        """Names of the interfaces without friction."""
        return [name for name, law in self.laws.items() if not law.friction > 0]

    @property
    def smooth(self) -> "Contact":
        """The contact of the same points without friction, by their normal laws."""
        laws = {name: law.normal for name, law in self.laws.items()}
        return self if laws == dict(self.laws) else replace(self, laws=laws)

    def parts(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        """Split forces into normal (..., n_point) and tangential ones (..., n_tangent, n_point).

        Forces (..., components * n_point) are ordered component by component.
        """
        n = self.n_points
        return forces[..., :n], forces[..., n:].reshape(*forces.shape[:-1], self.components - 1, n)

    def moved(self, relative: Vector) -> Matrix:
        """Return displacements at points (3, n_point) [length] from those of pairs (n_relative,).

        They are openings, and tangential displacements where there is friction.
        """
        moved = np.zeros((3, self.n_points))
        moved[0] = self.interpolation @ relative
        moved[1:, self.rubbing] = (self.shear @ relative).reshape(2, -1)
        return moved

    def offset(self, slip: Matrix | float = 0.0) -> Matrix:
        """Return z₀ of (F1) (3, n_point) [length]: initial gap, and minus the slip (2, n_point)."""
        offset = np.zeros((3, self.n_points))
        offset[0] = self.initial_gap
        offset[1:] -= slip
        return offset

    def free_slack(self, relative: Vector, slip: Matrix) -> Matrix:
        """Return z₀ plus the displacements of points without forces (3, n_point) [length]."""
        free = self.moved(relative) + self.offset()
        free[1 : 1 + len(slip)] -= slip
        return free

    def at_pairs(self, forces: Matrix, shear_forces: Matrix | None = None) -> Matrix:
        """Return forces between the pairs (n_relative, ...) due to forces at points (..., n_point).

        Shear forces (..., n_tangent, n_point) act along the tangential displacements.
        """
        pairs: Matrix = self.transposed[0] @ np.asarray(forces).T
        if shear_forces is not None and shear_forces.size and self.components > 1:
            rubbing = shear_forces[..., self.rubbing]
            pairs = pairs + self.shear.T @ rubbing.reshape(*rubbing.shape[:-2], -1).T
        return pairs

    def sticking(self, normal: Matrix, shear: Matrix) -> Mask:
        """Return which points are in contact with a traction below its bound μ p.

        Arguments are normal (..., n_point) and tangential forces (..., n_tangent, n_point) [force].
        """
        bound = self.coefficients * normal
        # Far above the accuracy of increments, far below the change in an increment of load.
        slack = DECK_DIGITS * bound + SOLVED * normal.max(initial=0.0)
        return np.asarray(np.linalg.norm(shear, axis=-2) < bound - slack)

    @property
    def yields(self) -> bool:
        """Whether forces follow from displacements at every point (no hard contact)."""
        return all(law.yields for law in self.laws.values())

    @property
    def proportional(self) -> bool:
        """Whether closure is proportional to force at every point."""
        return all(law.proportional for law in self.laws.values())

    @property
    def remembers(self) -> bool:
        """Whether pressure depends on earlier closure at some points."""
        return any(law.remembers for law in self.laws.values())

    @property
    def forgets(self) -> bool:
        """Whether a load case needs no history: neither slip nor earlier closure."""
        return self.components == 1 and not self.remembers

    @property
    def unilateral(self) -> bool:
        """Whether each point is a linear spring in compression: no friction and no curve."""
        return self.forgets and self.proportional

    def increments(self, asked: int) -> int:
        """Return the number of increments of a load path: as asked, or one without history."""
        return 1 if self.forgets else asked

    def way_to(self, instants: Indices) -> Indices:
        """Return, in order, the instants to solve for some: with history all earlier ones too."""
        return np.unique(instants) if self.forgets else np.arange(instants.max(initial=-1) + 1)

    def check_rubs(self) -> None:
        """Refuse joints without friction, for analyses of slip."""
        if not self.coefficients.any():
            message = "no interface has friction; give it with model.with_friction"
            raise ModelError(message)

    def check_slip(self, slip: Matrix, name: str) -> None:
        """Refuse a named state whose slip (n_tangent, n_point) has another number of components."""
        if len(slip) != self.components - 1:
            message = (
                f"of the joint and the initial solution '{name}' only one has friction, and says "
                "what has slipped; give one of solve_path, solve_path(joint, [fy.Load()], "
                "initial=...) to close a joint with friction that was tightened without"
            )
            raise ModelError(message)

    def check_frictionless(self, why: str = NOT_CARRIED) -> None:
        """Refuse friction, for methods without increments; the message says why and what to do."""
        for name, law in self.laws.items():
            if law.components > 1:
                message = f"interface '{name}' has friction, {why}"
                raise ModelError(message)

    def check_forgetful(self, what: str, instead: str) -> None:
        """Refuse laws that remember earlier closure, for methods that do not carry it along.

        ``instead`` names a method that does.
        """
        for name, law in self.laws.items():
            if law.remembers:
                message = (
                    f"interface '{name}' has the law '{law.normal.name}', which remembers how far "
                    f"it was closed; {what} do not carry that: take {instead}, or give it a 'table'"
                )
                raise ModelError(message)

    def check_cases(self) -> None:
        """Refuse independent load cases where slip or closure is remembered."""
        self.check_frictionless()
        self.check_forgetful("cases that do not follow each other", "solve_path")

    def check_proportional(self) -> None:
        """Refuse laws whose closure is not proportional to force."""
        for name, law in self.laws.items():
            if not law.proportional:
                message = (
                    f"interface '{name}' has the law '{law.normal.name}', whose closure is not in "
                    "proportion to its force, as it must be here; give it a penalty"
                )
                raise ModelError(message)

    def check_mean_forces(self) -> None:
        """Refuse what mean forces over a time step miss: curves, and hard points with friction.

        One hard point counts where any point has friction.
        """
        self.check_proportional()
        if self.components > 1 and not self.yields:
            message = (
                "EnergyDecaying steps with friction need elastic contact: a hard point has no "
                "force at an instant that the mean over a step would tell; give the interfaces a "
                "penalty and a tangential penalty, or take ImplicitEuler"
            )
            raise ModelError(message)

    @cached_property
    def tangential_flexibility(self) -> Vector:
        """Diagonal of D of one tangential component (n_rubbing,) [length/force]."""
        return frozen(self._compliance(-1)[self.rubbing])

    def _compliance(self, component: int) -> Vector:
        """Return c′(0) of one component at every point (n_point,) [length/force]."""

        def own(law: Law, points: slice) -> Vector:
            weights = self.weights[points]
            nothing = np.zeros((law.components, len(weights)))
            return np.asarray(law.closure(nothing, weights)[1][component])

        return self._by_point(own)

    @cached_property
    def friction(self) -> Vector:
        """Coefficients of friction (n_rubbing,)."""
        return frozen(self._by_point(lambda law, _: law.friction)[self.rubbing])

    @cached_property
    def coefficients(self) -> Vector:
        """Coefficients of friction of all points (n_point,), zero where there is none."""
        return frozen(self._by_point(lambda law, _: law.friction))

    @cached_property
    def penalty(self) -> Vector:
        """Contact stiffness c_n (n_point,) [force/length³]; infinite where contact is hard.

        Raises
        ------
        ModelError
            If some law has no single stiffness.
        """
        self.check_proportional()
        return frozen(self._by_point(lambda law, _: law.penalty))

    def _by_point(self, value: Callable[[Law, slice], Vector | float]) -> Vector:
        """Return a value of the laws at every point (n_point,)."""
        result = np.empty(self.n_points)
        for name, points in self.slices.items():
            result[points] = value(self.laws[name], points)
        return result

    def closed_by(self, forces: Matrix) -> Matrix:
        """Return closures of the laws (..., n_point) [length] under normal forces."""
        result = np.empty_like(forces)
        for name, points in self.slices.items():
            law_forces = forces[..., points]
            weights = np.broadcast_to(self.weights[points], law_forces.shape).ravel()
            closed = self.laws[name].normal.closure(law_forces.reshape(1, -1), weights)[0]
            result[..., points] = closed.reshape(law_forces.shape)
        return result

    @property
    def n_points(self) -> int:
        """Number of contact points of all interfaces."""
        return len(self.weights)

    def free_gap(self, relative_displacement: Matrix) -> Matrix:
        """Return g_free (..., n_point) from relative displacements (..., n_relative) without λ."""
        gap: Matrix = (self.interpolation @ np.asarray(relative_displacement).T).T
        return gap + self.initial_gap

    def at_points(self, compliance: Matrix, rows: SparseMatrix | None = None) -> Matrix:
        """Return the compliance N S Nᵀ between contact points, or along other rows of G than N."""
        rows = self.interpolation if rows is None else rows
        if not points_fit(rows.shape[0], self.dense_budget):
            message = (
                f"a dense matrix between {rows.shape[0]} contact forces exceeds the dense budget "
                f"of {self.dense_budget:.2g} bytes; solve without it (solve_static, "
                "solve_transient), use a coarser interface, or raise the budget with "
                "model.with_dense_budget"
            )
            raise ModelError(message)
        return np.asarray(rows @ (rows @ compliance).T)
