"""Writing of reduced models to HDF5: one to a file of its own, or those of a run to its results.

Both have the compliance of the full model under ``/ports`` and matrices in the coordinates under
``/reduced``; :mod:`faying.reduction.model_fields` explains each entry. A file of its own restores
the same numbers to the last bit and so holds the residual compliance too; for the models of a run
this is computed from the compliance of the ports.
"""

import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from faying._typing import Indices, Matrix
from faying.contact.between_pairs import ByCompliance, BySubstitution
from faying.contact.laws import Law
from faying.files.described import Format, new_file, new_group, write_members
from faying.files.meanings import Meaning
from faying.joint.load_pattern import pattern_forces
from faying.joint.system import PortCompliance, boundary_dofs, elongations
from faying.reduction.model_data import ModelData
from faying.reduction.model_fields import (
    COORDINATES,
    OWN_COORDINATES,
    OWN_PORTS,
    OWN_ROOT,
    PORTS,
    TABLES,
)
from faying.reduction.stored_compliance import stored
from faying.units import Units

MODEL = Format(
    name="reduced model",
    version=1,
    wanted="a file that faying reduce or ReducedModel.save wrote",
    remedy="save the model again",
    description=(
        "A jointed structure in a few generalized coordinates, with its contact and what recovers "
        "the contact pressures of the full finite element model. Gaps are positive where open."
    ),
)

MOST_PORTS = 4096
"""Most ports with a stored compliance in results: 134 MB."""

_PORTS = Meaning("the joint as seen through its ports, for recovery and export")
_REDUCED = Meaning("the reduced model in its coordinates")
_MODELS = Meaning("reduced models: method name, then number of joint modes")
_SHAPES = Meaning(
    "displacements of all nodes per coordinate q, each shape once", "1", "(n_shape, n_node, 3)"
)


def write_model(rom: ModelData, path: Path, *, shapes: bool, provenance: Mapping[str, str]) -> None:
    """Write one reduced model, as :meth:`ReducedModel.save`."""
    units = rom.unit_set
    root = {
        "name": rom.name,
        "method": rom.method,
        "units": rom.units,
        "nodes": rom.mesh.nodes,
        "node_ids": rom.mesh.node_ids,
        "blocks": tuple(rom.mesh.blocks),
        "interfaces": rom.interfaces,
        "laws": {name: _law(law) for name, law in rom.contact.laws.items()},
        "period": rom.period,
        "bolts": {name: {"initial_force": bolt.initial_force} for name, bolt in rom.bolts.items()},
        "bolt_ends": {n: bolt.ends for n, bolt in rom.bolts.items() if bolt.ends is not None},
        "provenance": {
            "python": platform.python_version(),
            "numpy": np.__version__,
            "date": datetime.now(UTC).isoformat(timespec="seconds"),
            **provenance,
        },
    }
    title = f"{rom.name}, {rom.method}"
    attributes = {"title": title, "units": rom.units, "model": rom.name, "method": rom.method}
    with new_file(path, MODEL, attributes, units) as file:
        write_members(file, root, OWN_ROOT, units, TABLES)
        ports = new_group(file, "ports", _PORTS)
        write_members(ports, _port_members(rom), {**PORTS, **OWN_PORTS}, units, TABLES)
        reduced = new_group(file, "reduced", _REDUCED)
        members = {**_members(rom, None), **_own_members(rom, shapes=shapes)}
        write_members(reduced, members, {**COORDINATES, **OWN_COORDINATES}, units, TABLES)


def write_models(
    file: h5py.File, models: Mapping[str, Mapping[int, ModelData]], units: Units
) -> None:
    """Write the reduced models of a run into its results."""
    everyone = [rom for sizes in models.values() for rom in sizes.values()]
    if not everyone:
        return
    ports = everyone[0].ports
    if (
        ports is not None
        and ports.n_port <= MOST_PORTS
        and not isinstance(ports.pairs, BySubstitution)
    ):
        group = new_group(file, "ports", _PORTS)
        write_members(group, _port_members(everyone[0]), PORTS, units, TABLES)
    nodal = [rom.mesh for rom in everyone if rom.mesh.translations is None]
    shapes = next((mesh.vectors for mesh in nodal if mesh.vectors is not None), None)
    reduced = new_group(file, "reduced", _MODELS)
    for method, sizes in models.items():
        inner = new_group(reduced, method, _MODELS)
        for count, rom in sizes.items():
            columns = None if shapes is None or rom.mesh.vectors is not shapes else rom.mesh.columns
            entry = new_group(inner, str(count), _REDUCED)
            write_members(entry, _members(rom, columns), COORDINATES, units)
    if shapes is not None:
        nodal_shapes = shapes.T.reshape(-1, len(everyone[0].mesh.nodes), 3)
        write_members(file, {"shapes": nodal_shapes}, {"shapes": _SHAPES}, units)


