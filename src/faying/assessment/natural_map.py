"""The equations of contact as one map of its forces, whose zeros are solutions.

With x = (λ_n, λ_t) at the points, their displacements z = G S Gᵀ x + c(x) + z_free, closure of the
law included, and any r > 0 (Alart & Curnier 1991, doi:10.1016/0045-7825(91)90022-X),

    F(x) = x − admissible(x − r z) = 0,                                                       (F1)

as for example F_n = λ_n − ⟨λ_n − r_n z_n⟩; z_t is then the slip of the increment.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix, read_only
from faying.contact.contact import Contact
from faying.contact.increment import check_flexibility
from faying.contact.laws_at_points import LawsAtPoints
from faying.joint.system import Joint


@dataclass(frozen=True, eq=False, kw_only=True)
class NaturalMap:
    """The equations (F1) of a joint.

    Attributes
    ----------
    contact
    S : (n_relative, n_relative) [length/force]
        Compliance between pairs.
    """

    contact: Contact
    S: Matrix

    @classmethod
    def of(cls, joint: Joint) -> "NaturalMap":
        """Return the natural map of a joint at rest.

        Raises
        ------
        ModelError
            If its compliance holds NaN or infinity, or exceeds the memory for it.
        """
        S = joint.static_contact.between.compliance
        return cls(contact=joint.contact, S=check_flexibility(S))

    @cached_property
    def laws(self) -> LawsAtPoints:
        """Contact laws at the points."""
        return LawsAtPoints(contact=self.contact)

    @cached_property
    def G(self) -> SparseMatrix:
        """Rows (3 n_point, n_relative): all normal ones, first tangents, second tangents."""
        rows, n = self.contact.rows, 3 * self.contact.n_points
        lacking = sp.csr_array((n - rows.shape[0], rows.shape[1]))
        return read_only(sp.vstack([rows, lacking]).tocsr())

    @cached_property
    def transposed(self) -> SparseMatrix:
        """Gᵀ, which maps forces at the points to the pairs."""
        return read_only(self.G.T.tocsr())

    def moved(self, forces: Matrix) -> Matrix:
        """Return G S Gᵀ x (3, n_point, ...) for forces x (3, n_point, ...)."""
        columns = forces.reshape(3 * self.contact.n_points, -1)
        moved = self.G @ (self.S @ (self.transposed @ columns))
        return np.asarray(moved.reshape(forces.shape))

    @cached_property
    def yields(self) -> Matrix:
        """Compliance c′(0) of the laws (3, n_point) [length/force]."""
        return self.laws.closure(np.zeros((3, self.contact.n_points)))[1]

    @cached_property
    def scale(self) -> Matrix:
        """Factors r (3, n_point) [force/length]: one over the diagonal of G S Gᵀ + c′."""
        own = np.asarray(self.G.multiply(self.G @ self.S).sum(axis=1)).reshape(3, -1)
        own[1:] = own[1:].mean(axis=0)  # independent of the directions of the tangents
        total = own + self.yields
        return np.where(total > 0, 1.0 / np.where(total > 0, total, 1.0), 1.0)
