"""The text of a first study of a deck or mesh, which runs where the file allows it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from faying._typing import Indices, Mask, Vector
from faying.digits import DECK_DIGITS
from faying.draft.bolts import Hole, bolt_diameter, clamping_lines, holes_in_line, pattern
from faying.draft.cylinders import cylinders
from faying.draft.model_file import (
    HELD,
    LOADED,
    ModelFile,
    far_node,
    loose_groups,
    named,
    pins,
    read_model_file,
)
from faying.draft.study_text import (
    DECIDE,
    STRAIN,
    BoltEntry,
    Findings,
    hole_keys,
    study_text,
)
from faying.exceptions import FayingError, ModelError
from faying.interface.facing import facing_bodies
from faying.interface.interface import Interface
from faying.joint.diagnosis import REMEDY
from faying.model.assembly import Assembly, Beam
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES
from faying.model.constraints import movable_components
from faying.model.deck_bolt import bolt_axis_element, bolt_direction
from faying.model.matrices import used_components
from faying.model.specs import BoltSpec
from faying.model.supports import nodes_of_set, with_held_nodes
from faying.study.inputs.load_model import build
from faying.study.keys.schema import parse_study

LOAD_SHARE = 0.05
"""Placeholder load of a file without loads, over the sum of the preloads."""

Direction = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class FirstStudy:
    """The text of a first study.

    Attributes
    ----------
    undecided
        Number of lines marked for a decision of the user.
    problem
        Why the study does not run yet; empty where it runs.
    """

    text: str
    undecided: int
    problem: str


def first_study(path: Path, target: Path, ignore: Sequence[str] = ()) -> FirstStudy:
    """Return a first study of a deck or mesh.

    The target is the path of the study file, to which its paths are relative. Keywords and cards
    in ``ignore`` are left out of the model.

    Notes
    -----
    The model of the study is built as a check, and to state areas and gaps. It is built again
    with weak springs where the first attempt asks for them.
    """
    findings = _findings(read_model_file(path, ignore))
    built, problem = _try_to_build(study_text(findings, target, {}), target)
    if REMEDY in problem:
        supported = replace(findings, weak_springs=True)
        joints, remaining = _try_to_build(study_text(supported, target, {}), target)
        if not remaining:
            findings, built, problem = supported, joints, ""
    text = study_text(findings, target, built, problem)
    return FirstStudy(text=text, undecided=text.count(DECIDE), problem=problem)


def _try_to_build(text: str, target: Path) -> tuple[Mapping[str, Interface], str]:
    """Build the model of a study; return its interfaces, or the message why that failed."""
    try:
        return build(parse_study(text, target)).interfaces, ""
    except FayingError as error:
        return {}, str(error)


def _findings(file: ModelFile) -> Findings:
    """Return likely interfaces, bolts, supports and loads where the file states none."""
    described, assembly = file.described, file.described.assembly
    faces = facing_bodies(assembly)
    faces.sort(key=lambda face: (not face.touching, -face.area))
    touching = sum(face.touching for face in faces)
    active = 0 if described.has_joined_faces else touching or len(faces)
    contact = np.unique(np.concatenate([np.empty(0, np.int64), *(face.nodes for face in faces)]))
    bolts, holes, new_bolts, along = _bolts(file, [np.array(face.normal) for face in faces])
    findings = Findings(
        file=file,
        faces=tuple(faces),
        active=0 if described.interfaces else active,
        bolts=tuple(bolts),
        holes=tuple(holes),
        made=tuple(new_bolts),
    )
    if not assembly.supports:
        names = named(assembly.mesh, HELD)
        findings = replace(
            findings, held=tuple(names), pins=() if names else tuple(pins(assembly, contact))
        )
    across = faces[0].normal if faces else (0.0, 0.0, 1.0)
    return findings if assembly.loads else _with_load(findings, contact, along or across)


def _bolts(
    file: ModelFile, normals: Sequence[Vector]
) -> tuple[list[BoltEntry], list[Hole], list[Hole], Direction | None]:
    """Return bolts, holes without a bolt, holes that get a bolt, and the direction of a bolt."""
    described, assembly = file.described, file.described.assembly
    if described.bolts:
        preloaded = {*described.preloads, *described.initial_forces}
        untold = [bolt for bolt in described.bolts if bolt.name not in preloaded]
        entries = [BoltEntry(name=b.name, preload=_shank_preload(assembly, b)) for b in untold]
        return entries, [], [], _pointing(assembly, described.bolts[0])
    entries, specs = [], []
    for number, line in enumerate(clamping_lines(assembly, normals), start=1):
        specs.append(BoltSpec(name=f"bolt-{number}", elements=line.elements))
        entries.append(
            BoltEntry(
                name=specs[-1].name,
                keys={"elements": f"[{', '.join(map(str, line.elements))}]"},
                preload=_shank_preload(assembly, specs[-1]),
                remark=f"{'spring' if line.spring else 'beam'} that holds bodies together",
            )
        )
    holes = holes_in_line(cylinders(assembly.mesh))
    if specs:
        return entries, holes, [], _pointing(assembly, specs[0])
    # Where shanks are meshed with solids, empty holes are bores.
    empty = [] if any(bolt.filled for bolt in holes) else pattern(holes)
    strained = STRAIN * _modulus(assembly)
    for number, hole in enumerate(empty, start=1):
        entries.append(
            BoltEntry(
                name=f"bolt-{number}" if len(empty) > 1 else "bolt",
                keys=hole_keys(hole, file.units),
                preload=strained * np.pi / 4 * bolt_diameter(hole, file.units) ** 2,
            )
        )
    along = _vector(np.array(empty[0].ends[1]) - empty[0].ends[0]) if empty else None
    return entries, [bolt for bolt in holes if bolt not in empty], empty, along


def _pointing(assembly: Assembly, spec: BoltSpec) -> Direction:
    return _vector(bolt_direction(assembly, spec))


def _vector(values: Vector) -> Direction:
    x, y, z = values.tolist()
    return x, y, z


def _modulus(assembly: Assembly) -> float:
    materials = list(assembly.materials.values())
    return materials[0].youngs_modulus if materials else 1.0


def _shank_preload(assembly: Assembly, spec: BoltSpec) -> float:
    """Return a placeholder preload from a strain of the shank; 0 for a spring."""
    try:
        cut = bolt_axis_element(assembly, spec)
    except ModelError:
        return 0.0
    if isinstance(cut, Beam):
        return STRAIN * cut.section.area * cut.material.youngs_modulus
    return 0.0


def _with_load(findings: Findings, contact: Indices, along: Direction) -> Findings:
    """Add a set or node for a load, and a force that is small against the preloads."""
    file, assembly = findings.file, findings.file.described.assembly
    mesh = assembly.mesh
    preloads = [
        *file.described.preloads.values(),
        *(entry.preload or 0.0 for entry in findings.bolts),
    ]
    extent = float(np.ptp(mesh.nodes, axis=0).max())
    # Without bolts: a strain of a millionth over the extent squared.
    force = LOAD_SHARE * sum(preloads) or DECK_DIGITS * _modulus(assembly) * extent**2
    by_name = [
        entry
        for entry in named(mesh, LOADED)
        # One or two nodes do not determine the motion of a face.
        if entry not in findings.held and len(mesh.node_sets[entry]) > 2
    ]
    free = _movable(findings)
    # The surface of a cut through a bolt has the bolt's name.
    used = [*findings.held, *(entry.name for entry in file.described.bolts)]
    sets = [
        entry
        for entry in (*by_name, *loose_groups(assembly, used, contact))
        if free[nodes_of_set(assembly, entry)].any()
    ]
    fixed = np.union1d(_held_nodes(findings), np.flatnonzero(~free.any(axis=1)))
    node = None if sets else far_node(assembly, fixed, contact)
    nodes = nodes_of_set(assembly, sets[0]) if sets else np.empty(0, dtype=np.int64)
    nodes = mesh.node_index(np.array([node])) if node is not None else nodes
    reach = np.abs(along) + 2.0 * free[nodes].any(axis=0)
    return replace(
        findings,
        loaded_set=sets[0] if sets else None,
        loaded_node=node,
        component=FORCE_NAMES[int(reach.argmax())],
        force=force,
    )


def _movable(findings: Findings) -> Mask:
    """Return which translations (n_node, 3) can be loaded; all where constraints contradict."""
    assembly, mesh = findings.file.described.assembly, findings.file.mesh
    fixed = [(nodes_of_set(assembly, name), [*range(6)]) for name in findings.held]
    for pin in findings.pins:
        components = [DISPLACEMENT_NAMES.index(name) for name in pin.components]
        fixed.append((mesh.node_index(np.array([pin.node])), components))
    assembly = with_held_nodes(assembly, fixed)
    try:
        movable = movable_components(assembly, used_components(assembly))
    except FayingError:
        return np.ones((len(mesh.nodes), 3), dtype=bool)
    return movable.reshape(-1, 6)[:, :3]


def _held_nodes(findings: Findings) -> Indices:
    mesh, supports = findings.file.mesh, findings.file.described.assembly.supports
    nodes = [mesh.node_sets[name] for name in findings.held]
    nodes += [support.nodes for support in supports]
    nodes += [mesh.node_index(np.array([pin.node])) for pin in findings.pins]
    return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *nodes]))
