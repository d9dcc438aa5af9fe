"""Fixed-interface normal modes Φ_n of Craig and Bampton, Eq. (15.18)."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from faying._typing import Matrix, SparseMatrix, Vector
from faying.exceptions import refuse_model
from faying.joint.structure import Structure
from faying.linalg.interface import Factorization
from faying.linalg.substitution import dense

NO_MASS = "the model has no mass: its materials have no density and it has no point masses"
"""Message where motions or modes of such a model are computed."""


@dataclass(frozen=True, eq=False, kw_only=True)
class NormalModes:
    """Vibration modes.

    Attributes
    ----------
    vectors : (n_dof, n_mode)
        Mass-normalized.
    frequencies : (n_mode,) [1/time]
        Cyclic, ascending.
    next_frequency : [1/time]
        Frequency of the first mode left out; infinite where there is none.
    """

    vectors: Matrix
    frequencies: Vector
    next_frequency: float


def fixed_interface_normal_modes(structure: Structure, count: int) -> NormalModes:
    """Compute the lowest vibration modes with the boundary held and contact absent.

    Notes
    -----
    Shift-invert Lanczos with the interior factorization of the structure. One more mode is
    computed, so that :func:`~faying.reduction.mode_count.check_modes` can count below it.
    """
    inner = structure.interior
    if count > len(inner):
        refuse_model(
            f"{count} normal modes asked for, but the structure has {len(inner)} degrees of "
            "freedom off its boundary; ask for fewer"
        )
    if count and not structure.has_mass:
        refuse_model(
            f"{count} normal modes asked for, but the structure has no mass; ask for none, which "
            "statics do not need, or give its materials a density"
        )
    vectors = np.zeros((structure.n_dof, count))
    if count == 0:
        return NormalModes(vectors=vectors, frequencies=np.empty(0), next_frequency=np.inf)
    K, M = structure.interior_stiffness, structure.M[inner][:, inner]
    squares, modes = lowest_modes(K, M, structure.interior_factor, min(count + 1, len(inner)))
    vectors[inner] = modes[:, :count]
    frequencies = np.append(np.sqrt(squares) / (2 * np.pi), np.inf)
    return NormalModes(
        vectors=vectors, frequencies=frequencies[:count], next_frequency=float(frequencies[count])
    )


def lowest_modes(
    K: SparseMatrix | Matrix, M: SparseMatrix | Matrix, factor: Factorization, count: int
) -> tuple[Vector, Matrix]:
    """Solve K φ = ω² M φ for the lowest ω² (count,), with a factorization of K.

    Vectors (n, count) are mass-normalized.
    """
    if not M.diagonal().any():
        refuse_model(f"{NO_MASS}, so it has no vibration modes; give its materials a density")
    n = K.shape[0]
    if n <= 3 * count + 20 or not sp.issparse(K):  # Lanczos needs room, and sparse matrices
        # M may be singular (massless couplings), and K too (free parts): with M = L Lᵀ
        # solve Lᵀ K⁺ L y = ω⁻² y, then φ = ω² K⁺ L y.
        mass, ways = la.eigh(dense(M))
        root = ways * np.sqrt(np.maximum(mass, 0.0))
        moved = factor.solve(root)
        inverse, vectors = la.eigh(root.T @ moved)
        # Massless and rigid motions have eigenvalues of the size of round-off.
        threshold = np.finfo(float).eps * inverse.max()
        squares = 1.0 / np.maximum(inverse[::-1][:count], threshold)
        return squares, moved @ vectors[:, ::-1][:, :count] * squares
    start = np.random.default_rng(0).standard_normal(n)  # fixed, so that runs repeat
    operator = spla.LinearOperator((n, n), matvec=factor.solve, dtype=float)
    squares, vectors = spla.eigsh(K, count, M, sigma=0.0, OPinv=operator, v0=start)
    order = np.argsort(squares)
    return squares[order], vectors[:, order]
