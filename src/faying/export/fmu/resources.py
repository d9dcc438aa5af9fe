"""The resources of an FMU: matrices of the joint, and matrices of pressure recovery."""

import hashlib
import io
import uuid

import numpy as np
import scipy.sparse as sp

from faying._typing import Vector
from faying.contact.laws import Law
from faying.exceptions import refuse_study
from faying.export.arrays import refuse_expanding_bolts, sparse_variables
from faying.export.fmu.variable import Kind, seconds
from faying.export.fmu.variables import FAMILIES
from faying.joint.load_pattern import pattern_forces
from faying.joint.system import boundary_dofs, elongations
from faying.reduction.reduced_model import ReducedModel

MAGIC = int.from_bytes(b"FYJOINT1", "little")
TOKEN_LENGTH = 64
N_HEADER = 16
"""Bytes of the token, and words of the header, as in ``sources/joint.c``."""

_STARTS = (Kind.RHO, Kind.INTEGRATOR, Kind.START_LOADED)
"""Parameters whose start values follow the step size."""


def joint_file(rom: ReducedModel, step_size: float) -> tuple[bytes, str]:
    """Return the contents of ``joint.bin``, and its instantiation token.

    Notes
    -----
    Layout: see ``sources/joint.c``. The token is a hash of everything else, so equal joints give
    equal files.
    """
    refuse_expanding_bolts(rom)
    contact, residual = rom.contact, rom.contact.residual_compliance
    if rom.rigid_motions.shape[1]:
        refuse_study(
            "the joint has no supports, and an FMU starts in static equilibrium, which needs "
            "them; add supports"
        )
    rows = sp.csr_array(contact.interpolation)
    shear = sp.csr_array(sparse_variables(rom)["T"])
    laws = [contact.laws[name] for name in contact.slices]
    relative = np.asarray(contact.relative_operator)
    time = seconds(rom.units)
    bolts = list(rom.bolts.values())
    slices = list(contact.slices.values())
    boundary = boundary_dofs(rom.boundaries)
    numbers: list[Vector] = [
        rom.M * time**2,
        rom.C * time,
        rom.K,
        relative,
        elongations(rom.bolts, len(rom.K)),
        np.array([bolt.stiffness for bolt in bolts]),
        np.array([bolt.initial_force for bolt in bolts]),
        contact.initial_gap,
        contact.weights,
        np.array([law.penalty for law in laws]),
        np.array([law.friction for law in laws]),
        np.array([_tangential_penalty(law) for law in laws]),
        np.array([step_size, *(float(FAMILIES[kind].start or 0.0) for kind in _STARTS)]),
        rows.data,
        shear.data,
        np.empty(0) if residual is None else np.asarray(residual),
        pattern_forces(rom.load_patterns, len(rom.K)),
    ]
    stops = [0, *(part.stop for part in slices)]
    indices = [boundary, stops, rows.indptr, rows.indices, shear.indptr, shear.indices]
    payload = b"".join(
        [
            *(np.ascontiguousarray(array, dtype="<f8").tobytes() for array in numbers),
            *(np.ascontiguousarray(array, dtype="<u8").tobytes() for array in indices),
        ]
    )
    counts = (
        len(rom.K),
        len(boundary),
        len(bolts),
        len(slices),
        contact.n_points,
        relative.shape[0],
        len(rows.data),
        int(residual is not None),
        len(rom.load_patterns),
        len(shear.data),
    )
    header = np.zeros(N_HEADER, dtype="<u8")
    header[0], header[1 : 1 + len(counts)], header[-1] = MAGIC, counts, _checksum(payload)
    token = _token(header.tobytes() + payload)
    return header.tobytes() + token.encode().ljust(TOKEN_LENGTH, b"\0") + payload, token


def _tangential_penalty(law: Law) -> float:
    return law.tangential_penalty or float("inf")


def recovery_file(rom: ReducedModel) -> bytes:
    """Return ``recovery.npz``, for pressures of the full model from a history of q."""
    contact, ports = rom.contact, rom.joint.port_compliance
    rows, shear = sp.csr_array(contact.interpolation), sp.csr_array(sparse_variables(rom)["T"])
    time = seconds(rom.units)
    file = io.BytesIO()
    np.savez_compressed(
        file,
        inertia=rom.recovery.inertia * time**2,
        damping=rom.recovery.damping * time,
        relative_compliance=ports.relative,
        contact_columns=ports.contact_columns,
        input_rows=ports.input_rows,
        interpolation_values=rows.data,
        interpolation_columns=rows.indices,
        interpolation_row_starts=rows.indptr,
        initial_gap=contact.initial_gap,
        weights=contact.weights,
        penalty=contact.penalty,
        shear_values=shear.data,
        shear_columns=shear.indices,
        shear_row_starts=shear.indptr,
        friction=[contact.laws[name].friction for name in contact.slices],
        tangential_penalty=[_tangential_penalty(contact.laws[name]) for name in contact.slices],
        points=np.concatenate([record.points for record in rom.interfaces.values()]),
        interface_names=np.array(list(contact.slices)),
        interface_stops=np.array([record.stop for record in contact.slices.values()]),
    )
    return file.getvalue()


def _token(content: bytes) -> str:
    return f"{{{uuid.UUID(hashlib.sha256(content).hexdigest()[:32])}}}"


def _checksum(payload: bytes) -> int:
    """Return the sum of words times odd numbers modulo 2⁶⁴, which detects any changed word."""
    words = np.frombuffer(payload, dtype="<u8").astype(np.uint64)
    factors = 2 * np.arange(len(words), dtype=np.uint64) + 1
    return int(np.sum(words * factors, dtype=np.uint64))
