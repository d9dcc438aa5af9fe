"""Tangential resultants of an interface: the forces of sticking springs and bolts across it.

Sticking springs and bolts through an interface transfer tangential forces. If nothing else connects
the two sides, their sum follows from equilibrium alone. Otherwise the sticking springs take a share
of it, and without them this share is unknown.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Frozen, Indices, Matrix, SparseMatrix, Vector
from faying.digits import DECK_DIGITS, SOLVED
from faying.interface.interface import Interface
from faying.interface.relative_displacement import tangents_of
from faying.joint.bolt_surroundings import nearest_bolts, told_apart
from faying.joint.model import Model
from faying.joint.sticking import sticking_forces
from faying.joint.system import elongations
from faying.model.bolt import Bolt
from faying.model.links import connected_parts

CURVED = "it is curved, and its tangential forces have no resultant along one plane"
"""Reason for unknown resultants of an area with several normals."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TangentialRows(Frozen):
    """Tangential resultants on the plus side of an area, per unit of the inputs of the joint.

    Rows are the forces along both tangents, and the moment about the normal through the origin.

    Attributes
    ----------
    interface
        Name of the interface.
    bolt
        Bolt whose surroundings are the area; empty for the whole interface.
    unknown
        Why the resultants are unknown; empty if they are known.
    origin : (3,) [length]
        A point of the interface.
    tangents : (2, 3) [1]
        Two directions along it.
    per_input : (3, n_input) [1]
        Per boundary force, initial bolt force and amplitude of a load pattern.
    per_pair : (3, n_relative) [1]
        Per force between the contact pairs.
    """

    interface: str
    bolt: str
    unknown: str
    origin: Vector
    tangents: Matrix
    per_input: Matrix
    per_pair: Matrix

    def carried(self, inputs: Matrix, pairs: Matrix) -> Matrix:
        """Return both forces and the moment (n_case, 3).

        ``inputs`` are (n_case, n_input), forces between ``pairs`` (n_case, n_relative) [force].
        """
        return inputs @ self.per_input.T + pairs @ self.per_pair.T


def tangential_rows(model: Model) -> tuple[TangentialRows, ...]:
    """Return the tangential resultants of every interface, and of the surroundings of its bolts.

    Raises
    ------
    SingularMatrixError
        If the structure is not held without its boundary.

    Notes
    -----
    Three back-substitutions for each interface and each area around a bolt.
    """
    rows_of_bolts = [item for name in model.interfaces for item in _areas_of_interface(model, name)]
    if not rows_of_bolts:
        return ()
    rows = sp.vstack([item for _, item in rows_of_bolts]).toarray()
    moved = model.structure.solve(rows.T)
    first = moved[model.structure.boundary]
    loads = model.pattern_forces @ moved
    bolts = -(elongations(model.bolts, model.structure.n_dof) @ moved)
    inputs = np.vstack([first, bolts, loads]).T.reshape(len(rows_of_bolts), 3, -1)
    pairs = (model.contact.relative_operator @ moved).T.reshape(len(rows_of_bolts), 3, -1)
    return tuple(
        item if item.unknown else replace(item, per_input=inputs[number], per_pair=pairs[number])
        for number, (item, _) in enumerate(rows_of_bolts)
    )


def _areas_of_interface(model: Model, name: str) -> Iterator[tuple[TangentialRows, SparseMatrix]]:
    """Yield the areas of an interface, with empty rows, and the rows of displacements."""
    interface = model.interfaces[name]
    places = interface.pair_points(model.assembly.mesh.nodes)
    normal = _plane_normal(interface)
    origin, first = interface.points.mean(axis=0), tangents_of(normal[None])[0]
    tangents = np.stack([first, np.cross(normal, first)])
    labels = _parts_without_bolts(model)
    joining = _joining_sides(interface, model.bolts, labels)
    pierced = _bolts_through(interface, tangents, origin, model.bolts, joining)
    unknown = _reason_unknown(model, name, pierced, labels)
    springs, pairs = _springs(model, name)
    areas = [("", np.ones(len(pairs), dtype=bool))]
    if model.bolts and told_apart(model.bolts):
        nearest = nearest_bolts(places[pairs], model.bolts)
        closest_bolts = np.unique(nearest_bolts(interface.points, model.bolts)).tolist()
        areas += [(list(model.bolts)[number], nearest == number) for number in closest_bolts]
    frame = np.vstack([tangents, normal])
    for bolt, area in areas:
        chosen = (
            [candidate for candidate in pierced if bolt in ("", candidate)] if not unknown else []
        )
        wrench = sp.csr_array((6, model.structure.n_dof))
        if area.any():
            wrench = wrench + _resultant(places[pairs[area]]) @ springs[np.repeat(area, 3)]
        for candidate in chosen:
            shank = model.bolts[candidate].shank
            if shank is not None:
                # The plus side bears the force of the bolt on its end there.
                wrench = wrench + pierced[candidate] * shank.across
        force, moment = wrench[:3], wrench[3:]
        about = moment - _cross(origin) @ force
        rows = sp.vstack([sp.csr_array(tangents) @ force, sp.csr_array(frame[2:]) @ about])
        yield (
            TangentialRows(
                interface=name,
                bolt=bolt,
                unknown=unknown,
                origin=origin,
                tangents=tangents,
                per_input=np.zeros((3, 0)),
                per_pair=np.zeros((3, 0)),
            ),
            rows.tocsr(),
        )


