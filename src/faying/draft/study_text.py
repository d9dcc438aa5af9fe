"""The text of a first study: facts of the file, and marked lines that the user decides."""

import os
import re
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from faying.display.facts import MOST_SHOWN
from faying.draft.bolts import DIAMETER, WASHER, Hole, size_of
from faying.draft.model_file import ModelFile, Pin
from faying.interface.facing import Facing
from faying.interface.interface import Interface
from faying.model.bodies import body_names
from faying.study.keys.deck_study import quoted
from faying.study.keys.schema import EDITOR_SCHEMA
from faying.units import units_of

DECIDE = "DECIDE:"
"""Mark of the lines that an engineer must decide."""

STRAIN = 1.5e-3
"""Strain of the shank under a placeholder preload."""

GRADE = "8.8"
"""Placeholder for the property class of a bolt."""


@dataclass(frozen=True, kw_only=True)
class BoltEntry:
    """A ``[[bolt]]`` entry of the study.

    Attributes
    ----------
    keys
        TOML values of the keys beside name and preload.
    preload : [force] or None
        Placeholder; None where the deck gives the preload.
    """

    name: str
    keys: Mapping[str, str] = field(default_factory=dict)
    preload: float | None = None
    remark: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Findings:
    """What was found in a file, from which a first study is written.

    Attributes
    ----------
    faces
        Pairs of bodies that face each other, touching pairs first.
    active
        Number of the first faces that become interfaces.
    bolts, holes
        Bolts, and holes where further bolts may be.
    made
        Holes that get a bolt.
    held, pins
        Sets and nodes to hold where the file has no supports.
    loaded_set, loaded_node
        Set or node of the placeholder load of a file without loads.
    weak_springs
        Whether the model needs weak springs as supports.
    component, force
        Component and value of the placeholder load.
    """

    file: ModelFile
    faces: tuple[Facing, ...] = ()
    active: int = 0
    bolts: tuple[BoltEntry, ...] = ()
    holes: tuple[Hole, ...] = ()
    made: tuple[Hole, ...] = ()
    held: tuple[str, ...] = ()
    pins: tuple[Pin, ...] = ()
    loaded_set: str | None = None
    loaded_node: int | None = None
    weak_springs: bool = False
    component: str = "Fz"
    force: float = 1.0


def study_text(
    findings: Findings, target: Path, built: Mapping[str, Interface], problem: str = ""
) -> str:
    """Return the text of the study at a target path.

    Comments state areas and gaps of the interfaces that were built, or the problem because of
    which the study does not run yet.
    """
    lines = [f"#:schema {EDITOR_SCHEMA.as_uri()}"]
    lines += _comment(
        f"Begun by faying init from {findings.file.path.name}. What the file leaves open is marked "
        f"with the word {DECIDE[:-1]}: search for it, decide, and delete the mark. faying check "
        f"{target.name} shows how the study is read, faying run {target.name} computes it."
    )
    if problem:
        lines += _comment(f"{DECIDE} it does not run yet: {problem}")
    sections: tuple[Iterable[str], ...] = (
        _head(findings, target),
        _materials(findings.file),
        _interfaces(findings, built),
        _bolts(findings),
        _held(findings),
        _loads(findings),
        _rest(findings),
    )
    for section in sections:
        lines += ["", *section]
    text = "\n".join(lines) + "\n"
    return re.sub(r"\n{3,}", "\n\n", text)


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in textwrap.wrap(text, 96, break_long_words=False)]


def _head(findings: Findings, target: Path) -> Iterator[str]:
    file, mesh = findings.file, findings.file.mesh
    yield f"title = {quoted(file.path.stem)}"
    suits = "fits its materials or size" if file.suits else "none tried fits its materials"
    yield f'units = "{file.units}"  # {DECIDE} the file does not say; {suits}'
    yield ""
    yield "[model]"
    yield f'source = "{file.source}"'
    yield f"file = {quoted(_relative(file.path, target))}"
    if file.ignore:
        yield f"ignore = [{', '.join(map(quoted, file.ignore))}]"
    if file.separate:
        names = ", ".join(map(quoted, file.separate))
        yield f"separate = [{names}]  # {DECIDE} parts that touch; they share nodes in the mesh"
    if findings.weak_springs:
        why = "only contact and friction hold some body; add a support if that is not intended"
        yield f'weak_springs = "auto"  # {DECIDE} {why}'
    parts = [quoted(name) for name in body_names(mesh)]
    extent = " × ".join(f"{size:.4g}" for size in np.ptp(mesh.nodes, axis=0).tolist())
    count = f"{len(parts)} bodies" if len(parts) != 1 else "one body"
    shown = ", ".join(parts[:20]) + (", …" if len(parts) > 20 else "")
    yield from _comment(f"{count}: {shown}; {mesh.n_elements} solids; {extent} over all")


