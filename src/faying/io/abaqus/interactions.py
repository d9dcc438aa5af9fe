"""``*SURFACE INTERACTION``: pressure over closure, and friction."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from faying.contact.laws import Curve, ExponentialClosure, TableClosure
from faying.contact.laws.coulomb import LARGEST_FRICTION
from faying.exceptions import ModelError
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import Line, lines, only_line, parameter
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.solid_sections import is_of_abaqus
from faying.io.left_out import IGNORABLE
from faying.model.specs import InterfaceSpec

_OTHER_LAWS = (
    "ROUGH", "USER", "TAUMAX", "EXPONENTIAL DECAY", "ANISOTROPIC", "DEPENDENCIES", "TEST DATA",
)  # fmt: skip
_NO_SLIP = 1e6
"""Coefficient of friction from which surfaces stick wherever they touch."""
_ELASTIC_SLIPS = ("SLIP TOLERANCE", "ELASTIC SLIP")


Stick = float | Literal["auto"]
"""Stick stiffness [force/length³], ``inf`` by Lagrange multipliers."""


def tied_slopes(
    deck: Deck, name: str, keyword: Keyword, friction: list[Keyword]
) -> tuple[float, float] | tuple[Literal["hard"], Literal["auto"]]:
    """Return the normal and tangential slopes of a tied interaction; rigid without slopes.

    If a deck has no stick slope, CalculiX 2.20 uses half of the largest E.
    """
    rows = lines(keyword)
    if not rows:
        return "hard", "auto"
    moduli = [lines(elastic)[0] for elastic in deck.of("ELASTIC") if elastic.data]
    stick = max((line.real(0, "a modulus") for line in moduli), default=0.0) / 2
    slope, along = rows[0].real(0, "the slope"), stick
    for line in (lines(member)[0] for member in friction if member.data):
        along = line.real(1, "the stick slope", stick)
    if not (slope > 0 and along > 0):
        keyword.refuse(
            f"its slopes are {slope:g} and {along:g} (*FRICTION); both must be positive", 0
        )
    missing = "" if friction else " (half of the largest E: CalculiX 2.20 asks for *FRICTION)"
    deck.ignored.append(
        f"{name}, which is TIED: an elastic layer of slope {slope:g} and stick slope {along:g}"
        f"{missing}; the coefficient of friction and gaps of the mesh have no effect"
    )
    return slope, along


def read_friction(keyword: Keyword, ignored: list[str]) -> tuple[float, Stick]:
    """Return coefficient and stick stiffness, and note differences to the deck's program."""
    keyword.check()
    laws = [name for name in _OTHER_LAWS if keyword.has(name)]
    rows = lines(keyword)
    if laws or len(rows) > 1:
        what = laws[0] if laws else f"a table of {len(rows)} lines"
        keyword.refuse(
            f"friction by {what} is not supported; give one line with one coefficient, or leave "
            'friction out by ignore = ["friction"]'
        )
    coefficient = rows[0].real(0, "a coefficient") if rows else 0.0
    if not 0 <= coefficient <= LARGEST_FRICTION and coefficient < _NO_SLIP:
        keyword.refuse(
            f"the coefficient of friction is {coefficient:g}; give a number from 0 to "
            f"{LARGEST_FRICTION:g}, or {_NO_SLIP:g} and more for surfaces that never slip",
            0,
        )
    if coefficient > LARGEST_FRICTION:
        ignored.append(
            f"*FRICTION: a coefficient of {coefficient:g} forbids slip; it is {LARGEST_FRICTION:g} "
            "here, which is equivalent as long as no point slips"
        )
        coefficient = LARGEST_FRICTION
    return coefficient, _stiffness(rows[0], ignored) if coefficient else "auto"


def _stiffness(line: Line, ignored: list[str]) -> Stick:
    """Return the stick stiffness of a slope; "auto" for an elastic slip."""
    keyword, slope = line.keyword, line.real(1, "the stick slope", 0.0)
    if keyword.has("SHEAR TRACTION SLOPE"):
        slope = parameter(keyword, "SHEAR TRACTION SLOPE")
    if slope < 0:
        keyword.refuse(f"the stick slope is {slope:g}; give a positive one, or none")
    if slope > 0:
        note = f"*FRICTION: the stick slope {slope:g} is the tangential penalty"
        ignored.append(note)
        return slope
    if keyword.has("LAGRANGE"):
        ignored.append("*FRICTION, LAGRANGE: rigid sticking (tangential penalty inf)")
        return float("inf")
    slip = next((name for name in _ELASTIC_SLIPS if keyword.has(name)), "SLIP TOLERANCE")
    ignored.append(
        f"*FRICTION: the elastic slip of its program ({slip}) makes sticking points softer "
        "where pressure is low; here the tangential penalty is uniform, automatic "
        "unless the study gives tangential_penalty"
    )
    return "auto"


Normal = float | Literal["hard"] | Curve
"""Contact stiffness [force/length³], or pressure over closure."""

_FLAGS = ("PENALTY", "DIRECT", "AUGMENTED LAGRANGE", "NO SEPARATION")


