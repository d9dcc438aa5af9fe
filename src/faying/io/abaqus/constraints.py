"""``*EQUATION``, ``*MPC`` and ``*RIGID BODY``: constraints between nodes."""

from collections.abc import Iterator, Mapping

import numpy as np

from faying._typing import Indices, Matrix
from faying.digits import DECK_DIGITS, ROUND_OFF
from faying.io.abaqus.deck_data import DeckData, component
from faying.io.abaqus.fields import Line, is_integer, lines
from faying.io.abaqus.keyword import Keyword
from faying.model.assembly import Equation, RigidCoupling

Term = tuple[int, int, float]


def read_equations(data: DeckData) -> Iterator[Equation]:
    """Yield the equations of all *EQUATION; the first term is eliminated."""
    for keyword in data.deck.of("EQUATION"):
        following = iter(lines(keyword))
        for head in following:
            count = head.integer(0, "the number of terms")
            if count < 1 or len(head) != 1:
                head.refuse("expected the number of terms alone on this line")
            fields: list[Line] = []
            while len(fields) < count and (line := next(following, None)) is not None:
                if len(line) % 3:
                    line.refuse("expected node, degree of freedom, coefficient for each term")
                fields += line.groups(3)
            if len(fields) != count:
                head.refuse(f"found {len(fields)} terms, expected {count}")
            for terms in _per_node(fields, data):
                yield Equation(id=0, terms=terms)


def _per_node(fields: list[Line], data: DeckData) -> Iterator[tuple[Term, ...]]:
    """Yield one equation, or one per member where the terms are node sets."""
    nodes = [data.find(line).tolist() for line in fields]
    count = len(nodes[0])
    for line, members in zip(fields, nodes, strict=True):
        if len(members) not in (1, count) or (count > 1 and members != sorted(members)):
            line.refuse(f"a set of {len(members)} nodes where the first term has {count}")
    for i in range(count):
        terms: list[Term] = []
        for line, members in zip(fields, nodes, strict=True):
            node = members[i] if len(members) > 1 else members[0]
            value = line.real(2, "a coefficient")
            parts = data.parts(node, component(line, 1))
            # The largest comes first, because the first term of an equation is eliminated.
            terms += [(owner, c, value * factor) for owner, c, factor in parts]
        yield tuple(terms)


_KNOWN = ("PIN", "TIE", "BEAM", "PLANE", "STRAIGHT", "MEANROT")
_REMEDIES: Mapping[str, str] = {
    "DIST": "it is an inequality; hold the distance by *EQUATION, or leave it out",
    "LINK": "use a stiff beam",
    "SLIDER": "write *EQUATION",
}
_ON_AXIS = 1e-10
"""Squared distance from the axis over the mean distance from the centre below which CalculiX
ignores a node of MEANROT."""

Terms = tuple[tuple[int, int, float], ...]


def read_mpcs(data: DeckData) -> tuple[list[Equation], list[RigidCoupling]]:
    """Read *MPC of type PIN, TIE, BEAM, PLANE, STRAIGHT and MEANROT.

    The last four are linearized about the geometry of the deck: with unit axis a and p_i the arms
    of the n nodes from their centre across it, MEANROT is
    Σ (a × p_i) · (u_i - ū) / |p_i|² = n θ, as in CalculiX.
    """
    equations: list[Equation] = []
    rigid: list[RigidCoupling] = []
    for keyword in data.deck.of("MPC"):
        for line in _definitions(keyword):
            kind = line.text(0).upper()
            if kind == "BEAM":
                rigid.append(_beam(line, data))
            else:
                all_terms = _terms(line, kind, data)
                equations += [Equation(id=0, terms=terms) for terms in all_terms]
            if kind in ("BEAM", "PLANE", "STRAIGHT", "MEANROT"):
                note = f"*MPC of type {kind}: linear about the geometry of the deck"
                if note not in data.deck.ignored:
                    data.deck.ignored.append(note)
    return equations, rigid


def _definitions(keyword: Keyword) -> list[Line]:
    """Return lines of a type and its nodes; a line that starts with 0 continues the one before."""
    definitions: list[Line] = []
    for line in lines(keyword):
        kind = line.text(0).upper()
        if kind == "0" and definitions:
            definitions[-1].texts.extend(line.texts[1:])
            continue
        if kind not in _KNOWN:
            remedy = _REMEDIES.get(kind, "write *EQUATION")
            line.refuse(f"type {kind} is not supported ({', '.join(_KNOWN)} are); {remedy}")
        definitions.append(line)
    return definitions


