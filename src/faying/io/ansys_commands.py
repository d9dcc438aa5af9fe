"""Commands of an Ansys archive between its blocks, and the handling of element routines."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

_BLOCKS = frozenset(("NBLO", "EBLO", "CMBL", "RLBL", "ETBL", "SECB", "SFEB", "BFBL", "BFEB"))
"""Commands whose data are the following lines of numbers."""

LEFT_OUT: Mapping[str, str] = {
    "D": 'supports (D): hold components by [[support]] with set = "…"',
    "F": "forces (F): give them in the [[load_case]] of the study, at a [[boundary]]",
    "SFE": "pressures (SFE): give their sum as forces of a [[load_case]], at a [[boundary]]",
    "SFEB": "pressures (SFEBLOCK): give their sum as forces of a [[load_case]]",
    "SF": "pressures (SF): give their sum as forces of a [[load_case]], at a [[boundary]]",
    "BF": "temperatures (BF): thermal expansion is not read",
    "BFE": "temperatures (BFE): thermal expansion is not read",
    "BFBL": "temperatures (BFBLOCK): thermal expansion is not read",
    "CE": "constraint equations (CE, also from CERIG and RBE3): they are not read; "
    'couple a face by [[boundary]] with coupling = "rbe2" or "rbe3", or use .full matrices',
    "CP": "coupled sets (CP): they are not read; share nodes, or use .full matrices",
    "TB": "tables of materials (TB): materials are linear and isotropic here",
    "ACEL": "accelerations (ACEL): weight is not read as a load",
    "OMEG": "rotation (OMEGA): centrifugal forces are not read as a load",
    "SLOA": "pretension (SLOAD): give it as preload of a [[bolt]]",
}
"""Description and advice for commands that change results, by their first four letters."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ArchiveCommands:
    """Contents of the commands of an archive.

    Attributes
    ----------
    options
        Key options of element types that are not zero, by number.
    constants
        Constants of materials at one temperature, by name.
    tables
        Names of the constants of materials that depend on temperature.
    counts
        Number of commands of :data:`LEFT_OUT`, by their first four letters.
    pretensions
        Number of pretension sections.
    """

    options: Mapping[int, Mapping[int, int]] = field(default_factory=dict)
    constants: Mapping[int, Mapping[str, float]] = field(default_factory=dict)
    tables: Mapping[int, frozenset[str]] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)
    pretensions: int = 0

    def notes(self) -> Iterator[str]:
        """Yield notes on commands that are not read, with advice."""
        for name, meaning in LEFT_OUT.items():
            if self.counts.get(name):
                yield f"{self.counts[name]} commands of {meaning}"
        if self.pretensions:
            yield (
                f"{self.pretensions} pretension sections: the bolts are cut there, and the two "
                "faces of the cut touch; delete the sections and merge the nodes (NUMMRG) before "
                "CDWRITE, and tighten the bolts by [[bolt]] with an axis"
            )


def read_commands(path: Path) -> ArchiveCommands:
    """Read the commands of an archive in one pass over its lines.

    Parameters and formulas in place of numbers are skipped:
    an archive written by CDWRITE has none.
    """
    options: dict[int, dict[int, int]] = {}
    constants: dict[int, dict[str, float]] = {}
    tables: dict[int, frozenset[str]] = {}
    counts: Counter[str] = Counter()
    pretensions, block = 0, ""
    with path.open(encoding="latin-1") as file:
        for line in file:
            start = line.lstrip()[:1]
            if not start.isalpha():
                if block == "ETBL":
                    _type_of_block(line, options)
                continue
            fields = [part.strip() for part in line.partition("!")[0].split(",")]
            name = fields[0].upper()[:4]
            block = name if name in _BLOCKS else ""
            if name == "KEYO":
                _set_option(fields, options)
            elif name in ("MP", "MPDA", "UIMP"):
                _constant(name, fields, constants, tables)
            elif name == "SECT" and len(fields) > 2 and fields[2].upper().startswith("PRET"):
                pretensions += 1
            elif name in LEFT_OUT and _applies(name, fields):
                counts[name] += 1
    return ArchiveCommands(
        options=options,
        constants=constants,
        tables=tables,
        counts=counts,
        pretensions=pretensions,
    )


def _applies(name: str, fields: Sequence[str]) -> bool:
    """Return whether a command has data, unlike the heads and tails that CDWRITE writes."""
    if name == "CE":
        return not (len(fields) > 2 and fields[2].upper() == "NODE")
    if name in ("ACEL", "OMEG"):
        return any(_real(text) for text in fields[1:4])
    return len(fields) > 2


def _type_of_block(line: str, options: dict[int, dict[int, int]]) -> None:
    """Read a line of ETBLOCK: a type, its routine and its key options, nine letters each."""
    numbers = [_whole(line[i : i + 9]) for i in range(0, len(line.rstrip()), 9)]
    if len(numbers) < 3 or numbers[0] is None or numbers[0] < 1:
        return
    chosen = {option: n for option, n in enumerate(numbers[2:], start=1) if n}
    options.setdefault(numbers[0], {}).update(chosen)