def _relative(path: Path, target: Path) -> str:
    try:
        return Path(os.path.relpath(path.resolve(), target.resolve().parent)).as_posix()
    except ValueError:  # another drive
        return path.resolve().as_posix()


def _materials(file: ModelFile) -> Iterator[str]:
    if file.stand_in is not None:
        yield f"[material.{file.stand_in.name}]  # {DECIDE} the mesh has none; this is steel"
        yield f"E = {_number(file.stand_in.youngs_modulus)}"
        yield f"nu = {_number(file.stand_in.poissons_ratio)}"
        yield f"rho = {_number(file.stand_in.density)}"
        return
    constants = [
        f"{solid.name or number}: E {solid.youngs_modulus:g}, nu {solid.poissons_ratio:g}, "
        f"rho {solid.density:g}"
        for number, solid in file.described.assembly.materials.items()
    ]
    shown = "; ".join(list(dict.fromkeys(constants))[:10])
    if shown:
        yield from _comment(f"Materials of the file, which [material.NAME] overrides: {shown}")


def _interfaces(findings: Findings, built: Mapping[str, Interface]) -> Iterator[str]:
    declared = findings.file.described.interfaces
    if declared:
        yield "# Contact the file declares; an [[interface]] of the same name overrides its keys."
        for spec in declared:
            yield from _comment(
                f"  {spec.name}: minus {spec.minus}, plus {spec.plus}{_facts(spec.name, built)}"
            )
        return
    names = body_names(findings.file.mesh)
    if not findings.faces:
        yield from _comment(f"{DECIDE} no faces of different bodies face each other: no interface")
    if findings.file.described.has_joined_faces and findings.faces:
        yield from _comment(
            f"{DECIDE} the file has ties or cut bolts, so the faces below may be joined already"
        )
    for number, face in enumerate(findings.faces):
        name = "joint" if findings.active == 1 and number == 0 else f"joint-{number + 1}"
        gap = f"gap {face.gap[0]:.3g} to {face.gap[1]:.3g}"
        off = "" if number < findings.active else "# "
        if off:
            yield from _comment(f"{DECIDE} also near each other, area {face.area:.5g}, {gap}:")
        yield f"{off}[[interface]]"
        yield f"{off}name = {quoted(name)}" + ("" if off else _trailing(name, built))
        yield f"{off}minus = {quoted(_body(names, findings, face.minus))}"
        yield f"{off}plus = {quoted(_body(names, findings, face.plus))}"
        if not face.matching:
            yield f'{off}meshes = "non-matching"'
        if not face.touching:
            yield f"{off}search_distance = {_number(1.01 * face.gap[1])}  # {DECIDE} {gap}"
        if not off:
            yield 'penalty = "auto"  # or "hard", or a number'
        yield ""


def _body(names: Sequence[str], findings: Findings, number: int) -> str:
    """Return the selection of a body: the name of its set, or its number."""
    name = names[number]
    used = {*findings.file.described.assembly.face_sets, *findings.file.mesh.node_sets}
    return f"body {number}" if name in used else name


def _facts(name: str, built: Mapping[str, Interface]) -> str:
    interface = built.get(name)
    if interface is None:
        return ""
    smallest, largest = float(interface.initial_gap.min()), float(interface.initial_gap.max())
    return f"; area {interface.area:.5g}, gap {smallest:.3g} to {largest:.3g}, {interface.law.name}"


def _trailing(name: str, built: Mapping[str, Interface]) -> str:
    return f"  # {_facts(name, built)[2:]}" if name in built else ""


def _bolts(findings: Findings) -> Iterator[str]:
    described = findings.file.described
    for spec in described.bolts:
        for kind, forces in (
            ("preload", described.preloads),
            ("initial_force", described.initial_forces),
        ):
            if spec.name in forces:
                yield from _comment(
                    f"Bolt of the file: {spec.name}, {kind} {forces[spec.name]:g}; a [[bolt]] of "
                    f"that name with another {kind} overrides it"
                )
    if findings.made:
        measures = (
            f"their diameter is {DIAMETER:g} of the hole's, the radius of washers {WASHER:g} of it"
            if size_of(findings.made[0], findings.file.units) is None
            else "clearance holes of ISO 273; heads are hexagons unless 'head' says otherwise"
        )
        yield from _comment(
            f"{DECIDE} bolts are made for holes in line, of radius {findings.made[0].radius:.4g}: "
            f"{measures}"
        )
    for bolt in findings.bolts:
        yield "[[bolt]]"
        yield f"name = {quoted(bolt.name)}" + (f"  # {bolt.remark}" if bolt.remark else "")
        for key, value in bolt.keys.items():
            yield f"{key} = {value}"
        if bolt.preload is not None:
            text = f"a placeholder, {STRAIN:.2%} strain of the shank" if bolt.preload else "unknown"
            yield f"preload = {_number(bolt.preload)}  # {DECIDE} {text}"
        yield ""
    for hole in findings.holes:
        said = (
            f"holes of several bodies in line, radius {hole.radius:.4g}, not tightened; a bolt "
            "there would be"
        )
        if hole.filled:
            said = (
                f"a shank of solids in a hole, radius {hole.radius:.4g}, and nothing tightens it: "
                "a pretension section of an Abaqus deck does, or leave the shank out of the mesh "
                "and take"
            )
        yield from _comment(f"{DECIDE} {said}")
        for key, value in hole_keys(hole, findings.file.units).items():
            yield f"#   {key} = {value}"
    if not (described.bolts or findings.bolts or findings.holes):
        yield from _comment(f"{DECIDE} no bolt was found; [[bolt]] tightens beams, or makes one")