def _surface_behavior(keyword: Keyword, abaqus: bool, ignored: list[str]) -> Normal:
    keyword.check()
    if keyword.has("NO SEPARATION"):
        keyword.refuse("NO SEPARATION is not supported, contact can open here; remove it")
    ignored += [
        f"{flag} of *SURFACE BEHAVIOR: faying enforces contact by its own method"
        for flag in _FLAGS
        if keyword.has(flag)
    ]
    kind = keyword.choice("PRESSURE-OVERCLOSURE")
    if kind == "HARD":
        return "hard"
    if kind in ("EXPONENTIAL", "TABULAR"):
        return _curve(keyword, kind, abaqus)
    line = only_line(keyword, range(1, 4), "the slope (pressure per overclosure)")
    slope = line.positive(0, "the slope")
    for column in range(1, len(line)):
        # CalculiX: tension at large clearance and its range, for node-to-surface contact only.
        line.real(column, "a number", 0.0)
        ignored.append("tension and range after the slope of *SURFACE BEHAVIOR")
    return slope


_STEP, _LARGEST = 0.05, 12.0
"""Step between rows of CalculiX's exponential, and its last row, in the logarithm of pressure."""


def _curve(keyword: Keyword, kind: str, abaqus: bool) -> Curve:
    """Return pressure over closure of EXPONENTIAL, which programs define differently, or TABULAR.

    CalculiX (User's Manual, *SURFACE BEHAVIOR): p = p0 exp(c ln(100) / c0), zero beyond c0 of
    clearance; by a table whose chords are 3e-4 above it. Abaqus: p0 s (e^s - 1) / (e - 1).
    """
    rows = [line.reals("a number") for line in lines(keyword)]
    pairs = 1 if kind == "EXPONENTIAL" else max(len(rows), 2)
    if len(rows) != pairs or any(len(row) != 2 for row in rows):
        keyword.refuse(
            f"{kind} needs {'one line' if pairs == 1 else 'two lines or more'} of two numbers"
        )
    try:
        if kind == "TABULAR":
            pressures, closures = zip(*rows, strict=True)
            return TableClosure(closures=closures, pressures=pressures)
        law = ExponentialClosure(clearance=rows[0][0], pressure=rows[0][1])
    except ModelError as error:
        raise keyword.error(str(error), 0) from error
    if abaqus:
        return law
    powers = np.arange(-np.log(100.0) + _STEP, _LARGEST, _STEP)
    return TableClosure(
        closures=(-law.clearance, *(law.clearance / np.log(100.0) * powers)),
        pressures=(0.0, *(law.pressure * np.exp(powers))),
    )


MEMBERS = ("SURFACE BEHAVIOR", "FRICTION", "CONTACT DAMPING", "GAP CONDUCTANCE")


@dataclass(frozen=True, eq=False)
class Interaction:
    """A ``*SURFACE INTERACTION`` as an interface without sides, and whether it is tied."""

    spec: InterfaceSpec
    tied: bool = False


def read_interactions(deck: Deck) -> dict[str, Interaction]:
    """Read all *SURFACE INTERACTION, by upper-case name."""
    interactions = {}
    along: Stick
    penalty: Normal
    for head, members in deck.groups("SURFACE INTERACTION", *MEMBERS):
        name = head.required("NAME")
        if tied := [member for member in members if _is_tied(member)]:
            stick = [member for member in members if member.name == "FRICTION"]
            slope, along = tied_slopes(deck, name, tied[0], stick)
            spec = InterfaceSpec(name=name, penalty=slope, tangential_penalty=along)
            interactions[name.upper()] = Interaction(spec, tied=True)
            continue
        if "friction" in deck.ignore:
            members = _frictionless(members, deck.ignored)
        penalty, friction, along = "hard", 0.0, "auto"
        for member in members:
            if member.name == "SURFACE BEHAVIOR":
                penalty = _surface_behavior(member, is_of_abaqus(deck), deck.ignored)
            elif member.name == "FRICTION":
                friction, along = read_friction(member, deck.ignored)
            elif member.name == "GAP CONDUCTANCE":
                deck.ignored.append(f"*{member.name} of {head.value('NAME')}")
        spec = InterfaceSpec(name=name, friction=friction, tangential_penalty=along)
        interactions[name.upper()] = Interaction(
            replace(spec, closure=penalty)
            if isinstance(penalty, Curve)
            else replace(spec, penalty=penalty)
        )
    return interactions


def _is_tied(keyword: Keyword) -> bool:
    behaviour = keyword.name == "SURFACE BEHAVIOR"
    return behaviour and keyword.choice("PRESSURE-OVERCLOSURE") == "TIED"


def _frictionless(members: list[Keyword], ignored: list[str]) -> list[Keyword]:
    """Return the member keywords without friction, and note this."""
    frictionless = [member for member in members if member.name != "FRICTION"]
    if len(frictionless) < len(members):
        ignored.append(f"*FRICTION: {IGNORABLE['friction']} (ignore = friction)")
    return frictionless
