"""Entries of a reduced model's file beyond pressures: interface resultants and weak springs."""

from collections.abc import Mapping

import h5py
import numpy as np

from faying._typing import Matrix
from faying.exceptions import refuse_value
from faying.files.described import member, member_name, numbers, read_member
from faying.joint.system import boundary_dofs
from faying.joint.tangential import TangentialRows
from faying.joint.weak_support import WeakSupport
from faying.reduction.model_fields import TABLES
from faying.reduction.reduced_model import ReducedModel


def tangential_of(file: h5py.File, joint: ReducedModel) -> tuple[TangentialRows, ...]:
    """Return the tangential resultants of the interfaces, where the file has them."""
    group = member(file, "ports")
    if "tangential" not in group:
        return ()
    rows: tuple[TangentialRows, ...] = read_member(
        member(group, "tangential"), tuple[TangentialRows, ...], TABLES
    )
    n_relative = int(joint.contact.relative_operator.shape[0])
    n_input = len(boundary_dofs(joint.boundaries)) + len(joint.bolts) + len(joint.load_patterns)
    for row in rows:
        refers = row.interface in joint.interfaces and row.bolt in ("", *joint.bolts)
        shapes = ((3, n_input), (3, n_relative))
        fits = bool(row.unknown) or (row.per_input.shape, row.per_pair.shape) == shapes
        if not (refers and fits) or (row.origin.shape, row.tangents.shape) != ((3,), (2, 3)):
            refuse_value(
                f"/ports/tangential of interface '{row.interface}', bolt '{row.bolt}' does not fit "
                f"{n_input} inputs and {n_relative} pairs"
            )
    return rows


def moments_of(group: h5py.Group, key: str, bolt: str, width: int) -> Matrix | None:
    """Return the moments of a bolt; None where the file has none."""
    if key not in group or member_name(bolt) not in group[key]:
        return None
    return numbers(member(group, key), bolt, (4, width))


def rigid_motions_of(group: h5py.Group, n: int) -> Matrix:
    """Return free rigid motions (n, n_motion); none where the file has none."""
    if "rigid_motions" not in group:
        return np.zeros((n, 0))
    motions: Matrix = numbers(group, "rigid_motions")
    if motions.ndim != 2 or len(motions) != n or motions.shape[1] > 6:
        refuse_value(f"'{group.name}/rigid_motions' has shape {motions.shape}, expected ({n}, 6)")
    return motions


def weak_supports_of(group: h5py.Group, n: int) -> dict[str, WeakSupport]:
    """Return the weak springs of bodies, where the file has any."""
    if "weak_supports" not in group:
        return {}
    supports: dict[str, WeakSupport] = read_member(
        member(group, "weak_supports"), Mapping[str, WeakSupport], TABLES
    )
    for body, support in supports.items():
        shape = (3 * len(support.nodes), n)
        if support.forces.shape != shape or support.nodes.shape[1:] != (2,):
            refuse_value(f"'{group.name}/weak_supports' of '{body}' do not fit {n} coordinates")
    return supports
