"""Write a joint as an input deck for CalculiX, with contact and bolts."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import count
from os import PathLike

import numpy as np

from faying._typing import Indices
from faying.exceptions import refuse
from faying.io.abaqus.written_nodes import (
    Term,
    WrittenNodes,
    equation_terms,
    held,
    real_text,
    rotation_coordinates,
    written_equations,
    written_nodes,
)
from faying.io.abaqus.written_steps import (
    CUT_OVER_BOLT,
    WrittenBeam,
    contact_lines,
    step_lines,
    written_beam,
)
from faying.io.left_out import refuse_unwritten, write_whole
from faying.model.assembly import Assembly, NodalLoads
from faying.model.cells import CellBlock
from faying.model.deck_bolt import bolt_axis_element
from faying.model.description import JointDescription
from faying.model.elements import SOLIDS, block_element


def write_deck(
    description: JointDescription,
    path: str | PathLike[str],
    *,
    loads: Mapping[str, NodalLoads] | None = None,
    modes: int | None = None,
    title: str = "",
) -> None:
    """Write an input deck for CalculiX: structure, contact pairs, bolts and steps.

    The first step tightens the bolts to their ``preloads``; each load set is a step after it, with
    the bolts locked. Every step has one increment, so that CalculiX uses small displacements in
    contact. Couplings, equations and inclined supports become ``*EQUATION``; node rotations are
    the translations of a second one; beams become springs, tightened ones with a cut that
    ``*PRE-TENSION SECTION`` pulls together.

    Parameters
    ----------
    description
        Description without given matrices. Bolts with preload are beams along coordinate axes.
    loads
        Nodal loads by name, in the order of the steps; by default the loads of the assembly.
    modes
        Write a ``*FREQUENCY`` step for this many modes instead, without contact.
    title
        The heading; the assembly's name by default.

    Raises
    ------
    FormatError
        If such a deck cannot represent the joint (matrices, non-matching interfaces, beams or
        moments on nodes without rotations), or the file cannot be written.
    ModelError
        If an interface or bolt does not exist.

    Notes
    -----
    Numbers have thirteen digits. Initial gaps become ``*CLEARANCE``. The mass of a beam goes to
    its ends in halves; point masses have no inertia.
    """
    assembly = description.assembly
    refuse_unwritten(assembly)
    cases = assembly.loads if loads is None else loads
    lines = _lines(description, cases, modes, title or assembly.name)
    write_whole(path, "\n".join(lines) + "\n")


def _lines(
    description: JointDescription,
    loads: Mapping[str, NodalLoads],
    modes: int | None,
    title: str,
) -> Iterator[str]:
    assembly = description.assembly
    rows, fixed = written_equations(assembly)
    nodes = written_nodes(assembly, rows)
    bolts = {} if modes is not None else _tightened(description)
    first, tightened = nodes.largest + 1, set(bolts.values())
    beams = [
        written_beam(assembly, beam, nodes, first + 4 * i, tightened=beam.id in tightened)
        for i, beam in enumerate(assembly.beams)
    ]
    controls = {
        name: beams[[b.id for b in assembly.beams].index(beam)].control
        for name, beam in bolts.items()
    }
    yield from ("*HEADING", " ".join(title.split())[:72] or "faying")
    yield from _nodes(assembly, nodes, beams)
    yield from _solids(assembly)
    yield from _sets(assembly)
    yield from _materials(assembly)
    yield from _line_elements(assembly, nodes, beams)
    equations = [*equation_terms(rows, nodes, fixed), *(e for b in beams for e in b.equations)]
    yield from _equations([terms for terms in equations if len(terms) > 1])
    # Degrees of freedom that depend only on held ones are held too.
    grounded = [terms[0][:2] for terms in equations if len(terms) == 1]
    yield from _boundary([*held(nodes, fixed), *grounded])
    if modes is not None:
        yield from ("*STEP", "*FREQUENCY", str(modes), "*NODE FILE", "U", "*END STEP")
        return
    yield from contact_lines(description)
    forces = {name: force for name, force in description.preloads.items() if name in controls}
    locked = [node for name, node in controls.items() if name not in description.unlocked]
    tightening = {controls[n]: f for n, f in forces.items()}
    yield from step_lines(nodes, loads, tightening, locked, bool(description.interfaces))


def _tightened(description: JointDescription) -> dict[str, int]:
    """Return the beam of each bolt that has a preload."""
    if description.initial_forces:
        name = next(iter(description.initial_forces))
        refuse(
            f"bolt '{name}' is locked at an initial force; only final forces are written, give its "
            "preload instead"
        )
    beams = {}
    beam_ids = {beam.id for beam in description.assembly.beams}
    for bolt in description.bolts:
        if bolt.name in description.preloads:
            element = bolt_axis_element(description.assembly, bolt)
            if element.id not in beam_ids:
                refuse(f"bolt '{bolt.name}' is a spring; only beams can be written as bolts")
            beams[bolt.name] = element.id
    missing = [name for name in description.preloads if name not in beams]
    if missing:
        refuse(f"there is no bolt '{missing[0]}' to preload; add it to the bolts")
    return beams


def _nodes(assembly: Assembly, nodes: WrittenNodes, beams: Sequence[WrittenBeam]) -> Iterator[str]:
    yield "*NODE,NSET=NALL"
    for number, coordinates in zip(nodes.ids.tolist(), assembly.mesh.nodes.tolist(), strict=True):
        yield f"{number},{_reals(coordinates)}"
    added = [*rotation_coordinates(assembly, nodes), *(n for beam in beams for n in beam.nodes)]
    if added:
        yield "** nodes whose translations are rotations, and nodes inside bolts"
        yield "*NODE,NSET=NAUXILIARY"
        yield from (f"{number},{_reals(coordinates.tolist())}" for number, coordinates in added)


def _solids(assembly: Assembly) -> Iterator[str]:
    ids = assembly.mesh.node_ids
    for block in assembly.mesh.blocks:
        for number in np.unique(block.properties).tolist():
            yield f"*ELEMENT,TYPE={_type(block, assembly)},ELSET={_property(number)}"
            chosen = block.properties == number
            cells = ids[SOLIDS[block.kind].elsewhere.theirs(block.nodes[chosen])]
            for element, row in zip(block.ids[chosen].tolist(), cells.tolist(), strict=True):
                yield from _wrapped([element, *row])


def _type(block: CellBlock, assembly: Assembly) -> str:
    names = block_element(block, assembly.element).elsewhere.abaqus
    if not names:
        refuse(
            f"element {block.ids[0]} is a {block.kind}, which CalculiX has not; write a Nastran "
            "deck, or mesh with tetrahedra, wedges or bricks"
        )
    return next(iter(names))


def _property(number: int) -> str:
    return f"PROPERTY{number}"


def _sets(assembly: Assembly) -> Iterator[str]:
    ids = assembly.mesh.node_ids
    labels: set[str] = set()
    for kind, sets in (
        ("NSET", {name: ids[nodes] for name, nodes in assembly.mesh.node_sets.items()}),
        ("ELSET", assembly.mesh.element_sets),
    ):
        for name, members in sets.items():
            if len(members):
                label = _label(name, labels)
                yield f"*{kind},{kind}={label}"
                yield from _wrapped(np.asarray(members).tolist())


def _label(name: str, labels: set[str]) -> str:
    """Return a unique set name in characters that both programs accept."""
    label = re.sub(r"[^A-Z0-9_-]", "_", name.upper())[:60]
    label = label if label[:1].isalpha() else f"S{label}"
    while label in labels or label == "NALL" or label.startswith("PROPERTY"):
        label += "_"
    labels.add(label)
    return label


def _materials(assembly: Assembly) -> Iterator[str]:
    used = [n for block in assembly.mesh.blocks for n in np.unique(block.properties).tolist()]
    labels: set[str] = set()
    names = {}
    for number in dict.fromkeys(used):
        if number not in assembly.materials:
            refuse(f"property {number} has no material; add it to Assembly.materials")
        material = assembly.materials[number]
        if material not in names:
            names[material] = _label(material.name or f"MATERIAL{number}", labels)
            yield f"*MATERIAL,NAME={names[material]}"
            yield from ("*ELASTIC", _reals([material.youngs_modulus, material.poissons_ratio]))
            yield from ("*DENSITY", _reals([material.density]))
        yield f"*SOLID SECTION,ELSET={_property(number)},MATERIAL={names[material]}"


def _line_elements(
    assembly: Assembly, nodes: WrittenNodes, beams: Sequence[WrittenBeam]
) -> Iterator[str]:
    """Yield springs, point masses, and cuts of bolts, with ids above all others."""
    numbers = count(assembly.largest_id + 1)
    springs = [spring for beam in beams for spring in beam.springs]
    springs += [
        ([nodes.place(6 * node + component) for node, component in spring.ends], spring.stiffness)
        for spring in assembly.springs
    ]
    for ends, stiffness in springs:
        section = (",".join(str(dof) for _, dof in ends), _reals([stiffness]))
        ids = [node for node, _ in ends]
        yield from _element(f"SPRING{len(ends)}", next(numbers), ids, "SPRING", *section)
    for node, mass in _masses(assembly):
        node_ids = [int(nodes.ids[node])]
        yield from _element("MASS", next(numbers), node_ids, "MASS", _reals([mass]))
    for beam in beams:
        if beam.cut is not None:
            yield from _cut(next(numbers), beam, beam.cut)


def _element(
    kind: str, number: int, nodes: Sequence[int], keyword: str, *data: str
) -> Iterator[str]:
    """Yield the lines of an element, and of a keyword with its data."""
    yield f"*ELEMENT,TYPE={kind},ELSET={keyword}{number}"
    yield ",".join(map(str, (number, *nodes)))
    yield f"*{keyword},ELSET={keyword}{number}"
    yield from data


def _cut(number: int, beam: WrittenBeam, nodes: tuple[int, int]) -> Iterator[str]:
    """Yield the beam element of a cut, its section, and the pretension section."""
    yield f"*ELEMENT,TYPE=B31,ELSET=CUT{number}"
    yield f"{number},{nodes[0]},{nodes[1]}"
    yield f"*MATERIAL,NAME=CUT{number}"
    material = beam.beam.material
    yield "*ELASTIC"
    yield _reals([CUT_OVER_BOLT * material.youngs_modulus, material.poissons_ratio])
    yield f"*BEAM SECTION,ELSET=CUT{number},MATERIAL=CUT{number},SECTION=CIRC"
    yield from (_reals([np.sqrt(beam.beam.section.area / np.pi)]), _reals(beam.across))
    yield f"*PRE-TENSION SECTION,ELEMENT={number},NODE={beam.control}"
    # Only its axial stiffness matters.
    yield from ("*BOUNDARY", f"{nodes[0]},4,6")


def _masses(assembly: Assembly) -> Iterator[tuple[int, float]]:
    for point in assembly.masses:
        if any(value != 0 for row in (*point.inertia, point.offset) for value in row):
            refuse(
                f"point mass {point.id} has inertia or an offset, which *MASS lacks; leave it out"
            )
        yield point.node, point.mass
    for beam in assembly.beams:
        length = np.linalg.norm(np.diff(assembly.mesh.nodes[list(beam.nodes)], axis=0))
        mass = float(beam.material.density * beam.section.area * length)
        if mass > 0:
            yield from ((node, mass / 2) for node in beam.nodes)


def _equations(equations: Sequence[Sequence[Term]]) -> Iterator[str]:
    for terms in equations:
        yield from ("*EQUATION", str(len(terms)))
        for i in range(0, len(terms), 3):
            part = terms[i : i + 3]
            yield ",".join(f"{node},{dof},{_reals([value])}" for node, dof, value in part)


def _boundary(supports: Sequence[tuple[int, int]]) -> Iterator[str]:
    if supports:
        yield "*BOUNDARY"
        yield from (f"{node},{direction},{direction}" for node, direction in supports)


def _wrapped(numbers: Sequence[int] | Indices) -> Iterator[str]:
    """Yield lines of at most ten numbers; a comma at the end continues."""
    for i in range(0, len(numbers), 10):
        part = ",".join(map(str, numbers[i : i + 10]))
        yield part + ("," if i + 10 < len(numbers) else "")


def _reals(values: Iterable[float]) -> str:
    """Return numbers of at most twenty columns, the width that CalculiX reads."""
    return ",".join(real_text(value) for value in values)