def hole_keys(hole: Hole, units: str) -> dict[str, str]:
    """Return the study keys of a bolt in a hole, with their TOML values."""
    size = size_of(hole, units)
    # The fitted cylinder has more digits than the drawing.
    places = np.round(hole.ends, 4 - int(np.floor(np.log10(hole.radius)))) + 0.0
    ends = ", ".join(f"[{', '.join(map(_number, end))}]" for end in places.tolist())
    if size is not None:
        grade = f"{quoted(GRADE)}  # {DECIDE} a placeholder, by which its strength is judged"
        return {"axis": f"[{ends}]", "size": quoted(size), "grade": grade}
    return {
        "axis": f"[{ends}]",
        "diameter": _number(DIAMETER * 2 * hole.radius),
        "washer_radius": _number(WASHER * hole.radius),
    }


def _number(value: float) -> str:
    """Return a number of seven digits as TOML."""
    text = f"{value:.7g}"
    return text if set(text) & set(".en") else f"{text}.0"


def _held(findings: Findings) -> Iterator[str]:
    mesh, supports = findings.file.mesh, findings.file.described.assembly.supports
    if supports:
        count = len(np.unique(np.concatenate([support.nodes for support in supports])))
        yield from _comment(f"The file holds {count} nodes; [[support]] holds more")
    for name in findings.held:
        yield "[[support]]"
        yield f"set = {quoted(name)}  # {DECIDE} held because of its name alone"
        yield ""
    if findings.pins:
        sets = ", ".join(map(quoted, [*mesh.node_sets][:12])) or "none"
        yield from _comment(
            f"{DECIDE} the file has no supports. These three nodes hold the largest body in place "
            f"without constraining its strain; hold a set instead (sets: {sets})"
        )
    for pin in findings.pins:
        yield "[[support]]"
        yield f"node = {pin.node}"
        yield f"components = [{', '.join(map(quoted, pin.components))}]"
        yield ""


def _loads(findings: Findings) -> Iterator[str]:
    described = findings.file.described
    loads = [*described.assembly.loads]
    if described.selected_load in loads:
        loads.sort(key=lambda name: name != described.selected_load)
    for name in loads[:MOST_SHOWN]:
        yield "[[load_case]]"
        case = name if name.startswith("step") else f"load {name}"
        yield f"name = {quoted(case)}"
        yield 'kind = "static"'
        yield f"forces = [{{ deck_load = {quoted(name)}, value = 1.0 }}]"
        yield ""
    if len(loads) > MOST_SHOWN:
        more = ", ".join(map(quoted, loads[MOST_SHOWN:][:20]))
        yield from _comment(f"{DECIDE} loads of the file without a load case: {more}")
    if loads or (findings.loaded_set is None and findings.loaded_node is None):
        return
    yield "[[boundary]]"
    yield 'name = "load"'
    if findings.loaded_set is not None:
        yield f"set = {quoted(findings.loaded_set)}  # {DECIDE} where the load enters"
        yield 'coupling = "rbe3"'
    else:
        yield f"node = {findings.loaded_node}  # {DECIDE} where the load enters"
    yield ""
    yield "[[load_case]]"
    yield 'name = "load"'
    yield 'kind = "static"'
    force = (
        f'boundary = "load", component = "{findings.component}", value = {_number(findings.force)}'
    )
    yield f"forces = [{{ {force} }}]  # {DECIDE} a placeholder"


def _rest(findings: Findings) -> Iterator[str]:
    yield "[reduction]"
    yield "normal_modes = 10"
    yield 'methods = ["compliance"]'
    yield ""
    yield from _comment(
        f"{DECIDE} requirements on the joint in every load case; faying run exits with status 3 "
        "where one is not met"
    )
    units = units_of(findings.file.units)
    yield "# [requirement]"
    yield f"# min_clamp_force = ?  # [{units.force}]"
    yield f"# max_pressure = ?  # [{units.pressure}]"
    yield f"# max_nodal_pressure = ?  # [{units.pressure}]"
    yield f"# no_opening_within = ?  # of the axis of every bolt [{units.length}]"
    yield "# slip_friction = ?  # of faying surfaces, by which slip is judged"
