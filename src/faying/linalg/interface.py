"""What every factorization offers, whichever library made it."""

from typing import Protocol, runtime_checkable

from faying._typing import Matrix, SparseMatrix


class Factorization(Protocol):
    """A matrix, or what stands for one, that solves for many right-hand sides, from any thread."""

    @property
    def backend(self) -> str:
        """Name of the library that made the factors."""
        ...

    def solve(self, right_hand_side: Matrix) -> Matrix:
        """Return A⁻¹ B for B of shape (n,) or (n, k)."""
        ...


@runtime_checkable
class MatrixFactorization(Factorization, Protocol):
    """The factors of one matrix, by one library."""

    @property
    def memory(self) -> int:
        """Bytes the factors take."""
        ...

    def gram(self, columns: SparseMatrix | Matrix) -> Matrix:
        """Return Bᵀ A⁻¹ B (k, k) for B (n, k), by whatever is cheapest with these factors."""
        ...
