"""Named contact parameters: pairs of a name and a value on BCTPARM, BCPARA, BCONPRG, ..."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from faying.contact.laws.coulomb import LARGEST_FRICTION
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card

FRICTION_REMEDY = (
    "only Coulomb's friction with one coefficient for a pair is read; remove it, or set friction = "
    "0 in the study"
)
COULOMB = ("2", "6")
"""MSC's FTYPE of friction by Coulomb's law, smoothed or bilinear."""
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
        *("BEAMB", "ERRBAS", "DDULMT", "RVCNST", "FRLIM", "BKGL", "BGM", "BGN"),
        *("BGSN", "BGST", "DQNEAR", "EMISS", "HBL", "HCT", "HCV", "HGLUE", "HNC", "HNL", "BNC"),
        *("BNL", "IDSPL", "ISTYP", "SANGLE", "MIDNOD", "COPTB", "CMB", "CMS", "CFILM", "CHEAT"),
        *("TBODY", "TSINK"),
        # Simcenter, BGPARM: glue is as stiff as the program makes it
        *("GLUETYPE", "PENGLUE", "ESOPT"),
    )
)
"""Parameters that leave contact without glue as it is (the study's penalties count)."""

INIPENE = {"": None, "0": None, "1": None, "2": 0.0, "3": np.inf}
"""Largest gap that Simcenter's INIPENE resets to zero; None leaves gaps and penetrations."""

ICOORD = {"": False, "0": False, "1": True, "2": False, "3": True}
"""Whether MSC's ICOORD moves nodes onto the other body, as far as they are within ERROR of it."""

_WORDS = frozenset(("METHOD",))
_OTHER_FRICTION = frozenset(("MU", "FRICMOD"))
_OFFSETS = frozenset(("CINTERF", "OFFSET", "PDEPTH"))
_KINDS_OF_GLUE = 4
"""MSC's kinds of IGLUE differ by moments of shells and by gaps that are closed beforehand."""


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
    friction
        Coefficient FRIC; None leaves it to the bodies.
    slides
        Whether MSC's FTYPE = 0 switches friction off, whatever the coefficients.
    glued
        Whether the sides neither open nor slide (IGLUE, TIED).
    """

    closed_up_to: float | None = None
    within_error: bool = False
    error: float = 0.0
    friction: float | None = None
    slides: bool = False
    glued: bool = False


def friction_coefficient(card: Card, field: int, name: str = "FRIC") -> float:
    """Return the coefficient of friction in a field; zero where it is blank."""
    text = card.text(field)
    value = numbers.real(text) if text else 0.0
    table = text.isdigit() and value != 0.0
    if value is None or table or not 0 <= value <= LARGEST_FRICTION:
        what = f"no coefficient from 0 to {LARGEST_FRICTION:g}"
        card.refuse(
            f"{name} = {text} is {'the id of a table' if table else what}; {FRICTION_REMEDY}", field
        )
    return value


def note_friction(ignored: dict[str, None]) -> None:
    """Note how friction sticks elsewhere."""
    ignored[
        "stick stiffness of friction (PENT, RVCNST, FRLIM and the like): the tangential penalty "
        "is automatic unless the study gives tangential_penalty"
    ] = None


def read_parameters(card: Card, first: int, ignored: dict[str, None]) -> Parameters:
    """Check the pairs of names and values from field ``first`` on.

    Harmless names are added to ``ignored``.
    """
    parameters = Parameters()
    for name, value, field in _pairs(card, first):
        zero = numbers.real(value) == 0.0 if value else True
        if name in _OTHER_FRICTION and not zero:
            card.refuse(f"{name} = {value}: {FRICTION_REMEDY}", field)
        if name in _READ:
            attribute, read = _READ[name]
            parameters = replace(parameters, **{attribute: read(card, field)})
        elif name == "JGLUE":
            refuse_letting_go(card, field + 1)
        elif name in _OTHER_FRICTION:
            pass
        elif name in _OFFSETS:
            if not zero:
                card.refuse(
                    f"{name} = {value} is not supported; give 'initial_gap' in the study", field
                )
        elif name not in HARMLESS:
            card.refuse(
                f"{name} = {value} may change the contact and is not supported; remove it", field
            )
        else:
            ignored[f"{card.cards.name} {name}"] = None
    return parameters


def is_glued(card: Card, field: int) -> bool:
    """Return whether a field asks for glue, of whichever of the four kinds."""
    value = card.integer(field, 0)
    if not 0 <= value <= _KINDS_OF_GLUE:
        card.refuse(f"glue of kind {value} is not known; give one of 0 to {_KINDS_OF_GLUE}", field)
    return value > 0


def refuse_letting_go(card: Card, field: int) -> None:
    """Raise if glue lets go at a force."""
    if card.integer(field, 0):
        card.refuse("JGLUE: glue that lets go at a force is not supported; leave it blank", field)


def _slides(card: Card, field: int) -> bool:
    """Return whether FTYPE switches friction off."""
    value = card.text(field + 1)
    if value not in ("", "0", *COULOMB):
        card.refuse(f"FTYPE = {value}: {FRICTION_REMEDY}", field)
    return value == "0"


_Choice = TypeVar("_Choice")


def _chosen(card: Card, field: int, choices: Mapping[str, _Choice]) -> _Choice:
    """Return what the value behind a parameter's name stands for."""
    value = card.text(field + 1)
    if value not in choices:
        names = ", ".join(filter(None, choices))
        card.refuse(f"{card.text(field)} = {value} is not supported; give one of {names}", field)
    return choices[value]


_READ: Mapping[str, tuple[str, Callable[[Card, int], Any]]] = {
    "INIPENE": ("closed_up_to", lambda card, field: _chosen(card, field, INIPENE)),
    "ICOORD": ("within_error", lambda card, field: _chosen(card, field, ICOORD)),
    "ERROR": ("error", lambda card, field: card.real(field + 1, 0.0)),
    "FRIC": ("friction", lambda card, field: friction_coefficient(card, field + 1)),
    "FTYPE": ("slides", _slides),
    **dict.fromkeys(("IGLUE", "TIED"), ("glued", lambda card, field: is_glued(card, field + 1))),
}
"""Names to what of :class:`Parameters` they give, and how it is read at the field of the name."""


def _pairs(card: Card, first: int) -> list[tuple[str, str, int]]:
    """Names, values and fields; blank fields may stand between pairs."""
    pairs = []
    field = first
    while field < len(card):
        name = card.text(field)
        if not name:
            field += 1
            continue
        value = card.text(field + 1)
        word = value and numbers.real(value) is None and name not in _WORDS
        if not name[:1].isalpha() or word:
            card.refuse(
                f"'{name}' with '{value}' is no parameter with its value; expected pairs such as "
                "'PENN', '10.0'",
                field,
            )
        pairs.append((name, value, field))
        field += 2
    return pairs
