"""The structure between its pairs, by its compliance S or by its stiffness Σ = S⁻¹.

Reduced models know S. Σ of a full model is a Schur complement, and S is its inverse, which is
formed where something asks for it. Of many pairs sparse factors give products.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias, cast, final

import numpy as np

from faying._typing import Matrix, Vector, frozen
from faying.linalg.cholesky import inverse
from faying.linalg.compressed import Compliance
from faying.linalg.sparse_stiffness import SparseStiffness

REGULAR = 1e-11
"""Smallest over largest squared pivot of S from which it has an inverse worth using.

Springs of 1 N/mm beside elasticity leave 1e-7, a basis of fewer modes than pairs 1e-16.
"""


@final
@dataclass(frozen=True, eq=False)
class ByCompliance:
    """A structure whose compliance is known.

    Attributes
    ----------
    compliance : (n_relative, n_relative) [length/force]
        S, dense or compressed.
    """

    compliance: Compliance

    def __post_init__(self) -> None:
        if isinstance(self.compliance, np.ndarray):
            object.__setattr__(self, "compliance", frozen(self.compliance))

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p (n_relative,) [length] of forces between the pairs."""
        return self.compliance @ forces

    @cached_property
    def stiffness(self) -> Matrix:
        """Σ (n_relative, n_relative) [force/length].

        Raises
        ------
        LinAlgError
            If S is not positive definite beyond round-off.
        """
        return inverse(cast("Matrix", self.compliance), REGULAR)


@final
@dataclass(frozen=True, eq=False)
class ByStiffness:
    """A structure whose stiffness is known, in which weak springs cost no digits.

    Attributes
    ----------
    stiffness : (n_relative, n_relative) [force/length]
        Σ.
    moved_by
        Returns S p (n_relative,) [length] of forces between the pairs, by substitution.
    form_compliance
        Returns S.
    """

    stiffness: Matrix
    moved_by: Callable[[Vector], Vector]
    form_compliance: Callable[[], Compliance]

    @cached_property
    def compliance(self) -> Compliance:
        """S (n_relative, n_relative) [length/force]."""
        return self.form_compliance()


@final
@dataclass(frozen=True, eq=False)
class BySubstitution:
    """A structure with more pairs than matrices between them have room for.

    Attributes
    ----------
    stiffness
        Σ, by sparse factors.
    moved_by
        Returns S p (n_relative, ...) [length] of forces between the pairs, by substitution.
    form_compliance
        Returns S, compressed.
    """

    stiffness: SparseStiffness
    moved_by: Callable[[Matrix], Matrix]
    form_compliance: Callable[[], Compliance]

    @cached_property
    def compliance(self) -> Compliance:
        """S (n_relative, n_relative) [length/force]."""
        return self.form_compliance()


DenseBetweenPairs: TypeAlias = ByCompliance | ByStiffness
BetweenPairs: TypeAlias = DenseBetweenPairs | BySubstitution
