"""Named contact parameters: pairs of a name and a value on BCTPARM, BCPARA, BCONPRG, ..."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from faying.contact.laws.coulomb import LARGEST_FRICTION
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card

FRICTION_REMEDY = (
    "faying reads one Coulomb coefficient a pair; remove it, or set friction = 0 in the study"
)
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
"""Parameters without effect on contact here, as the study sets the penalties."""

_CHOICES: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    # Largest gap that Simcenter resets to zero; None leaves gaps and penetrations.
    "INIPENE": ("closed_up_to", {"0": None, "1": None, "2": 0.0, "3": np.inf}),
    # Whether MSC moves nodes within ERROR of the other body onto it.
    "ICOORD": ("within_error", {"0": False, "1": True, "2": False, "3": True}),
    # MSC's friction: none, or by Coulomb's law, smoothed or bilinear.
    "FTYPE": ("slides", {"0": True, "2": False, "6": False}),
    # Kinds of glue differ by moments of shells and by gaps closed in advance.
    **dict.fromkeys(("IGLUE", "TIED"), ("glued", {"0": False, **dict.fromkeys("1234", True)})),
}
"""Names of parameters to fields of :class:`Parameters`, and the meaning of their values."""

_NO_OFFSET = " is not supported; give 'initial_gap' in the study"
_REFUSALS = {
    **dict.fromkeys(("FTYPE", "MU", "FRICMOD"), f": {FRICTION_REMEDY}"),
    **dict.fromkeys(("CINTERF", "OFFSET", "PDEPTH"), _NO_OFFSET),
    "JGLUE": ": glue that breaks at a force is not supported; leave it blank",
}
"""Messages for unsupported values: nonzero values of parameters without choices."""

_WORDS = frozenset(("METHOD",))


@dataclass(frozen=True, eq=False, kw_only=True)
class Parameters:
    """Contact parameters of a pair.

    Attributes
    ----------
    search_distance : [length]
        Largest gap across which faces are paired.
    closed_up_to : [length]
        Largest gap that is closed before the analysis (INIPENE); None for no closing.
    within_error
        Whether gaps within the contact tolerance are closed (ICOORD).
    error : [length]
        Contact tolerance ERROR; zero means the program's default.
    friction
        Coefficient FRIC; None means those of the bodies.
    slides
        Whether MSC's FTYPE = 0 switches friction off, whatever the coefficients.
    glued
        Whether the sides neither open nor slide (IGLUE, TIED).
    """

    search_distance: float = np.inf
    closed_up_to: float | None = None
    within_error: bool = False
    error: float = 0.0
    friction: float | None = None
    slides: bool = False
    glued: bool = False


NO_PARAMETERS = Parameters()


def friction_coefficient(card: Card, field: int) -> float:
    """Return the coefficient of friction in a field; zero where it is blank."""
    text = card.text(field)
    value = numbers.real(text) if text else 0.0
    table = text.isdigit() and value != 0.0
    if value is None or table or not 0 <= value <= LARGEST_FRICTION:
        what = f"not a coefficient from 0 to {LARGEST_FRICTION:g}"
        card.refuse(
            f"FRIC = {text} is {'the id of a table' if table else what}; {FRICTION_REMEDY}", field
        )
    return value


def note_friction(ignored: dict[str, None]) -> None:
    """Note that stick stiffness comes from the study, not from the deck."""
    ignored[
        "stick stiffness of friction (PENT, RVCNST, FRLIM and the like): the tangential penalty "
        "is automatic unless the study gives tangential_penalty"
    ] = None


def read_parameters(
    card: Card, ignored: dict[str, None], parameters: Parameters = NO_PARAMETERS
) -> Parameters:
    """Return parameters updated by a card, which has pairs of name and value after its id.

    Harmless names are added to ``ignored``.
    """
    card.integer(0, 0)
    for pair in _pairs(card):
        name = pair.text(0)
        if name in HARMLESS:
            ignored[f"{card.cards.name} {name}"] = None
        else:
            parameters = with_parameter(parameters, name, pair, 1)
    return parameters


def with_parameter(parameters: Parameters, name: str, card: Card, field: int) -> Parameters:
    """Return parameters updated by the value in a field; a blank changes nothing."""
    text = card.text(field)
    attribute, choices = _CHOICES.get(name, ("", {}))
    if name == "ERROR":
        return replace(parameters, error=card.real(field, parameters.error))
    if name == "FRIC":
        friction = friction_coefficient(card, field) if text else parameters.friction
        return replace(parameters, friction=friction)
    is_nothing = not text or numbers.real(text) == 0.0
    if text not in choices and not (is_nothing and (choices or name in _REFUSALS)):
        refusal = " may change the contact and is not supported; remove it"
        if choices:
            refusal = f" is not supported; give one of {', '.join(choices)}"
        card.refuse(f"{name} = {text}{_REFUSALS.get(name, refusal)}", field)
    return replace(parameters, **{attribute: choices[text]}) if text in choices else parameters


def _pairs(card: Card) -> list[Card]:
    """Return pairs of name and value; blank fields may separate them."""
    pairs = []
    field = 1
    while field < len(card):
        pair = card.part(field, 2)
        name, value = pair.text(0), pair.text(1)
        word = value and numbers.real(value) is None and name not in _WORDS
        if name and (not name[:1].isalpha() or word):
            pair.refuse(
                f"'{name}' with '{value}' is not a parameter and its value; expected pairs like "
                "'PENN', '10.0'"
            )
        pairs += [pair] if name else []
        field += 2 if name else 1
    return pairs
