"""Where an interface is and what its contact points stand for, without the matrices of a model."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.laws import Coulomb
from faying.interface.interface import FacePairs, Interface


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactSurface:
    """Geometry and law of one interface, as models and results keep them.

    Attributes
    ----------
    points, normals : (n_point, 3)
    weights, initial_gap : (n_point,)
    slice
        First and last + 1 of its points among all contact points.
    pairs : (n_pair, 2)
        Node indices.
    pair_points : (n_pair, 3)
    averaging : (n_pair, n_point)
        Takes point values to nodal averages.
    faces
        Matched facets (node indices).
    penalty
        ``inf`` for hard contact.
    friction
        Coefficient μ.
    tangential_penalty
        c_t, ``inf`` where nothing moves that sticks; zero without friction.
    stuck : (n_pair,)
        Sticking area.
    face_coverage : (n_face,), optional
        Share of each facet that the other side covers, through all entries of ``faces``; None
        where the meshes match, and every facet is wholly covered.
    overlap : (n_triangle, 3, 3), optional
        Triangles of the common part on facets that are covered in part.
    declared_area : optional
        Area of the smaller side that was named as faces; None where both were bodies.
    """

    points: Matrix
    normals: Matrix
    weights: Vector
    initial_gap: Vector
    slice: tuple[int, int]
    pairs: Indices
    pair_points: Matrix
    averaging: Matrix
    faces: tuple[FacePairs, ...]
    penalty: float
    quadrature: str
    stuck: Mask
    face_coverage: Vector | None = None
    overlap: Matrix | None = None
    declared_area: float | None = None
    friction: float = 0.0
    tangential_penalty: float = 0.0


def contact_surface(
    interface: Interface,
    points: slice,
    nodes: Matrix,
    stuck: Mask | None,
) -> ContactSurface:
    """Return geometry and law of an interface.

    Parameters
    ----------
    points
        Its contact points among those of all interfaces.
    nodes : (n_node, 3)
        Coordinates of all nodes.
    """
    coupling = interface.coupling
    return ContactSurface(
        points=interface.points,
        normals=interface.normals,
        weights=interface.weights,
        initial_gap=interface.initial_gap,
        slice=(points.start, points.stop),
        pairs=interface.pairs,
        pair_points=interface.pair_points(nodes),
        averaging=interface.averaging.toarray(),
        faces=interface.faces,
        penalty=interface.penalty,
        quadrature=interface.quadrature,
        stuck=np.zeros(len(interface.pairs), dtype=bool) if stuck is None else stuck,
        face_coverage=None if coupling is None else coupling.face_coverage,
        overlap=None if coupling is None else coupling.segments.partial,
        declared_area=interface.declared_area,
        friction=interface.law.friction,
        tangential_penalty=interface.law.tangential_penalty
        if isinstance(interface.law, Coulomb)
        else 0.0,
    )
