"""Reading of reduced models from the HDF5 files of :mod:`faying.reduction.model_writer`."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, get_type_hints

import h5py
import numpy as np

from faying._typing import Matrix, frozen
from faying.contact.between_pairs import between
from faying.contact.contact import Contact
from faying.contact.laws import LAWS, Law
from faying.exceptions import FormatError, refuse_value
from faying.files.described import (
    described_file,
    items,
    member,
    member_name,
    numbers,
    read_member,
    sparse_matrix,
    texts,
)
from faying.interface.surface import ContactSurface, recorded_law
from faying.joint.load_pattern import LoadPattern
from faying.joint.system import PortCompliance, boundary_slices, port_compliance_of
from faying.linalg.relief import factorize_relieved, shifted
from faying.linalg.sparse_compliance import Compliance, plus
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary
from faying.model.cells import CellBlock
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.model_check import (
    check_definite,
    check_distinct,
    check_finite,
    check_nodes,
    check_surfaces,
)
from faying.reduction.model_data import MeshShapes
from faying.reduction.model_fields import TABLES
from faying.reduction.model_writer import MODEL
from faying.reduction.reduced_model import ReducedModel
from faying.reduction.stored_compliance import read_compliance
from faying.reduction.stored_rows import (
    moments_of,
    rigid_motions_of,
    tangential_of,
    weak_supports_of,
)

_MEMBERS = (
    "interfaces",
    "laws",
    "ports/bolt_stiffness",
    "ports/tangential",
    "ports/relative_compliance",
    "reduced/residual_compliance",
    "reduced/weak_supports",
)
"""Groups read by the annotations of their members, which do not check for finite numbers."""


def read_reduced_model(path: Path | str) -> ReducedModel:
    """Read a reduced model that :meth:`ReducedModel.save` wrote.

    Returns
    -------
    ReducedModel
        With the same numbers, to the last bit.

    Raises
    ------
    FormatError
        If the file is missing, not a reduced model of faying, of another version or damaged.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=5.0)
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4))
    >>> with TemporaryDirectory() as folder:
    ...     rom.save(f"{folder}/joint.h5")
    ...     len(fy.read_reduced_model(f"{folder}/joint.h5").K)
    11
    """
    with described_file(Path(path), MODEL) as file:
        for entry in _MEMBERS:
            if isinstance(file.get(entry), h5py.Group):
                check_finite(file[entry])
        name, method, units = (_text(file, key) for key in ("name", "method", "units"))
        interfaces = read_member(member(file, "interfaces"), Mapping[str, ContactSurface], TABLES)
        forces = {
            bolt: float(numbers(connection, "initial_force", ()))
            for bolt, connection in items(member(file, "bolts"))
        }
        ids = numbers(file, "node_ids", dtype=np.int64)
        mesh = MeshShapes(
            nodes=numbers(file, "nodes", (len(ids), 3)),
            node_ids=ids,
            blocks=read_member(member(file, "blocks"), tuple[CellBlock, ...], TABLES),
        )
        check_surfaces(interfaces, mesh)
        joint = read_ports(member(file, "ports"), interfaces, forces, mesh)
        laws = {interface: _law(group) for interface, group in items(member(file, "laws"))}
        if list(laws) != list(joint.contact.slices):
            message = f"/laws has {', '.join(laws)}, /interfaces {', '.join(joint.contact.slices)}"
            raise ValueError(message)
        joint = replace(
            joint,
            contact=replace(joint.contact, laws=laws),
            bolts=_with_ends(file, joint.bolts),
            name=name,
            method=method,
            units=units,
            period=float(numbers(file, "period", ())) if "period" in file else None,
            tangential=tangential_of(file, joint),
        )
        group = member(file, "reduced")
        return _with_shapes(group, read_model(group, joint))


def read_ports(
    group: h5py.Group,
    interfaces: Mapping[str, ContactSurface],
    bolt_forces: Mapping[str, float],
    mesh: MeshShapes,
) -> ReducedModel:
    """Return the common part of the models of a file, as a model without coordinates."""
    boundaries, first = {}, 0
    for name, boundary in items(member(group, "boundaries")):
        nodes = numbers(boundary, "nodes", dtype=np.int64)
        components = numbers(boundary, "components", nodes.shape, np.int64)
        check_nodes(nodes, components, mesh, boundary.name)
        dofs = np.arange(first, first + len(nodes))
        boundaries[name] = Boundary(name=name, nodes=nodes, components=components, dofs=dofs)
        first += len(nodes)
    stiffness = read_member(member(group, "bolt_stiffness"), Mapping[str, float], TABLES)
    patterns = texts(group, "load_patterns")
    if set(stiffness) != set(bolt_forces):
        names = ", ".join(bolt_forces)
        message = f"'{group.name}/bolt_stiffness' is of {', '.join(stiffness)}, expected {names}"
        raise ValueError(message)
    added = _optional_numbers(group, "pattern_bolt_forces", (len(patterns), len(stiffness)))
    rows = np.zeros((len(patterns), len(stiffness))) if added is None else added
    expanding = [{n: f for n, f in zip(stiffness, row, strict=True) if f} for row in rows.tolist()]
    contact = _contact(group, interfaces)
    n_relative = int(contact.relative_operator.shape[0])
    n_port = n_relative + first + len(stiffness) + len(patterns)
    ports = _ports(group, contact, n_port, first, len(patterns))
    none, empty = np.zeros((0, 0)), np.zeros(0)
    return ReducedModel(
        M=none,
        C=none,
        K=none,
        contact=contact,
        boundaries=boundaries,
        bolts={
            name: Bolt(name=name, elongation=empty, stiffness=k, initial_force=bolt_forces[name])
            for name, k in stiffness.items()
        },
        basis=Basis(vectors=none, kinds=()),
        load_patterns={
            name: LoadPattern(name=name, forces=empty, bolt_forces=of_bolts)
            for name, of_bolts in zip(patterns, expanding, strict=True)
        },
        ports=ports,
        recovery_frame=_optional_numbers(group, "frame_recovery", (n_port, 12)),
        interfaces=interfaces,
        mesh=mesh,
    )


def _ports(
    group: h5py.Group, contact: Contact, n_port: int, n_boundary: int, n_pattern: int
) -> PortCompliance | None:
    """Return the compliance of all ports, with that of the pairs dense or as sparse factors."""
    n_relative = int(contact.relative_operator.shape[0])
    if (whole := _optional_numbers(group, "compliance", (n_port, n_port))) is not None:
        check_definite(whole, f"{group.name}/compliance")
        stiffness = _optional_numbers(group, "relative_stiffness", (n_relative, n_relative))
        return port_compliance_of(whole, n_relative, n_boundary, n_pattern, stiffness)
    relative = _compliance(group, "relative_compliance", contact)
    if relative is None:
        return None
    n_input = n_port - n_relative
    rows = numbers(group, "input_rows", (n_input, n_input))
    check_definite(rows, f"{group.name}/input_rows")
    return PortCompliance(
        pairs=between(relative),
        contact_columns=numbers(group, "contact_columns", (n_input, n_relative)),
        input_rows=rows,
        n_boundary=n_boundary,
        n_pattern=n_pattern,
    )


def _compliance(group: h5py.Group, name: str, contact: Contact) -> Compliance | None:
    """Return a compliance between the pairs, dense or as sparse factors; None if not stored."""
    n_relative = int(contact.relative_operator.shape[0])
    if isinstance(group.get(name), h5py.Group):
        return read_compliance(group[name], n_relative)
    return _optional_numbers(group, name, (n_relative, n_relative))


def read_model(group: h5py.Group, joint: ReducedModel) -> ReducedModel:
    """Return a reduced model from its matrices and the common part of all models.

    Without a stored residual compliance, this is R = P K⁻¹ Pᵀ − PΦ K_r⁻¹ (PΦ)ᵀ (M5).
    """
    kinds = tuple(map(ModeKind, texts(group, "kinds")))
    n, n_relative = len(kinds), int(joint.contact.relative_operator.shape[0])
    M, C, K = (numbers(group, name, (n, n)) for name in ("mass", "damping", "stiffness"))
    seen = numbers(group, "relative", (n_relative, n))
    rows = numbers(group, "elongations", (len(joint.bolts), n))
    places = boundary_slices(joint.boundaries)
    n_boundary = sum(len(boundary.dofs) for boundary in joint.boundaries.values())
    dofs = numbers(group, "boundary", (n_boundary,), np.int64)
    check_distinct(dofs, n, f"{group.name}/boundary")
    loads = _optional_numbers(group, "pattern_forces", (len(joint.load_patterns), n))
    motions = rigid_motions_of(group, n)
    check_definite(shifted(K, M @ motions), f"{group.name}/stiffness")
    residual = _compliance(group, "residual_compliance", joint.contact)
    if (
        residual is None
        and read_member(member(group, "compliance"), bool, TABLES)
        and joint.ports is not None
    ):
        flexibility = factorize_relieved(K, M, motions).solve(np.eye(n))
        residual = plus(joint.ports.relative, seen, -flexibility)
    n_port = n_relative + n_boundary + len(joint.bolts) + len(joint.load_patterns)
    return replace(
        joint,
        M=M,
        C=C,
        K=K,
        contact=replace(
            joint.contact,
            relative_operator=frozen(seen),
            residual_compliance=frozen(residual) if isinstance(residual, np.ndarray) else residual,
        ),
        boundaries={
            name: boundary.with_dofs(dofs[places[name]])
            for name, boundary in joint.boundaries.items()
        },
        bolts={
            name: replace(
                boundary,
                elongation=row,
                bending=moments_of(group, "bending", name, n),
                residual_bending=moments_of(group, "residual_bending", name, n_relative),
            )
            for (name, boundary), row in zip(joint.bolts.items(), rows, strict=True)
        },
        basis=Basis(vectors=np.zeros((0, n)), kinds=kinds),
        load_patterns={
            name: replace(boundary, forces=row)
            for (name, boundary), row in zip(joint.load_patterns.items(), loads, strict=True)
        }
        if loads is not None
        else {},
        weak_supports=weak_supports_of(group, n),
        rigid_motions=motions,
        recovery_inertia=_optional_numbers(group, "inertia_recovery", (n_port, n)),
        recovery_damping=_optional_numbers(group, "damping_recovery", (n_port, n)),
        invariants=_optional_numbers(group, "invariants", (4 + 3 * n, 4 + 3 * n)),
    )


def _with_shapes(group: h5py.Group, rom: ReducedModel) -> ReducedModel:
    """Add the trial vectors of a model in a file of its own, or its displacements of nodes."""
    n, n_node = len(rom.K), len(rom.mesh.nodes)
    mesh = replace(rom.mesh, columns=np.arange(n))
    if "trial_vectors" in group:
        vectors = numbers(group, "trial_vectors")
        rom = replace(rom, basis=Basis(vectors=vectors, kinds=rom.basis.kinds))
    if "translations" in group:
        rows = sparse_matrix(group, "translations")
        if rows.shape != (3 * n_node, len(rom.basis.vectors)):
            message = f"{len(rom.basis.vectors)} rows of trial vectors do not move {n_node} nodes"
            raise ValueError(message)
        mesh = replace(mesh, vectors=rom.basis.vectors, translations=rows)
    if "nodal_shapes" in group:
        shapes = numbers(group, "nodal_shapes", (n, n_node, 3))
        mesh = replace(mesh, vectors=shapes.reshape(n, -1).T)
    return replace(rom, mesh=mesh)


def _with_ends(file: h5py.File, bolts: Mapping[str, Bolt]) -> dict[str, Bolt]:
    """Return bolts with the positions of their ends, where the file has them."""
    group = file.get("bolt_ends", {})
    return {
        name: replace(bolt, ends=numbers(group, name, (2, 3)))
        if member_name(name) in group
        else bolt
        for name, bolt in bolts.items()
    }


def _law(group: h5py.Group) -> Law:
    """Return the contact law of an interface by its name and its parameters."""
    name = _text(group, "law")
    if name not in LAWS:
        refuse_value(f"{group.name} names the contact law '{name}'; known are {', '.join(LAWS)}")
    parameters: dict[str, Any] = {}
    for parameter, hint in get_type_hints(LAWS[name]).items():
        value = member(group, parameter)
        inner = isinstance(value, h5py.Group)
        parameters[parameter] = _law(value) if inner else read_member(value, hint, TABLES)
    return LAWS[name](**parameters)


def _contact(group: h5py.Group, interfaces: Mapping[str, ContactSurface]) -> Contact:
    records = list(interfaces.values())
    interpolation = sparse_matrix(group, "interpolation")
    n_relative = int(interpolation.shape[1])
    sizes = [len(record.weights) for record in records]
    ends = np.cumsum([0, *sizes]).tolist()
    if [record.slice for record in records] != list(pairwise(ends)) or (
        interpolation.shape[0] != ends[-1]
    ):
        refuse_value(f"the interfaces have {ends[-1]} points, {group.name} does not")
    stated: dict[str, Any] = {}  # files of earlier versions contain less
    if "dense_budget" in group:
        stated["dense_budget"] = int(numbers(group, "dense_budget", (), np.int64))
    if "shear" in group:
        stated["shear"] = sparse_matrix(group, "shear")
        stated["tangents"] = numbers(group, "tangents", (2, ends[-1], 3))
    return Contact(
        relative_operator=np.zeros((n_relative, 0)),
        interpolation=interpolation,
        initial_gap=_concatenated(record.initial_gap for record in records),
        weights=_concatenated(record.weights for record in records),
        laws={name: recorded_law(record) for name, record in interfaces.items()},
        slices={name: slice(*record.slice) for name, record in interfaces.items()},
        **stated,
    )


def _concatenated(parts: Iterable[Matrix]) -> Matrix:
    return frozen(np.concatenate([*parts, np.empty(0)]))


def _optional_numbers(group: h5py.Group, name: str, shape: tuple[int, ...]) -> Matrix | None:
    return numbers(group, name, shape) if name in group else None


def study_of(path: Path | str) -> str:
    """Return the text of the study that a reduced model in a file came from; empty if none.

    Raises
    ------
    FormatError
        As :func:`load`.
    """
    with described_file(Path(path), MODEL) as file:
        provenance = member(file, "provenance")
        return _text(provenance, "study") if "study" in provenance else ""


PRELOAD_PATH = "preload_path"
"""Entry of the provenance: initial bolt forces, increment by increment, as JSON."""


def preload_path_of(path: Path | str) -> list[dict[str, float]] | None:
    """Return the path of initial bolt forces that tightened a joint with friction, by increment.

    Empty after tightening without friction; None if the file has no record of it.

    Raises
    ------
    FormatError
        As :func:`load`.
    """
    with described_file(Path(path), MODEL) as file:
        provenance = member(file, "provenance")
        if PRELOAD_PATH not in provenance:
            return None
        text = _text(provenance, PRELOAD_PATH)
    try:
        return [
            {str(name): float(force) for name, force in forces.items()}
            for forces in json.loads(text)
        ]
    except (ValueError, TypeError, AttributeError) as error:
        message = f"{path}: /provenance/{PRELOAD_PATH} is not a list of bolt forces; {error}"
        raise FormatError(message) from None


def _text(group: h5py.Group, name: str) -> str:
    return str(read_member(member(group, name), str, TABLES))
