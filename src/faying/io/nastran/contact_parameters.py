"""Named contact parameters: pairs of a name and a value on BCTPARM, BCPARA, BCONPRG, ..."""

from collections.abc import Mapping
from dataclasses import dataclass

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
        *("ERROR", "BIAS", "COPTS", "COPTM", "COPTS1", "COPTM1", "ISEARCH", "FNTOL", "IBSEP"),
        *("ISPLIT", "PENALT", "AUGDIST", "TPENALT", "STKSLP", "SLIDE", "HARDS", "METHOD"),
        *("MAXENT", "MAXNOD", "NBODIES", "NLGLUE", "TAUGMNT", "LINCNT", "LINQUAD", "RVCNST"),
        *("BEAMB", "ERRBAS", "FTYPE", "DDULMT", "RVCNST", "FRLIM", "JGLUE", "BKGL", "BGM", "BGN"),
        *("BGSN", "BGST", "DQNEAR", "EMISS", "HBL", "HCT", "HCV", "HGLUE", "HNC", "HNL", "BNC"),
        *("BNL", "IDSPL", "ISTYP", "SANGLE", "MIDNOD", "COPTB", "CMB", "CMS", "CFILM", "CHEAT"),
        *("TBODY", "TSINK"),
    )
)
"""Parameters that leave frictionless contact without glue as it is (the study's penalty counts)."""

GAP_CLOSING = {"INIPENE": ("", "0", "1"), "ICOORD": ("", "0")}
"""Parameters that move nodes to close gaps, and the values for which they do not."""

_WORDS = frozenset(("METHOD",))
_FRICTION = frozenset(("FRIC", "MU", "FRICMOD"))
_OFFSETS = frozenset(("CINTERF", "OFFSET", "PDEPTH"))
_GLUE = frozenset(("IGLUE", "TIED"))


@dataclass(frozen=True, eq=False, kw_only=True)
class Parameters:
    """What the parameters of a card amount to.

    Attributes
    ----------
    closing
        Parameter that closes gaps, as ``NAME = value`` with its place; empty if there is none.
    """

    closing: str = ""


def read_parameters(card: Card, first: int, ignored: dict[str, None]) -> Parameters:
    """Check the pairs of names and values from field ``first`` on.

    Harmless names are added to ``ignored``.

    Raises
    ------
    FormatError
        If a parameter brings friction, glue or anything else that is not represented.
    """
    closing = ""
    for name, value, at in _pairs(card, first):
        zero = numbers.real(value) == 0.0 if value else True
        if name in _FRICTION and not zero:
            text = f"{name} = {value}: {FRICTION_REMEDY}"
            raise card.error(text, at)
        if name in _GLUE and not zero:
            text = f"{name} = {value}: glued contact is not supported; {GLUE_REMEDY}"
            raise card.error(text, at)
        if name in GAP_CLOSING:
            if value not in GAP_CLOSING[name]:
                closing = f"{card.where()}: {name} = {value}"
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
    return Parameters(closing=closing)


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
