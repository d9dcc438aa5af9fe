"""Steps that change the structure, which is one and the same for all steps here."""

from faying.io.abaqus.deck import Deck
from faying.io.abaqus.keyword import Keyword


def step_before_changes(deck: Deck, ignored: list[str]) -> int | None:
    """Return the last general step in front of the first that changes the structure, and note it.

    None if no step changes it, or none comes before: the last step is read then, and refused if
    something in it is not supported.
    """
    first = next((k for k in deck.keywords if k.step > 1 and _changes(k)), None)
    aside = {k.step for k in deck.of("STEP") if k.has("PERTURBATION")}
    if first is None or any(k.step == 1 and _changes(k) for k in deck.keywords):
        return None
    earlier = [number for number in range(1, first.step) if number not in aside]
    if not earlier:
        return None
    ignored.append(
        f"steps from {first.step} on: *{first.name} ({first.where()}) changes the structure there; "
        f"step {earlier[-1]} is read"
    )
    return earlier[-1]


def _changes(keyword: Keyword) -> bool:
    if keyword.name == "EQUATION":
        return keyword.has("REMOVE") or keyword.has("REMOVE ALL")
    return keyword.name == "MODEL CHANGE" or keyword.name.startswith("CHANGE ")
