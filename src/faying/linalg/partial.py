"""Entries of an inverse between a few ports: Q A⁻¹ Qᵀ."""

from faying._typing import Matrix, SparseMatrix
from faying.linalg.factorization import Factorization, MatrixFactorization
from faying.linalg.pardiso import PardisoFactorization
from faying.linalg.substitution import solved_gram


def port_compliance(ports: SparseMatrix | Matrix, factor: Factorization) -> Matrix:
    """Compute Q A⁻¹ Qᵀ (n_port, n_port) for ports Q (n_port, n), sparse or dense.

    Notes
    -----
    At most one back-substitution per port, in blocks of bounded memory; where there is a stiffness
    between them its inverse instead (:func:`port_stiffness`).
    """
    if isinstance(factor, MatrixFactorization):
        return factor.gram(ports.T)
    return solved_gram(factor.solve, ports.T)


def port_stiffness(ports: SparseMatrix, factor: MatrixFactorization) -> Matrix | None:
    """Compute (Q A⁻¹ Qᵀ)⁻¹ of many ports by PARDISO, if these have degrees of freedom of their own.

    Notes
    -----
    One more factorization (:mod:`faying.linalg.relative_unknowns`).
    """
    return factor.stiffness(ports) if isinstance(factor, PardisoFactorization) else None
