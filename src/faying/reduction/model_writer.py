"""Writing of reduced models to HDF5: one to a file of its own, or those of a run to its results."""

import platform
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from faying._typing import Indices, Matrix
from faying.contact.between_pairs import ByCompliance, BySubstitution
from faying.contact.laws import Law
from faying.files.described import new_file, write_members
from faying.joint.load_pattern import pattern_forces
from faying.joint.system import boundary_dofs, elongations
from faying.reduction.model_data import MeshShapes, ModelData
from faying.reduction.stored_compliance import stored
from faying.reduction.stored_model import (
    MODEL,
    OWN_PORTS,
    TABLES,
    StoredBoundary,
    StoredCoordinates,
    StoredModel,
    StoredModels,
    StoredPorts,
)
from faying.units import Units

MOST_PORTS = 4096
"""Most ports with a stored compliance in results: 134 MB."""


def write_model(rom: ModelData, path: Path, *, shapes: bool, provenance: Mapping[str, str]) -> None:
    """Write one reduced model, as :meth:`ReducedModel.save`."""
    units, mesh, vectors = rom.unit_set, rom.mesh, rom.basis.vectors
    bolts = rom.bolts.items()
    stored_model = StoredModel(
        name=rom.name,
        method=rom.method,
        units=rom.units,
        nodes=mesh.nodes,
        node_ids=mesh.node_ids,
        blocks=tuple(mesh.blocks),
        interfaces=rom.interfaces,
        laws={name: _law(law) for name, law in rom.contact.laws.items()},
        period=rom.period,
        bolts={name: {"initial_force": bolt.initial_force} for name, bolt in bolts},
        bolt_ends={name: bolt.ends for name, bolt in bolts if bolt.ends is not None},
        provenance={
            "python": platform.python_version(),
            "numpy": np.__version__,
            "date": datetime.now(UTC).isoformat(timespec="seconds"),
            **provenance,
        },
        ports=_ports(rom),
        reduced=replace(
            _coordinates(rom),
            residual_compliance=stored(rom.contact.residual_compliance),
            trial_vectors=vectors if shapes and len(vectors) else None,
            translations=mesh.translations if shapes else None,
            bending=_moments({name: bolt.bending for name, bolt in bolts}),
            residual_bending=_moments({name: bolt.residual_bending for name, bolt in bolts}),
            weak_supports=rom.weak_supports or None,
            nodal_shapes=mesh.modes if shapes and mesh.translations is None else None,
        ),
    )
    title = f"{rom.name}, {rom.method}"
    attributes = {"title": title, "units": rom.units, "model": rom.name, "method": rom.method}
    with new_file(path, MODEL, attributes, units) as file:
        write_members(file, stored_model, units, TABLES)


def write_models(
    file: h5py.File, models: Mapping[str, Mapping[int, ModelData]], units: Units
) -> None:
    """Write the reduced models of a run into its results."""
    everyone = [rom for sizes in models.values() for rom in sizes.values()]
    if not everyone:
        return
    ports = everyone[0].ports
    formed = ports is not None and not isinstance(ports.pairs, BySubstitution)
    few = formed and ports is not None and ports.n_port <= MOST_PORTS
    nothing: dict[str, Any] = dict.fromkeys(OWN_PORTS)
    nodal = [rom.mesh for rom in everyone if rom.mesh.translations is None]
    shapes = next((mesh.vectors for mesh in nodal if mesh.vectors is not None), None)
    run = StoredModels(
        ports=replace(_ports(everyone[0]), **nothing) if few else None,
        reduced={
            method: {
                count: replace(_coordinates(rom), shapes=_columns(rom.mesh, shapes))
                for count, rom in sizes.items()
            }
            for method, sizes in models.items()
        },
        shapes=None if shapes is None else shapes.T.reshape(-1, len(everyone[0].mesh.nodes), 3),
    )
    write_members(file, run, units, TABLES)


def _columns(mesh: MeshShapes, shapes: Matrix | None) -> Indices | None:
    """Return which of the shapes of a run a model has; None where it has others."""
    return None if shapes is None or mesh.vectors is not shapes else mesh.columns


def _law(law: Law) -> dict[str, Any]:
    """Return name and parameters of a law; a parameter may be a law itself."""
    parameters = {
        name: _law(value) if hasattr(value, "admissible") else value
        for name, value in vars(law).items()
    }
    return {"law": law.name, **parameters}


def _ports(rom: ModelData) -> StoredPorts:
    """Return the full model at its ports, with the compliance that was formed, or its factors."""
    contact, ports = rom.contact, rom.ports
    pairs = None if ports is None else ports.pairs
    solved = ports if isinstance(pairs, BySubstitution) else None
    known = pairs.known if isinstance(pairs, ByCompliance) else None
    return StoredPorts(
        compliance=None if ports is None or solved else ports.whole,
        interpolation=contact.interpolation,
        boundaries={
            name: StoredBoundary(nodes=boundary.nodes, components=boundary.components)
            for name, boundary in rom.boundaries.items()
        },
        bolt_stiffness={name: float(bolt.stiffness) for name, bolt in rom.bolts.items()},
        frame_recovery=rom.recovery_frame,
        load_patterns=tuple(rom.load_patterns),
        pattern_bolt_forces=_bolts_of_patterns(rom),
        shear=contact.shear,
        tangents=contact.tangents,
        relative_stiffness=None if known is None else known.stiffness,
        relative_compliance=stored(pairs.total) if isinstance(pairs, BySubstitution) else None,
        contact_columns=None if solved is None else solved.contact_columns,
        input_rows=None if solved is None else solved.input_rows,
        tangential=rom.tangential or None,
        dense_budget=contact.dense_budget,
    )


def _bolts_of_patterns(rom: ModelData) -> Matrix | None:
    """Return bolt forces per load pattern (n_pattern, n_bolt); None if all vanish."""
    rows = [
        [pattern.bolt_forces.get(bolt, 0.0) for bolt in rom.bolts]
        for pattern in rom.load_patterns.values()
    ]
    return np.array(rows) if any(map(any, rows)) else None


def _coordinates(rom: ModelData) -> StoredCoordinates:
    """Return a model in its coordinates, without members of a file of its own."""
    n = len(rom.K)
    return StoredCoordinates(
        kinds=tuple(kind.value for kind in rom.basis.kinds),
        mass=rom.M,
        damping=rom.C,
        stiffness=rom.K,
        relative=np.asarray(rom.contact.relative_operator),
        elongations=elongations(rom.bolts, n),
        boundary=boundary_dofs(rom.boundaries),
        inertia_recovery=rom.recovery_inertia,
        damping_recovery=rom.recovery_damping,
        compliance=rom.contact.residual_compliance is not None,
        invariants=rom.invariants,
        rigid_motions=rom.rigid_motions if rom.rigid_motions.shape[1] else None,
        pattern_forces=pattern_forces(rom.load_patterns, n) if rom.load_patterns else None,
    )


def _moments(rows: Mapping[str, Any]) -> dict[str, Matrix] | None:
    """Return the rows that exist, by bolt; None without any."""
    return {name: np.asarray(row) for name, row in rows.items() if row is not None} or None
