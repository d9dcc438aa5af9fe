"""``*SURFACE INTERACTION`` and ``*CONTACT PAIR``: interfaces."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from faying._typing import Matrix
from faying.contact.laws import Curve
from faying.interface.gap_pairing import declared
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import parameter
from faying.io.abaqus.friction import FRICTIONLESS, DeckFriction, read_friction, tied_slopes
from faying.io.abaqus.keyword import Keyword, named
from faying.io.abaqus.overclosure import Normal, read_behaviour
from faying.io.abaqus.sets import NamedSets
from faying.io.abaqus.solid_sections import is_of_abaqus
from faying.io.abaqus.surfaces import DeckSurface, Surfaces, removed_sides, slave_and_master
from faying.io.left_out import IGNORABLE
from faying.model.assembly import Assembly
from faying.model.gap_rule import GapRule
from faying.model.mesh import Mesh
from faying.model.specs import InterfaceSpec

MEMBERS = ("SURFACE BEHAVIOR", "FRICTION", "CONTACT DAMPING", "GAP CONDUCTANCE")


@dataclass(frozen=True, kw_only=True)
class Interaction:
    """A ``*SURFACE INTERACTION``; what is ``tied`` neither opens nor slides."""

    name: str
    penalty: Normal = "hard"
    friction: DeckFriction = FRICTIONLESS
    tied: bool = False

    def spec(self, name: str, minus: str, plus: str) -> InterfaceSpec:
        """Return an interface of two sides that has this interaction."""
        return InterfaceSpec(
            name=name,
            minus=minus,
            plus=plus,
            penalty="auto" if isinstance(self.penalty, Curve) else self.penalty,
            closure=self.penalty if isinstance(self.penalty, Curve) else None,
            friction=self.friction.coefficient,
            tangential_penalty=self.friction.tangential_penalty,
        )


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A contact pair: the slave is our minus side, which carries the points and the normals.

    ``lone`` pairs are of a single point.
    """

    keyword: Keyword
    row: int
    slave: DeckSurface
    master: DeckSurface
    interaction: Interaction
    adjusted: GapRule | None
    lone: bool = False


def read_interactions(deck: Deck) -> dict[str, Interaction]:
    """Read all *SURFACE INTERACTION, by upper-case name."""
    interactions = {}
    for head, members in deck.groups("SURFACE INTERACTION", *MEMBERS):
        head.check()
        name = head.required("NAME")
        if tied := [member for member in members if _is_tied(member)]:
            stick = [member for member in members if member.name == "FRICTION"]
            slopes = tied_slopes(deck, name, tied[0], stick)
            stiffness = DeckFriction(tangential_penalty=slopes[1])
            interactions[name.upper()] = Interaction(
                name=name, tied=True, penalty=slopes[0], friction=stiffness
            )
            continue
        if "friction" in deck.ignore:
            members = _frictionless(members, deck.ignored)
        penalty = read_behaviour(head, members, is_of_abaqus(deck), deck.ignored)
        friction = read_friction(members, deck.ignored)
        interactions[name.upper()] = Interaction(name=name, penalty=penalty, friction=friction)
    return interactions


def read_pairs(
    deck: Deck, interactions: Mapping[str, Interaction], surfaces: Surfaces, sets: NamedSets
) -> list[Pair]:
    """Read all *CONTACT PAIR."""
    return [
        pair
        for keyword in deck.of("CONTACT PAIR")
        for pair in _pairs(keyword, surfaces, _adjust(keyword, sets), interactions, deck.ignored)
    ]


def _is_tied(keyword: Keyword) -> bool:
    behaviour = keyword.name == "SURFACE BEHAVIOR"
    return behaviour and keyword.choice("PRESSURE-OVERCLOSURE") == "TIED"


def _frictionless(members: list[Keyword], ignored: list[str]) -> list[Keyword]:
    """Leave out friction as asked."""
    frictionless = [member for member in members if member.name != "FRICTION"]
    if len(frictionless) < len(members):
        ignored.append(f"*FRICTION: {IGNORABLE['friction']} (ignore = friction)")
    return frictionless


def _pairs(
    keyword: Keyword,
    surfaces: Surfaces,
    adjusted: GapRule | None,
    interactions: Mapping[str, Interaction],
    ignored: list[str],
) -> list[Pair]:
    keyword.check()
    name = keyword.required("INTERACTION")
    interaction = named(keyword, name, interactions, "*SURFACE INTERACTION")
    note = f"formulation of *CONTACT PAIR: small sliding, {keyword.choice('TYPE', 'default')}"
    if note not in ignored:
        ignored.append(note)
    pairs = []
    for row, fields in enumerate(keyword.rows()):
        if removed := removed_sides(surfaces, keyword, row, fields):
            ignored.append(
                f"contact pair {', '.join(fields)}: *MODEL CHANGE removes all elements of {removed}"
            )
            continue
        slave, master = slave_and_master(surfaces, keyword, row, fields)
        if not slave.facets:
            ignored.append(
                f"slave surface {slave.name} of nodes: taken as the facets between these nodes"
            )
        pairs.append(
            Pair(
                keyword=keyword,
                row=row,
                slave=slave,
                master=master,
                interaction=interaction,
                adjusted=adjusted,
            )
        )
    return pairs


def _adjust(keyword: Keyword, sets: NamedSets) -> GapRule | None:
    """Which slave nodes start in contact: those up to a gap, or those of a set."""
    if not keyword.has("ADJUST"):
        return None
    text = keyword.value("ADJUST")
    try:
        return GapRule(closed_up_to=float(text or 0.0))
    except ValueError:
        members = sets.members(keyword, text)
        return GapRule(closed_nodes=tuple(members.tolist()))