def _plane_normal(interface: Interface) -> Vector:
    """Return the normal (3,) of most of an interface's area, where most of it has one.

    By components it is the median over the area: edges that bend away do not tilt it.
    """
    if interface.flat:
        return np.asarray(interface.normals[0])
    order = np.argsort(interface.normals, axis=0)
    area = np.cumsum(interface.weights[order], axis=0)
    middle = (area >= area[-1] / 2).argmax(axis=0)
    median = np.take_along_axis(interface.normals, order, axis=0)[middle, np.arange(3)]
    nearest = interface.normals[(interface.normals @ median).argmax()]
    return np.asarray(nearest)


def _mostly_flat(interface: Interface) -> bool:
    """Return whether one normal is that of more than half of an interface's area."""
    along = interface.normals @ _plane_normal(interface) > 1 - DECK_DIGITS
    return bool(2 * interface.weights[along].sum() > (1 + SOLVED) * interface.weights.sum())


def _springs(model: Model, name: str) -> tuple[SparseMatrix, Indices]:
    """Return the forces of sticking springs on the plus side, three rows a pair, and the pairs."""
    stuck = model.stuck.get(name)
    if stuck is None or not stuck.any() or not model.stuck_stiffness:
        return sp.csr_array((0, model.structure.n_dof)), np.empty(0, dtype=np.int64)
    rows = sticking_forces(model.interfaces[name], stuck, model.stuck_stiffness)
    return -rows, np.flatnonzero(stuck)


def _resultant(places: Matrix) -> SparseMatrix:
    """Return the matrix (6, 3 n) from forces at places (n, 3) to their resultant at the origin."""
    forces = np.tile(np.eye(3), len(places))
    moments = np.hstack([_cross(arm) for arm in places])
    return sp.csr_array(np.vstack([forces, moments]))


def _cross(arm: Vector) -> Matrix:
    """Return the matrix (3, 3) of arm × …."""
    x, y, z = arm
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _parts_without_bolts(model: Model) -> Indices:
    """Return labels of parts connected without bolts and contact, by node, the ground last."""
    shanks = [port.shank for port in model.bolts.values() if port.shank is not None]
    return connected_parts(
        model.assembly, {element for shank in shanks for element in shank.elements}
    )


def _joining_sides(
    interface: Interface, bolts: Mapping[str, Bolt], labels: Indices
) -> Collection[str]:
    """Return the bolts that join the two sides of an interface."""
    sides = np.unique(np.sort(labels[interface.pairs], axis=1), axis=0)
    shanks = {name: bolt.shank for name, bolt in bolts.items() if bolt.shank is not None}
    return {
        name
        for name, shank in shanks.items()
        if (np.sort(labels[shank.nodes]) == sides).all(axis=1).any()
    }


def _bolts_through(
    interface: Interface,
    tangents: Matrix,
    origin: Vector,
    bolts: Mapping[str, Bolt],
    joining: Collection[str],
) -> dict[str, float]:
    """Return the bolts through an interface: 1 if they begin on its plus side, else −1.

    An axis that crosses its plane passes through the interface if contact points surround it, or if
    the bolt is among those that join its sides, as beside a gasket inside the bolt circle.
    """
    normal, pierced = np.cross(*tangents), {}
    points = (interface.points - origin) @ tangents.T
    for name, bolt in bolts.items():
        ends = bolt.ends if bolt.shank is None else bolt.shank.ends
        if ends is None:
            continue
        heights = (ends - origin) @ normal
        smallest = SOLVED * np.abs(np.diff(heights)[0])
        if heights.min() > -smallest or heights.max() < smallest or smallest == 0:
            continue
        share = heights[0] / (heights[0] - heights[1])
        point = (ends[0] + share * (ends[1] - ends[0]) - origin) @ tangents.T
        angles = np.sort(np.arctan2(*(points - point).T))
        around = np.diff(angles, append=angles[:1] + 2 * np.pi).max() < np.pi
        if around or name in joining:
            pierced[name] = float(np.sign(heights[0]))
    return pierced


def _reason_unknown(model: Model, name: str, pierced: Mapping[str, float], labels: Indices) -> str:
    """Return why the resultants along an interface are unknown; empty if they are known."""
    if not _mostly_flat(model.interfaces[name]):
        return CURVED
    stuck = model.stuck.get(name)
    sticks = stuck is not None and bool(stuck.any())
    if sticks and not model.stuck_stiffness:
        return "the stiffness of its sticking pairs is unknown"
    contained = [bolt for bolt, port in model.bolts.items() if port.shank is None]
    if contained:
        return f"bolt '{contained[0]}' is part of given matrices, which hide its lateral force"
    if not sticks and _held_elsewhere(model, name, pierced, labels):
        return (
            "its sides are held together elsewhere too, by supports, ties or other interfaces, and "
            "no pairs stick ([sticking]), so that its share is unknown"
        )
    return ""


def _held_elsewhere(model: Model, name: str, pierced: Mapping[str, float], labels: Indices) -> bool:
    """Return whether the sides are connected without the interface and the bolts through it."""
    shanks = {bolt: port.shank for bolt, port in model.bolts.items() if port.shank is not None}
    links = [
        labels[model.interfaces[neighbour].pairs]
        for neighbour in model.interfaces
        if neighbour != name
    ]
    links += [labels[port.nodes][None] for bolt, port in shanks.items() if bolt not in pierced]
    links.append(np.empty((0, 2), dtype=np.int64))
    rows, columns = np.concatenate(links).T
    size = int(labels.max()) + 1
    ones = np.ones(len(rows), dtype=np.int8)
    graph = sp.csr_array((ones, (rows, columns)), shape=(size, size))
    _, parts = connected_components(graph, directed=False)
    minus, plus = parts[labels[model.interfaces[name].pairs]].T
    return bool(np.isin(minus, plus).any())
