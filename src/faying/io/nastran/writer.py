"""Writing an :class:`~faying.model.assembly.Assembly` as a Nastran deck."""

import os
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from faying._typing import Indices
from faying.exceptions import refuse
from faying.io.left_out import refuse_unwritten, write_whole
from faying.io.nastran.fields import (
    LARGEST_ID,
    Value,
    digits_of,
    format_real,
    frame_independent,
    large,
    small,
)
from faying.model.assembly import Assembly, BeamSection, Material, Support
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS, solid_element

_NUMBER = re.compile(r"[1-9]\d{0,7}")

SectionKey = tuple[BeamSection, Material]


@dataclass(frozen=True, eq=False, kw_only=True)
class Numbering:
    """Ids of a deck.

    Attributes
    ----------
    sections
        Section and material to property id.
    supports, equations
        Set ids of the assembly to set ids of the deck (only 0 changes).
    elements
        Element family and id of the assembly to the element id of the deck.
    spc, mpc
        Sets that case control selects.
    """

    materials: Mapping[Material, int]
    sections: Mapping[SectionKey, int]
    supports: Mapping[int, int]
    equations: Mapping[int, int]
    loads: Mapping[str, int]
    elements: Mapping[tuple[str, int], int]
    spc: int
    mpc: int


def number_assembly(assembly: Assembly) -> Numbering:
    """Return unique ids for all items of an assembly."""
    supports, equations = (
        _numbered({item.id: item.id for item in items}, "constraint set")
        for items in (assembly.supports, assembly.equations)
    )
    materials = [*assembly.materials.values(), *(beam.material for beam in assembly.beams)]
    named = Counter(material.name for material in dict.fromkeys(materials))
    sections: dict[SectionKey, int] = {}
    for beam in assembly.beams:
        sections.setdefault((beam.section, beam.material), beam.property)
    return Numbering(
        # Different materials of one name get new numbers.
        materials=_numbered(
            {m: _number_of(m.name) if named[m.name] == 1 else 0 for m in materials}, "number"
        ),
        sections=_numbered(
            sections,
            "property",
            {int(n) for block in assembly.mesh.blocks for n in np.unique(block.properties)},
        ),
        supports=supports,
        equations=equations,
        loads=_numbered({name: _number_of(name) for name in assembly.loads}, "number"),
        elements=_elements(assembly),
        spc=_joined(supports),
        mpc=_joined(equations),
    )


_Key = TypeVar("_Key")


def _numbered(
    wanted: Mapping[_Key, int], what: str, taken: Collection[int] = ()
) -> dict[_Key, int]:
    """Return the wanted numbers; free numbers replace those that are not positive or are taken."""
    used, free = set(taken), max([0, *wanted.values(), *taken])
    numbers = {}
    for key, preferred in wanted.items():
        number = preferred
        if number <= 0 or number in used:
            number = free = free + 1
        if number > LARGEST_ID:
            refuse(
                f"{what} {number} does not fit a Nastran field; renumber it below {LARGEST_ID + 1}"
            )
        used.add(number)
        numbers[key] = number
    return numbers


def _joined(sets: Mapping[int, int]) -> int:
    values = set(sets.values())
    return next(iter(values)) if len(values) == 1 else max(values, default=0) + 1


def _number_of(name: str) -> int:
    """Return a name as a number; 0 if it is not a number."""
    return int(name) if _NUMBER.fullmatch(name) else 0


def _elements(assembly: Assembly) -> dict[tuple[str, int], int]:
    families = {
        "cell": [n for block in assembly.mesh.blocks for n in block.ids.tolist()],
        "beam": [beam.id for beam in assembly.beams],
        "spring": [spring.id for spring in assembly.springs],
        "mass": [mass.id for mass in assembly.masses],
        "rigid": [coupling.id for coupling in assembly.rigid_couplings],
        "average": [coupling.id for coupling in assembly.average_couplings],
    }
    for family, ids in families.items():
        if len(set(ids)) < len(ids):
            twice = next(n for n in ids if ids.count(n) > 1)
            refuse(f"{family} id {twice} occurs twice; give each its own id")
    wanted = {(family, number): number for family, ids in families.items() for number in ids}
    return _numbered(wanted, "element")


