"""Fields of the node pairs that come nearest to values at the contact points."""

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
from faying.interface.interface import Interface
from faying.linalg.factorization import factorize
from faying.linalg.interface import Factorization

DIAGONAL_SHIFT = 1e-11
"""Added to the normal equations, over their largest entry: it decides what the points leave open,
and is far below the accuracy anyone reads."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PairFit:
    """Least squares by values at the pairs, weighted with the areas of the points.

    Where points do not determine a pair (corners of six-node triangles under nodal quadrature, one
    point on a facet of four pairs) the smallest values are taken.

    Attributes
    ----------
    shape : (n_point, n_pair)
    weighted : (n_pair, n_point)
        Nᵀ W.
    normal
        Factors of Nᵀ W N.
    """

    shape: SparseMatrix
    weighted: SparseMatrix
    normal: Factorization

    @classmethod
    def of(cls, interface: Interface) -> "PairFit":
        """Factorize the normal equations of an interface; sparse, once for any number of fields."""
        shape = sp.csr_array(interface.point_shape)
        weighted = sp.csr_array(shape.T @ sp.diags_array(interface.weights))
        normal = weighted @ shape
        shift = DIAGONAL_SHIFT * float(normal.diagonal().max())
        shifted = sp.csr_array(normal + shift * sp.eye_array(normal.shape[0]))
        return cls(shape=shape, weighted=weighted, normal=factorize(shifted))

    def at_pairs(self, values: Matrix) -> Matrix:
        """Return the values (..., n_pair) that fit values (..., n_point) best."""
        fitted: Matrix = self.normal.solve(self.weighted @ np.asarray(values).T).T
        return fitted

    def felt(self, pressure: Matrix) -> Matrix:
        """Return the part of a pressure (..., n_point) that does work on displacements.

        What is left of it, where there are more points than pairs, gives the same nodal forces
        whatever its size: hard contact does not determine it.
        """
        felt: Matrix = self.at_pairs(pressure) @ self.shape.T
        return felt
