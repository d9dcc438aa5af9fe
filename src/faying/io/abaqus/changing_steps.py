"""Steps that change the structure, which is one and the same for all steps here.

So do those that hold nodes where the step before left them, unless these lock a bolt.
"""

from faying.io.abaqus.deck import Deck
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.model_changes import is_from_the_start


def step_before_changes(deck: Deck, ignored: list[str]) -> int | None:
    """Return the last general step in front of the first that changes the structure, and note it.

    None if no step changes it, or none comes before: the last step is read then, and refused if
    something in it is not supported.
    """
    locks = _pretension_nodes(deck)
    first = next((k for k in deck.keywords if k.step > 1 and _changes(k, locks)), None)
    aside = deck.perturbations
    if first is None or any(k.step == 1 and _changes(k, locks) for k in deck.keywords):
        return None
    earlier = [number for number in range(1, first.step) if number not in aside]
    if not earlier:
        return None
    ignored.append(
        f"steps from {first.step} on: *{_called(first)} ({first.where()}) changes the structure "
        f"there; "
        f"step {earlier[-1]} is read"
    )
    return earlier[-1]


def _changes(keyword: Keyword, locks: frozenset[str]) -> bool:
    if keyword.name == "EQUATION":
        return keyword.has("REMOVE") or keyword.has("REMOVE ALL")
    if keyword.name == "BOUNDARY":
        return keyword.has("FIXED") and any(_name(row[0]) not in locks for row in keyword.rows())
    if is_from_the_start(keyword):
        return False
    return keyword.name == "MODEL CHANGE" or keyword.name.startswith("CHANGE ")


def _name(label: str) -> str:
    return label.strip("\"' ").upper()


def _called(keyword: Keyword) -> str:
    return "BOUNDARY, FIXED" if keyword.name == "BOUNDARY" else keyword.name


def _pretension_nodes(deck: Deck) -> frozenset[str]:
    """Return what the nodes of pretension sections may be called: ids, and sets of one of them."""
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