_METHOD = 1


def write_deck(
    assembly: Assembly,
    path: str | os.PathLike[str],
    *,
    title: str = "",
    loads: str | None = None,
    modes: int | None = None,
) -> None:
    """Write a deck that Nastran can run: linear statics (SOL 101) or normal modes (SOL 103).

    All load sets are written; case control selects ``loads`` (the first one by default). Supports
    of several sets are joined by SPCADD, equations by MPCADD. Beams become CBAR, with the shear
    factors on PBAR. The file appears complete or not at all.

    Parameters
    ----------
    assembly
        Without matrices from elsewhere.
    title
        One line for the output of the other program; the assembly's name by default.
    loads
        Name of the load set to select.
    modes
        Write SOL 103 and an EIGRL that asks for this many modes, instead of statics.

    Raises
    ------
    FormatError
        If ``modes`` is not positive, bulk data cannot represent the assembly (matrices, ids above
        99 999 999, several support directions at a node), or the file cannot be written.

    Notes
    -----
    Real numbers take 16 columns: 10 to 15 digits. Set names, facets and clashing ids are not
    kept; comments give the names of load sets and materials that are not numbers.
    """
    write_whole(path, _deck(assembly, title or assembly.name, loads, modes))


def _deck(assembly: Assembly, title: str, loads: str | None, modes: int | None) -> str:
    refuse_unwritten(assembly)
    if loads is not None and loads not in assembly.loads:
        names = ", ".join(assembly.loads) or "none"
        refuse(f"the assembly has no load set '{loads}'; load sets are {names}")
    if modes is not None and modes < 1:
        refuse(f"{modes} modes requested; request one or more, or omit modes")
    numbering = number_assembly(assembly)
    selected = loads if loads is not None else next(iter(assembly.loads), None)
    control = [f"TITLE = {' '.join(title.split())[:60]}"]
    control += [f"SPC = {numbering.spc}"] if assembly.supports else []
    control += [f"MPC = {numbering.mpc}"] if assembly.equations else []
    bulk = [] if modes is None else [small("EIGRL", [_METHOD, None, None, modes])]
    if modes is not None:
        control += [f"METHOD = {_METHOD}"]
    elif selected is not None:
        control += [f"LOAD = {numbering.loads[selected]}"]
    bulk += [
        *_properties(assembly, numbering),
        *_grids(assembly),
        *(line for b in assembly.mesh.blocks for line in _block(b, assembly, numbering)),
        *_lines(assembly, numbering),
        *_couplings(assembly, numbering),
        *_constraints(assembly, numbering),
        *_loads(assembly, numbering),
    ]
    head = [f"SOL {101 if modes is None else 103}", "CEND", *control]
    return "\n".join([*head, "DISPLACEMENT = ALL", "BEGIN BULK", *bulk, "ENDDATA", ""])


def _turned(support: Support) -> bool:
    return support.axes is not None and not frame_independent(support.components)


def _grids(assembly: Assembly) -> Iterator[str]:
    ids = assembly.mesh.node_ids
    if len(ids) and not 0 < ids.min() <= ids.max() <= LARGEST_ID:
        refuse(f"node ids must lie between 1 and {LARGEST_ID}; found {ids.min()} to {ids.max()}")
    system = np.zeros(len(ids), dtype=np.int64)
    number = 0
    for support in assembly.supports:
        if _turned(support) and support.axes is not None:
            number += 1
            x, _, z = support.axes.tolist()
            yield large("CORD2R", [number, 0, 0.0, 0.0, 0.0, *z, *x])
            if system[support.nodes].any():
                node = ids[support.nodes[system[support.nodes] != 0][0]]
                refuse(f"node {node} has supports along several axes; Nastran allows one set")
            system[support.nodes] = number
    _check_turned(assembly, np.flatnonzero(system))
    # Coordinates of structured meshes repeat; each distinct value is formatted once.
    values, which = np.unique(assembly.mesh.nodes, return_inverse=True)
    texts = [format_real(value).ljust(16) for value in values.tolist()]
    rows = which.reshape(-1, 3).tolist()
    for node, (x, y, z), turned in zip(ids.tolist(), rows, system.tolist(), strict=True):
        yield (
            f"GRID*   {node:<16d}{'':16}{texts[x]}{texts[y]}\n"
            f"*       {texts[z]}{turned or ''}".rstrip()
        )


