"""Named contact parameters: pairs of a name and a value on BCTPARM, BCPARA, BCONPRG, ..."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card, Cards

FRICTION_REMEDY = (
    "faying's contact is frictionless; set it to zero if friction does not matter, or model "
    "sticking by [sticking] in the study"
)
GLUE_REMEDY = "join the bodies at common nodes or by RBE2, or let them touch (no glue)"

HARMLESS = frozenset(
    (
        # Simcenter, BCTPARM and BCTPARA: penalty factors, iterations, tolerances, shells, output
        *("PENN", "PENT", "PENTYP", "PENAUTO", "EPSN", "EPST", "CTOL", "MAXF", "MAXS", "NCHG"),
        *("MPER", "RESET", "SHLTHK", "REFINE", "CSTRAT", "INTORD", "PREVIEW", "AVGSTS", "GUESS"),
        *("SEGNORM", "CSTIFF", "NSIDE", "EXTFAC", "ZOFFSET", "INITENF", "SLFACT", "RTPCHECK"),
        # MSC, BCPARA, BCONPRG and BCONPRP: search, separation tolerances, penalty, heat
        *("BIAS", "COPTS", "COPTM", "COPTS1", "COPTM1", "ISEARCH", "FNTOL", "IBSEP"),
        *("ISPLIT", "PENALT", "AUGDIST", "TPENALT", "STKSLP", "SLIDE", "HARDS", "METHOD"),
        *("MAXENT", "MAXNOD", "NBODIES", "NLGLUE", "TAUGMNT", "LINCNT", "LINQUAD", "RVCNST"),
        *("BEAMB", "ERRBAS", "FTYPE", "DDULMT", "RVCNST", "FRLIM", "JGLUE", "BKGL", "BGM", "BGN"),
        *("BGSN", "BGST", "DQNEAR", "EMISS", "HBL", "HCT", "HCV", "HGLUE", "HNC", "HNL", "BNC"),
        *("BNL", "IDSPL", "ISTYP", "SANGLE", "MIDNOD", "COPTB", "CMB", "CMS", "CFILM", "CHEAT"),
        *("TBODY", "TSINK"),
    )
)
"""Parameters that leave frictionless contact without glue as it is (the study's penalty counts)."""

INIPENE = {"": None, "0": None, "1": None, "2": 0.0, "3": np.inf}
"""Largest gap that Simcenter's INIPENE resets to zero; None leaves gaps and penetrations."""

ICOORD = {"": False, "0": False, "1": True, "2": False, "3": True}
"""Whether MSC's ICOORD moves nodes onto the other body, as far as they are within ERROR of it."""

_WORDS = frozenset(("METHOD",))
_FRICTION = frozenset(("FRIC", "MU", "FRICMOD"))
_OFFSETS = frozenset(("CINTERF", "OFFSET", "PDEPTH"))
_GLUE = frozenset(("IGLUE", "TIED"))


@dataclass(frozen=True, eq=False, kw_only=True)
class Parameters:
    """What the parameters of a card amount to.

    Attributes
    ----------
    closed_up_to : [length]
        Largest gap that is closed before the analysis (INIPENE); None closes none.
    within_error
        Whether gaps within the contact tolerance are closed (ICOORD).
    error : [length]
        The contact tolerance ERROR; zero leaves it to the program.
    """

    closed_up_to: float | None = None
    within_error: bool = False
    error: float = 0.0


def read_parameters(card: Card, first: int, ignored: dict[str, None]) -> Parameters:
    """Check the pairs of names and values from field ``first`` on.

    Harmless names are added to ``ignored``.

    Raises
    ------
    FormatError
        If a parameter brings friction, glue or anything else that is not represented.
    """
    found = Parameters()
    for name, value, at in _pairs(card, first):
        zero = numbers.real(value) == 0.0 if value else True
        if name in _FRICTION and not zero:
            text = f"{name} = {value}: {FRICTION_REMEDY}"
            raise card.error(text, at)
        if name in _GLUE and not zero:
            text = f"{name} = {value}: glued contact is not supported; {GLUE_REMEDY}"
            raise card.error(text, at)
        if name == "INIPENE":
            found = replace(found, closed_up_to=_chosen(card, at, INIPENE))
        elif name == "ICOORD":
            found = replace(found, within_error=_chosen(card, at, ICOORD))
        elif name == "ERROR":
            found = replace(found, error=card.real(at + 1, 0.0))
        elif name in _FRICTION or name in _GLUE:
            pass
        elif name in _OFFSETS:
            if not zero:
                text = f"{name} = {value} is not supported; give 'initial_gap' in the study"
                raise card.error(text, at)
        elif name not in HARMLESS:
            text = f"{name} = {value} may change the contact and is not supported; remove it"
            raise card.error(text, at)
        else:
            ignored[f"{card.cards.name} {name}"] = None
    return found


_Choice = TypeVar("_Choice")


def _chosen(card: Card, at: int, choices: Mapping[str, _Choice]) -> _Choice:
    """Return what the value behind a parameter's name stands for."""
    value = card.text(at + 1)
    if value not in choices:
        known = ", ".join(filter(None, choices))
        text = f"{card.text(at)} = {value} is not supported; give one of {known}"
        raise card.error(text, at)
    return choices[value]


def _pairs(card: Card, first: int) -> list[tuple[str, str, int]]:
    """Names, values and fields; blank fields may stand between pairs."""
    found = []
    at = first
    while at < len(card):
        name = card.text(at)
        if not name:
            at += 1
            continue
        value = card.text(at + 1)
        word = value and numbers.real(value) is None and name not in _WORDS
        if not name[:1].isalpha() or word:
            text = (
                f"'{name}' with '{value}' is no parameter with its value; expected pairs such as "
                "'PENN', '10.0'"
            )
            raise card.error(text, at)
        found.append((name, value, at))
        at += 2
    return found


def by_id(cards: Mapping[str, Cards], name: str) -> dict[int, Card]:
    """Return the cards of a name by the id in their first field.

    Raises
    ------
    FormatError
        If an id occurs twice.
    """
    found: dict[int, Card] = {}
    for card in cards.get(name, ()):
        number = card.integer(0)
        if number in found:
            text = f"{name} {number} is already defined at {found[number].where()}; renumber one"
            raise card.error(text)
        found[number] = card
    return found
