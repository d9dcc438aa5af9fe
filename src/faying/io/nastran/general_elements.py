"""GENEL: an element given by its stiffness or flexibility, as springs between its components."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from faying._typing import Matrix
from faying.io.nastran import fields as numbers
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card
from faying.io.nastran.components import components
from faying.io.nastran.grids import Grids
from faying.model.assembly import Spring
from faying.model.matrices import rigid_body_motions

Place = tuple[int, int]


def read_general_elements(bulk: BulkData) -> Iterator[Spring]:
    """Yield springs that make up the stiffness of GENEL, some of them negative.

    MSC Nastran Quick Reference Guide, GENEL: forces at u_i are K (u_i - S u_d), K being given or
    the inverse of Z, and S given or that of a rigid body. A symmetric matrix is a spring of -K_ij
    between each two components, and one of the sum of its row from each to the ground.
    """
    for card in bulk.cards.get("GENEL", ()):
        yield from springs_between(card.integer(0), *_stiffness(card, bulk.grids))


def springs_between(number: int, places: Sequence[Place], K: Matrix) -> Iterator[Spring]:
    """Yield the springs between components that have a symmetric stiffness."""
    for i, j in np.argwhere(np.triu(K, 1)).tolist():
        yield Spring(id=number, ends=(places[i], places[j]), stiffness=-float(K[i, j]))
    ground = K.sum(axis=1)
    # What a rigid motion leaves is rounding of sums.
    for k in np.flatnonzero(np.abs(ground) > 1e-12 * np.abs(K).sum(axis=1)).tolist():
        yield Spring(id=number, ends=(places[k],), stiffness=float(ground[k]))


def _stiffness(card: Card, grids: Grids) -> tuple[list[Place], Matrix]:
    parts = _parts(card)
    free, dependent = (_places(card, parts.get(name, []), grids) for name in ("UI", "UD"))
    n = len(free)
    letter = "K" if "K" in parts else "Z"
    square = np.zeros((n, n))
    square[np.triu_indices(n)] = _reals(card, parts.get(letter, []), n * (n + 1) // 2, letter)
    square = square + np.triu(square, 1).T
    try:
        K = square if letter == "K" else np.linalg.inv(square)
        S = _following(card, parts, free, dependent, grids)
    except np.linalg.LinAlgError as error:
        text = f"its {letter}, or the rigid motion of its UD, cannot be inverted"
        raise card.error(text) from error
    both = np.hstack([np.eye(n), -S])
    return [*free, *dependent], np.asarray(both.T @ K @ both, dtype=np.float64)


def _following(
    card: Card,
    parts: Mapping[str, list[str]],
    free: Sequence[Place],
    dependent: Sequence[Place],
    grids: Grids,
) -> Matrix:
    """S (n_free, n_held)."""
    if not dependent:
        return np.zeros((len(free), 0))
    if "S" in parts:
        values = _reals(card, parts["S"], len(free) * len(dependent), "S")
        return values.reshape(len(free), len(dependent))
    if len(dependent) != 6:
        card.refuse(
            f"{len(dependent)} components in UD and no S; six make a rigid body, else give S"
        )
    origin = grids.nodes[dependent[0][0]]

    def motions(places: Sequence[Place]) -> Matrix:
        nodes = grids.nodes[[node for node, _ in places]]
        every = rigid_body_motions(nodes, origin).reshape(-1, 6, 6)
        return np.asarray(every[np.arange(len(places)), [c for _, c in places]])

    return np.asarray(np.linalg.solve(motions(dependent).T, motions(free).T).T)


def _parts(card: Card) -> dict[str, list[str]]:
    """Texts behind UI (which is not written), UD, K or Z, and S."""
    parts: dict[str, list[str]] = {"UI": [card.text(j) for j in range(2, min(len(card), 8))]}
    name = "UI"
    for first in range(8, len(card), 8):
        texts = [card.text(first + j) for j in range(8)]
        if texts[0] in ("UD", "K", "Z", "S"):
            name, texts = texts[0], texts[1:]
        parts.setdefault(name, []).extend(texts)
    return parts


def _places(card: Card, texts: list[str], grids: Grids) -> list[Place]:
    filled = [text for text in texts if text]
    places = []
    for grid, digit in zip(filled[::2], filled[1::2], strict=False):
        number = numbers.integer(grid)
        (node,) = grids.several(card, [-1 if number is None else number]).tolist()
        chosen = (0,) if digit == "0" else components(digit, card.error)
        if grids.systems.axes(node) is not None or len(chosen) != 1:
            card.refuse(
                f"GRID {grid} with components '{digit}': one component each, of grids without a "
                "displacement system, is supported"
            )
        places.append((node, chosen[0]))
    return places


def _reals(card: Card, texts: list[str], count: int, name: str) -> Matrix:
    filled = [text for text in texts if text]
    values = [numbers.real(text) for text in filled]
    if len(values) != count or None in values:
        card.refuse(f"{name} has {len(values)} numbers; {count} are expected for its components")
    return np.array(values, dtype=float)
