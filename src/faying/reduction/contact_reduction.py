"""A system whose contact problem is itself reduced; everything else is the system's own."""

from collections.abc import Mapping
from dataclasses import dataclass

from faying._typing import Matrix, SparseMatrix
from faying.contact.condensed import ContactSolver
from faying.contact.contact import Contact
from faying.joint.load_pattern import LoadPattern
from faying.joint.system import PortCompliance, System
from faying.linalg.factorization import Factorization
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactReducedModel:
    """A full or reduced model with contact forces from a reduced set; static solutions only.

    Attributes
    ----------
    system
        Gives the compliance: the full model, or a reduced one with residual compliance.
    static_contact
        The reduced contact problem; its forces are those of all contact points.
    """

    system: System
    static_contact: ContactSolver

    @property
    def M(self) -> SparseMatrix | Matrix:
        """Mass matrix."""
        return self.system.M

    @property
    def C(self) -> SparseMatrix | Matrix:
        """Damping matrix."""
        return self.system.C

    @property
    def K(self) -> SparseMatrix | Matrix:
        """Stiffness matrix."""
        return self.system.K

    @property
    def contact(self) -> Contact:
        """All contact points."""
        return self.system.contact

    @property
    def boundaries(self) -> Mapping[str, Boundary]:
        """Where loads enter."""
        return self.system.boundaries

    @property
    def bolts(self) -> Mapping[str, Bolt]:
        """Bolts with their locked initial forces."""
        return self.system.bolts

    @property
    def load_patterns(self) -> Mapping[str, LoadPattern]:
        """Distributed loads that may be scaled."""
        return self.system.load_patterns

    @property
    def port_compliance(self) -> PortCompliance:
        """Static compliance between the ports."""
        return self.system.port_compliance

    def factorize_static(self) -> Factorization:
        """Return a factorization of K."""
        return self.system.factorize_static()

    def expand(self, states: Matrix) -> Matrix:
        """Return displacements of the full model."""
        return self.system.expand(states)
