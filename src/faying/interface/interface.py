"""The contact interface: a linear gap operator, quadrature weights, and a local law.

Signs and units: ``docs/conventions.md``. In short, the normal points out of the *minus* side,
gap g = g₀ + n·(u⁺ − u⁻) ≥ 0 is open, and pressure p ≥ 0 is compression.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from faying._typing import Frozen, Indices, Matrix, SparseMatrix, Vector, frozen, read_only
from faying.contact.contact import Contact
from faying.contact.laws import Curve, Law, normal_law
from faying.digits import ROUND_OFF
from faying.display.facts import Shown, with_unit
from faying.exceptions import naming, refuse_model
from faying.interface.averaging import averaging_operator, facet_columns
from faying.interface.coupling import Coupling
from faying.interface.relative_displacement import axes_of, tangents_of, times_normals


@dataclass(frozen=True, eq=False, kw_only=True)
class FacePairs(Frozen):
    """Matched facets of one kind on the two sides of an interface.

    Between non-matching meshes these are the corners of the minus facets that the plus side
    covers, wholly or in part, and the plus node nearest to each.

    Attributes
    ----------
    kind
        One of tri3, tri6, quad4 or quad8.
    minus : (n_face, n_node_per_face) [into n_node]
        Node indices; columns run counter-clockwise seen from outside the minus body.
    plus : (n_face, n_node_per_face) [into n_node]
        Node indices; column j touches column j of ``minus``.
    """

    kind: str
    minus: Indices
    plus: Indices


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Interface(Frozen, Shown):
    """Two surfaces in contact, Eq. (15.11), with a law.

    Zero-thickness elements where the meshes match, a mortar coupling where they do not; both have
    the same members.

    Attributes
    ----------
    faces
        The matched facets, one entry per kind.
    pairs : (n_pair, 2)
        Node indices (minus, plus) of the touching nodes; for a mortar coupling the minus nodes
        that carry it, each with the nearest plus node as a mere label.
    pair_normals : (n_pair, 3)
        Unit normals out of the minus side at the pairs (area-weighted mean of the facets).
    motion_operator : (3 n_pair, n_dof) sparse
        All components of the relative displacement u⁺ − u⁻, pair by pair (projected for a mortar
        coupling).
    flat
        Whether all normals are equal.
    point_shape : (n_point, n_pair) sparse
        Shape functions of the pairs at the contact points.
    initial_gap : (n_point,) [length]
    weights : (n_point,) [length²]
        Area of each contact point.
    points, normals : (n_point, 3)
    face_of_point : (n_point,)
        Number of the facet of a point, counted through all entries of ``faces``. Under nodal
        quadrature the points of facets at a node pair are one point, with the sum of their
        weights: its facet is then the first of them, an approximate position.
    law
        Contact law of the points.
    quadrature
        Name of the rule, e.g. ``"gauss-2"`` or ``"nodal"``.
    coupling
        Projection of the motion of the plus side to the pairs; None where the meshes match.
    declared_area : [length²]
        Area of the smaller side that was given as faces; None where both are bodies.
    """

    name: str
    faces: tuple[FacePairs, ...]
    pairs: Indices
    pair_normals: Matrix
    motion_operator: SparseMatrix
    flat: bool
    point_shape: SparseMatrix
    initial_gap: Vector
    weights: Vector
    points: Matrix
    normals: Matrix
    face_of_point: Indices
    law: Law
    quadrature: str
    coupling: Coupling | None = None
    declared_area: float | None = None

    def __post_init__(self) -> None:
        """Refuse hard contact with friction at linearly dependent points."""
        super().__post_init__()
        rigid = self.law.friction > 0 and np.isinf(self.penalty)
        if rigid and self.quadrature != "nodal" and self.n_points > len(self.pairs):
            refuse_model(
                f"interface '{self.name}': contact is hard, with friction, at {self.n_points} "
                f"points by {self.quadrature} between {len(self.pairs)} node pairs; so many rigid "
                "points contradict each other: take quadrature = 'nodal', or a penalty"
            )

    @property
    def facts(self) -> Mapping[str, str]:
        """Name, size and law."""
        return {
            "name": self.name,
            "node pairs": str(len(self.pairs)),
            "contact points": f"{self.n_points} by {self.quadrature}",
            "area [length²]": with_unit(self.area, ""),
            **self._stiffness,
            "friction": with_unit(self.law.friction, ""),
            "meshes": "matching" if self.coupling is None else "not matching",
        }

    @property
    def _stiffness(self) -> Mapping[str, str]:
        normal = self.law.normal
        if isinstance(normal, Curve):
            return {"closure": normal.name}
        return {"penalty [force/length³]": with_unit(self.penalty, "")}

    @property
    def penalty(self) -> float:
        """Contact stiffness c_n [force/length³] of Eq. (15.12); ``inf`` where contact is hard.

        NaN where the law is a curve.
        """
        return self.law.penalty

    @cached_property
    def pair_axes(self) -> SparseMatrix:
        """T (n_relative, 3 n_pair): unit directions of motion of each pair that affect its points.

        One where all points of a pair have one normal, two on an edge between planes, three where
        the surface is curved or tangential forces act. None where there is no point, or along
        directions in which supports hold both sides, as across a plane of symmetry.
        """
        axes = axes_of(self.point_shape, self.normals, self.law.components)
        moved = abs(axes @ self.motion_operator).max(axis=1).toarray().ravel()
        return axes[moved > ROUND_OFF * moved.max(initial=0.0)]

    @cached_property
    def relative_operator(self) -> SparseMatrix:
        """P (n_relative, n_dof): relative displacements that gaps and slips depend on."""
        return (self.pair_axes @ self.motion_operator).tocsr()

    @cached_property
    def interpolation(self) -> SparseMatrix:
        """N (n_point, n_relative): gaps at the contact points."""
        return self._point_motion(self.normals)

    @cached_property
    def tangents(self) -> Matrix:
        """Two unit tangents at every contact point (2, n_point, 3), orthogonal to its normal."""
        first = tangents_of(self.normals)
        return np.stack([first, np.cross(self.normals, first)])

    @property
    def shear(self) -> SparseMatrix:
        """Tangential displacements (2 n_point, n_relative), the first tangents before the second.

        Empty where the law has no tangential component.
        """
        nothing = sp.csr_array((0, self.relative_operator.shape[0]))
        along = self.tangents[: self.law.components - 1]
        return sp.vstack([nothing, *map(self._point_motion, along)]).tocsr()

    def _point_motion(self, directions: Matrix) -> SparseMatrix:
        """Return rows (n_point, n_relative): motion of points along directions (n_point, 3)."""
        felt = (times_normals(self.point_shape, directions) @ self.pair_axes.T).tocsr()
        # Normals along one axis have mere round-off along the others.
        felt.data[np.abs(felt.data) <= ROUND_OFF * np.abs(felt.data).max(initial=0.0)] = 0.0
        felt.eliminate_zeros()
        return felt

    @cached_property
    def gap_operator(self) -> SparseMatrix:
        """G (n_point, n_dof): gap per displacement, Eq. (15.3); Gᵀλ are the forces of (15.11)."""
        return read_only((self.interpolation @ self.relative_operator).tocsr())

    @property
    def n_points(self) -> int:
        """Number of contact points."""
        return len(self.weights)

    @property
    def area(self) -> float:
        """Area of the interface [length²]."""
        return float(self.weights.sum())

    def pair_points(self, nodes: Matrix) -> Matrix:
        """Return the positions of the pairs (n_pair, 3), from the coordinates of all nodes."""
        if self.coupling is not None:
            return np.asarray(nodes[self.pairs[:, 0]])
        return np.asarray(nodes[self.pairs].mean(axis=1))

    @cached_property
    def averaging(self) -> SparseMatrix:
        """Map from values at contact points to node pairs (n_pair, n_point)."""
        facets = [(f.kind, facet_columns(self.pairs, f.minus, f.plus)) for f in self.faces]
        return averaging_operator(self.point_shape, self.weights, facets)

    def nodal_average(self, values: Matrix) -> Matrix:
        """Return averages of a quantity at the contact points over node pairs, by positive weights.

        A constant stays constant; :mod:`faying.interface.averaging` defines the weights.

        Parameters
        ----------
        values : (..., n_point)

        Returns
        -------
        ndarray (..., n_pair)
        """
        return np.asarray((self.averaging @ np.asarray(values).T).T)

    def with_penalty(self, penalty: float) -> "Interface":
        """Return a copy with another contact stiffness (``inf`` is hard) and the same friction.

        Raises
        ------
        ModelError
            If the penalty is not positive.
        """
        with naming(f"interface '{self.name}'"):
            normal = normal_law(penalty)
        return self._with_normal(normal)

    def with_closure(self, closure: Curve) -> "Interface":
        """Return a copy with a curve of pressure over closure; friction and c_t do not change."""
        return self._with_normal(closure)

    def _with_normal(self, normal: Law) -> "Interface":
        return self.with_law(self.law.with_normal(normal))

    def with_law(self, law: Law) -> "Interface":
        """Return a copy with another law."""
        return replace(self, law=law)

    def with_initial_gap(self, initial_gap: Vector) -> "Interface":
        """Return a copy with another initial gap at every contact point."""
        gap = np.broadcast_to(np.asarray(initial_gap, dtype=float), self.initial_gap.shape)
        return replace(self, initial_gap=gap)


def _diagonal(blocks: Sequence[SparseMatrix]) -> SparseMatrix:
    """Return the block diagonal matrix of any number of blocks."""
    return sp.block_diag([sp.csr_array((0, 0)), *blocks], format="csr")


def _stacked_shear(members: Sequence[Interface]) -> SparseMatrix:
    """Return the first tangential rows of all interfaces, then the second."""
    halves: list[list[SparseMatrix]] = [[], []]
    for member in members:
        half = member.shear.shape[0] // 2
        for rows, half_rows in zip(halves, (slice(0, half), slice(half, None)), strict=True):
            rows.append(member.shear[half_rows])
    return read_only(sp.vstack([_diagonal(rows) for rows in halves]).tocsr())


def stack(interfaces: Mapping[str, Interface], n_dof: int) -> Contact:
    """Return the contact of all interfaces of a model, in their order; there may be none."""
    members = list(interfaces.values())
    operators = [sp.csr_array((0, n_dof)), *(member.relative_operator for member in members)]
    weights = [np.zeros(0), *(member.weights for member in members)]
    gaps = [np.zeros(0), *(member.initial_gap for member in members)]
    tangents = [np.zeros((2, 0, 3)), *(member.tangents for member in members)]
    ends = np.cumsum([0, *(member.n_points for member in members)])
    return Contact(
        relative_operator=read_only(sp.vstack(operators).tocsr()),
        interpolation=read_only(_diagonal([member.interpolation for member in members])),
        initial_gap=frozen(np.concatenate(gaps)),
        weights=frozen(np.concatenate(weights)),
        laws={name: member.law for name, member in interfaces.items()},
        shear=_stacked_shear(members),
        tangents=frozen(np.concatenate(tangents, axis=1)),
        slices={
            name: slice(int(start), int(stop))
            for name, start, stop in zip(interfaces, ends[:-1], ends[1:], strict=True)
        },
    )
