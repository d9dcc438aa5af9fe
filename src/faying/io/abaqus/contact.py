"""``*CONTACT PAIR`` with its ``*SURFACE INTERACTION``: interfaces."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import optional_real, real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.surfaces import DeckSurface, Surfaces, find_surface
from faying.model.specs import InterfaceSpec

MEMBERS = ("SURFACE BEHAVIOR", "FRICTION", "CONTACT DAMPING", "GAP CONDUCTANCE", "CONTACT CONTROLS")
_FLAGS = ("PENALTY", "DIRECT", "AUGMENTED LAGRANGE", "NO SEPARATION")


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A contact pair: the slave is our minus side, which carries the points and the normals."""

    keyword: Keyword
    row: int
    slave: DeckSurface
    master: DeckSurface
    penalty: float | Literal["hard"]
    adjusted: bool
    interaction: str


def read_pairs(deck: Deck, surfaces: Surfaces, ignored: list[str]) -> list[Pair]:
    """Read all *CONTACT PAIR.

    Raises
    ------
    FormatError
        Naming the line of friction, tied contact, or a pressure-overclosure curve that is not
        linear.
    """
    behaviours = {}
    for head, members in deck.groups("SURFACE INTERACTION", *MEMBERS):
        head.allow("NAME", "PAD THICKNESS")
        behaviours[head.required("NAME").upper()] = _behaviour(head, members, ignored)
    pairs = []
    for keyword in deck.of("CONTACT PAIR"):
        pairs += _pairs(keyword, surfaces, behaviours, ignored)
    return pairs


def _pairs(
    keyword: Keyword,
    surfaces: Surfaces,
    behaviours: Mapping[str, float | Literal["hard"]],
    ignored: list[str],
) -> list[Pair]:
    keyword.allow("INTERACTION", "TYPE", "SMALL SLIDING", "ADJUST", "EXTENSION ZONE", "CPSET",
                  "MECHANICAL CONSTRAINT", "GEOMETRIC CORRECTION", "SMOOTH", "HCRIT", "TRACKING",
                  "SUPPLEMENTARY CONSTRAINTS", "SLIDING TRANSITION")  # fmt: skip
    name = keyword.required("INTERACTION")
    if name.upper() not in behaviours:
        message = f"there is no *SURFACE INTERACTION '{name}'; define it or correct the name"
        raise keyword.error(message)
    note = f"formulation of *CONTACT PAIR: small sliding, {keyword.choice('TYPE', 'default')}"
    if note not in ignored:
        ignored.append(note)
    pairs = []
    for row, fields in enumerate(keyword.rows()):
        if len(fields) != 2 or not all(fields):
            message = f"found {len(fields)} fields, expected the slave and the master surface"
            raise keyword.error(message, row)
        slave, master = (find_surface(surfaces, keyword, text, row) for text in fields)
        for side in (slave, master):
            if not side.facets:
                message = (
                    f"surface '{side.name}' has no facets; contact needs TYPE=ELEMENT surfaces "
                    "on both sides"
                )
                raise keyword.error(message, row)
        pairs.append(
            Pair(
                keyword=keyword,
                row=row,
                slave=slave,
                master=master,
                penalty=behaviours[name.upper()],
                adjusted=keyword.has("ADJUST"),
                interaction=name,
            )
        )
    return pairs


def _behaviour(
    head: Keyword, members: list[Keyword], ignored: list[str]
) -> float | Literal["hard"]:
    """Contact stiffness of an interaction; hard where it says nothing."""
    penalty: float | Literal["hard"] = "hard"
    for member in members:
        if member.name == "SURFACE BEHAVIOR":
            penalty = _surface_behavior(member, ignored)
        elif member.name == "FRICTION":
            _check_frictionless(member)
        elif member.name == "CONTACT DAMPING":
            message = "damping in contact is not supported; remove it"
            raise member.error(message)
        else:
            ignored.append(f"*{member.name} of {head.value('NAME')}")
    return penalty


def _surface_behavior(keyword: Keyword, ignored: list[str]) -> float | Literal["hard"]:
    keyword.allow("PRESSURE-OVERCLOSURE", *_FLAGS)
    if keyword.has("NO SEPARATION"):
        message = "NO SEPARATION is not supported; faying's contact opens"
        raise keyword.error(message)
    ignored += [
        f"{flag} of *SURFACE BEHAVIOR: faying enforces contact in its own way"
        for flag in _FLAGS
        if keyword.has(flag)
    ]
    kind = keyword.choice("PRESSURE-OVERCLOSURE", "HARD")
    if kind == "HARD":
        return "hard"
    if kind != "LINEAR":
        message = f"PRESSURE-OVERCLOSURE={kind} is not supported; give LINEAR (a slope) or HARD"
        raise keyword.error(message)
    rows = keyword.rows()
    if len(rows) != 1 or not 1 <= len(rows[0]) <= 3:
        message = "expected one data line with the slope (pressure per overclosure)"
        raise keyword.error(message)
    slope = real(keyword, 0, rows[0][0], "the slope")
    if not slope > 0:
        message = f"the slope is {slope:g}; it must be positive"
        raise keyword.error(message, 0)
    for column in range(1, len(rows[0])):
        # CalculiX: tension at large clearance and its range, for node-to-surface contact only.
        optional_real(keyword, 0, rows[0], column, 0.0, "a number")
        ignored.append("tension and range behind the slope of *SURFACE BEHAVIOR")
    return slope


def _check_frictionless(keyword: Keyword) -> None:
    rows = keyword.rows()
    rough = keyword.has("ROUGH") or keyword.has("USER")
    values = [real(keyword, 0, text, "a coefficient") for text in rows[0][:1]] if rows else []
    if rough or any(values) or len(rows) > 1:
        message = (
            "friction is not supported; remove it (coefficient 0), and let faying hold the "
            "sticking area by springs ([sticking] in the study)"
        )
        raise keyword.error(message)


def interface_names(pairs: list[Pair]) -> list[str]:
    """Names of interfaces: that of the interaction, with both surfaces where it is used twice."""
    names = [pair.interaction for pair in pairs]
    return [
        name if names.count(name) == 1 else f"{name} {pair.slave.name} {pair.master.name}"
        for name, pair in zip(names, pairs, strict=True)
    ]


def specs(pairs: list[Pair]) -> tuple[InterfaceSpec, ...]:
    """Return the pairs as interfaces."""
    return tuple(
        InterfaceSpec(name=name, minus=pair.slave.name, plus=pair.master.name, penalty=pair.penalty)
        for name, pair in zip(interface_names(pairs), pairs, strict=True)
    )
