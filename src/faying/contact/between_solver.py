"""Base class of the contact solvers of one structure."""

from dataclasses import dataclass
from functools import cached_property

from faying._typing import Matrix, Vector
from faying.contact.between_pairs import BetweenPairs
from faying.contact.contact import Contact
from faying.contact.laws_at_points import LawsAtPoints


@dataclass(frozen=True, eq=False, kw_only=True)
class BetweenSolver:
    """Contact between the pairs of a structure.

    Attributes
    ----------
    contact
        Gaps, tangential displacements and laws.
    between
        Structure between pairs.
    """

    contact: Contact
    between: BetweenPairs

    @property
    def S(self) -> Matrix:
        """Compliance between pairs (n_relative, n_relative) [length/force]."""
        return self.between.compliance

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p (n_relative,) [length] of forces between the pairs."""
        return self.between.moved_by(forces)

    @cached_property
    def laws(self) -> LawsAtPoints:
        """Contact laws at the points."""
        return LawsAtPoints(contact=self.contact)
