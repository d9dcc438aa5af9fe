"""The variables of a contact-capable hand-over, the same in MATLAB and NumPy files.

``docs/how-to/export_to_matlab.md`` has the table of their names; tests compare it with this module.
"""

from importlib.metadata import version
from typing import Any

import numpy as np

from faying._typing import Indices, Matrix
from faying.joint.load_pattern import pattern_forces
from faying.joint.system import boundary_dofs, elongations, initial_bolt_forces
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.static import solve_static


def variables(rom: ReducedModel) -> dict[str, Any]:
    """Return the variables of a reduced model but for N, the interpolation, which is sparse.

    Numbers are float64, what points into other arrays from zero is int64, names are text.

    Raises
    ------
    ModelError
        If the model does not know its recovery matrices.

    Notes
    -----
    G = N P is formed; everything else is taken as it is.
    """
    contact, bolts, n_mode = rom.contact, rom.bolts, len(rom.K)
    rest, recovery = solve_static(rom), rom.recovery
    return {
        "M": rom.M,
        "C": rom.C,
        "K": rom.K,
        "P": np.asarray(contact.relative_operator),
        "G": np.asarray(contact.gap_operator),
        "R": _residual(rom),
        "g0": contact.initial_gap,
        "w": contact.weights,
        "cn": contact.penalty,
        "points": _stacked(rom, "points", 3),
        "normals": _stacked(rom, "normals", 3),
        "E": elongations(bolts, n_mode),
        "bolt_stiffness": np.array([bolt.stiffness for bolt in bolts.values()], dtype=float),
        "N0": initial_bolt_forces(rom),
        "L": pattern_forces(rom.load_patterns, n_mode),
        "q0": rest.states,
        "lambda0": rest.contact_forces,
        "recovery_inertia": recovery.inertia,
        "recovery_damping": recovery.damping,
        "recovery_compliance": recovery.joint.port_compliance.whole,
        "boundary": boundary_dofs(rom.boundaries),
        "interface_of_point": _interface_of_point(rom),
        "boundary_names": _texts(_boundary_names(rom)),
        "bolt_names": _texts(bolts),
        "load_names": _texts(rom.load_patterns),
        "interface_names": _texts(contact.slices),
        "kinds": _texts(rom.basis.kinds),
        "title": np.array(rom.name),
        "units": np.array(rom.units),
        "method": np.array(rom.method),
        "faying": np.array(version("faying")),
    }


def numpy_variables(rom: ReducedModel) -> dict[str, Any]:
    """Return all variables as plain arrays, N as ``N_rows``, ``N_columns`` and ``N_values``."""
    sparse = rom.contact.interpolation.tocoo()
    return {
        **variables(rom),
        "N_rows": np.asarray(sparse.row, dtype=np.int64),
        "N_columns": np.asarray(sparse.col, dtype=np.int64),
        "N_values": np.asarray(sparse.data, dtype=np.float64),
    }


def _texts(names: Any) -> Any:
    return np.array([str(name) for name in names], dtype=np.str_)


def _residual(rom: ReducedModel) -> Matrix:
    residual, n_relative = rom.contact.residual_compliance, len(rom.contact.relative_operator)
    if residual is None:
        return np.zeros((n_relative, n_relative))
    return np.asarray(residual @ np.eye(n_relative))


def _stacked(rom: ReducedModel, name: str, width: int) -> Matrix:
    parts = [getattr(record, name) for record in rom.interfaces.values()]
    return np.concatenate([np.empty((0, width)), *parts])


def _interface_of_point(rom: ReducedModel) -> Indices:
    numbers = np.zeros(rom.contact.n_points, dtype=np.int64)
    for number, points in enumerate(rom.contact.slices.values()):
        numbers[points] = number
    return numbers


def _boundary_names(rom: ReducedModel) -> list[str]:
    """Name every boundary degree of freedom: boundary, node id and component."""
    return [
        f"{name}.{node}.{DISPLACEMENT_NAMES[component]}"
        for name, one in rom.boundaries.items()
        for node, component in zip(one.nodes.tolist(), one.components.tolist(), strict=True)
    ]
