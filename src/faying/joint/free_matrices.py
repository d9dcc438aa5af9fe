"""M, C and K of a model, formed at their first use, so that a model is checked without them."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial

from faying._typing import SparseMatrix, read_only
from faying.model.assembly import Assembly
from faying.model.dofs import DofMap
from faying.model.matrices import assemble_matrices
from faying.model.specs import Rayleigh

_Formed = tuple[SparseMatrix, SparseMatrix, SparseMatrix | None]


@dataclass(frozen=True, eq=False, kw_only=True)
class FreeMatrices:
    """Mass, damping and stiffness (n_dof, n_dof) at the free degrees of freedom.

    Attributes
    ----------
    form
        Function that returns M, K and the dampers D, None without any; called once.
    damping
        Factors α and β of C = α M + β K + D.
    """

    form: Callable[[], _Formed]
    damping: Rayleigh = field(default_factory=Rayleigh)

    def stiffened(self, added: SparseMatrix) -> "FreeMatrices":
        """Return matrices with springs (n_dof, n_dof) in K, and in C by the Rayleigh factor."""
        return FreeMatrices(form=partial(_stiffened, self, added), damping=self.damping)

    @cached_property
    def _formed(self) -> _Formed:
        return self.form()

    @property
    def M(self) -> SparseMatrix:
        """Mass."""
        return self._formed[0]

    @property
    def K(self) -> SparseMatrix:
        """Stiffness."""
        return self._formed[1]

    @property
    def dampers(self) -> SparseMatrix | None:
        """Damping that is not proportional to M and K; None without any."""
        return self._formed[2]

    @cached_property
    def C(self) -> SparseMatrix:
        """Damping."""
        C = self.damping.alpha * self.M + self.damping.beta * self.K
        return read_only((C if self.dampers is None else C + self.dampers).tocsr())


def free_matrices(assembly: Assembly, dofs: DofMap, damping: Rayleigh) -> FreeMatrices:
    """Return the matrices of an assembly, with Rayleigh damping added to C."""
    return FreeMatrices(form=partial(_assembled, assembly, dofs), damping=damping)


def _stiffened(matrices: FreeMatrices, added: SparseMatrix) -> _Formed:
    return matrices.M, read_only((matrices.K + added).tocsr()), matrices.dampers


def _assembled(assembly: Assembly, dofs: DofMap) -> _Formed:
    nodal = assemble_matrices(assembly)
    dampers = None if nodal.C is None else read_only(dofs.projected(nodal.C))
    return read_only(dofs.projected(nodal.M)), read_only(dofs.projected(nodal.K)), dampers
