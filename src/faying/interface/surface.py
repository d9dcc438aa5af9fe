"""Geometry and law of an interface and its contact points, without the matrices of a model."""

import json
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any, cast

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.laws import CLOSURES, Curve, Law, law_with_friction, normal_law
from faying.exceptions import ModelError
from faying.interface.averaging import facet_columns
from faying.interface.interface import FacePairs, Interface


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactSurface:
    """Geometry and law of one interface, as models and results keep them.

    Attributes
    ----------
    points : (n_point, 3) [length]
        Contact points.
    normals : (n_point, 3) [1]
        Unit normals out of the minus side.
    weights : (n_point,) [length²]
        Area of each contact point.
    initial_gap : (n_point,) [length]
        Gap before any load.
    slice : (2,) [1]
        First and last + 1 of its points among all contact points.
    pairs : (n_pair, 2) [into n_node]
        Touching nodes (minus, plus), as indices.
    pair_points : (n_pair, 3) [length]
        Positions of the pairs.
    averaging : (n_pair, n_point) [1]
        Map from point values to nodal averages.
    faces
        Matched facets, one group per kind.
    penalty : [force/length³]
        Contact stiffness c_n; inf is hard contact, None a curve.
    quadrature
        Rule that places the contact points.
    stuck : (n_pair,) [1]
        Pairs that stick in tangential direction.
    face_coverage : (n_face,) [1]
        Share of each facet that the other side covers, through all entries of ``faces``; None
        where the meshes match and every facet is wholly covered.
    overlap : (n_triangle, 3, 3) [length]
        Triangles of the common part of partly covered facets; absent where meshes match.
    declared_area : [length²]
        Area of the smaller side that was given as faces; None where both were bodies.
    friction : [1]
        Coefficient of friction μ.
    tangential_penalty : [force/length³]
        Tangential stiffness c_t of sticking points, ``inf`` if rigid; zero without friction.
    closure
        Curve of pressure over closure in place of a penalty, its name and parameters as JSON;
        empty without a curve.
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
    penalty: float | None
    quadrature: str
    stuck: Mask
    face_coverage: Vector | None = None
    overlap: Matrix | None = None
    declared_area: float | None = None
    friction: float = 0.0
    tangential_penalty: float = 0.0
    closure: str = ""

    @cached_property
    def _averages(self) -> SparseMatrix:
        """The averaging as a sparse matrix; the full one is for files."""
        return sp.csr_array(self.averaging)

    def nodal_average(self, values: Matrix) -> Matrix:
        """Return averages at the pairs (n_pair, ...) of values at points (n_point, ...)."""
        return np.asarray(self._averages @ values)


def contact_surface(
    interface: Interface,
    points: slice,
    nodes: Matrix,
    stuck: Mask | None,
) -> ContactSurface:
    """Return geometry and law of an interface, whose contact points are ``points`` among all.

    ``nodes`` are the coordinates of all nodes (n_node, 3).
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
        penalty=None if np.isnan(interface.penalty) else interface.penalty,
        quadrature=interface.quadrature,
        stuck=np.zeros(len(interface.pairs), dtype=bool) if stuck is None else stuck,
        face_coverage=None if coupling is None else coupling.face_coverage,
        overlap=None if coupling is None else coupling.segments.partial,
        declared_area=interface.declared_area,
        friction=interface.law.friction,
        tangential_penalty=interface.law.tangential_penalty,
        closure=curve_text(interface.law.normal),
    )


def curve_text(law: Law) -> str:
    """Return name and parameters of a curve as JSON; empty for other laws."""
    return json.dumps({law.name: asdict(cast("Any", law))}) if isinstance(law, Curve) else ""


def curve_of(text: str) -> Law:
    """Return the curve of :func:`curve_text`."""
    ((name, parameters),) = json.loads(text).items()
    return CLOSURES[name](**parameters)


def recorded_law(record: ContactSurface) -> Law:
    """Return the law of a stored interface."""
    try:
        normal = curve_of(record.closure) if record.closure else normal_law(record.penalty or 0.0)
    except (ModelError, TypeError, AttributeError, KeyError) as error:
        message = f"the contact law cannot be read ({error})"
        raise ValueError(message) from None
    return law_with_friction(normal, record.friction, record.tangential_penalty)


def pair_facets(record: ContactSurface) -> tuple[tuple[str, Indices], ...]:
    """Return kinds of facets of the minus side and their node pairs (n_face, n_node_per_face).

    These are indices into ``record.pairs``, one entry per facet kind, nodes in the order of the
    facets.
    """
    if not len(record.pairs):
        return ()
    return tuple(
        (faces.kind, facet_columns(record.pairs, faces.minus, faces.plus)) for faces in record.faces
    )


def nodal_average(record: ContactSurface, values: Matrix) -> Matrix:
    """Return averages at the pairs (..., n_pair) of values at all contact points (..., n_point)."""
    at_points: Matrix = np.asarray(values)[..., slice(*record.slice)]
    return np.moveaxis(record.nodal_average(np.moveaxis(at_points, -1, 0)), 0, -1)
