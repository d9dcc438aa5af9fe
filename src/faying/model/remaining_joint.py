"""Interfaces, bolts and boundaries of a source on what remains of its structure."""

from dataclasses import replace

import numpy as np

from faying.exceptions import ModelError
from faying.model.assembly import Assembly
from faying.model.description import JointDescription
from faying.model.specs import BoltSpec, BoundarySpec, Selection


def remaining_joint(
    described: JointDescription, assembly: Assembly, notes: list[str]
) -> JointDescription:
    """Return what the source says of the joint without what is no longer there.

    The assembly is what remains of the structure of the whole joint described; what goes is
    appended to the notes.

    Raises
    ------
    ModelError
        If a bolt remains in part.
    """
    whole = described.assembly
    interfaces = []
    for spec in described.interfaces:
        lost = [side for side in (spec.minus, spec.plus) if not _remains(side, whole, assembly)]
        if lost:
            notes.append(f"interface '{spec.name}'")
            continue
        interfaces.append(spec)
        for side in (spec.minus, spec.plus):
            faces = whole.face_sets.get(side) if isinstance(side, str) else None
            if faces is not None and isinstance(side, str):
                left = len(assembly.face_sets[side].nodes)
                if left < len(faces.nodes):
                    count = len(faces.nodes) - left
                    notes.append(f"{count} of {len(faces.nodes)} faces of '{side}' ({spec.name})")
    bolts = [bolt for bolt in described.bolts if _tightened(bolt, assembly)]
    notes += [f"bolt '{bolt.name}'" for bolt in described.bolts if bolt not in bolts]
    boundaries = [boundary for boundary in described.boundaries if _entered(boundary, assembly)]
    notes += [f"boundary '{b.name}'" for b in described.boundaries if b not in boundaries]
    named = {spec.name for spec in interfaces}
    tight = {bolt.name for bolt in bolts}
    selected = described.selected_load
    return replace(
        described,
        assembly=assembly,
        interfaces=tuple(interfaces),
        bolts=tuple(bolts),
        boundaries=tuple(boundaries),
        preloads={n: force for n, force in described.preloads.items() if n in tight},
        initial_forces={n: f for n, f in described.initial_forces.items() if n in tight},
        unlocked=described.unlocked & tight,
        initial_gaps={n: gap for n, gap in described.initial_gaps.items() if n in named},
        gap_rules={n: rule for n, rule in described.gap_rules.items() if n in named},
        selected_load=selected if selected in assembly.loads else None,
    )


def _remains(side: Selection, whole: Assembly, assembly: Assembly) -> bool:
    """Whether anything is left of a side that was there."""
    mesh = assembly.mesh
    if isinstance(side, str):
        named_sets = (whole.face_sets, whole.mesh.element_sets, whole.mesh.node_sets)
        left = (assembly.face_sets, mesh.element_sets, mesh.node_sets)
        return not any(side in sets for sets in named_sets) or any(side in sets for sets in left)
    if isinstance(side, int):
        return bool((mesh.element_properties == side).any() or (mesh.element_ids == side).any())
    return bool(np.isin(mesh.element_ids, np.array(side)).any())


def _tightened(bolt: BoltSpec, assembly: Assembly) -> bool:
    """Whether all elements of a bolt remain, and not some."""
    if bolt.elements is None:
        return True
    ids = {beam.id for beam in assembly.beams} | {spring.id for spring in assembly.springs}
    left = [number for number in bolt.elements if number in ids]
    if left and len(left) < len(bolt.elements):
        message = (
            f"bolt '{bolt.name}': {len(bolt.elements) - len(left)} of its {len(bolt.elements)} "
            "elements are left out by parts and without of [model]; keep or leave out all"
        )
        raise ModelError(message)
    return bool(left)


def _entered(boundary: BoundarySpec, assembly: Assembly) -> bool:
    if boundary.set is not None:
        return boundary.set in assembly.mesh.node_sets
    return True
