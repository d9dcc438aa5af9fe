"""GRID, GRDSET, SPOINT, SET1, SPCADD, MPCADD: nodes and sets; data shared by readers."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

import numpy as np

from faying._typing import Indices, Matrix
from faying.exceptions import FormatError, refuse
from faying.io.nastran.cards import Card, Cards, single
from faying.io.nastran.case_control import CaseControl
from faying.io.nastran.coordinates import Systems, missing_system, read_frames
from faying.io.nastran.fields import components
from faying.io.nastran.id_lists import id_list
from faying.model.assembly import Material


@dataclass(frozen=True, eq=False, kw_only=True)
class Grids:
    """Nodes of a deck.

    Attributes
    ----------
    ids : (n_node,)
    nodes : (n_node, 3) [length]
        Basic coordinates.
    permanent
        Permanent supports (PS): component digits to node indices.
    n_scalar
        Number of scalar points after the grid points. They have no position and get the mean of
        the grid points.
    """

    ids: Indices
    nodes: Matrix
    systems: Systems
    permanent: Mapping[str, Indices]
    order: Indices
    n_scalar: int = 0

    def components(
        self, nodes: Indices, digits: str, error: Callable[[str], FormatError]
    ) -> tuple[int, ...]:
        """Return components 0..5 of digits 1..6; scalar points have only 0, which may be blank."""
        scalar = len(nodes) and int(nodes.min()) >= len(self.ids) - self.n_scalar
        if scalar and digits in ("", "0"):
            return (0,)
        return components(digits, error)

    def index(self, ids: Indices) -> Indices:
        """Return the indices (n,) of nodes given by id, -1 for unknown ids."""
        if not len(self.ids):
            return np.full(len(ids), -1, dtype=np.int64)
        position = np.searchsorted(self.ids, ids, sorter=self.order)
        indices = self.order[np.minimum(position, len(self.order) - 1)]
        return np.where(self.ids[indices] == ids, indices, -1)

    def of_column(self, cards: Cards, field: int, *, blank: bool = False) -> Indices:
        """Return node indices (n,) of field j of every card; -1 for allowed blanks."""
        ids = cards.integers(field, -1 if blank else None)
        index = self.index(ids)
        missing = (index < 0) & (cards.given(field) if blank else True)
        cards.refuse_where(missing, lambda i: _missing(int(ids[i])), field)
        return index

    def one(self, card: Card, field: int) -> int:
        """Return the node index of field j of one card."""
        number = card.integer(field)
        index = int(self.index(np.array([number]))[0])
        if index < 0:
            raise card.error(_missing(number), field)
        return index

    def several(self, card: Card, ids: list[int]) -> Indices:
        """Return node indices (n,) of ids on one card."""
        numbers = np.array(ids, dtype=np.int64)
        index = self.index(numbers)
        if (index < 0).any():
            raise card.error(_missing(int(numbers[index < 0][0])))
        return index


def _missing(number: int) -> str:
    return f"GRID {number} is not in the deck; define it or correct the id"


def read_grids(cards: Mapping[str, Cards]) -> Grids:
    """Read nodes and coordinate systems."""
    grid = cards.get("GRID")
    if grid is None:
        refuse("the deck has no GRID; is it Nastran bulk data?")
    position, displacement, support = _defaults(cards)
    ids = grid.integers(0)
    order = np.argsort(ids, kind="stable")
    _check_ids(grid, ids, order)
    coordinates = grid.vectors((2, 3, 4))
    system_in = grid.integers(1, position)
    system_out = grid.integers(5, displacement)

    def locate(number: int, card: Card) -> tuple[int, Matrix]:
        row = int(np.searchsorted(ids, number, sorter=order))
        if row == len(order) or ids[order[row]] != number:
            raise card.error(_missing(number))
        return int(system_in[order[row]]), coordinates[order[row]]

    frames = read_frames(cards, locate)
    for place, systems in ((1, system_in), (5, system_out)):
        unknown = ~np.isin(systems, list(frames))
        if unknown.any():
            card = int(unknown.argmax())
            grid.refuse(card, missing_system(int(systems[card])), place)
    nodes = coordinates.copy()
    for number in np.unique(system_in[system_in != 0]).tolist():
        rows = system_in == number
        nodes[rows] = frames[number].to_basic(coordinates[rows])
    scalar = _scalar_points(cards, ids)
    if len(scalar):
        ids = np.concatenate([ids, scalar])
        order = np.argsort(ids, kind="stable")
        nodes = np.vstack([nodes, np.tile(nodes.mean(axis=0), (len(scalar), 1))])
        system_out = np.concatenate([system_out, np.zeros(len(scalar), dtype=np.int64)])
    return Grids(
        ids=ids,
        nodes=nodes,
        systems=Systems(frames=frames, nodes=nodes, displacement=system_out),
        permanent=_permanent(grid, support),
        order=order,
        n_scalar=len(scalar),
    )


def _scalar_points(cards: Mapping[str, Cards], grids: Indices) -> Indices:
    """Return the ids of scalar points; elements that join only scalar points need no SPOINT."""
    names = (f"C{kind}{n}" for kind in ("ELAS", "MASS", "DAMP") for n in "34")
    blocks = [cards[name] for name in names if name in cards]
    of_elements = (block.integers(field, 0) for block in blocks for field in (2, 3))
    ends = np.concatenate([np.zeros(0, dtype=np.int64), *of_elements])
    parts = [ends[(ends > 0) & ~np.isin(ends, grids)]]
    for card in cards.get("SPOINT", ()):
        numbers = np.array(id_list(card, card.texts), dtype=np.int64)
        wrong = numbers[(numbers <= 0) | np.isin(numbers, grids)]
        if wrong.size:
            card.refuse(f"scalar point {wrong[0]} is also a GRID, or not positive; renumber it")
        parts.append(numbers)
    return np.unique(np.concatenate(parts))


def _defaults(cards: Mapping[str, Cards]) -> tuple[int, int, str]:
    default = single(cards, "GRDSET")
    if default is None:
        return 0, 0, ""
    return default.integer(1, 0), default.integer(5, 0), default.text(6)


def _check_ids(grid: Cards, ids: Indices, order: Indices) -> None:
    if (ids <= 0).any():
        worst = int(ids.argmin())
        grid.refuse(worst, f"id {ids[worst]} must be positive")
    twice = np.flatnonzero(np.diff(ids[order]) == 0)
    if twice.size:
        first, second = order[twice[0]], order[twice[0] + 1]
        grid.refuse(
            int(second),
            f"id {ids[second]} is already used at {grid.where(int(first))}; renumber one",
        )


def _permanent(grid: Cards, default: str) -> dict[str, Indices]:
    column = grid.column(6)
    blank = ~grid.given(6)
    result: dict[str, Indices] = {}
    for raw in np.unique(column[~blank]):
        result[raw.decode("latin-1").strip("\0 ")] = np.flatnonzero(column == raw)
    if default:
        nodes = np.flatnonzero(blank)
        result[default] = np.union1d(result.get(default, nodes), nodes)
    return {digits: nodes for digits, nodes in result.items() if digits != "0" and len(nodes)}


@dataclass(frozen=True, eq=False, kw_only=True)
class BulkData:
    """Cards of a deck by name, with its grid points.

    Attributes
    ----------
    control
        Sets selected by case control.
    mass_factor
        Factor of densities and masses (PARAM,WTMASS).
    ignored
        Notes so far; readers append theirs.
    materials, shear_factors
        See :func:`faying.io.nastran.materials.read_materials`.
    """

    cards: Mapping[str, Cards]
    control: CaseControl
    grids: Grids
    mass_factor: float
    ignored: list[str]
    materials: Mapping[int, Material] = field(default_factory=dict)
    shear_factors: Mapping[int, float] = field(default_factory=dict)

    def material(self, card: Card, field: int) -> tuple[Material, float]:
        """Return the material named in a field, and its shear factor."""
        material = card.find(self.materials, field, "material", "MAT1")
        return material, self.shear_factors.get(card.integer(field), 1.0)


def read_sets(
    bulk: BulkData, elements: Mapping[str, Indices]
) -> tuple[dict[str, Indices], dict[str, Indices]]:
    """Return node sets (indices) and element sets (ids).

    ``set:<n>`` of a SET1 is a node set if all ids are grids, an element set if all are solid
    elements, and both if both hold.
    """
    node_sets: dict[str, Indices] = {}
    element_sets: dict[str, Indices] = {}
    element_ids = np.concatenate(list(elements.values()) or [np.zeros(0, dtype=np.int64)])
    for card in bulk.cards.get("SET1", ()):
        texts = card.texts[1:]
        name = f"set:{card.integer(0)}"
        if "SKIN" in texts:
            bulk.ignored.append(f"SET1 {card.integer(0)} (SKIN is not supported)")
            continue
        ids = np.unique(np.array(id_list(card, texts), dtype=np.int64))
        index = bulk.grids.index(ids)
        if len(ids) and (index >= 0).all():
            node_sets[name] = np.union1d(node_sets.get(name, index), index)
        if len(ids) and np.isin(ids, element_ids).all():
            element_sets[name] = np.union1d(element_sets.get(name, ids), ids)
    return node_sets, element_sets


def selected_sets(bulk: BulkData, kind: str, members: set[int]) -> set[int]:
    """Return the ids of the active constraint sets; all without case control.

    The kind is ``"SPC"`` or ``"MPC"``; members are ids of sets with constraints.
    """
    combined: dict[int, list[int]] = {}
    for card in bulk.cards.get(f"{kind}ADD", ()):
        number = card.integer(0)
        parts = id_list(card, card.texts[1:])
        unknown = [str(part) for part in parts if part not in members]
        if unknown:
            # As in Nastran, whose own examples name such sets.
            bulk.ignored.append(
                f"{card.where()}: sets that are not in the deck: {', '.join(unknown)}"
            )
        combined.setdefault(number, []).extend(parts)
    chosen = bulk.control.set_of(kind)
    if chosen is None:
        if members:
            shown = ", ".join(map(str, sorted(members)))
            said = (
                f"case control selects none by {kind}, so they constrain nothing"
                if bulk.control.present
                else "without case control all apply"
            )
            bulk.ignored.append(f"{kind} sets {shown}: {said}")
        return set() if bulk.control.present else set(members)
    if kind == "MPC" and not members and not combined:
        bulk.ignored.append(f"case control selects MPC = {chosen}, which the deck lacks")
        return set()
    if chosen not in members and chosen not in combined:
        refuse(
            f"case control selects {kind} = {chosen}, but the bulk data have no such set; "
            f"sets are {', '.join(map(str, sorted(members | set(combined)))) or 'none'}"
        )
    return ({chosen} | set(combined.get(chosen, []))) & members


def chosen_sets(
    control: CaseControl, word: str, sets: Collection[int], what: str
) -> tuple[list[int], str]:
    """Return the sets selected by a command; all without case control.

    Also returned is the note on sets that are not selected.
    """
    chosen, shown = control.set_of(word), ", ".join(map(str, sets)) or "none"
    if chosen is not None and chosen not in sets:
        refuse(f"case control selects {word} = {chosen}, but the {what} are {shown}")
    if chosen is not None or not control.present:
        return [*sets] if chosen is None else [chosen], ""
    return [], f"{what} {shown} (case control selects none by {word})" if sets else ""
