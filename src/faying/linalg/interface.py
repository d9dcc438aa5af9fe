"""The interface of factorizations by any library."""

from typing import Protocol, runtime_checkable

from faying._typing import Matrix, SparseMatrix


class Factorization(Protocol):
    """A factorized matrix, or an equivalent operator; any thread may solve with it."""

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return A⁻¹ B for B of shape (n,) or (n, k)."""


@runtime_checkable
class MatrixFactorization(Factorization, Protocol):
    """The factors of one matrix, by one library."""

    @property
    def backend(self) -> str:
        """Name of the library that made the factors."""

    @property
    def memory(self) -> int:
        """Bytes the factors take."""

    def gram(self, columns: SparseMatrix | Matrix) -> Matrix:
        """Return Bᵀ A⁻¹ B (k, k) for B (n, k), the cheapest way with these factors."""