def _set_option(fields: Sequence[str], options: dict[int, dict[int, int]]) -> None:
    if len(fields) < 4:
        return
    kind, option, value = (_whole(text) for text in fields[1:4])
    if kind is not None and option is not None and value is not None:
        options.setdefault(kind, {})[option] = value


def _constant(
    name: str,
    fields: Sequence[str],
    constants: dict[int, dict[str, float]],
    tables: dict[int, frozenset[str]],
) -> None:
    """Read MP, UIMP (label, material, value, …) or MPDATA (release, label, material, place, …)."""
    arguments = list(fields[1:])
    if name == "MPDA" and arguments and arguments[0][:1].upper() == "R" and len(arguments) > 1:
        arguments = arguments[2:]  # release and number of values
    if name == "UIMP":
        arguments = arguments[1:2] + arguments[:1] + arguments[4:]
    label, number = (
        arguments[0].upper() if arguments else "",
        _whole(arguments[1]) if len(arguments) > 1 else None,
    )
    values = [_real(text) for text in (arguments[3:] if name == "MPDA" else arguments[2:])]
    constant = [value for value in values if value is not None]
    if number is None or not constant:
        return
    first = _whole(arguments[2]) if name == "MPDA" else 1
    later = first not in (None, 1) or len(constant) > 1
    if later and any(value != 0.0 for value in constant[1:] or constant):
        tables[number] = tables.get(number, frozenset()) | {label}
    if first in (None, 1):
        constants.setdefault(number, {})[label] = constant[0]


def _whole(text: str) -> int | None:
    text = text.strip()
    return int(text) if text.lstrip("-").isdecimal() else None


def _real(text: str) -> float | None:
    try:
        return float(text.replace("D", "E").replace("d", "e"))
    except ValueError:
        return None


BRICKS_8 = frozenset((45, 185))
BRICKS_20 = frozenset((95, 186))
TETRAHEDRA_10 = frozenset((92, 187))
NO_STRUCTURE = frozenset((151, 152, 153, 154, 200))
"""Routines without stiffness: MESH200 is a mesh alone, SURF151 to SURF154 carry loads."""

CONTACTS, TARGETS = frozenset((173, 174)), frozenset((170,))

_JOINED = "they are not read; couple a face by [[boundary]], or use .full matrices"
_STRUCTURE = "model them as solids, or use .full matrices"
_SPRINGS = "they are not read; use .full matrices"

OTHERS: Mapping[int, tuple[str, str]] = {
    14: ("COMBIN14", _SPRINGS),
    21: ("MASS21", "they are not read; use .full matrices"),
    39: ("COMBIN39", _SPRINGS),
    40: ("COMBIN40", _SPRINGS),
    180: ("LINK180", _STRUCTURE),
    181: ("SHELL181", _STRUCTURE),
    281: ("SHELL281", _STRUCTURE),
    63: ("SHELL63", _STRUCTURE),
    188: ("BEAM188", "bolts are made by [[bolt]] with an axis; else use .full matrices"),
    189: ("BEAM189", "bolts are made by [[bolt]] with an axis; else use .full matrices"),
    4: ("BEAM4", "bolts are made by [[bolt]] with an axis; else use .full matrices"),
    184: ("MPC184", _JOINED),
    175: ("CONTA175", _JOINED),
    176: ("CONTA176", _JOINED),
    177: ("CONTA177", _JOINED),
    178: ("CONTA178", "contact is between surfaces; name their sides in an [[interface]]"),
    179: (
        "PRETS179",
        "the bolts are cut at their sections without a connection; delete the sections and "
        "merge the nodes (NUMMRG) before CDWRITE, and tighten by [[bolt]] with an axis",
    ),
    190: ("SOLSH190", "change them to SOLID185"),
    285: ("SOLID285", "change them to SOLID187"),
    65: ("SOLID65", "change them to SOLID185"),
}
"""Names of routines that are not read, and advice."""

_BRICK_OPTIONS: Mapping[tuple[int, int, int], str] = {
    (185, 2, 0): "selective reduced integration (B-bar), stiffer in bending than here",
    (185, 2, 1): "uniform reduced integration, softer in bending than here",
    (45, 1, 1): "no extra shapes, stiffer in bending than here",
    (45, 2, 1): "uniform reduced integration, softer in bending than here",
}
"""Formulation of Ansys' eight-node bricks, by routine, key option and its value."""


def is_reduced(routine: int, options: Mapping[int, int]) -> bool:
    """Return whether twenty-node bricks have eight points: SOLID186 has, unless KEYOPT(2) = 1."""
    return options.get(2, 0) != 1 if routine == 186 else options.get(11, 0) == 1


def brick_note(routine: int, options: Mapping[int, int]) -> str:
    """Return a note if Ansys formulates eight-node bricks differently; empty otherwise."""
    for (number, option, value), meaning in _BRICK_OPTIONS.items():
        if number == routine and options.get(option, 0) == value:
            return (
                f"SOLID{routine} with KEYOPT({option}) = {value}: {meaning}, where bricks have "
                'incompatible modes; element = "standard" under [model] leaves these out'
            )
    return ""


def left_out_note(routine: int, count: int) -> str:
    """Return a note on elements that are not read."""
    name, remedy = OTHERS.get(
        routine, (f"routine {routine}", "model them in the study, or use .full matrices")
    )
    return f"{count} elements {name}: {remedy}"
