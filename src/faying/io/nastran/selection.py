"""Sets of constraints: which apply, by case control, SPCADD and MPCADD."""

from collections.abc import Mapping

from faying.exceptions import FormatError
from faying.io.nastran.cards import Cards
from faying.io.nastran.id_lists import id_list


def selected_sets(
    cards: Mapping[str, Cards], combination: str, members: set[int], chosen: int | None
) -> set[int]:
    """Return the ids of the constraint sets that apply.

    Parameters
    ----------
    combination
        ``"SPCADD"`` or ``"MPCADD"``.
    members
        Ids of the sets that hold constraints.
    chosen
        What case control selects; without a selection (None) all sets apply.

    Raises
    ------
    FormatError
        If the selected set, or one a combination refers to, does not exist.
    """
    combined: dict[int, list[int]] = {}
    for card in cards.get(combination, ()):
        number = card.integer(0)
        parts = id_list(card, [text for text in card.texts[1:] if text])
        unknown = [part for part in parts if part not in members]
        if unknown:
            text = f"set {unknown[0]} is not in the deck; define it or take it out"
            raise card.error(text)
        combined.setdefault(number, []).extend(parts)
    if chosen is None:
        return set(members)
    kind = combination.removesuffix("ADD")
    if chosen not in members and chosen not in combined:
        message = (
            f"case control selects {kind} = {chosen}, but the bulk data have no such set; "
            f"sets are {', '.join(map(str, sorted(members | set(combined)))) or 'none'}"
        )
        raise FormatError(message)
    return ({chosen} & members) | set(combined.get(chosen, []))
