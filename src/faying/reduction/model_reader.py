"""Reading of reduced models from the HDF5 files of :mod:`faying.reduction.model_writer`."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np

from faying._typing import Matrix, frozen
from faying.contact.between_pairs import between
from faying.contact.contact import Contact
from faying.contact.laws import LAWS, Law
from faying.exceptions import FormatError, refuse_value
from faying.files.described import described_file, member, read_member, read_value
from faying.files.shapes import Axes, ShapeRules
from faying.interface.surface import ContactSurface, recorded_law
from faying.joint.load_pattern import LoadPattern
from faying.joint.system import PortCompliance, boundary_slices, port_compliance_of
from faying.joint.tangential import TangentialRows
from faying.joint.weak_support import WeakSupport
from faying.linalg.relief import factorize_relieved, shifted
from faying.linalg.sparse_compliance import plus
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.model_check import (
    check_definite,
    check_distinct,
    check_finite,
    check_geometry,
    check_nodes,
    without_own,
)
from faying.reduction.model_data import MeshShapes
from faying.reduction.reduced_model import ReducedModel
from faying.reduction.stored_compliance import restored
from faying.reduction.stored_model import (
    MODEL,
    TABLES,
    StoredCoordinates,
    StoredModel,
    StoredModels,
    StoredPorts,
)


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
        return _restored(read_value(file, StoredModel, TABLES))


def _restored(stored: StoredModel) -> ReducedModel:
    """Return the model of a file."""
    check_finite(stored)
    mesh = MeshShapes(nodes=stored.nodes, node_ids=stored.node_ids, blocks=stored.blocks)
    RULES.check(stored, _axes(stored.ports, stored.interfaces, len(mesh.nodes)))
    forces = {bolt: locked["initial_force"] for bolt, locked in stored.bolts.items()}
    joint = _at_ports(stored.ports, stored.interfaces, forces, mesh)
    for row in stored.ports.tangential or ():
        if row.interface not in joint.interfaces or row.bolt not in ("", *joint.bolts):
            refuse_value(f"/ports/tangential is of '{row.interface}' and bolt '{row.bolt}'")
    laws = {name: _law(parameters, f"/laws/{name}") for name, parameters in stored.laws.items()}
    if list(laws) != list(joint.contact.slices):
        message = f"/laws has {', '.join(laws)}, /interfaces {', '.join(joint.contact.slices)}"
        raise ValueError(message)
    joint = replace(
        joint,
        contact=replace(joint.contact, laws=laws),
        bolts={
            name: replace(bolt, ends=stored.bolt_ends.get(name))
            for name, bolt in joint.bolts.items()
        },
        name=stored.name,
        method=stored.method,
        units=stored.units,
        period=stored.period,
        tangential=stored.ports.tangential or (),
    )
    return _with_shapes(stored.reduced, _in_coordinates(stored.reduced, joint, "/reduced"))


def models_of_run(
    run: StoredModels,
    interfaces: Mapping[str, ContactSurface],
    bolt_forces: Mapping[str, float],
    mesh: MeshShapes,
    name: str,
    units: str,
) -> dict[str, dict[int, ReducedModel]]:
    """Return the reduced models of a run by method and number of joint modes.

    Empty where the compliance of the ports was not stored. Bolt forces [force] are initial ones.
    """
    if run.ports is None or run.reduced is None:
        return {}
    check_finite(run)
    axes = _axes(run.ports, interfaces, len(mesh.nodes))
    RULES.check(run, axes | ({} if run.shapes is None else {"n_shape": len(run.shapes)}))
    joint = _at_ports(run.ports, interfaces, bolt_forces, mesh)
    vectors = None
    if run.shapes is not None:
        vectors = run.shapes.reshape(len(run.shapes), 3 * len(mesh.nodes)).T
    models: dict[str, dict[int, ReducedModel]] = {}
    for method, sizes in run.reduced.items():
        models[method] = {}
        for count, stored in sizes.items():
            rom = _in_coordinates(stored, joint, f"/reduced/{method}/{count}")
            if vectors is not None and stored.shapes is not None:
                shapes = replace(mesh, vectors=vectors, columns=stored.shapes)
                rom = replace(rom, mesh=shapes)
            models[method][count] = replace(rom, name=name, units=units, method=method)
    return models


def _axes(ports: StoredPorts, interfaces: Mapping[str, ContactSurface], n_node: int) -> Axes:
    """Return the lengths of axes that values of a file share."""
    n_relative = int(ports.interpolation.shape[-1])
    n_boundary = sum(len(boundary.nodes) for boundary in ports.boundaries.values())
    n_bolt, n_pattern = len(ports.bolt_stiffness), len(ports.load_patterns)
    n_input = n_boundary + n_bolt + n_pattern
    return {
        "n_node": n_node,
        "n_point": sum(len(surface.weights) for surface in interfaces.values()),
        "n_relative": n_relative,
        "n_boundary": n_boundary,
        "n_bolt": n_bolt,
        "n_pattern": n_pattern,
        "n_input": n_input,
        "n_port": n_relative + n_input,
    }


def _axes_within(value: Any, _: str, axes: Axes) -> Axes:
    """Return the known axes within a value of a reduced model."""
    if isinstance(value, ContactSurface):
        return without_own(axes)
    if isinstance(value, TangentialRows) and value.unknown:
        return {}
    if isinstance(value, WeakSupport):
        return {**axes, "n_dof": axes["n_mode"]}
    return axes


RULES = ShapeRules(tables=TABLES, axes_within=_axes_within, check_relations=check_geometry)
"""Rules for the arrays of reduced models."""


def _at_ports(
    stored: StoredPorts,
    interfaces: Mapping[str, ContactSurface],
    bolt_forces: Mapping[str, float],
    mesh: MeshShapes,
) -> ReducedModel:
    """Return the common part of the models of a file, as a model without coordinates."""
    boundaries, first = {}, 0
    for name, boundary in stored.boundaries.items():
        check_nodes(boundary.nodes, boundary.components, mesh, f"/ports/boundaries/{name}")
        dofs = np.arange(first, first + len(boundary.nodes))
        boundaries[name] = Boundary(
            name=name, nodes=boundary.nodes, components=boundary.components, dofs=dofs
        )
        first += len(boundary.nodes)
    stiffness, patterns = stored.bolt_stiffness, stored.load_patterns
    if set(stiffness) != set(bolt_forces):
        names = ", ".join(bolt_forces)
        message = f"'/ports/bolt_stiffness' is of {', '.join(stiffness)}, expected {names}"
        raise ValueError(message)
    added = stored.pattern_bolt_forces
    rows = np.zeros((len(patterns), len(stiffness))) if added is None else added
    expanding = [{n: f for n, f in zip(stiffness, row, strict=True) if f} for row in rows.tolist()]
    none, empty = np.zeros((0, 0)), np.zeros(0)
    return ReducedModel(
        M=none,
        C=none,
        K=none,
        contact=_contact(stored, interfaces),
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
        ports=_compliance(stored, first),
        recovery_frame=stored.frame_recovery,
        interfaces=interfaces,
        mesh=mesh,
    )


def _compliance(stored: StoredPorts, n_boundary: int) -> PortCompliance | None:
    """Return the compliance of all ports, with that of the pairs dense or as sparse factors."""
    n_relative, n_pattern = int(stored.interpolation.shape[1]), len(stored.load_patterns)
    if stored.compliance is not None:
        check_definite(stored.compliance, "/ports/compliance")
        return port_compliance_of(
            stored.compliance, n_relative, n_boundary, n_pattern, stored.relative_stiffness
        )
    relative, columns = restored(stored.relative_compliance), stored.contact_columns
    if relative is None or columns is None or stored.input_rows is None:
        return None
    check_definite(stored.input_rows, "/ports/input_rows")
    return PortCompliance(
        pairs=between(relative),
        contact_columns=columns,
        input_rows=stored.input_rows,
        n_boundary=n_boundary,
        n_pattern=n_pattern,
    )


def _in_coordinates(stored: StoredCoordinates, joint: ReducedModel, entry: str) -> ReducedModel:
    """Return a reduced model from its matrices and the common part of all models.

    Without a stored residual compliance, this is R = P K⁻¹ Pᵀ − PΦ K_r⁻¹ (PΦ)ᵀ (M5).
    """
    n, M, K = len(stored.kinds), stored.mass, stored.stiffness
    places, dofs, loads = boundary_slices(joint.boundaries), stored.boundary, stored.pattern_forces
    check_distinct(dofs, f"{entry}/boundary")
    motions = np.zeros((n, 0)) if stored.rigid_motions is None else stored.rigid_motions
    if motions.shape[1] > 6:
        refuse_value(f"'{entry}/rigid_motions' has {motions.shape[1]} motions, expected 6 at most")
    check_definite(shifted(K, M @ motions), f"{entry}/stiffness")
    residual = restored(stored.residual_compliance)
    if residual is None and stored.compliance and joint.ports is not None:
        flexibility = factorize_relieved(K, M, motions).solve(np.eye(n))
        residual = plus(joint.ports.relative, stored.relative, -flexibility)
    bending, lacking = stored.bending or {}, stored.residual_bending or {}
    return replace(
        joint,
        M=M,
        C=stored.damping,
        K=K,
        contact=replace(
            joint.contact,
            relative_operator=frozen(stored.relative),
            residual_compliance=frozen(residual) if isinstance(residual, np.ndarray) else residual,
        ),
        boundaries={
            name: boundary.with_dofs(dofs[places[name]])
            for name, boundary in joint.boundaries.items()
        },
        bolts={
            name: replace(
                bolt,
                elongation=row,
                bending=bending.get(name),
                residual_bending=lacking.get(name),
            )
            for (name, bolt), row in zip(joint.bolts.items(), stored.elongations, strict=True)
        },
        basis=Basis(vectors=np.zeros((0, n)), kinds=tuple(map(ModeKind, stored.kinds))),
        load_patterns={
            name: replace(pattern, forces=row)
            for (name, pattern), row in zip(joint.load_patterns.items(), loads, strict=True)
        }
        if loads is not None
        else {},
        weak_supports=dict(stored.weak_supports or {}),
        rigid_motions=motions,
        recovery_inertia=stored.inertia_recovery,
        recovery_damping=stored.damping_recovery,
        invariants=stored.invariants,
    )


def _with_shapes(stored: StoredCoordinates, rom: ReducedModel) -> ReducedModel:
    """Add the trial vectors of a model in a file of its own, or its displacements of nodes."""
    n, vectors = len(rom.K), stored.trial_vectors
    mesh = replace(rom.mesh, columns=np.arange(n))
    if vectors is not None:
        rom = replace(rom, basis=Basis(vectors=vectors, kinds=rom.basis.kinds))
    if stored.translations is not None:
        mesh = replace(mesh, vectors=rom.basis.vectors, translations=stored.translations)
    if stored.nodal_shapes is not None:
        mesh = replace(mesh, vectors=stored.nodal_shapes.reshape(n, -1).T)
    return replace(rom, mesh=mesh)


def _law(parameters: Mapping[str, Any], entry: str) -> Law:
    """Return the contact law of an interface by its name and its parameters."""
    name = read_member(member(parameters, "law"), str, {})
    if name not in LAWS:
        refuse_value(f"{entry} names the contact law '{name}'; known are {', '.join(LAWS)}")
    values: dict[str, Any] = {}
    for parameter, hint in get_type_hints(LAWS[name]).items():
        value = member(parameters, parameter)
        inner = isinstance(value, Mapping)
        values[parameter] = (
            _law(value, f"{entry}/{parameter}") if inner else read_member(value, hint, {})
        )
    return LAWS[name](**values)


def _contact(stored: StoredPorts, interfaces: Mapping[str, ContactSurface]) -> Contact:
    records = list(interfaces.values())
    ends = np.cumsum([0, *(len(record.weights) for record in records)]).tolist()
    if [record.slice for record in records] != list(pairwise(ends)):
        refuse_value(f"the interfaces have {ends[-1]} points, their slices others")
    stated: dict[str, Any] = {}  # files of earlier versions contain less
    if stored.dense_budget is not None:
        stated["dense_budget"] = stored.dense_budget
    if stored.shear is not None:
        stated |= {"shear": stored.shear, "tangents": stored.tangents}
    return Contact(
        relative_operator=np.zeros((stored.interpolation.shape[1], 0)),
        interpolation=stored.interpolation,
        initial_gap=_concatenated(record.initial_gap for record in records),
        weights=_concatenated(record.weights for record in records),
        laws={name: recorded_law(record) for name, record in interfaces.items()},
        slices={name: slice(*record.slice) for name, record in interfaces.items()},
        **stated,
    )


def _concatenated(parts: Iterable[Matrix]) -> Matrix:
    return frozen(np.concatenate([*parts, np.empty(0)]))


def study_of(path: Path | str) -> str:
    """Return the text of the study that a reduced model in a file came from; empty if none.

    Raises
    ------
    FormatError
        As :func:`load`.
    """
    return _provenance(path).get("study", "")


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
    provenance = _provenance(path)
    if PRELOAD_PATH not in provenance:
        return None
    try:
        return [
            {str(name): float(force) for name, force in forces.items()}
            for forces in json.loads(provenance[PRELOAD_PATH])
        ]
    except (ValueError, TypeError, AttributeError) as error:
        message = f"{path}: /provenance/{PRELOAD_PATH} is not a list of bolt forces; {error}"
        raise FormatError(message) from None


def _provenance(path: Path | str) -> Mapping[str, str]:
    with described_file(Path(path), MODEL) as file:
        texts: Mapping[str, str] = read_member(
            member(file, "provenance"), Mapping[str, str], TABLES
        )
        return texts