def _check_turned(assembly: Assembly, nodes: Indices) -> None:
    """Refuse single-component constraints at nodes with their own displacement system."""
    if not len(nodes):
        return
    used = {node for equation in assembly.equations for node, _, _ in equation.terms}
    used |= {node for spring in assembly.springs for node, _ in spring.ends}
    for rigid in assembly.rigid_couplings:
        used |= set() if frame_independent(rigid.components) else set(rigid.nodes.tolist())
    for mean in assembly.average_couplings:
        used |= set() if frame_independent(mean.components) else set(mean.nodes.tolist())
        used |= set() if frame_independent(mean.reference_components) else {mean.reference}
    for support in assembly.supports:
        used |= (
            set()
            if _turned(support) or frame_independent(support.components)
            else set(support.nodes.tolist())
        )
    both = used & set(nodes.tolist())
    if both:
        refuse(
            f"node {assembly.mesh.node_ids[min(both)]} is supported along turned axes and also "
            "enters springs, equations or supports along basic ones; Nastran allows one set"
        )


def _properties(assembly: Assembly, numbering: Numbering) -> Iterator[str]:
    for material, number_of_material in numbering.materials.items():
        if material.name and material.name != str(number_of_material):
            yield f"$ material {number_of_material} is '{' '.join(material.name.split())[:50]}'"
        e, nu, rho = material.youngs_modulus, material.poissons_ratio, material.density
        yield large("MAT1", [number_of_material, e, None, nu, rho])
    kinds: dict[int, set[str]] = {}
    for block in assembly.mesh.blocks:
        for number in np.unique(block.properties).tolist():
            kinds.setdefault(number, set()).add(block.kind)
    for number, kinds_of_property in kinds.items():
        if number not in assembly.materials:
            refuse(f"property {number} has no material; add it to Assembly.materials")
        network, scheme = _scheme(kinds_of_property, assembly.element)
        made_of = numbering.materials[assembly.materials[number]]
        yield small("PSOLID", [number, made_of, None, network, None, scheme])
    for (section, material), number in numbering.sections.items():
        factors = [section.shear_factor_y, section.shear_factor_z]
        stiff = np.isinf(factors).all()
        # Zero means infinite shear stiffness; the eight stress points come first.
        shear = [] if stiff else [*[None] * 10, *(0.0 if np.isinf(k) else k for k in factors)]
        made_of = numbering.materials[material]
        main = [section.area, section.inertia_z, section.inertia_y, section.torsion]
        yield large("PBAR", [number, made_of, *main, *shear])


def _scheme(kinds: set[str], element: str) -> tuple[str | None, str | None]:
    """Return IN and ISOP of PSOLID that make Nastran's element equal to faying's."""
    schemes = {kind: solid_element(kind, element).elsewhere.nastran_scheme for kind in kinds}
    # Only eight-node bricks change with more points than they need.
    allowed = {schemes["hex8"]} if "hex8" in kinds else set(schemes.values())
    return next(
        (scheme for scheme in (("THREE", "FULL"), ("TWO", "FULL")) if scheme in allowed),
        (None, None),
    )


def _block(block: CellBlock, assembly: Assembly, numbering: Numbering) -> Iterator[str]:
    formulation = block.formulation or (assembly.element if block.kind == "hex8" else "")
    if block.formulation or formulation.startswith("reduced"):
        refuse(
            f"element {block.ids[0]} is a {formulation} {block.kind}, which Nastran lacks, "
            "or not beside others; give the model one formulation, or write a CalculiX deck"
        )
    name = SOLIDS[block.kind].elsewhere.nastran
    ids = [numbering.elements["cell", number] for number in block.ids.tolist()]
    nodes = assembly.mesh.node_ids[block.nodes].tolist()
    for number, pid, row in zip(ids, block.properties.tolist(), nodes, strict=True):
        yield small(name, [number, pid, *row])


