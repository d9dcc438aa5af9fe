"""Read an Abaqus or CalculiX deck: the structure, its contact pairs and its bolts."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np

from faying.io.abaqus.deck import Deck, read_keyword_deck
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.model import description
from faying.io.abaqus.model_changes import is_from_the_start
from faying.io.deck_lines import naming
from faying.io.left_out import checked_ignore
from faying.model.assembly import Assembly
from faying.model.description import JointDescription


def read_joint(
    path: str | PathLike[str], *, step: int | None = None, ignore: Sequence[str] = ()
) -> JointDescription:
    """Read a deck, its contact pairs as interfaces and its pretension sections as bolts.

    Parameters
    ----------
    path
        The deck; *INCLUDE is relative to its folder.
    step
        Step whose boundary conditions, loads and bolt forces are read, with those of earlier steps
        that are in force. By default the last general step before those that change the
        structure (*MODEL CHANGE, *CHANGE …, *EQUATION with REMOVE).

    ignore
        Content of the deck to leave out of the model: words of
        :data:`faying.io.left_out.IGNORABLE`, which describes each.

    Returns
    -------
    JointDescription
        Slave surfaces are the minus sides. ``assembly.loads`` has ``step 1``, … with the loads in
        force in each step up to the chosen one, which comes first. Ids and names are those of the
        deck; names inside instances are ``instance.name``. ``assembly.ignored`` lists everything
        left out.

    Raises
    ------
    FormatError
        With file and line: a missing file, an invalid number, a reference to an unknown
        name or id, a repeated id; or all unsupported keywords that change the structure.

    Notes
    -----
    About 8 s for 500 000 nodes and bricks.
    """
    path = Path(path)
    # Checks of finite values report overflow with its line.
    with np.errstate(over="ignore", invalid="ignore"), naming(path):
        deck = read_keyword_deck(path, checked_ignore(ignore))
        chosen = step_before_changes(deck) if step is None else step
        return description(deck.until(chosen))


def read_deck(path: str | PathLike[str]) -> Assembly:
    """Read the structure of a deck in its last general step, as :func:`read_joint`."""
    return read_joint(path).assembly


def step_before_changes(deck: Deck) -> int | None:
    """Return the last general step before the first that changes the structure, and note it.

    None if no step changes it, or none is before: the last step is read then, and refused if
    it contains unsupported keywords.
    """
    locks = _pretension_nodes(deck)
    first = next((k for k in deck.keywords if k.step > 1 and _changes(k, locks)), None)
    aside = deck.perturbations
    if first is None or any(k.step == 1 and _changes(k, locks) for k in deck.keywords):
        return None
    earlier = [number for number in range(1, first.step) if number not in aside]
    if not earlier:
        return None
    called = "BOUNDARY, FIXED" if first.name == "BOUNDARY" else first.name
    deck.ignored.append(
        f"steps from {first.step} on: *{called} ({first.where()}) changes the structure "
        f"there; "
        f"step {earlier[-1]} is read"
    )
    return earlier[-1]


def _changes(keyword: Keyword, locks: frozenset[str]) -> bool:
    if keyword.name == "EQUATION":
        return keyword.has("REMOVE") or keyword.has("REMOVE ALL")
    if keyword.name == "BOUNDARY":
        return keyword.has("FIXED") and any(
            row[0].strip("\"' ").upper() not in locks for row in keyword.rows()
        )
    if is_from_the_start(keyword):
        return False
    return keyword.name == "MODEL CHANGE" or keyword.name.startswith("CHANGE ")


def _pretension_nodes(deck: Deck) -> frozenset[str]:
    """Return the names of the nodes of pretension sections: ids, and sets of one node."""
    names = {keyword.value("NODE").upper() for keyword in deck.of("PRE-TENSION SECTION")}
    if not names:
        return frozenset()
    sets = {
        keyword.value("NSET").upper(): {text for row in keyword.rows() for text in row if text}
        for keyword in deck.of("NSET")
        if len(keyword.data) == 1
    }
    ids = {member for name in names for member in sets.get(name, {name})}
    return frozenset(names | ids | {name for name, members in sets.items() if members <= ids})