def _beam(line: Line, data: DeckData) -> RigidCoupling:
    dependent, leader = _two(line, "BEAM", data)
    return RigidCoupling(id=0, reference=leader, nodes=dependent, components=tuple(range(6)))


def _terms(line: Line, kind: str, data: DeckData) -> Iterator[Terms]:
    if kind in ("PIN", "TIE"):
        dependent, leader = _two(line, kind, data)
        for node in dependent.tolist():
            for c in range(3 if kind == "PIN" else 6):
                yield ((node, c, 1.0), (leader, c, -1.0))
        return
    nodes = [
        node
        for column, label in enumerate(line.texts)
        if column and label and not (is_integer(label) and int(label) == 0)
        for node in data.find(line, column).tolist()
    ]
    if kind == "MEANROT":
        yield _mean_rotation(line, nodes, data.nodes.coordinates)
    else:
        yield from _staying(line, kind, nodes, data.nodes.coordinates)


def _two(line: Line, kind: str, data: DeckData) -> tuple[Indices, int]:
    """Return the dependent nodes and the independent one."""
    line.check((3,), f"{kind}, dependent node or set, node")
    leader = data.one(line.keyword, line.row, line.text(2), "the independent node")
    return data.find(line, 1), leader


def _mean_rotation(line: Line, nodes: list[int], points: Matrix) -> Terms:
    """Return the equation of a MEANROT: each node three times, then the node of the rotation."""
    turning, turned = nodes[-1:], nodes[:-1]
    distinct = np.array(turned[::3], dtype=np.int64)
    if len(turned) % 3 or not turned or not np.array_equal(np.repeat(distinct, 3), turned):
        line.refuse("expected MEANROT, each node three times, and the node of the rotation")
    axis = points[turning[0]]
    length = float(np.linalg.norm(axis))
    if not length > 0:
        line.refuse("the coordinates of the last node are the axis of rotation; they are zero")
    axis = axis / length
    arms = points[distinct] - points[distinct].mean(axis=0)
    spread = float(np.sqrt((arms**2).sum(axis=1).mean()))
    across = arms - np.outer(arms @ axis, axis)
    squared = (across**2).sum(axis=1)
    counted = squared > _ON_AXIS * spread
    if not counted.any():
        line.refuse("all nodes lie on the axis of rotation; they must span a rotation about it")
    gradients = np.zeros_like(arms)
    gradients[counted] = np.cross(axis, across[counted]) / squared[counted, None]
    gradients -= gradients.mean(axis=0)
    terms = _of(distinct.tolist(), gradients)
    return (*sorted(terms, key=lambda t: -abs(t[2])), (turning[0], 0, -float(len(distinct))))


_SHAPES = {
    "PLANE": (3, "four", "plane", "lie on one line"),
    "STRAIGHT": (2, "three", "line", "coincide"),
}
"""Number of defining nodes, least number of nodes, shape, and fault of nodes that define none."""


def _staying(line: Line, kind: str, nodes: list[int], points: Matrix) -> Iterator[Terms]:
    """Yield the equations that keep nodes on a plane or line.

    Normal to it, each node moves by interpolation between the nodes farthest apart.
    """
    count, least, shape, problem = _SHAPES[kind]
    nodes = list(dict.fromkeys(nodes))
    if len(nodes) <= count:
        line.refuse(f"found {len(nodes)} nodes, expected {least} or more that stay on a {shape}")
    basis = _farthest(nodes, points)[:count]
    edges = points[basis[1:]] - points[basis[0]]
    across = _across(edges)
    sizes = np.linalg.norm(edges, axis=1)
    if not np.linalg.norm(across[0]) > DECK_DIGITS * np.prod(sizes):
        line.refuse(f"all nodes {problem}; they must span a {shape}")
    others = [node for node in nodes if node not in basis]
    arms = points[others] - points[basis[0]]
    shares = np.linalg.lstsq(edges.T, arms.T)[0].T
    off = np.linalg.norm(arms - shares @ edges, axis=1)
    wrong = np.flatnonzero(off > DECK_DIGITS * np.linalg.norm(arms, axis=1))
    if wrong.size:
        line.refuse(
            f"a node is {off[wrong[0]]:.3g} off the {shape} of the others; place it there: it "
            "is not moved to it"
        )
    shares[np.abs(shares) < ROUND_OFF] = 0.0
    for node, share in zip(others, shares, strict=True):
        factors = [1.0, share.sum() - 1.0, *-share]
        for direction in across:
            terms = _of([node, *basis], np.outer(factors, direction))
            # The largest term of the dependent node comes first, for the first one is eliminated.
            yield tuple(sorted(terms, key=lambda t: (t[0] != node, -abs(t[2]))))


