"""PARAM: what scales and lumps masses, and what cannot be scaled."""

from collections.abc import Iterator, Mapping

from faying.io.nastran.cards import Bulk, Card, Cards

LUMPED = (
    "masses are consistent here; Nastran lumps them unless PARAM,COUPMASS,1 is given, which lowers "
    "frequencies: by about 3 % at 10 linear elements to a wave, 14 % at 5, and CBAR then have no "
    "inertia against twist; compare with COUPMASS"
)
"""Elements of length h: consistent over lumped frequencies are
√(3 / (2 + cos k h)), nearly 1 + 3.3 / n² with n elements to a wave."""

_SCALES = frozenset(("CB1", "CB2", "CK1", "CK2", "CK3", "CM1", "CM2", "CP1", "CP2"))


def mass_factor(cards: Mapping[str, Cards], control: Bulk, ignored: list[str]) -> float:
    """Return PARAM,WTMASS (1 if absent) and note the other parameters.

    Parameters
    ----------
    cards
        Of the bulk data.
    control
        PARAM lines of case control, which Nastran takes like those of the bulk data.
    """
    factor = 1.0
    others: set[str] = set()
    for card in _parameters(cards, control):
        name = card.text(0)
        if name == "COUPMASS":
            continue
        if name == "WTMASS":
            factor = card.real(1)
            if not factor > 0:
                card.refuse(f"WTMASS = {factor:g} must be positive", 1)
        elif name in _SCALES:
            if card.real(1) != 1.0:
                card.refuse(f"{name} scales input matrices, which is not supported; remove it", 1)
        elif name:
            others.add(name)
    if others:
        ignored.append(f"PARAM {', '.join(sorted(others))}")
    return factor


def lumps_masses(cards: Mapping[str, Cards], control: Bulk) -> bool:
    """Tell whether Nastran lumps masses, as it does unless PARAM,COUPMASS is positive."""
    chosen = [card for card in _parameters(cards, control) if card.text(0) == "COUPMASS"]
    return not chosen or chosen[-1].integer(1) <= 0


def is_heat(cards: Mapping[str, Cards], control: Bulk) -> bool:
    """Whether PARAM,HEATSTAT makes statics one of heat, whose constraints are temperatures."""
    chosen = [card for card in _parameters(cards, control) if card.text(0) == "HEATSTAT"]
    return any(card.text(1).startswith("Y") for card in chosen)


def _parameters(cards: Mapping[str, Cards], control: Bulk) -> Iterator[Card]:
    """Yield PARAM of case control, then those of the bulk data."""
    yield from control.cards().get("PARAM", ())
    yield from cards.get("PARAM", ())
