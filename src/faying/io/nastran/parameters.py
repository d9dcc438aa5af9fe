"""PARAM: what scales masses, and what cannot be scaled."""

from collections.abc import Mapping

from faying.io.nastran.cards import Bulk, Cards

_SCALES = frozenset(("CB1", "CB2", "CK1", "CK2", "CK3", "CM1", "CM2", "CP1", "CP2"))


def mass_factor(cards: Mapping[str, Cards], control: Bulk, ignored: list[str]) -> float:
    """Return PARAM,WTMASS (1 if absent) and note the other parameters.

    Parameters
    ----------
    cards
        Of the bulk data.
    control
        PARAM lines of case control, which Nastran takes like those of the bulk data.

    Raises
    ------
    FormatError
        If a parameter scales matrices in a way that is not supported.
    """
    factor = 1.0
    others: set[str] = set()
    for card in (*control.cards().get("PARAM", ()), *cards.get("PARAM", ())):
        name = card.text(0)
        if name == "WTMASS":
            factor = card.real(1)
            if not factor > 0:
                text = f"WTMASS = {factor:g} must be positive"
                raise card.error(text, 1)
        elif name in _SCALES:
            if card.real(1) != 1.0:
                text = f"{name} scales input matrices, which is not supported; remove it"
                raise card.error(text, 1)
        elif name:
            others.add(name)
    if others:
        ignored.append(f"PARAM {', '.join(sorted(others))}")
    return factor
