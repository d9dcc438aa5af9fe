"""Memory of the factorization of a large model, before its matrices are formed."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Mask, Matrix
from faying.joint.model import Model
from faying.joint.structure import Structure
from faying.linalg.backends import chosen_backend, estimate_memory
from faying.linalg.budget import DENSE_COPIES, SPARSE_FACTORS
from faying.linalg.memory import FactorMemory
from faying.linalg.pardiso import FEW_PORTS
from faying.linalg.pieces import pieces
from faying.model.assembly import Assembly
from faying.model.elements import block_element
from faying.model.elements.geometry import volume_factors
from faying.model.elements.solid_element import stiffness_gradients

MOST_COUNTED = 200_000
"""Most degrees of freedom for which the entries of factors are counted from formed matrices."""

_SMALLEST_SOLID_SHARE = 0.9
"""Least share of degrees of freedom in solids, for which alone there is an estimate."""

_LEAF_NODES = 64
"""Nodes of a part that is not divided further, with a full factor."""

_OVER_PLANES = 1.8
"""Entries stored by PARDISO over those of the planes: 1.5 to 2.1 measured on cubes, plates and bars
of 47 000 to 1.6 million degrees of freedom, of hex8 and tet10; also of the peak with the compliance
over the entries of the bordered matrix. Its peak is 1.04 to 1.12 of its final memory."""

_SEPARATORS = 2.0
"""Unknowns coupled to a pair in the factor of the bordered matrix, over n^⅔ for n unknowns: 1.5 to
2.0 measured on the roof, the flange and lap joints of 33 000 to 49 000 degrees of freedom."""


def expected_memory(model: Model) -> FactorMemory:
    """Return the memory that the factorization of a model takes.

    It is counted from the pattern of K; for large models it is estimated from the positions of
    nodes, which are divided at planes repeatedly, as orderings by nested dissection do.

    Notes
    -----
    An estimate takes a second for 500 000 nodes; forming K and counting takes a minute.
    """
    n_dof, mesh = model.structure.n_dof, model.assembly.mesh
    used = np.zeros(len(mesh.nodes), dtype=bool)
    for block in mesh.blocks:
        used[block.nodes] = True
    places = mesh.nodes[used]
    if n_dof <= MOST_COUNTED or 3 * len(places) < _SMALLEST_SOLID_SHARE * n_dof:
        return model.structure.factor_memory
    backend = chosen_backend(None)
    if backend != "pardiso":
        return estimate_memory(sp.csr_array((n_dof, n_dof)), backend=backend)
    spacing = (_volume(model.assembly) / len(places)) ** (1 / 3)
    factor = int(_OVER_PLANES * 9 * 8 * dissected(places, spacing))
    factors = FactorMemory(backend=backend, order=n_dof, factor=factor, peak=factor, counted=False)
    if not model.structure.is_kept_whole:
        return factors.beside(SPARSE_FACTORS)
    return factors.with_ports(*_between_pairs(model.structure, factor))


def _between_pairs(structure: Structure, factor: int) -> tuple[float, float]:
    """Return bytes of the elimination of all but the pairs, and of matrices between them."""
    n_relative = int(structure.relative_operator.shape[0])
    dense = 8.0 * DENSE_COPIES * n_relative**2
    if n_relative <= FEW_PORTS:
        return 0.0, dense
    border = n_relative * (n_relative / 2 + _SEPARATORS * structure.n_dof ** (2 / 3))
    return float(_OVER_PLANES * (factor + 8 * border)), dense


def dissected(places: Matrix, spacing: float) -> float:
    """Return the number of pairs of nodes in the factor of a structure divided at planes.

    Nodes within one spacing of a plane, the distance of neighbours [length], separate its two
    sides. They are eliminated after both, together with the nodes of earlier planes that the part
    touches. Places are (n, 3) [length].
    """
    parts: list[tuple[Matrix, Mask]] = [(places, np.zeros(len(places), dtype=bool))]
    pairs = 0.0
    while parts:
        points, touched = parts.pop()
        front = np.count_nonzero(touched)
        along = points[:, int(np.ptp(points, axis=0).argmax())]
        behind = along - np.partition(along, len(along) // 2)[len(along) // 2]
        separating = (behind >= 0) & (behind < spacing)
        n_separating = np.count_nonzero(separating)
        if len(points) <= _LEAF_NODES or n_separating in (0, len(points)):
            pairs += len(points) ** 2 / 2 + len(points) * front
            continue
        pairs += n_separating**2 / 2 + n_separating * front
        separator = touched | (np.abs(behind - spacing / 2) < 1.5 * spacing)
        sides = (behind < 0, behind >= spacing)
        parts.extend((points[side], separator[side]) for side in sides if side.any())
    return pairs


def _volume(assembly: Assembly) -> float:
    """Return the volume of the solids."""
    total = 0.0
    for block in assembly.mesh.blocks:
        element = block_element(block, assembly.element)
        gradients, weights = stiffness_gradients(element), element.stiffness_quadrature().weights
        for part in pieces(len(block.ids), 9 * element.n_nodes):
            factors = volume_factors(gradients, assembly.mesh.nodes[block.nodes[part]])
            total += float((weights @ factors).sum())
    return total
