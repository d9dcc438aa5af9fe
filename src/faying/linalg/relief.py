"""Free structures under forces balanced by inertia ("inertia relief").

A free structure has rigid motions R, K R = 0, RᵀM R = I. Forces f accelerate it by R Rᵀf, and the
remaining forces, Tᵀf with T = I − R RᵀM, are in equilibrium. Displacements under them, without
rigid motion, are

    K⁺ f = T K̂⁻¹ Tᵀ f,   K̂ = K + E s Eᵀ,                                                     (M11)

with springs s at as many degrees of freedom as there are rigid motions, chosen so that they just
hold the structure. Forces in equilibrium do not load them, so the result is independent of s. For
dense matrices E s Eᵀ is M R c RᵀM, which shifts the rigid motions alone, for the same reason.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix
from faying.linalg.factorization import factorize
from faying.linalg.interface import MatrixFactorization
from faying.linalg.substitution import dense

PREFERRED = 1e3
"""Weight of preferred degrees of freedom, which get the springs if they hold the structure."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Relieved:
    """The operator K⁺ of (M11) in place of an inverse.

    Attributes
    ----------
    factor
        Factors of K̂.
    motions, carried : (n, n_motion)
        R and M R.
    """

    factor: MatrixFactorization
    motions: Matrix
    carried: Matrix

    @property
    def backend(self) -> str:
        """Name of the library that made the factors."""
        return self.factor.backend

    @property
    def memory(self) -> int:
        """Bytes of the factors."""
        return self.factor.memory

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return K⁺ B for B of shape (n,) or (n, k)."""
        loads = balanced(right_hand_side, self.motions, self.carried)
        return balanced(self.factor.solve(loads), self.carried, self.motions)

    def gram(self, columns: SparseMatrix | Matrix) -> Matrix:
        """Return Bᵀ K⁺ B for B (n, k)."""
        return self.factor.gram(balanced(dense(columns), self.motions, self.carried))


def balanced(forces: Matrix, motions: Matrix, carried: Matrix) -> Matrix:
    """Return Tᵀ f = f − M R Rᵀ f; with motions and carried exchanged, T u = u − R RᵀM u."""
    return np.asarray(forces - carried @ (motions.T @ forces))


def factorize_relieved(
    A: SparseMatrix | Matrix, M: SparseMatrix | Matrix, motions: Matrix
) -> MatrixFactorization:
    """Factorize a stiffness with rigid motions (n, n_motion), RᵀM R = I, as K⁺.

    Raises
    ------
    SingularMatrixError
        If any other motion is free.
    """
    if not motions.shape[1]:
        return factorize(A)
    carried = np.asarray(M @ motions)
    if isinstance(A, np.ndarray):
        supported_matrix: SparseMatrix | Matrix = shifted(A, carried)
    else:
        supported_matrix = supported(A, supports(motions))
    return Relieved(factor=factorize(supported_matrix), motions=motions, carried=carried)


def shifted(A: Matrix, carried: Matrix) -> Matrix:
    """Return K + M R c RᵀM, dense, with c such that both terms have the same trace."""
    if not carried.shape[1]:
        return A
    return np.asarray(A + np.trace(A) / np.sum(carried**2) * (carried @ carried.T))


def supported(A: SparseMatrix, supports_at: Indices) -> SparseMatrix:
    """Return K̂ = K + E s Eᵀ with s from the diagonal of K."""
    stiffness = np.zeros(A.shape[0])
    stiffness[supports_at] = A.diagonal()[supports_at]
    supported_matrix: SparseMatrix = (A + sp.diags_array(stiffness)).tocsr()
    return supported_matrix


def supports(motions: Matrix, preferred: Indices | tuple[()] = ()) -> Indices:
    """Return degrees of freedom (n_motion,) that just hold the rigid motions.

    They are among the preferred ones if these suffice.
    """
    weight = np.ones(len(motions))
    weight[np.asarray(preferred, dtype=np.int64)] = PREFERRED
    order = la.qr((motions * weight[:, None]).T, mode="r", pivoting=True)[1]
    return np.asarray(np.sort(order[: motions.shape[1]]))
