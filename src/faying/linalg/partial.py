"""Entries of an inverse between a few ports: Q A⁻¹ Qᵀ."""

from faying._typing import Matrix, SparseMatrix
from faying.linalg.interface import Factorization, MatrixFactorization
from faying.linalg.pardiso import PardisoFactorization
from faying.linalg.substitution import solved_gram


def port_compliance(ports: SparseMatrix | Matrix, factor: Factorization) -> Matrix:
    """Return Q A⁻¹ Qᵀ (n_port, n_port) for ports Q (n_port, n), sparse or dense.

    Notes
    -----
    At most one back-substitution per port, in blocks of bounded memory; the inverse of the
    stiffness between the ports, where there is one (:func:`port_stiffness`).
    """
    if isinstance(factor, MatrixFactorization):
        return factor.gram(ports.T)
    return solved_gram(factor.solve, ports.T)


def port_stiffness(ports: SparseMatrix, factor: MatrixFactorization) -> Matrix | None:
    """Return (Q A⁻¹ Qᵀ)⁻¹ of many ports by PARDISO, if they have distinct degrees of freedom.

    Notes
    -----
    One more factorization (:mod:`faying.linalg.relative_unknowns`).
    """
    return factor.stiffness(ports) if isinstance(factor, PardisoFactorization) else None
