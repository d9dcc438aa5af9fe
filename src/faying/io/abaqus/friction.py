"""``*FRICTION`` of a surface interaction: the law of Coulomb, and what its stick stiffness is."""

from dataclasses import dataclass
from typing import Literal

from faying.contact.laws.coulomb import LARGEST_FRICTION
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import optional_real, parameter, real
from faying.io.abaqus.keyword import Keyword

_OTHER_LAWS = (
    "ROUGH", "USER", "TAUMAX", "EXPONENTIAL DECAY", "ANISOTROPIC", "DEPENDENCIES", "TEST DATA",
)  # fmt: skip
_NO_SLIP = 1e6
"""Coefficients from here on say that surfaces stick wherever they touch."""
_ELASTIC_SLIPS = ("SLIP TOLERANCE", "ELASTIC SLIP")


@dataclass(frozen=True, kw_only=True)
class DeckFriction:
    """Coefficient and stick stiffness of an interaction.

    Attributes
    ----------
    coefficient
        μ; zero without friction.
    tangential_penalty : [force/length³]
        c_t; ``inf`` by Lagrange multipliers.
    """

    coefficient: float = 0.0
    tangential_penalty: float | Literal["auto"] = "auto"


FRICTIONLESS = DeckFriction()


def read_friction(members: list[Keyword], ignored: list[str]) -> DeckFriction:
    """Return the friction of an interaction; what its program defines otherwise is noted."""
    friction = FRICTIONLESS
    for keyword in members:
        if keyword.name == "FRICTION":
            friction = _read(keyword, ignored)
    return friction


def tied_slopes(
    deck: Deck, name: str, keyword: Keyword, friction: list[Keyword]
) -> tuple[float, float] | tuple[Literal["hard"], Literal["auto"]]:
    """Return the slopes of a tied interaction along normals and across; without any it is rigid.

    Where a deck has no stick slope CalculiX 2.20 takes half of the largest E.
    """
    rows = keyword.rows()
    if not rows:
        return "hard", "auto"
    first = [(elastic, elastic.rows()[0][0]) for elastic in deck.of("ELASTIC") if elastic.data]
    stick = max((real(elastic, 0, text, "a modulus") for elastic, text in first), default=0.0) / 2
    slope, along = real(keyword, 0, rows[0][0], "the slope"), stick
    for member in friction:
        row = next(iter(member.rows()), [])
        along = optional_real(member, 0, row, 1, stick, "the stick slope")
    if not (slope > 0 and along > 0):
        keyword.refuse(
            f"its slopes are {slope:g} and {along:g} (*FRICTION); both must be positive", 0
        )
    missing = "" if friction else " (half of the largest E: CalculiX 2.20 asks for *FRICTION)"
    deck.ignored.append(
        f"{name}, which is TIED: an elastic layer of slope {slope:g} and stick slope {along:g}"
        f"{missing}; the coefficient of friction and gaps of the mesh do not count"
    )
    return slope, along


def _read(keyword: Keyword, ignored: list[str]) -> DeckFriction:
    keyword.check()
    laws = [name for name in _OTHER_LAWS if keyword.has(name)]
    rows = keyword.rows()
    if laws or len(rows) > 1:
        what = laws[0] if laws else f"a table of {len(rows)} lines"
        keyword.refuse(
            f"friction by {what} is not supported; give one line with one coefficient, or leave "
            'friction out by ignore = ["friction"]'
        )
    coefficient = real(keyword, 0, rows[0][0], "a coefficient") if rows else 0.0
    if not 0 <= coefficient <= LARGEST_FRICTION and coefficient < _NO_SLIP:
        keyword.refuse(
            f"the coefficient of friction is {coefficient:g}; give a number from 0 to "
            f"{LARGEST_FRICTION:g}, or {_NO_SLIP:g} and more for surfaces that never slip",
            0,
        )
    if coefficient > LARGEST_FRICTION:
        ignored.append(
            f"*FRICTION: a coefficient of {coefficient:g} forbids slip; it is {LARGEST_FRICTION:g} "
            "here, which is the same as long as nothing slips"
        )
        coefficient = LARGEST_FRICTION
    if coefficient == 0:
        return FRICTIONLESS
    return DeckFriction(
        coefficient=coefficient, tangential_penalty=_stiffness(keyword, rows[0], ignored)
    )


def _stiffness(keyword: Keyword, row: list[str], ignored: list[str]) -> float | Literal["auto"]:
    """Return the stick stiffness: a slope is the same thing here, an elastic slip is not."""
    slope = optional_real(keyword, 0, row, 1, 0.0, "the stick slope") if len(row) > 1 else 0.0
    if keyword.has("SHEAR TRACTION SLOPE"):
        slope = parameter(keyword, "SHEAR TRACTION SLOPE")
    if slope < 0:
        keyword.refuse(f"the stick slope is {slope:g}; give a positive one, or none")
    if slope > 0:
        note = f"*FRICTION: the stick slope {slope:g} is the tangential penalty"
        ignored.append(note)
        return slope
    if keyword.has("LAGRANGE"):
        ignored.append("*FRICTION, LAGRANGE: nothing moves that sticks (tangential penalty inf)")
        return float("inf")
    slip = next((name for name in _ELASTIC_SLIPS if keyword.has(name)), "SLIP TOLERANCE")
    ignored.append(
        f"*FRICTION: the elastic slip of its program ({slip}) makes sticking points softer "
        "where pressure is low; here the tangential penalty is the same everywhere, automatic "
        "unless the study gives tangential_penalty"
    )
    return "auto"