def _law(law: Law) -> dict[str, Any]:
    """Return name and parameters of a law; a parameter may be a law itself."""
    parameters = {
        name: _law(value) if hasattr(value, "admissible") else value
        for name, value in vars(law).items()
    }
    return {"law": law.name, **parameters}


def _port_compliance(ports: PortCompliance | None) -> dict[str, Any]:
    """Return the members of :data:`PORTS` and :data:`OWN_PORTS` that make up the compliance."""
    names = "compliance", "relative_stiffness", "relative_compliance", "contact_columns"
    none = dict.fromkeys((*names, "input_rows"))
    if ports is None:
        return none
    if not isinstance(ports.pairs, BySubstitution):
        known = ports.pairs.known if isinstance(ports.pairs, ByCompliance) else None
        stiffness = None if known is None else known.stiffness
        return {**none, "compliance": ports.whole, "relative_stiffness": stiffness}
    return {
        **none,
        "relative_compliance": stored(ports.pairs.total),
        "contact_columns": ports.contact_columns,
        "input_rows": ports.input_rows,
    }


def _port_members(rom: ModelData) -> dict[str, Any]:
    return {
        **_port_compliance(rom.ports),
        "interpolation": rom.contact.interpolation,
        "boundaries": rom.boundaries,
        "bolt_stiffness": {name: float(bolt.stiffness) for name, bolt in rom.bolts.items()},
        "frame_recovery": rom.recovery_frame,
        "load_patterns": tuple(rom.load_patterns),
        "pattern_bolt_forces": _bolts_of_patterns(rom),
        "shear": rom.contact.shear,
        "tangents": rom.contact.tangents,
        "tangential": rom.tangential or None,
        "dense_budget": rom.contact.dense_budget,
    }


def _bolts_of_patterns(rom: ModelData) -> Matrix | None:
    """Return bolt forces per load pattern (n_pattern, n_bolt); None if all vanish."""
    rows = [
        [pattern.bolt_forces.get(bolt, 0.0) for bolt in rom.bolts]
        for pattern in rom.load_patterns.values()
    ]
    return np.array(rows) if any(map(any, rows)) else None


def _members(rom: ModelData, shapes: Indices | None) -> dict[str, Any]:
    n = len(rom.K)
    return {
        "kinds": tuple(kind.value for kind in rom.basis.kinds),
        "mass": rom.M,
        "damping": rom.C,
        "stiffness": rom.K,
        "relative": np.asarray(rom.contact.relative_operator),
        "elongations": elongations(rom.bolts, n),
        "boundary": boundary_dofs(rom.boundaries),
        "inertia_recovery": rom.recovery_inertia,
        "damping_recovery": rom.recovery_damping,
        "compliance": rom.contact.residual_compliance is not None,
        "shapes": shapes,
        "invariants": rom.invariants,
        "rigid_motions": rom.rigid_motions if rom.rigid_motions.shape[1] else None,
        "pattern_forces": pattern_forces(rom.load_patterns, n) if rom.load_patterns else None,
    }


def _own_members(rom: ModelData, *, shapes: bool) -> dict[str, Any]:
    mesh, vectors = rom.mesh, rom.basis.vectors
    return {
        "residual_compliance": stored(rom.contact.residual_compliance),
        "trial_vectors": vectors if shapes and len(vectors) else None,
        "translations": mesh.translations if shapes else None,
        "bending": _moments({name: bolt.bending for name, bolt in rom.bolts.items()}),
        "residual_bending": _moments(
            {name: bolt.residual_bending for name, bolt in rom.bolts.items()}
        ),
        "weak_supports": rom.weak_supports or None,
        "nodal_shapes": mesh.modes if shapes and mesh.translations is None else None,
    }


def _moments(rows: Mapping[str, Any]) -> dict[str, Matrix] | None:
    """Return the rows that exist, by bolt; None without any."""
    return {name: np.asarray(row) for name, row in rows.items() if row is not None} or None
