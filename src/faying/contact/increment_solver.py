"""What paths and time steps ask of a solver of increments with friction."""

from typing import Protocol

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.frictional import Increment


class IncrementSolver(Protocol):
    """Solves increments of one compliance between pairs; it remembers nothing of them."""

    @property
    def contact(self) -> Contact:
        """Gaps, tangential displacements and laws."""
        ...

    @property
    def S(self) -> Matrix:
        """Compliance between pairs (n_relative, n_relative) [length/force]."""
        ...

    def solve(
        self, z_free: Matrix, start: Matrix | None = None, similar: Increment | None = None
    ) -> Increment:
        """Solve one increment; see :meth:`.FrictionalContact.solve`."""
        ...

    def gap(self, increment: Increment) -> Vector:
        """Return the gap (n_point,) [length] after an increment."""
        ...
