"""``*COUPLING`` and ``*DISTRIBUTING COUPLING``: nodes tied rigidly or on average."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.digits import ROUND_OFF
from faying.interface.facets import gauss_rule, shape_functions, surface
from faying.io.abaqus.deck_data import DeckData, component_range
from faying.io.abaqus.fields import lines
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.line_elements import TYPES
from faying.io.abaqus.mesh import SHELL_TYPES, Elements
from faying.io.abaqus.solid_sections import find_frame, is_of_abaqus
from faying.io.abaqus.surfaces import DeckSurface, Surfaces, find_surface
from faying.model.assembly import AverageCoupling, Equation, RigidCoupling
from faying.model.surface import nodes_by_kind

MEMBERS = ("KINEMATIC", "DISTRIBUTING")
_ALL = tuple(range(6))


@dataclass(frozen=True, eq=False, kw_only=True)
class Couplings:
    """Couplings of *COUPLING: rigid, average, and equations along axes of the nodes."""

    rigid: list[RigidCoupling]
    average: list[AverageCoupling]
    turned: list[Equation]


def read_couplings(data: DeckData, surfaces: Surfaces) -> tuple[Couplings, DeckData]:
    """Read all *COUPLING with their *KINEMATIC or *DISTRIBUTING.

    Distributing couplings weight nodes by their share of the surface's area, ∫N dA. Kinematic ones
    of some translations with ORIENTATION are equations a · u = a · (u_ref + θ_ref × r) along the
    axes a of each node. Also return the data with the axes of reference nodes of *DISTRIBUTING
    with ORIENTATION: in CalculiX (User's Manual, *COUPLING) forces and moments on them are along
    these axes; Abaqus uses them only to select rotations.
    """
    rigid: list[RigidCoupling] = []
    average: list[AverageCoupling] = []
    turned: list[Equation] = []
    deck = data.deck
    for head, members in deck.groups("COUPLING", *MEMBERS):
        if len(members) != 1:
            head.refuse("expected one *KINEMATIC or *DISTRIBUTING below it")
        (member,) = members
        reference = data.one(head, None, head.required("REF NODE"), "the reference node")
        coupled = find_surface(surfaces, head, head.required("SURFACE"), None)
        nodes = coupled.nodes[coupled.nodes != reference]
        components = _components(member)
        if member.name == "KINEMATIC":
            translations = tuple(c for c in components if c < 3)
            if head.has("ORIENTATION") and 0 < len(translations) < 3:
                if len(translations) < len(components):
                    message = "rotations along an ORIENTATION are not supported beside some, not "
                    message += "all, translations; tie all translations, or no rotations"
                    raise member.error(message)
                points = data.nodes.coordinates[nodes]
                axes = find_frame(deck, head, points).directions(points)
                turned += _along(data.nodes.coordinates, reference, nodes, axes[:, translations])
                continue
            rigid.append(
                RigidCoupling(id=0, reference=reference, nodes=nodes, components=components)
            )
            continue
        if head.has("ORIENTATION"):
            components = _ALL
            if not is_of_abaqus(deck) and not data.local.displacement[reference]:
                points = data.nodes.coordinates[[reference]]
                data = data.along(np.array([reference]), find_frame(deck, head, points))
            deck.ignored.append(
                "ORIENTATION of *DISTRIBUTING: forces on its node are along these axes, as in "
                "CalculiX, except in decks that only Abaqus reads; all rotations are tied"
            )
        _check_distributing(member, data.elements, nodes)
        weights = _areas(coupled, data.nodes.coordinates)[coupled.nodes != reference]
        average.append(
            AverageCoupling(
                id=0,
                reference=reference,
                nodes=nodes[weights != 0],
                weights=weights[weights != 0],
                reference_components=tuple(sorted({0, 1, 2, *components})),
            )
        )
    return Couplings(rigid=rigid, average=average, turned=turned), data


def _along(points: Matrix, reference: int, nodes: Indices, axes: Matrix) -> list[Equation]:
    """Return equations that tie each node to the reference along its axes (n_node, n_axis, 3)."""
    arms = points[nodes] - points[reference]
    moments = np.cross(arms[:, None], axes)
    equations = []
    for node, rows, turning in zip(nodes.tolist(), axes, moments, strict=True):
        for axis, moment in zip(rows.tolist(), turning.tolist(), strict=True):
            of_node = sorted(((node, c, a) for c, a in enumerate(axis)), key=lambda t: -abs(t[2]))
            of_reference = [(reference, c, -a) for c, a in enumerate([*axis, *moment])]
            terms = tuple(term for term in [*of_node, *of_reference] if term[2] != 0.0)
            equations.append(Equation(id=0, terms=terms))
    return equations


def _check_distributing(member: Keyword, elements: Elements, nodes: Indices) -> None:
    """Refuse other weights, and moments on rotations of the nodes (STRUCTURAL)."""
    kind = member.choice("COUPLING")
    blocks = elements.of(*SHELL_TYPES, *TYPES)
    turning = any(np.isin(nodes, block.nodes).any() for block in blocks)
    if kind != "CONTINUUM" and (kind != "STRUCTURAL" or turning):
        message = f"COUPLING={kind} is supported as STRUCTURAL of nodes of solids alone, where it "
        message += "is CONTINUUM; give CONTINUUM"
        raise member.error(message)


def _components(member: Keyword) -> tuple[int, ...]:
    components: set[int] = set()
    for line in lines(member, (1, 2), "the first and the last degree of freedom"):
        components.update(component_range(line, 0))
    return tuple(sorted(components)) or _ALL


def _areas(coupled: DeckSurface, coordinates: Matrix) -> Vector:
    """Return the area of each node, ∫N dA, as for a uniform pressure.

    It is zero at corners of six-node facets, and negative at corners of eight-node facets.
    """
    shares = np.zeros(len(coordinates))
    for kind, facets in nodes_by_kind(coupled.facets).items():
        rule = gauss_rule(kind)
        share = surface(kind, coordinates[facets], rule).areas @ shape_functions(kind, rule.points)
        share[np.abs(share) < ROUND_OFF * share.max(axis=1, keepdims=True)] = 0.0
        shares += np.bincount(facets.ravel(), share.ravel(), minlength=len(coordinates))
    if not len(coupled.facets):
        shares[coupled.nodes] = 1.0
    return shares[coupled.nodes]


def read_distributing(data: DeckData) -> list[Equation]:
    """Read all *DISTRIBUTING COUPLING: one DCOUP3D element, then nodes or sets and weights.

    As in CalculiX the displacement of the element's node is the weighted mean without rotation;
    Abaqus adds rotation, like *COUPLING with *DISTRIBUTING in both.
    """
    equations: list[Equation] = []
    reference_of = {
        int(i): int(node)
        for block in data.elements.of("DCOUP3D")
        for i, node in zip(block.ids, block.nodes[:, 0], strict=True)
    }
    for keyword in data.deck.of("DISTRIBUTING COUPLING"):
        members = data.element_sets.find(keyword, keyword.required("ELSET")).tolist()
        if len(members) != 1 or members[0] not in reference_of:
            keyword.refuse(f"the set '{keyword.value('ELSET')}' is not one DCOUP3D element")
        weights: dict[int, float] = {}
        for line in lines(keyword, (2,), "node or node set and weight"):
            weight = line.positive(1, "the weight")
            weights.update(dict.fromkeys(data.find(line).tolist(), weight))
        reference = reference_of[members[0]]
        weights.pop(reference, None)
        total = sum(weights.values())
        for c in range(3):
            terms = [(reference, c, 1.0)]
            terms += [(node, c, -weight / total) for node, weight in weights.items()]
            equations.append(Equation(id=0, terms=tuple(terms)))
        data.deck.ignored.append(
            f"rotations of *DISTRIBUTING COUPLING {keyword.value('ELSET')}: the mean displacement "
            "as in CalculiX; Abaqus adds rotation, like *COUPLING with *DISTRIBUTING"
        )
    return equations


def with_real_rotations(couplings: Sequence[RigidCoupling], rotating: Mask) -> list[RigidCoupling]:
    """Return couplings without the rotations of nodes of solids, which have none."""
    result = []
    for coupling in couplings:
        turning = rotating[coupling.nodes]
        translations = tuple(c for c in coupling.components if c < 3)
        parts: list[tuple[Indices, tuple[int, ...]]] = [
            (coupling.nodes[turning], coupling.components),
            (coupling.nodes[~turning], translations),
        ]
        result += [
            replace(coupling, nodes=nodes, components=components)
            for nodes, components in parts
            if len(nodes) and components
        ]
    return result
