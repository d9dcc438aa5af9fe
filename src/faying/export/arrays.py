"""The variables of a contact-capable hand-over, the same in MATLAB and NumPy files.

``docs/how-to/export_to_matlab.md`` has the table of their names; tests compare it with this module.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.export.hand_over import HandOver
from faying.joint.load_pattern import pattern_forces
from faying.joint.system import boundary_dofs, boundary_slices, elongations, initial_bolt_forces
from faying.model.boundary import DISPLACEMENT_NAMES


@dataclass(frozen=True, eq=False, kw_only=True)
class Variables:
    """What a hand-over holds, by name.

    Attributes
    ----------
    arrays
        Dense matrices, and vectors (n,).
    indices
        Whole numbers that point into arrays, from zero.
    names
        Lists of text.
    texts
        Single texts.
    interpolation : (n_point, n_relative) sparse
        N.
    """

    arrays: Mapping[str, Matrix]
    indices: Mapping[str, Indices]
    names: Mapping[str, tuple[str, ...]]
    texts: Mapping[str, str]
    interpolation: SparseMatrix


def variables(given: HandOver) -> Variables:
    """Return the variables of a hand-over.

    Notes
    -----
    G = N P is formed; everything else is taken as it is.
    """
    contact, bolts = given.model.contact, given.model.bolts
    return Variables(
        arrays={
            "M": np.asarray(given.model.M),
            "C": np.asarray(given.model.C),
            "K": np.asarray(given.model.K),
            "P": np.asarray(contact.relative_operator),
            "G": np.asarray(contact.gap_operator),
            "R": _residual(given),
            "g0": contact.initial_gap,
            "w": contact.weights,
            "cn": contact.penalty,
            "points": _stacked(given, "points", 3),
            "normals": _stacked(given, "normals", 3),
            "E": elongations(bolts, len(given.model.K)),
            "bolt_stiffness": np.array([bolt.stiffness for bolt in bolts.values()], dtype=float),
            "N0": initial_bolt_forces(given.model),
            "L": pattern_forces(given.model.load_patterns, len(given.model.K)),
            "q0": given.preloaded.states,
            "lambda0": given.preloaded.contact_forces,
            "recovery_inertia": given.recovery.inertia,
            "recovery_damping": given.recovery.damping,
            "recovery_compliance": _ports(given),
        },
        indices={
            "boundary": boundary_dofs(given.model.boundaries),
            "interface_of_point": _interface_of_point(given),
        },
        names={
            "boundary_names": _boundary_names(given),
            "bolt_names": tuple(bolts),
            "load_names": tuple(given.model.load_patterns),
            "interface_names": tuple(contact.slices),
            "kinds": given.record.kinds,
        },
        texts={
            "title": given.title,
            "units": given.units,
            "method": given.method,
            "faying": version("faying"),
        },
        interpolation=contact.interpolation,
    )


def _residual(given: HandOver) -> Matrix:
    contact = given.model.contact
    n_relative = int(contact.relative_operator.shape[0])
    if contact.residual_compliance is None:
        return np.zeros((n_relative, n_relative))
    return np.asarray(contact.residual_compliance @ np.eye(n_relative))


def _ports(given: HandOver) -> Matrix:
    ports = given.joint.port_compliance
    relative = np.asarray(ports.relative @ np.eye(ports.n_relative))
    return np.block(
        [[relative, ports.contact_columns.T], [ports.contact_columns, ports.input_rows]]
    )


def _stacked(given: HandOver, name: str, width: int) -> Matrix:
    parts = [getattr(record, name) for record in given.interfaces.values()]
    return np.concatenate([np.empty((0, width)), *parts])


def _interface_of_point(given: HandOver) -> Indices:
    numbers: Vector = np.zeros(given.model.contact.n_points)
    for number, points in enumerate(given.model.contact.slices.values()):
        numbers[points] = number
    return numbers.astype(np.int64)


def _boundary_names(given: HandOver) -> tuple[str, ...]:
    """Name every boundary degree of freedom: boundary, node id and component."""
    boundaries = given.joint.boundaries
    places = boundary_slices(boundaries)
    return tuple(
        f"{name}.{node}.{DISPLACEMENT_NAMES[component]}"
        for name in places
        for node, component in zip(
            boundaries[name].nodes.tolist(), boundaries[name].components.tolist(), strict=True
        )
    )
