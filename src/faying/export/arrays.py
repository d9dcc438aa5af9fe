"""The variables of an export with contact, equal in MATLAB and NumPy files.

``docs/how-to/export_to_matlab.md`` has the table of their names; tests compare it with this module.
"""

from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.exceptions import refuse_study
from faying.joint.load_pattern import pattern_forces
from faying.joint.system import boundary_dofs, elongations, initial_bolt_forces
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.path import solve_static
from faying.study.results.values import Results


def variables(rom: ReducedModel) -> dict[str, Any]:
    """Return the variables of a reduced model, without the sparse N and T.

    Numbers are float64, indices into other arrays (from zero) int64, names text.

    Raises
    ------
    ModelError
        If the model has no recovery matrices, or as :func:`refuse_expanding_bolts`.

    Notes
    -----
    G = N P is computed; all other variables are members of the model.
    """
    refuse_expanding_bolts(rom)
    contact, bolts, n_mode = rom.contact, rom.bolts, len(rom.K)
    preloaded, recovery = solve_static(rom), rom.recovery
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
        "ct": _tangential_penalty(rom),
        "mu": contact.coefficients,
        "points": _stacked(rom, "points", 3),
        "normals": _stacked(rom, "normals", 3),
        "tangents1": np.asarray(contact.tangents[0]),
        "tangents2": np.asarray(contact.tangents[1]),
        "E": elongations(bolts, n_mode),
        "bolt_stiffness": np.array([bolt.stiffness for bolt in bolts.values()], dtype=float),
        "N0": initial_bolt_forces(rom),
        "L": pattern_forces(rom.load_patterns, n_mode),
        "q0": preloaded.states,
        "lambda0": preloaded.contact_forces,
        "shear0": _tangential(preloaded.shear_forces),
        "slip0": _tangential(preloaded.shear_slip),
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


def refuse_expanding_bolts(rom: ReducedModel) -> None:
    """Refuse temperatures of bolts, whose part of the bolt force these formats lack."""
    for name, pattern in rom.load_patterns.items():
        if any(pattern.bolt_forces.values()):
            refuse_study(
                f"temperature '{name}' expands bolts, whose forces this format cannot contain; "
                "export to linearized, or remove it from the load cases"
            )


def sparse_variables(rom: ReducedModel) -> dict[str, SparseMatrix]:
    """Return N and T, from pair displacements to openings and tangential displacements at points.

    T has the rows of the first tangent of all points, then of the second; rows
    of points without friction are empty.
    """
    contact = rom.contact
    shear, every = contact.shear.tocoo(), contact.rubbing + contact.n_points * np.arange(2)[:, None]
    shape = (2 * contact.n_points, shear.shape[1])
    T = sp.coo_array((shear.data, (every.ravel()[shear.row], shear.col)), shape=shape)
    return {"N": sp.csr_array(contact.interpolation), "T": T.tocsr()}


def numpy_variables(rom: ReducedModel) -> dict[str, Any]:
    """Return all variables as arrays, N and T as ``N_rows``, ``N_columns``, ``N_values`` etc."""
    arrays = variables(rom)
    for name, matrix in sparse_variables(rom).items():
        entries = matrix.tocoo()
        arrays |= {
            f"{name}_rows": np.asarray(entries.row, dtype=np.int64),
            f"{name}_columns": np.asarray(entries.col, dtype=np.int64),
            f"{name}_values": np.asarray(entries.data, dtype=np.float64),
        }
    return arrays


def _tangential_penalty(rom: ReducedModel) -> Vector:
    """Return c_t (n_point,); infinite for rigid sticking, and without friction."""
    every = np.full(rom.contact.n_points, np.inf)
    rigid = rom.contact.tangential_flexibility == 0
    relative = rom.contact.weights[rom.contact.rubbing] * rom.contact.tangential_flexibility
    every[rom.contact.rubbing] = np.where(rigid, np.inf, 1.0 / np.where(rigid, 1.0, relative))
    return every


def _tangential(components: Matrix) -> Matrix:
    """Return tangential components (n_point, 2) of (n_tangent, n_point); zero without friction."""
    both = np.zeros((components.shape[1], 2))
    both[:, : len(components)] = components.T
    return both


def _texts(names: Any) -> Any:
    return np.array([str(name) for name in names], dtype=np.str_)


def _residual(rom: ReducedModel) -> Matrix:
    residual, n_relative = rom.contact.residual_compliance, len(rom.contact.relative_operator)
    if residual is None:
        return np.zeros((n_relative, n_relative))
    return np.asarray(residual)


def _stacked(rom: ReducedModel, name: str, width: int) -> Matrix:
    parts = [getattr(record, name) for record in rom.interfaces.values()]
    return np.concatenate([np.empty((0, width)), *parts])


def _interface_of_point(rom: ReducedModel) -> Indices:
    numbers = np.zeros(rom.contact.n_points, dtype=np.int64)
    for number, points in enumerate(rom.contact.slices.values()):
        numbers[points] = number
    return numbers


def _boundary_names(rom: ReducedModel) -> list[str]:
    """Return the name of every boundary degree of freedom: boundary, node id and component."""
    return [
        f"{name}.{node}.{DISPLACEMENT_NAMES[component]}"
        for name, boundary in rom.boundaries.items()
        for node, component in zip(
            boundary.nodes.tolist(), boundary.components.tolist(), strict=True
        )
    ]


def write(rom: ReducedModel, path: Path, _: Results | None = None) -> tuple[Path, ...]:
    """Write the variables of :mod:`faying.export.arrays` to a compressed archive.

    N and T are stored as three arrays each, such as ``N_rows``, ``N_columns`` and ``N_values``;
    nothing is pickled.
    """
    with path.open("wb") as file:
        np.savez_compressed(file, **numpy_variables(rom))
    return (path,)
