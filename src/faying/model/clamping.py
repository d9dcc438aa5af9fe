"""Whether a bolt clamps something: what its head and its nut hold, and what lies between."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.exceptions import ModelError
from faying.model.assembly import Assembly, Beam, Spring
from faying.model.links import joined_nodes
from faying.model.mesh import Mesh
from faying.model.specs import BoltSpec

# A body in the plane of a seat touches it, but is not between the seats.
_SMALLEST_DEPTH = 1e-2


def check_clamping(mesh: Mesh, spec: BoltSpec, seats: tuple[Indices, Indices]) -> None:
    """Refuse a bolt through one body only; a fork with another part between its arms is fine.

    Its seats are nodes of solids that the head and the nut hold.
    """
    labels = mesh.bodies
    head, nut = (np.unique(labels[seat]) for seat in seats)
    if not len(head) or not len(nut) or not np.array_equal(head, nut):
        return
    if np.setdiff1d(labels[_between(mesh, spec, seats)], [-1, *head]).size:
        return
    nodes = ", ".join(map(str, mesh.node_ids[np.unique(np.concatenate(seats))][:4].tolist()))
    message = (
        f"bolt '{spec.name}' clamps nothing: head and nut hold the same body (at nodes {nodes}, …) "
        "with no other between them; give parts nodes of their own where they touch (separate of "
        "[model], for a mesh file)"
    )
    raise ModelError(message)


def element_seats(assembly: Assembly, cut: Beam | Spring) -> tuple[Indices, Indices]:
    """Find the nodes of solids that the two ends of a deck's bolt hold, apart from each other.

    Ends are followed through beams, springs, couplings and equations up to the first solids, but
    not through the cut element and what joins the same two nodes (its shear and bending springs).
    Where such springs have nodes of their own (CalculiX's rotation nodes), a way around the cut
    remains and the links do not tell head from nut; nothing is returned then.
    """
    first, second = cut.nodes if isinstance(cut, Beam) else (node for node, _ in cut.ends)
    links = _links(assembly, (first, second))
    solid = assembly.mesh.bodies >= 0
    of_node, through = links.tocsc(), links[:, np.flatnonzero(~solid)]
    _, group = connected_components(through @ through.T, directed=False)

    def groups(node: int) -> Indices:
        at_node = of_node.indices[of_node.indptr[node] : of_node.indptr[node + 1]]
        return np.unique(group[at_node])

    def reached(node: int) -> Indices:
        if solid[node]:
            return np.array([node])
        nodes = np.unique(links[np.flatnonzero(np.isin(group, groups(node)))].indices)
        neighbours: Indices = nodes[solid[nodes]]
        return neighbours

    if not solid[[first, second]].any() and np.isin(groups(first), groups(second)).any():
        nothing = np.empty(0, dtype=np.int64)
        return nothing, nothing
    return reached(first), reached(second)


def _links(assembly: Assembly, cut: tuple[int, int]) -> SparseMatrix:
    """Return the nodes (n_link, n_node) that each beam, spring, coupling and equation joins."""
    parts = [nodes for _, nodes in joined_nodes(assembly)]
    parts += [shell for block in assembly.shells for shell in block.nodes]
    parts = [part for part in parts if np.setdiff1d(part, cut).size]
    columns = np.concatenate([np.empty(0, dtype=np.int64), *parts])
    rows = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    shape = (len(parts), len(assembly.mesh.nodes))
    return sp.csr_array((np.ones(len(columns)), (rows, columns)), shape=shape)


def _between(mesh: Mesh, spec: BoltSpec, seats: tuple[Indices, Indices]) -> Indices:
    """Nodes inside the cylinder from seat to seat."""
    ends = np.array([mesh.nodes[seat].mean(axis=0) for seat in seats])
    length = float(np.linalg.norm(ends[1] - ends[0]))
    if length == 0:
        return np.empty(0, dtype=np.int64)
    axis = (ends[1] - ends[0]) / length
    along, radial = _cylindrical(mesh.nodes, ends[0], axis)
    radius = max(spec.washer_radius or 0.0, float(radial[np.concatenate(seats)].max()))
    # A beam may end at a single node of a solid; its thickness is then unknown.
    radius = radius if radius > _SMALLEST_DEPTH * length else length / 2
    inside = (along > _SMALLEST_DEPTH * length) & (along < (1 - _SMALLEST_DEPTH) * length)
    return np.flatnonzero(inside & (radial <= radius))


def _cylindrical(points: Matrix, origin: Vector, axis: Vector) -> tuple[Vector, Vector]:
    """Return the distances of points (n, 3) along an axis and from it."""
    relative = points - origin
    along = relative @ axis
    return along, np.linalg.norm(relative - np.outer(along, axis), axis=1)
