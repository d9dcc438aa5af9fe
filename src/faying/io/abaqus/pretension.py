"""``*PRE-TENSION SECTION``: bolts and their forces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Vector
from faying.io import solid_cuts
from faying.io.abaqus.deck_data import DeckData
from faying.io.abaqus.fields import is_integer, only_line
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.line_elements import TYPES
from faying.io.abaqus.loads import Forces
from faying.io.abaqus.supports import Boundary
from faying.io.abaqus.surfaces import DeckSurface
from faying.model.assembly import Assembly, NodalLoads
from faying.model.deck_bolt import axial_stiffness, bolt_axis_element
from faying.model.specs import BoltSpec


@dataclass(frozen=True, kw_only=True)
class Section:
    """A pretension section with its surface or beam, and the node of its force.

    Attributes
    ----------
    node
        Index of the pretension node.
    element
        Id of the cut beam; None for a cut through solids.
    surface
        Name of the surface at which solids are cut; empty for a beam.
    direction : (3,)
        Normal given on the data line, if any.
    sense
        1 where a positive force is tension, -1 where it is compression.
    """

    keyword: Keyword
    name: str
    node: int
    element: int | None
    surface: str
    direction: tuple[float, ...] | None = None
    sense: float = 1.0

    def through(self, surface: DeckSurface) -> solid_cuts.Section:
        """Return the section through solids at a surface."""
        if not len(surface.facets):
            self.keyword.refuse(
                f"surface '{surface.name}' has no facets; give a TYPE=ELEMENT surface"
            )
        return solid_cuts.Section(
            name=self.name,
            shown=f"surface '{surface.name}'",
            facets=surface.facets,
            elements=surface.elements,
            refuse=self.keyword.refuse,
            direction=self.direction,
        )


def read_sections(data: DeckData) -> list[Section]:
    """Read all *PRE-TENSION SECTION."""
    sections: list[Section] = []
    for keyword in data.deck.of("PRE-TENSION SECTION"):
        node = data.one(keyword, None, keyword.required("NODE"), "the pretension node")
        if keyword.has("SURFACE") == keyword.has("ELEMENT"):
            keyword.refuse("give either SURFACE= or ELEMENT=")
        if any(section.node == node for section in sections):
            keyword.refuse(
                f"the pretension node {keyword.value('NODE')} belongs to another section too, "
                "which would share its force; give each section a separate node"
            )
        direction, element, sense = _direction(keyword), None, 1.0
        if keyword.has("ELEMENT"):
            element, axis = _beam(keyword, data)
            sense = float(np.sign(np.dot(direction, axis))) if direction else 1.0
            if sense == 0.0:
                keyword.refuse("the direction is zero or normal to the beam; give the beam's", 0)
        surface = keyword.value("SURFACE")
        label = keyword.value("NODE")
        plain = surface or (f"bolt {element}" if is_integer(label) else label)
        sections.append(
            Section(
                keyword=keyword,
                name=plain,
                node=node,
                element=element,
                surface=surface,
                direction=direction,
                sense=sense,
            )
        )
        if any(section.name == plain for section in sections[:-1]):
            keyword.refuse(
                f"there are two pretension sections '{plain}'; use different surfaces or nodes"
            )
    return sections


def _direction(keyword: Keyword) -> tuple[float, ...] | None:
    if not keyword.data:
        return None
    line = only_line(keyword, (3,), "the direction of the section: three numbers")
    return tuple(line.reals("a direction"))


def _beam(keyword: Keyword, data: DeckData) -> tuple[int, Vector]:
    """Return the id of the beam, and the vector from its first node to its last."""
    members = data.element_sets.members(keyword, keyword.required("ELEMENT"))
    blocks = data.elements.of(*TYPES)
    ends = [tuple(ends) for block in blocks for ends in block.nodes[np.isin(block.ids, members)]]
    if len(members) != 1 or not ends:
        keyword.refuse(f"ELEMENT={keyword.value('ELEMENT')} is not one beam element")
    start, *_, end = ends[0]
    return int(members[0]), data.nodes.coordinates[end] - data.nodes.coordinates[start]


def bolts(sections: list[Section], springs: list[int]) -> tuple[BoltSpec, ...]:
    """Return all bolts; ``springs`` are the ids of the springs across cuts, in order."""
    closing = iter(springs)
    return tuple(
        BoltSpec(
            name=section.name,
            elements=(next(closing) if section.element is None else section.element,),
        )
        for section in sections
    )


def preloads(
    sections: list[Section],
    forces: Sequence[Forces],
    holds: Boundary,
    data: DeckData,
) -> dict[str, float]:
    """Return the preload of each bolt: the *CLOAD on its pretension node.

    ``forces`` are in force in each step, from 0 to the last. A bolt whose node is displaced
    has none, with a note.
    """
    bolt_forces = {}
    for section in sections:
        displacement = holds.pretension.get(section.node, np.nan)
        if not np.isnan(displacement):
            if any((section.node, 0) in step for step in forces):
                data.deck.ignored.append(
                    f"*CLOAD on the pretension node {data.nodes.ids[section.node]}: *BOUNDARY "
                    f"without FIXED holds the node at {displacement:g} in the step that is read, "
                    "whatever the force before; FIXED would lock the bolt under that force"
                )
            continue
        last = holds.since.get(section.node, len(forces)) - 1
        force = forces[last].get((section.node, 0)) if last >= 0 else None
        value = None if force is None else force * section.sense + 0.0
        if value is None or not value >= 0:
            problem = "has no force" if value is None else f"has the compressive force {value:g}"
            when = f"at the end of step {last}" if last > 0 else "before the first step"
            section.keyword.refuse(
                f"the section '{section.name}' {problem} {when}, where it is "
                f"{'locked' if section.node in holds.since else 'read'}; give its pretension node "
                "a *CLOAD in direction 1, positive for tension along the direction of the section, "
                "or a displacement by *BOUNDARY; *BOUNDARY, FIXED in the next step locks it"
            )
        bolt_forces[section.name] = value
    return bolt_forces


def unlocked(
    sections: list[Section],
    holds: Boundary,
    preloads: Mapping[str, float],
    loads: Mapping[str, NodalLoads],
    step: int,
    ignored: list[str],
) -> frozenset[str]:
    """Return the bolts whose force *CLOAD maintains under the loads of the step, with a note.

    If only bolts act in the step, the deck just tightens them: loads of a study come
    after it, with locked bolts. Bolts locked by FIXED while loads act are noted.
    """
    free = frozenset(section.name for section in sections if section.node not in holds.since)
    names = ", ".join(f"'{name}'" for name in sorted(free))
    if free and step_name(step) not in loads:
        ignored.append(
            f"bolts {names}: no *BOUNDARY, FIXED locks them and only bolts "
            f"act in step {step}; they are locked after it, for loads of a study"
        )
        return frozenset()
    if free:
        ignored.append(
            f"bolts {names}: no *BOUNDARY, FIXED locks them; each has its *CLOAD under any "
            "load, as in the deck; a [[bolt]] with preload = its force locks it"
        )
    ignored.extend(
        f"bolt '{section.name}': FIXED locks it while the loads of step {last} act; its force "
        f"{preloads[section.name]:g} is without these loads here, and with them in the deck"
        for section in sections
        if (last := holds.since.get(section.node, 0) - 1) > 0
        and section.name in preloads
        and step_name(last) in loads
    )
    return free


def step_name(step: int) -> str:
    """Return the name of the loads of a step."""
    return f"step {step}"


def initial_forces(
    sections: list[Section],
    bolts: tuple[BoltSpec, ...],
    displacements: Mapping[int, float],
    assembly: Assembly,
) -> dict[str, float]:
    """Return the initial forces of bolts whose pretension node is displaced.

    The initial force is the displacement times the axial stiffness of the bolt.
    Displacements are given by pretension node, NaN where a force determines it.
    """
    forces = {}
    for section, bolt in zip(sections, bolts, strict=True):
        closed = displacements.get(section.node, np.nan) * section.sense
        if np.isnan(closed):
            continue
        if closed < 0:
            section.keyword.refuse(
                f"the section '{section.name}' is compressed by the displacement {closed:g} of "
                "its pretension node; give one that is positive for tension along the direction of "
                "the section, or a *CLOAD"
            )
        element = bolt_axis_element(assembly, bolt)
        forces[bolt.name] = axial_stiffness(assembly, element) * closed + 0.0
    return forces
