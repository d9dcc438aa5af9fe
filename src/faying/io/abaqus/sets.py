"""Sets of ``*NSET`` and ``*ELSET``, and of the parameters of ``*NODE`` and ``*ELEMENT``."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from faying._typing import Indices, frozen
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import Table, integers, is_integer, table
from faying.io.abaqus.keyword import Keyword, named, scoped_names
from faying.io.abaqus.mesh import ElementBlock, Elements, Nodes, located


@dataclass(frozen=True, eq=False, kw_only=True)
class NamedSets:
    """Sets of node or element ids, with case-insensitive names.

    Attributes
    ----------
    what
        ``"node set"`` or ``"element set"``.
    ids
        Sorted ids by upper-case name.
    names
        Names as first written by upper-case name.
    offsets
        Offset of the ids of each instance, by upper-case name.
    absent : (n,)
        Ids that the deck defines and later removes.
    """

    what: str
    ids: Mapping[str, Indices]
    names: Mapping[str, str]
    offsets: Mapping[str, int]
    absent: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def find(self, keyword: Keyword, label: str, row: int | None = None) -> Indices:
        """Return the ids of a set."""
        return named(keyword, label, self.ids, self.what, row)

    def indices(self, nodes: Nodes) -> dict[str, Indices]:
        """Return node indices by name of the set as first written."""
        return {self.names[key]: np.searchsorted(nodes.ids, i) for key, i in self.ids.items()}

    def members(self, keyword: Keyword, label: str, row: int | None = None) -> Indices:
        """Return the ids of a data field: an id, ``instance.id``, or a set."""
        if is_integer(label):
            return np.setdiff1d([int(label) + keyword.scope.offset], self.absent)
        instance, _, number = label.rpartition(".")
        if is_integer(number) and instance.upper() in self.offsets:
            return np.setdiff1d([int(number) + self.offsets[instance.upper()]], self.absent)
        return self.find(keyword, label, row)


@dataclass(eq=False, kw_only=True)
class _Builder:
    """Builder of sets, whose nested names are resolved at the end, since any order is allowed."""

    what: str
    parts: dict[str, list[Indices | tuple[Keyword, int, str]]] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)

    def open(self, keyword: Keyword, label: str) -> list[Indices | tuple[Keyword, int, str]]:
        """Return the list of parts of a set, to which its keyword adds."""
        plain = label.strip("\"' ")
        name = f"{keyword.scope.name}.{plain}" if keyword.scope.name else plain
        self.names.setdefault(name.upper(), name)
        return self.parts.setdefault(name.upper(), [])

    def closed(self, deck: Deck) -> NamedSets:
        done: dict[str, Indices] = {}
        for key in self.parts:
            self._resolve(key, done, ())
        return NamedSets(what=self.what, ids=done, names=self.names, offsets=deck.offsets)

    def _resolve(self, key: str, done: dict[str, Indices], path: tuple[str, ...]) -> Indices:
        if key in done:
            return done[key]
        parts = [np.empty(0, dtype=np.int64)]
        for part in self.parts[key]:
            if not isinstance(part, tuple):
                parts.append(part)
                continue
            keyword, row, label = part
            inner = next((n for n in scoped_names(keyword, label) if n in self.parts), None)
            if inner is None or inner in (*path, key) or len(path) > 50:
                problem = "does not exist" if inner is None else "contains itself"
                keyword.refuse(f"the {self.what} '{label}' {problem}; correct the name", row)
            parts.append(self._resolve(inner, done, (*path, key)))
        done[key] = frozen(np.unique(np.concatenate(parts)), np.int64)
        return done[key]


def read_element_sets(deck: Deck, elements: Elements) -> NamedSets:
    """Read all element sets; refuse unknown element ids."""
    builder = _Builder(what="element set")
    blocks = {id(block.keyword): block for block in elements.blocks}
    element_ids = np.sort(np.concatenate([block.ids for block in elements.blocks]))
    for keyword in deck.of("ELEMENT", "ELSET"):
        if keyword.name == "ELEMENT":
            if keyword.has("ELSET"):
                parts = builder.open(keyword, keyword.required("ELSET"))
                parts.append(blocks[id(keyword)].ids)
            continue
        parts = builder.open(keyword, keyword.required("ELSET"))
        ids, rows = _explicit(keyword, parts, deck, element_ids)
        _check_known(ids, rows, element_ids, keyword, "element")
        parts.append(ids)
    return builder.closed(deck)


def read_node_sets(deck: Deck, nodes: Nodes, elements: Elements, by_name: NamedSets) -> NamedSets:
    """Read all node sets; refuse unknown node ids."""
    builder = _Builder(what="node set")
    for keyword in deck.of("NODE", "NSET"):
        if keyword.name == "NODE":
            if keyword.has("NSET"):
                parts = builder.open(keyword, keyword.required("NSET"))
                fields = table(keyword)
                first = np.flatnonzero(np.diff(fields.row, prepend=-1))
                ids = integers(fields.texts[first], keyword, fields.row[first], "a node id")
                parts.append(ids + keyword.scope.offset)
            continue
        # FREQUENCY belongs to output and is ignored by CalculiX here.
        parts = builder.open(keyword, keyword.required("NSET"))
        ids, rows = _explicit(keyword, parts, deck, nodes.ids)
        _check_known(ids, rows, nodes.ids, keyword, "node")
        parts.append(ids)
        if keyword.has("ELSET"):
            chosen = by_name.find(keyword, keyword.value("ELSET"))
            corners = [b.nodes[np.isin(b.ids, chosen)].ravel() for b in elements.blocks]
            parts.append(nodes.ids[np.unique(np.concatenate(corners))])
    return builder.closed(deck)


def _explicit(
    keyword: Keyword,
    parts: list[Indices | tuple[Keyword, int, str]],
    deck: Deck,
    known_ids: Indices,
) -> tuple[Indices, Indices]:
    """Return written or generated ids with their data lines; names are added to the parts."""
    name = keyword.required("INSTANCE") if keyword.has("INSTANCE") else ""
    offset = named(keyword, name, deck.offsets, "instance") if name else keyword.scope.offset
    fields = table(keyword)
    if keyword.has("GENERATE"):
        return _generated(keyword, fields, known_ids, offset)
    letters = np.strings.isdigit(fields.texts)
    texts, rows = fields.texts[letters], fields.row[letters]
    for position in np.flatnonzero(~letters).tolist():
        label, row = fields.texts[position].decode("latin-1"), int(fields.row[position])
        head, dot, tail = label.rpartition(".")
        if dot and is_integer(tail):
            raised = named(keyword, head, deck.offsets, "instance", row)
            parts.append(np.array([int(tail) + raised]))
        elif not label or label[0] in "+-.0123456789":
            keyword.refuse(f"found '{label}', expected ids or names of sets", row)
        else:
            inside = f"{name}.{label}" if name else label
            parts.append((keyword, row, inside))
    return integers(texts, keyword, rows, "an id") + offset, rows


def _generated(
    keyword: Keyword, fields: Table, known_ids: Indices, offset: int
) -> tuple[Indices, Indices]:
    """Return the existing ids of ranges, since both programs skip missing ids, with data lines."""
    columns, counts = fields.columns(2, 3, "first, last, increment")
    rows = np.arange(len(counts), dtype=np.int64)
    first = integers(columns[0], keyword, rows, "the first id")
    last = integers(columns[1], keyword, rows, "the last id")
    step = integers(np.where(counts > 2, columns[2], b"1"), keyword, rows, "the increment")
    wrong = np.flatnonzero((step < 1) | (last < first))
    if not wrong.size:
        wrong = np.flatnonzero((last - first) % step != 0)
    if wrong.size:
        bad = int(wrong[0])
        keyword.refuse(
            f"{first[bad]} to {last[bad]} in steps of {step[bad]} is not a range; the last id "
            "must be reached from the first",
            bad,
        )
    ids = []
    for row, (a, b, s) in enumerate(zip(first + offset, last + offset, step, strict=True)):
        part = known_ids[
            np.searchsorted(known_ids, a) : np.searchsorted(known_ids, b, side="right")
        ]
        part = part[(part - a) % s == 0]
        if not len(part) or part[0] != a or part[-1] != b:
            missing = a if not len(part) or part[0] != a else b
            keyword.refuse(
                f"the range starts or ends at {missing - offset}, which does not exist", row
            )
        ids.append(part)
    joined = np.concatenate([np.empty(0, dtype=np.int64), *ids])
    return joined, np.repeat(rows, [len(part) for part in ids])


def _check_known(
    ids: Indices, rows: Indices, known_ids: Indices, keyword: Keyword, what: str
) -> None:
    missing = np.flatnonzero(~np.isin(ids, known_ids))
    if missing.size:
        bad = int(missing[0])
        keyword.refuse(
            f"there is no {what} {ids[bad] - keyword.scope.offset}; correct the set", int(rows[bad])
        )


def section_numbers(
    name: str,
    keywords: Sequence[Keyword],
    blocks: Sequence[ElementBlock],
    sets: NamedSets,
    ignored: list[str],
) -> list[Indices]:
    """Return the number of the keyword, from 0, for each element (n_element,) of each block.

    An element gets the last keyword whose ELSET has it; ``name`` is for messages.
    """
    ids = np.concatenate([np.empty(0, dtype=np.int64), *(block.ids for block in blocks)])
    numbers = np.full(len(ids), -1)
    for number, keyword in enumerate(keywords):
        chosen = np.isin(ids, sets.find(keyword, keyword.required("ELSET")))
        again = ids[chosen & (numbers >= 0)]
        if again.size:
            ignored.append(
                f"{keyword.where()}: *{keyword.name} of {len(again)} elements (the first "
                f"{again[0]}) that have one already: the last one applies, as in CalculiX; Abaqus "
                "refuses such a deck"
            )
        numbers[chosen] = number
    missing = np.flatnonzero(numbers < 0)
    if missing.size:
        position, row = located([block.ids for block in blocks], int(missing[0]))
        blocks[position].keyword.refuse(
            f"element {ids[missing[0]]} has no *{name}; give its set one",
            int(blocks[position].rows[row]),
        )
    return np.split(numbers, np.cumsum([len(block.ids) for block in blocks], dtype=int))[:-1]
