"""The linear part of a model, and the one factorization from which all else is computed."""

import logging
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.linalg as la

from faying._typing import Frozen, Indices, Matrix, SparseMatrix, Vector, frozen
from faying.contact.between_pairs import BetweenPairs, ByStiffness, Stiffness, between
from faying.digits import ROUND_OFF
from faying.joint.free_matrices import FreeMatrices
from faying.joint.system import PortCompliance
from faying.linalg.backends import estimate_memory, estimate_port_memory
from faying.linalg.budget import SPARSE_FACTORS, default_budget, pairs_fit
from faying.linalg.cholesky import factorize_condensed, inverse
from faying.linalg.factorization import factorize
from faying.linalg.interface import Factorization, MatrixFactorization
from faying.linalg.memory import FactorMemory
from faying.linalg.partial import port_stiffness
from faying.linalg.relief import balanced, supported, supports
from faying.linalg.singular import SingularMatrixError
from faying.linalg.sparse_compliance import Compliance, SparseCompliance, plus
from faying.linalg.sparse_stiffness import SparseStiffness
from faying.linalg.substitution import dense, solved_gram, symmetrized

_log = logging.getLogger("faying")


@dataclass(frozen=True, eq=False, kw_only=True)
class Structure(Frozen):
    """Mass, damping and stiffness with ports: the model without contact.

    The interior (all but the boundary) is factorized once. With the constraint modes Ψ of Craig &
    Bampton that factorization also gives the structure with a free boundary,

        K⁻¹ = [K_ii⁻¹ 0; 0 0] + Ψ (ΨᵀKΨ)⁻¹ Ψᵀ,

    so bases, compliances and static solutions share it. For a free structure K̂ of (M11) takes the
    place of K in both, and K⁺ that of K⁻¹.

    Attributes
    ----------
    matrices
        M, C and K.
    relative_operator : (n_relative, n_dof) sparse
        P of all interfaces.
    boundary : (n_boundary,)
        Indices of the boundary degrees of freedom, boundary by boundary, without repetition.
    elongations : (n_bolt, n_dof)
    whole_motions
        Function that returns the free rigid motions (n_dof, n) of the whole; without it the
        structure has to be held.
    diagnose
        Function that returns a message on a free motion (n_dof,).
    dense_budget
        Memory that dense matrices between pairs or contact points may take [bytes].
    firm_rows : (n_spring, n_dof) sparse or None
        Displacements over which weak springs act, times the root of the stiffness that makes them
        firm.
    """

    matrices: FreeMatrices
    relative_operator: SparseMatrix
    boundary: Indices
    elongations: Matrix
    whole_motions: Callable[[SparseMatrix], Matrix] | None = None
    diagnose: Callable[[SparseMatrix, Vector], str] | None = None
    dense_budget: int = field(default_factory=default_budget)
    firm_rows: SparseMatrix | None = None

    @property
    def n_dof(self) -> int:
        """Number of degrees of freedom."""
        return int(self.relative_operator.shape[1])

    @property
    def M(self) -> SparseMatrix:
        """Mass (n_dof, n_dof)."""
        return self.matrices.M

    @property
    def C(self) -> SparseMatrix:
        """Damping (n_dof, n_dof)."""
        return self.matrices.C

    @property
    def K(self) -> SparseMatrix:
        """Stiffness (n_dof, n_dof)."""
        return self.matrices.K

    @property
    def has_mass(self) -> bool:
        """Whether any degree of freedom has mass, which statics do not need."""
        return bool(self.M.diagonal().any())

    @cached_property
    def rigid_motions(self) -> Matrix:
        """R (n_dof, n_motion), free rigid motions: KR = 0, RᵀMR = I.

        Empty (n_dof, 0) where the structure is held, or has no mass that could balance forces.
        """
        if self.whole_motions is None or not self.has_mass:
            return np.zeros((self.n_dof, 0))
        motions = self.whole_motions(self.K)
        inertia, ways = np.linalg.eigh(motions.T @ (self.M @ motions))
        heavy = inertia > ROUND_OFF * inertia.max(initial=0.0)
        return frozen(motions @ (ways[:, heavy] / np.sqrt(inertia[heavy])))

    @cached_property
    def carried(self) -> Matrix:
        """M R (n_dof, n_motion)."""
        return np.asarray(self.M @ self.rigid_motions)

    @cached_property
    def supports(self) -> Indices:
        """Degrees of freedom of the springs of (M11), on the boundary if possible."""
        return supports(self.rigid_motions, self.boundary)

    @cached_property
    def supported_stiffness(self) -> SparseMatrix:
        """K̂ of (M11); K where the structure is held."""
        if not self.rigid_motions.shape[1]:
            return self.K
        return supported(self.K, self.supports)

    @cached_property
    def firm(self) -> "Structure":
        """The structure with weak springs made as stiff as the bodies that they hold.

        A basis with :attr:`relief_shapes` has the same residual compliance between pairs in both.
        No digits are lost to bodies that nearly move freely.
        """
        if self.firm_rows is None:
            return self
        K = (self.supported_stiffness + self.firm_rows.T @ self.firm_rows).tocsr()
        matrices = FreeMatrices(form=lambda: (self.M, K, None))
        return replace(self, matrices=matrices, whole_motions=None, firm_rows=None)

    @cached_property
    def relief_shapes(self) -> Matrix:
        """Shapes that a basis of a free or weakly held structure needs, boundary held.

        They are static responses to the forces of springs and of inertia, K̂_ii⁻¹ [E, M R]_i: with
        constraint modes they span R and K̂⁻¹ M R of (M12), so that (M5) and (M6) hold with K⁺. Weak
        springs are treated like these springs; their shapes span the same space in the firm
        structure.
        """
        springs = np.zeros((self.n_dof, len(self.supports)))
        springs[self.supports, np.arange(len(self.supports))] = 1.0
        weak = [] if self.firm_rows is None else [dense(self.firm_rows.T)]
        return self.firm.solve_held(np.hstack([springs, self.carried, *weak]))

    @cached_property
    def interior(self) -> Indices:
        """Indices of the degrees of freedom off the boundary, u_i of Eq. (15.17)."""
        inner = np.ones(self.n_dof, dtype=bool)
        inner[self.boundary] = False
        return np.flatnonzero(inner)

    @cached_property
    def interior_factor(self) -> MatrixFactorization:
        """Factorization of K_ii."""
        try:
            return factorize(self.interior_stiffness)
        except SingularMatrixError as error:
            motion = np.zeros(self.n_dof)
            motion[self.interior] = error.motion
            raise self.unconstrained(motion) from None

    @property
    def factor_memory(self) -> FactorMemory:
        """Memory of the factorization of K_ii, from its pattern alone.

        The peak includes the dense matrices between pairs, or factors in their place.
        """
        K = self.interior_stiffness
        factors = estimate_memory(K)
        if not self.is_kept_whole:
            return factors.beside(SPARSE_FACTORS)
        return factors.with_ports(*estimate_port_memory(K, self._held_ports))

    @property
    def interior_stiffness(self) -> SparseMatrix:
        """K_ii."""
        return self.supported_stiffness[self.interior][:, self.interior]

    def unconstrained(self, motion: Vector) -> SingularMatrixError:
        """Return an error with a message on the free motion (n_dof,)."""
        message = self.diagnose(self.supported_stiffness, motion) if self.diagnose else ""
        return SingularMatrixError(motion, message)

    @cached_property
    def constraint_modes(self) -> Matrix:
        """Ψ_c (n_dof, n_boundary): unit displacement of one boundary dof, all others held."""
        modes = np.zeros((self.n_dof, len(self.boundary)))
        coupling = self.supported_stiffness[self.interior][:, self.boundary].toarray()
        modes[self.interior] = -self.interior_factor.solve(coupling)
        modes[self.boundary] = np.eye(len(self.boundary))
        return modes

    @cached_property
    def boundary_stiffness(self) -> Matrix:
        """ΨᵀKΨ (n_boundary, n_boundary): stiffness condensed to the boundary."""
        condensed: Matrix = self.supported_stiffness[self.boundary] @ self.constraint_modes
        return (condensed + condensed.T) / 2

    @cached_property
    def boundary_factor(self) -> Factorization:
        """Factorization of the condensed stiffness."""
        singly = self.supported_stiffness.diagonal() @ self.constraint_modes**2
        try:
            return factorize_condensed(self.boundary_stiffness, singly)
        except SingularMatrixError as error:
            raise self.unconstrained(self.constraint_modes @ error.motion) from None

    def solve_held(self, forces: Matrix) -> Matrix:
        """Return displacements (n_dof, k) under forces (n_dof, k) with the boundary held."""
        displacement = np.zeros(np.shape(forces))
        displacement[self.interior] = self.interior_factor.solve(forces[self.interior])
        return displacement

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return displacements (n_dof, k) under forces (n_dof, k) with the boundary free.

        For a free structure these are K⁺ f, (M11).

        Raises
        ------
        SingularMatrixError
            If the structure is not held without its boundary.
        """
        loads = balanced(right_hand_side, self.rigid_motions, self.carried)
        moved = self._solve_supported(loads)
        return balanced(moved, self.carried, self.rigid_motions)

    def _solve_supported(self, forces: Matrix) -> Matrix:
        """Return K̂⁻¹ f."""
        at_boundary = self.constraint_modes.T @ forces
        return self.solve_held(forces) + self.constraint_modes @ self.boundary_factor.solve(
            at_boundary
        )

    @cached_property
    def held_compliance(self) -> Compliance:
        """P K_ii⁻¹ Pᵀ (n_relative, n_relative) of relative displacements, boundary held.

        By sparse factors where its dense matrices exceed the dense budget.

        Notes
        -----
        The inverse of :attr:`held_stiffness`, or a back-substitution per row of P.
        """
        if not self.is_kept_whole:
            stiffness = SparseStiffness(
                matrix=self.interior_stiffness,
                ports=self._held_ports,
                solve=self.interior_factor.solve,
            )
            return SparseCompliance.of(stiffness)
        if self.firm_rows is not None:
            shapes = self.firm.solve_held(dense(self.firm_rows.T))
            softer = np.eye(shapes.shape[1]) - self.firm_rows @ shapes
            core = np.linalg.inv((softer + softer.T) / 2)
            return plus(self.firm_compliance, self.relative_operator @ shapes, core)
        if self.held_stiffness is not None:
            return inverse(self.held_stiffness)
        return solved_gram(self.interior_factor.solve, self._held_ports.T)

    @cached_property
    def firm_compliance(self) -> Compliance:
        """:attr:`held_compliance` of the firm structure, whose stiffness is not kept."""
        if self.firm_rows is None or not self.is_kept_whole:
            return self.firm.held_compliance
        return self.firm.interior_factor.gram(self._held_ports.T)

    @cached_property
    def held_stiffness(self) -> Matrix | None:
        """(P K_ii⁻¹ Pᵀ)⁻¹ (n_relative, n_relative), boundary held; one more factorization, (F14).

        None for few pairs, for pairs without distinct degrees of freedom, and where its dense
        matrices exceed the dense budget or the free memory.
        """
        whole = self.is_kept_whole
        return port_stiffness(self._held_ports, self.interior_factor) if whole else None

    def take_held(self, name: str, matrix: Matrix) -> None:
        """Store a held stiffness or compliance that was formed before, without checks."""
        vars(self)[name] = frozen(matrix)

    @cached_property
    def _held_ports(self) -> SparseMatrix:
        """P at the interior (n_relative, n_interior)."""
        return self.relative_operator[:, self.interior].tocsr()

    @property
    def is_kept_whole(self) -> bool:
        """Whether the compliance between all pairs is stored as a dense matrix."""
        return pairs_fit(self.relative_operator.shape[0], self.dense_budget)

    @cached_property
    def bolt_shapes(self) -> Matrix:
        """Displacements (n_dof, n_bolt) under a unit initial force of each bolt, boundary held."""
        return self.solve_held(-self.elongations.T)

    def loaded_ports(self, patterns: Matrix) -> PortCompliance:
        """Return the port compliance with load patterns (n_pattern, n_dof) as further ports.

        Notes
        -----
        One back-substitution for each pattern.
        """
        ports, shapes = self.port_compliance, self.solve(patterns.T)
        columns = np.vstack([shapes[self.boundary], self.elongations @ shapes])
        symmetric = symmetrized(patterns @ shapes)
        return replace(
            ports,
            contact_columns=np.vstack([ports.contact_columns, (self.relative_operator @ shapes).T]),
            input_rows=np.block([[ports.input_rows, columns], [columns.T, symmetric]]),
            n_pattern=len(patterns),
        )

    @cached_property
    def port_compliance(self) -> PortCompliance:
        """Compliance between relative displacements, boundary and bolts, boundary free.

        For a free structure (M12).

        Raises
        ------
        SingularMatrixError
            If the structure is not held without its boundary.
        """
        seen = self.relative_operator @ self.constraint_modes
        outer = np.vstack([np.eye(len(self.boundary)), self.elongations @ self.constraint_modes])
        condensed = self.boundary_factor.solve(np.eye(len(self.boundary)))
        columns, inputs = outer @ condensed @ seen.T, outer @ condensed @ outer.T
        bolts = slice(len(self.boundary), len(outer))
        columns[bolts] -= (self.relative_operator @ self.bolt_shapes).T
        inputs[bolts, bolts] -= self.elongations @ self.bolt_shapes
        moved, others, core = self._relief_ports
        columns += others @ core @ moved.T
        inputs += others @ core @ others.T
        smooth = np.hstack([seen, moved]), la.block_diag(condensed, core)
        return PortCompliance(
            pairs=self._between_pairs(smooth),
            contact_columns=columns,
            input_rows=symmetrized(inputs),
            n_boundary=len(self.boundary),
        )

    def _between_pairs(self, smooth: tuple[Matrix, Matrix]) -> BetweenPairs:
        """Return compliance or stiffness between the pairs with the boundary free.

        ``smooth`` are the shapes and the core that this adds to the compliance with the boundary
        held.
        """
        P = self.relative_operator

        def form_compliance() -> Matrix:
            return np.asarray(plus(self.held_compliance, *smooth))

        if (stiffness := self._free_stiffness) is not None:
            known = Stiffness(stiffness)
            return ByStiffness(known, lambda p: P @ self.solve(P.T @ p), form_compliance)
        if not self.is_kept_whole:
            _log.info(
                "dense matrices between %d relative displacements exceed the dense budget of %.2g "
                "bytes, so contact is solved with sparse factors",
                P.shape[0],
                self.dense_budget,
            )
        return between(plus(self.held_compliance, *smooth))

    @property
    def _free_stiffness(self) -> Matrix | None:
        """Σ with the boundary free; None if the structure is not held then, or without Σ held."""
        held = self.held_stiffness
        if held is None or self.rigid_motions.shape[1]:
            return None
        seen = self.relative_operator @ self.constraint_modes
        moved = held @ seen
        core = la.cholesky(self.boundary_stiffness + symmetrized(seen.T @ moved), lower=True)
        given_way = la.solve_triangular(core, moved.T, lower=True)
        # BLAS works in column order; the transpose of a symmetric matrix is the same.
        free: Matrix = la.blas.dgemm(-1.0, given_way, given_way, 1.0, held.T, trans_a=1).T
        free.setflags(write=False)
        return free

    @cached_property
    def _relief_ports(self) -> tuple[Matrix, Matrix, Matrix]:
        """Return [R, X] of (M12) at pairs and at other ports, and the matrix between them."""
        R = self.rigid_motions
        answers = self._solve_supported(self.carried)
        both, identity = np.hstack([R, answers]), np.eye(R.shape[1])
        core = np.block([[self.carried.T @ answers, -identity], [-identity, 0.0 * identity]])
        others = np.vstack([both[self.boundary], self.elongations @ both])
        return self.relative_operator @ both, others, core
