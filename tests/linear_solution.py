"""Displacements and frequencies of an assembly by itself: linear, without contact."""

import numpy as np
import scipy.sparse.linalg as spl

from faying._typing import Matrix, Vector
from faying.linalg.factorization import factorize
from faying.model.assembly import Assembly, NodalLoads
from faying.model.constraints import constrain
from faying.model.matrices import assemble_matrices, used_components
from faying.reduction.normal_modes import lowest_modes


def displacements_of(assembly: Assembly, load: NodalLoads | None) -> Matrix:
    """Displacements (n_node, 6) under a load; under none what is left is zero."""
    T = constrain(assembly, used_components(assembly)).transformation
    forces = np.zeros((len(assembly.mesh.nodes), 6))
    if load is not None:
        np.add.at(forces, load.nodes, load.forces)
    K = (T.T @ assemble_matrices(assembly).K @ T).tocsc()
    return np.asarray(T @ spl.spsolve(K, T.T @ forces.ravel())).reshape(-1, 6)


def circular_frequencies(assembly: Assembly, count: int) -> Vector:
    """Lowest circular frequencies (count,)."""
    ours = assemble_matrices(assembly)
    T = constrain(assembly, used_components(assembly)).transformation
    K, M = ((T.T @ matrix @ T).tocsr() for matrix in (ours.K, ours.M))
    squares, _ = lowest_modes(K, M, factorize(K), count)
    return np.sqrt(squares)
