"""M, C and K of a model, formed when they are first asked for: a model is checked without them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

from faying._typing import SparseMatrix, read_only
from faying.model.assembly import Assembly
from faying.model.dofs import DofMap
from faying.model.matrices import assemble_matrices
from faying.model.specs import Rayleigh

_Three = tuple[SparseMatrix, SparseMatrix, SparseMatrix]


@dataclass(frozen=True, eq=False, kw_only=True)
class FreeMatrices:
    """Mass, damping and stiffness (n_dof, n_dof) at the free degrees of freedom.

    Attributes
    ----------
    form
        Returns M, C and K; called once.
    """

    form: Callable[[], _Three]

    def stiffened(self, added: SparseMatrix, damping: Rayleigh) -> "FreeMatrices":
        """Return matrices with springs (n_dof, n_dof) in K, and in C by the Rayleigh factor."""
        return FreeMatrices(form=partial(_stiffened, self, added, damping))

    @cached_property
    def _formed(self) -> _Three:
        return self.form()

    @property
    def M(self) -> SparseMatrix:
        """Mass."""
        return self._formed[0]

    @property
    def C(self) -> SparseMatrix:
        """Damping."""
        return self._formed[1]

    @property
    def K(self) -> SparseMatrix:
        """Stiffness."""
        return self._formed[2]


def free_matrices(assembly: Assembly, dofs: DofMap, damping: Rayleigh) -> FreeMatrices:
    """Return the matrices of an assembly, with Rayleigh damping added to C."""
    return FreeMatrices(form=partial(_assembled, assembly, dofs, damping))


def _stiffened(own: FreeMatrices, added: SparseMatrix, damping: Rayleigh) -> _Three:
    K = read_only((own.K + added).tocsr())
    return own.M, read_only((own.C + damping.beta * added).tocsr()), K


def _assembled(assembly: Assembly, dofs: DofMap, damping: Rayleigh) -> _Three:
    nodal = assemble_matrices(assembly)
    M, K = dofs.projected(nodal.M), dofs.projected(nodal.K)
    C = damping.alpha * M + damping.beta * K
    if nodal.C is not None:
        C = C + dofs.projected(nodal.C)
    return read_only(M), read_only(C.tocsr()), read_only(K)