def _lines(assembly: Assembly, numbering: Numbering) -> Iterator[str]:
    ids = assembly.mesh.node_ids
    turned = {n for s in assembly.supports if _turned(s) for n in s.nodes.tolist()}
    for beam in assembly.beams:
        start, end = beam.nodes
        pid = numbering.sections[beam.section, beam.material]
        flag = "BGG" if start in turned else None
        fields = [numbering.elements["beam", beam.id], pid, int(ids[start]), int(ids[end])]
        yield large("CBAR", [*fields, *beam.orientation, flag])
    for spring in assembly.springs:
        ends = [value for node, c in spring.ends for value in (int(ids[node]), c + 1)]
        yield large("CELAS2", [numbering.elements["spring", spring.id], spring.stiffness, *ends])
    for mass in assembly.masses:
        i = mass.inertia
        # Off-diagonal fields of CONM2 are ∫ x y dm, the negative of the tensor's entries.
        tensor = [i[0][0], -i[1][0], i[1][1], -i[2][0], -i[2][1], i[2][2]]
        fields = [numbering.elements["mass", mass.id], int(ids[mass.node]), 0]
        yield large("CONM2", [*fields, mass.mass, *mass.offset, None, *tensor])


def _couplings(assembly: Assembly, numbering: Numbering) -> Iterator[str]:
    ids = assembly.mesh.node_ids
    for rigid in assembly.rigid_couplings:
        number = numbering.elements["rigid", rigid.id]
        head: list[Value] = [number, int(ids[rigid.reference]), digits_of(rigid.components)]
        yield small("RBE2", [*head, *ids[rigid.nodes].tolist()])
    for mean in assembly.average_couplings:
        number = numbering.elements["average", mean.id]
        groups: list[Value] = []
        previous = None
        for weight, node in zip(mean.weights.tolist(), ids[mean.nodes].tolist(), strict=True):
            if weight != previous:
                groups += [weight, digits_of(mean.components)]
                previous = weight
            groups.append(node)
        reference: list[Value] = [int(ids[mean.reference]), digits_of(mean.reference_components)]
        yield large("RBE3", [number, None, *reference, *groups])


def _constraints(assembly: Assembly, numbering: Numbering) -> Iterator[str]:
    ids = assembly.mesh.node_ids
    for support in assembly.supports:
        number = numbering.supports[support.id]
        node_ids = ids[support.nodes].tolist()
        yield small("SPC1", [number, digits_of(support.components), *node_ids])
    yield from _combined("SPCADD", numbering.spc, numbering.supports.values())
    for equation in assembly.equations:
        fields: list[Value] = []
        for i, (node, component, coefficient) in enumerate(equation.terms):
            head: list[Value] = (
                [numbering.equations[equation.id] if i == 0 else None] if i % 2 == 0 else []
            )
            fields += [*head, int(ids[node]), component + 1, coefficient]
            fields += [None] if i % 2 else []
        yield large("MPC", fields)
    yield from _combined("MPCADD", numbering.mpc, numbering.equations.values())


def _combined(name: str, number: int, members: Iterable[int]) -> Iterator[str]:
    sets = sorted(set(members))
    if len(sets) > 1:
        yield small(name, [number, *sets])


def _loads(assembly: Assembly, numbering: Numbering) -> Iterator[str]:
    ids = assembly.mesh.node_ids
    for name, loads in assembly.loads.items():
        number = numbering.loads[name]
        if name != str(number):
            yield f"$ load set {number} is '{' '.join(name.split())[:50]}'"
        for node, force in zip(ids[loads.nodes].tolist(), loads.forces.tolist(), strict=True):
            for card, part in (("FORCE", force[:3]), ("MOMENT", force[3:])):
                if any(part):
                    yield large(card, [number, node, 0, 1.0, *part])
        if not loads.forces.any() and len(ids):
            # Nastran refuses a selected load set without a card.
            yield large("FORCE", [number, int(ids[0]), 0, 0.0, 1.0, 0.0, 0.0])
