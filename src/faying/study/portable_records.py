"""Joint and reduced models as they stand in results.h5, and back from there without elements."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix
from faying.assessment.recovery import Recovery, frame_operator, supported_operator
from faying.contact.contact import Contact
from faying.contact.laws import normal_law
from faying.exceptions import StudyError
from faying.joint.load_pattern import LoadPattern, pattern_forces
from faying.joint.model import Model
from faying.joint.system import (
    System,
    boundary_dofs,
    boundary_slices,
    elongations,
    port_compliance_of,
)
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary
from faying.reduction.basis import Basis
from faying.reduction.portable import PortableJoint, PortableModel, with_residual
from faying.reduction.reduced_model import ReducedModel, reduce
from faying.simulation.frame_motion import mass_invariants
from faying.study.recovery_results import (
    BoundaryRecord,
    PortsRecord,
    ReducedRecord,
    SparseRecord,
)
from faying.study.results import InterfaceRecord, Results

MOST_PORTS = 4096
"""Ports up to which their compliance is kept: 134 MB."""

MOST_SHAPE_BYTES = 256_000_000
"""What the nodal displacements of all trial vectors may take: 100 vectors of 100 000 nodes."""


def ports_record(model: Model) -> PortsRecord | None:
    """Return the ports of a model; None where they are too many to keep."""
    ports = model.port_compliance
    n_port = ports.n_relative + len(ports.input_rows)
    if n_port > MOST_PORTS or not isinstance(ports.relative, np.ndarray):
        return None
    return PortsRecord(
        compliance=np.block(
            [[ports.relative, ports.contact_columns.T], [ports.contact_columns, ports.input_rows]]
        ),
        interpolation=_sparse_record(model.contact.interpolation),
        boundaries={
            name: BoundaryRecord(nodes=boundary.nodes, components=boundary.components)
            for name, boundary in model.boundaries.items()
        },
        bolt_stiffness={name: float(bolt.stiffness) for name, bolt in model.bolts.items()},
        frame_recovery=frame_operator(model),
        load_patterns=tuple(model.load_patterns),
    )


def kept_models(
    model: Model, models: Mapping[str, Mapping[int, System]], classic: Basis
) -> dict[str, dict[int, ReducedModel]]:
    """Return the reduced models of a run that have a basis, the classic ones in any case."""
    chosen: dict[str, dict[int, ReducedModel]] = {
        name: {count: rom for count, rom in sizes.items() if isinstance(rom, ReducedModel)}
        for name, sizes in models.items()
    }
    for name, compliance in (("craig-bampton", False), ("compliance", True)):
        if name not in chosen:
            chosen[name] = {0: reduce(model, classic, compliance=compliance)}
    return {name: sizes for name, sizes in chosen.items() if sizes}


def reduced_records(
    model: Model, kept: Mapping[str, Mapping[int, ReducedModel]]
) -> tuple[dict[str, dict[int, ReducedRecord]], Matrix | None]:
    """Return reduced models as records, and the nodal shapes (n_shape, n_node, 3) they share.

    Notes
    -----
    Two back-substitutions for each trial vector; those that bases share are solved once.
    """
    # The shortest first, for shapes are kept as far as there is room.
    everyone = sorted(
        (rom for sizes in kept.values() for rom in sizes.values()), key=lambda rom: len(rom.basis)
    )
    together, columns = _shared_vectors([rom.basis for rom in everyone])
    operator = supported_operator(model, together)
    shapes = nodal_shapes(model, together)
    invariants = mass_invariants(model, together.vectors[:, : len(shapes)], shapes)
    records = {
        id(rom): _reduced_record(rom, operator, at, len(shapes), invariants)
        for rom, at in zip(everyone, columns, strict=True)
    }
    reduced = {
        name: {count: records[id(rom)] for count, rom in sizes.items()}
        for name, sizes in kept.items()
    }
    return reduced, shapes if len(shapes) else None


def nodal_shapes(model: Model, basis: Basis, most_bytes: int = MOST_SHAPE_BYTES) -> Matrix:
    """Return trial vectors as displacements of all nodes (n_shape, n_node, 3), the first that fit.

    Parameters
    ----------
    most_bytes
        What they may take.
    """
    n_node = model.dofs.n_nodes
    count = min(len(basis), most_bytes // max(24 * n_node, 1))
    translations = (6 * np.arange(n_node)[:, None] + np.arange(3)).ravel()
    rows = model.dofs.transformation[translations]
    shapes: Matrix = (rows @ basis.vectors[:, :count]).T.reshape(count, n_node, 3)
    return shapes


def _shared_vectors(bases: Sequence[Basis]) -> tuple[Basis, list[Indices]]:
    """Return the distinct vectors of several bases, and where those of each basis are."""
    places: dict[bytes, int] = {}
    columns: list[tuple[Basis, int]] = []
    chosen: list[Indices] = []
    for basis in bases:
        keys = [column.tobytes() for column in basis.vectors.T]
        for number, key in enumerate(keys):
            if key not in places:
                places[key] = len(columns)
                columns.append((basis, number))
        chosen.append(np.array([places[key] for key in keys], dtype=np.int64))
    together = Basis(
        vectors=np.column_stack([basis.vectors[:, number] for basis, number in columns]),
        kinds=tuple(basis.kinds[number] for basis, number in columns),
    )
    return together, chosen


def _reduced_record(
    rom: ReducedModel,
    operator: Recovery,
    columns: Indices,
    n_shape: int,
    invariants: Matrix | None,
) -> ReducedRecord:
    has_shapes = columns.max(initial=-1) < n_shape
    fields = np.concatenate([np.arange(4), (4 + 3 * columns[:, None] + np.arange(3)).ravel()])
    return ReducedRecord(
        kinds=tuple(kind.value for kind in rom.basis.kinds),
        mass=rom.M,
        damping=rom.C,
        stiffness=rom.K,
        relative=np.asarray(rom.contact.relative_operator),
        elongations=elongations(rom.bolts, len(rom.K)),
        boundary=boundary_dofs(rom.boundaries),
        inertia_recovery=operator.inertia[:, columns],
        damping_recovery=operator.damping[:, columns],
        compliance=rom.contact.residual_compliance is not None,
        shapes=columns if has_shapes else None,
        invariants=invariants[np.ix_(fields, fields)]
        if invariants is not None and has_shapes
        else None,
        pattern_forces=pattern_forces(rom.load_patterns, len(rom.K)) if rom.load_patterns else None,
    )


def restored_joint(results: Results) -> PortableJoint:
    """Return the joint of a run as seen through its ports.

    Raises
    ------
    StudyError
        If the results do not hold it.
    """
    if results.ports is None:
        message = (
            f"the results of '{results.title}' hold no port compliance: they are of an older "
            f"version of faying, or the interfaces need more than {MOST_PORTS} ports; run the "
            "study again, or recover in Python with faying.recover_from_modal"
        )
        raise StudyError(message)
    forces = {name: bolt.initial_force for name, bolt in results.bolts.items()}
    return joint_of(results.ports, results.interfaces, forces)


def joint_of(
    ports: PortsRecord, interfaces: Mapping[str, InterfaceRecord], bolt_forces: Mapping[str, float]
) -> PortableJoint:
    """Return a joint as seen through its ports, its bolts locked at initial forces."""
    boundaries = _boundaries(ports)
    n_relative = ports.interpolation.shape[1]
    n_boundary = sum(len(one.dofs) for one in boundaries.values())
    return PortableJoint(
        contact=_contact(interfaces, ports, np.zeros((n_relative, 0))),
        boundaries=boundaries,
        bolts={
            name: Bolt(
                name=name,
                elongation=np.zeros(0),
                stiffness=stiffness,
                initial_force=bolt_forces[name],
            )
            for name, stiffness in ports.bolt_stiffness.items()
        },
        port_compliance=port_compliance_of(
            ports.compliance, n_relative, n_boundary, len(ports.load_patterns)
        ),
        load_patterns={
            name: LoadPattern(name=name, forces=np.zeros(0)) for name in ports.load_patterns
        },
    )


def restored_model(joint: PortableJoint, record: ReducedRecord) -> PortableModel:
    """Return a reduced model of a run, for any solver."""
    places = boundary_slices(joint.boundaries)
    n_mode = len(record.stiffness)
    loads = np.zeros((0, n_mode)) if record.pattern_forces is None else record.pattern_forces
    model = PortableModel(
        M=record.mass,
        C=record.damping,
        K=record.stiffness,
        contact=replace(joint.contact, relative_operator=record.relative),
        boundaries={
            name: boundary.with_dofs(record.boundary[places[name]])
            for name, boundary in joint.boundaries.items()
        },
        bolts={
            name: replace(bolt, elongation=row)
            for (name, bolt), row in zip(joint.bolts.items(), record.elongations, strict=True)
        },
        load_patterns={
            name: LoadPattern(name=name, forces=row)
            for name, row in zip(joint.load_patterns, loads, strict=True)
        },
    )
    return with_residual(model, joint) if record.compliance else model


def restored_recovery(
    joint: PortableJoint, record: ReducedRecord, frame: Matrix | None = None
) -> Recovery:
    """Return the recovery matrices of a reduced model of a run."""
    return Recovery(
        model=joint,
        ports=joint.port_compliance,
        static_contact=joint.static_contact,
        inertia=record.inertia_recovery,
        damping=record.damping_recovery,
        frame=frame,
    )


def _contact(
    interfaces: Mapping[str, InterfaceRecord], ports: PortsRecord, relative: Matrix
) -> Contact:
    records = list(interfaces.values())
    return Contact(
        relative_operator=relative,
        interpolation=sparse_matrix(ports.interpolation),
        initial_gap=_joined(record.initial_gap for record in records),
        weights=_joined(record.weights for record in records),
        laws={name: normal_law(record.penalty) for name, record in interfaces.items()},
        slices={name: slice(*record.slice) for name, record in interfaces.items()},
    )


def _boundaries(ports: PortsRecord) -> dict[str, Boundary]:
    boundaries, start = {}, 0
    for name, record in ports.boundaries.items():
        stop = start + len(record.nodes)
        boundaries[name] = Boundary(
            name=name,
            nodes=record.nodes,
            components=record.components,
            dofs=np.arange(start, stop),
        )
        start = stop
    return boundaries


def _joined(parts: Iterable[Matrix]) -> Matrix:
    return np.concatenate([*parts, np.empty(0)])


def _sparse_record(matrix: SparseMatrix) -> SparseRecord:
    rows = sp.csr_array(matrix)
    return SparseRecord(
        values=np.asarray(rows.data, dtype=np.float64),
        columns=_indices(rows.indices),
        row_starts=_indices(rows.indptr),
        shape=(int(rows.shape[0]), int(rows.shape[1])),
    )


def sparse_matrix(record: SparseRecord) -> SparseMatrix:
    """Return the matrix of a record."""
    parts = (record.values, record.columns, record.row_starts)
    return sp.csr_array(parts, shape=record.shape)


def _indices(values: Matrix) -> Indices:
    return np.asarray(values, dtype=np.int64)
