"""The part of the linear motion of a joint with stuck points that some shapes omit, by few vectors.

Under f exp(iΩt), with given harmonics q of M-orthonormal shapes Φ, the rest v = u − Φ q has

    Yᵀ (K + iΩC − Ω²M) Y x = Yᵀ f − Yᵀ (K + iΩC) Φ q,   v = Y x,   Φᵀ M Y = 0.              (F17)

The directions Y are those of the series v = Σ (K⁻¹M)ʲ K⁻¹ (f − iΩCΦq) in Ω², whose first term alone
is the static rest of mode acceleration (R. E. Cornwell, R. R. Craig & C. P. Johnson, On the
application of the mode-acceleration method, Earthq. Eng. Struct. Dyn. 11, 1983). By Galerkin's
method, one term has the error of two terms of the series.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la

from faying._typing import ComplexMatrix, ComplexVector, Matrix, SparseMatrix
from faying.digits import ROUND_OFF
from faying.joint.system import System
from faying.linalg.interface import Factorization

TERMS = 2
"""Terms of the series: the relative error of a lap joint's linear response between resonances was
2e-4 without terms, 8e-7 with one, and 1e-9 with two, the round-off of its modes."""


@dataclass(frozen=True, eq=False, kw_only=True)
class StuckRest:
    """The motion (F17) in shapes and directions together.

    Attributes
    ----------
    directions : (n_dof, n_mode + n_rest)
        Φ, Y: M-orthonormal.
    n_mode
        Number of shapes.
    stiffness, damping : (n_mode + n_rest, n_mode + n_rest)
        K and C between them.
    forced : (n_mode + n_rest,)
        Generalized forces of the load.
    """

    directions: Matrix
    n_mode: int
    stiffness: Matrix
    damping: Matrix
    forced: ComplexVector

    @classmethod
    def of(
        cls,
        system: System,
        stiffness: SparseMatrix | Matrix,
        factor: Factorization,
        shapes: Matrix,
        load: Matrix,
    ) -> "StuckRest":
        """Return the motion for shapes (n_dof, n) and both parts of a load (n_dof, 2).

        The stiffness (n_dof, n_dof) is that of the joint whose closed points stick.
        """
        M, C, W = system.M, system.C, shapes
        forces = np.column_stack([load, C @ shapes])
        for _ in range(TERMS):
            moved = factor.solve(forces)
            size = np.sqrt(np.einsum("ij,ij->j", moved, M @ moved))
            moved = moved[:, size > 0] / size[size > 0]
            # Twice, since the first projection leaves round-off.
            for _ in range(2):
                moved = moved - W @ (W.T @ (M @ moved))
            mass, ways = la.eigh(moved.T @ (M @ moved))
            apart = mass > ROUND_OFF  # dependent directions leave no more
            moved = moved @ (ways[:, apart] / np.sqrt(mass[apart]))
            forces, W = M @ moved, np.column_stack([W, moved])
        return cls(
            directions=W,
            n_mode=shapes.shape[1],
            stiffness=W.T @ (stiffness @ W),
            damping=W.T @ (C @ W),
            forced=W.T @ load @ np.array([1.0, 1j]),
        )

    @property
    def shapes(self) -> Matrix:
        """Φ (n_dof, n_mode)."""
        return self.directions[:, : self.n_mode]

    def swung(self, circular: float) -> ComplexVector:
        """Return harmonics of all directions under the load (n_mode + n_rest,)."""
        dynamic = self._dynamic(circular)
        return np.asarray(la.solve(dynamic, self.forced))

    def led(self, circular: float) -> tuple[ComplexMatrix, ComplexMatrix]:
        """Return x due to the load and to each shape (n_rest, 1 + n_mode), and its slope over Ω."""
        m = self.n_mode
        dynamic, slope = self._dynamic(circular)[m:], 1j * self.damping[m:]
        right = np.column_stack([self.forced[m:], -dynamic[:, :m]])
        factors = la.lu_factor(dynamic[:, m:])
        x = la.lu_solve(factors, right)
        right = -(slope[:, m:] - 2 * circular * np.eye(len(x))) @ x
        right[:, 1:] -= slope[:, :m]
        return x, np.asarray(la.lu_solve(factors, right))

    def _dynamic(self, circular: float) -> ComplexMatrix:
        """Return K + iΩC − Ω²M between the directions."""
        square = circular**2 * np.eye(len(self.stiffness))
        return np.asarray(self.stiffness - square + 1j * circular * self.damping)