def interface_names(pairs: list[Pair]) -> list[str]:
    """Names of interfaces: that of the interaction, with both surfaces where it is used twice."""
    names = [pair.interaction.name for pair in pairs]
    return [
        name if names.count(name) == 1 else f"{name} {pair.slave.name} {pair.master.name}"
        for name, pair in zip(names, pairs, strict=True)
    ]


def with_mixed_sides(mesh: Mesh, sides: Iterable[DeckSurface]) -> Mesh:
    """Name sides that are no face set as node sets: mixed facets, and surfaces of nodes."""
    for side in sides:
        if len(side.facets) == 1:
            continue
        exterior = mesh.exterior
        inside = np.zeros(len(mesh.nodes) + 1, dtype=bool)
        inside[side.nodes] = inside[-1] = True
        count = int(inside[exterior.nodes].all(axis=1).sum())
        if not side.facets and not count:
            continue  # of single nodes, which are contact points of their own
        namesake = mesh.node_sets.get(side.name)
        if (namesake is not None and not np.array_equal(np.unique(namesake), side.nodes)) or (
            side.facets and count != sum(map(len, side.facets.values()))
        ):
            side.keyword.refuse(
                f"surface '{side.name}' cannot be told by its nodes; name no node set like it, "
                "and give triangles and quadrilaterals a surface and a contact pair each"
            )
        mesh = mesh.with_node_set(side.name, side.nodes)
    return mesh


def specs(assembly: Assembly, pairs: list[Pair], ignored: list[str]) -> tuple[InterfaceSpec, ...]:
    """Return the pairs as interfaces; those whose meshes do not match are so marked."""
    interfaces = []
    for name, pair in zip(interface_names(pairs), pairs, strict=True):
        spec = replace(
            pair.interaction.spec(name, pair.slave.name, pair.master.name),
            search_distance=np.inf,
            quadrature="gauss" if pair.lone else None,
            order=1 if pair.lone else None,
        )
        spec = declared(assembly, spec)
        if spec.meshes == "non-matching":
            # Whatever else is wrong, the mortar interface will say when the model is built.
            ignored.append(
                f"meshes of contact pair {name} do not match: coupled by projection, in the mean "
                "of facets instead of at each point; where contact is hard or far stiffer than the "
                "elements, coarse meshes give way more: 4 to 9 % in most joints tried, 16 % in one"
            )
        if pair.slave.height or pair.master.height:
            ignored.append(
                f"contact pair {name}: shells touch at half their thickness off their nodes "
                f"({pair.slave.height:g}, {pair.master.height:g}); tangential motion there is that "
                "of the nodes, without the lever of the thickness"
            )
        if pair.adjusted is not None and pair.keyword.has("ADJUST"):
            ignored.append(
                f"ADJUST of contact pair {name}: gaps start closed there, the mesh stays as it is"
            )
        interfaces.append(spec)
    return tuple(interfaces)


def gap_rules(
    deck: Deck, assembly: Assembly, pairs: list[Pair], interfaces: tuple[InterfaceSpec, ...]
) -> tuple[dict[str, float], dict[str, GapRule]]:
    """Read *CLEARANCE and ADJUST: the gaps that interfaces start with, by name.

    Offsets are added to the gap of surfaces that coincide; rules make something of the gap of the
    mesh elsewhere.
    """
    rules: dict[str, GapRule] = {}
    offsets: dict[str, float] = {}
    for spec, pair in zip(interfaces, pairs, strict=True):
        height = pair.slave.height + pair.master.height
        if pair.adjusted is not None:
            rules[spec.name] = pair.adjusted
        if height != 0.0:
            offsets[spec.name] = -height
        if np.isnan(height) or (height and pair.adjusted is not None):
            problem = "ADJUST" if pair.adjusted is not None else "thicknesses that differ"
            pair.keyword.refuse(
                f"{problem} is not supported with surfaces of shells in contact; give *CLEARANCE, "
                "or each thickness a surface and a contact pair",
                pair.row,
            )
    for keyword in deck.of("CLEARANCE"):
        pair, spec, value = _clearance(keyword, pairs, interfaces)
        offsets.pop(spec.name, None)
        if spec.meshes == "matching" and _coincide(assembly.mesh.nodes, pair):
            offsets[spec.name] = value
        else:
            rules[spec.name] = GapRule(value=value)
    return offsets, rules


def _clearance(
    keyword: Keyword, pairs: list[Pair], interfaces: tuple[InterfaceSpec, ...]
) -> tuple[Pair, InterfaceSpec, float]:
    """Return the pair a *CLEARANCE is of, its interface, and the gap it starts with."""
    keyword.check()
    if keyword.data:
        keyword.refuse("it must be one VALUE; give other gaps as initial_gap in the study")
    value = parameter(keyword, "VALUE")
    surfaces = [keyword.required(name).upper() for name in ("SLAVE", "MASTER")]
    for pair, spec in zip(pairs, interfaces, strict=True):
        if [pair.slave.name.upper(), pair.master.name.upper()] == surfaces:
            return pair, spec, value
    message = "no *CONTACT PAIR has these surfaces as slave and master"
    raise keyword.error(message)


def _coincide(nodes: Matrix, pair: Pair) -> bool:
    """Whether paired nodes lie on one another, to a millionth of the size of the slave."""
    distance, _ = cKDTree(nodes[pair.master.nodes]).query(nodes[pair.slave.nodes])
    size = float(np.ptp(nodes[pair.slave.nodes], axis=0).max(initial=0.0))
    facets = np.concatenate([part[:, :2] for part in pair.master.facets.values()])
    edge = float(np.linalg.norm(nodes[facets[:, 1]] - nodes[facets[:, 0]], axis=1).min())
    paired = distance[distance < 0.1 * edge]
    return bool(paired.max(initial=0.0) <= 1e-6 * size)