def _across(edges: Matrix) -> Matrix:
    """Return directions normal to one edge, or to two, as rows."""
    if len(edges) == 2:
        return np.cross(edges[:1], edges[1:])
    axis = int(np.abs(edges[0]).argmax())
    others = [c for c in range(3) if c != axis]
    across = np.zeros((2, 3))
    across[[0, 1], others] = edges[0, axis]
    across[:, axis] = -edges[0, others]
    return across


def _farthest(nodes: list[int], points: Matrix) -> list[int]:
    """Return the first node, the node farthest from it, and the node farthest from their line."""
    arms = points[nodes] - points[nodes[0]]
    second = int(np.linalg.norm(arms, axis=1).argmax())
    third = int(np.linalg.norm(np.cross(arms[second], arms), axis=1).argmax())
    return [nodes[0], nodes[second], nodes[third]]


def _of(nodes: list[int], vectors: Matrix) -> list[tuple[int, int, float]]:
    return [
        (node, c, value)
        for node, vector in zip(nodes, vectors.tolist(), strict=True)
        for c, value in enumerate(vector)
        if value != 0.0
    ]


Group = tuple[Indices, tuple[int, ...]]
"""Nodes, and the components that follow the reference node."""


def rotation_nodes(data: DeckData) -> dict[int, int]:
    """Return the index of the first reference node by index of CalculiX's rotation nodes."""
    return {rotation: reference for reference, rotation in reversed(_turning(data))}


def shared_rotations(data: DeckData) -> list[Equation]:
    """Return the equations that couple the rotations of bodies with a common rotation node."""
    first = rotation_nodes(data)
    return [
        Equation(id=0, terms=((reference, c, 1.0), (first[rotation], c, -1.0)))
        for reference, rotation in _turning(data)
        if reference != first[rotation]
        for c in (3, 4, 5)
    ]


def _turning(data: DeckData) -> list[tuple[int, int]]:
    """Return reference and rotation node of each rigid body with a rotation node."""
    pairs = []
    for keyword in data.deck.of("RIGID BODY"):
        if keyword.has("ROT NODE"):
            what = "the rotation node"
            rotation = data.one(keyword, None, keyword.required("ROT NODE"), what)
            reference = _reference(keyword, data, _named_nodes(keyword, data))
            if rotation == reference:
                keyword.refuse("the rotation node must differ from the reference node")
            pairs.append((reference, rotation))
    return pairs


def read_rigid_bodies(data: DeckData) -> Iterator[RigidCoupling]:
    """Read all *RIGID BODY of CalculiX (NSET or ELSET) and Abaqus (PIN NSET, TIE NSET, ELSET)."""
    for keyword in data.deck.of("RIGID BODY"):
        groups = _groups(keyword, data)
        if not sum(len(nodes) for nodes, _ in groups):
            keyword.refuse("it names no nodes; give NSET=, ELSET=, PIN NSET= or TIE NSET=")
        reference = _reference(keyword, data, groups)
        for nodes, components in groups:
            others = nodes[nodes != reference]
            if len(others):
                yield RigidCoupling(id=0, reference=reference, nodes=others, components=components)


def _reference(keyword: Keyword, data: DeckData, groups: list[Group]) -> int:
    """Return the reference node, or any node of the body where none is named."""
    nodes = next((nodes for nodes, _ in groups if len(nodes)), None)
    if keyword.has("REF NODE") or nodes is None:
        return data.one(keyword, None, keyword.required("REF NODE"), "the reference node")
    return int(nodes[0])


def _groups(keyword: Keyword, data: DeckData) -> list[Group]:
    groups = _named_nodes(keyword, data)
    if keyword.has("ELSET"):
        ids = data.element_sets.find(keyword, keyword.required("ELSET"))
        parts = [b.nodes[np.isin(b.ids, ids)].ravel() for b in data.elements.blocks]
        groups.append((np.unique(np.concatenate(parts)), tuple(range(6))))
    return groups


def _named_nodes(keyword: Keyword, data: DeckData) -> list[Group]:
    groups: list[Group] = []
    for name, components in (("NSET", range(3)), ("PIN NSET", range(3)), ("TIE NSET", range(6))):
        if keyword.has(name):
            groups.append((data.named_nodes(keyword, name), tuple(components)))
    return groups
