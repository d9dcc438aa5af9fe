"""A keyword of a deck: its place in the file, its data lines and its parameters."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NoReturn, TypeVar

import numpy as np

from faying._typing import Matrix
from faying.display.facts import listed
from faying.exceptions import FormatError
from faying.io.abaqus.left_out import KEYWORDS
from faying.io.deck_lines import Lines

_COMMENTS = (b"**", b">*")
"""``**`` starts a comment, as does ``>*`` in the first lines of some CalculiX decks."""


@dataclass(frozen=True, eq=False)
class Body:
    """The lines after a keyword, up to the next one."""

    lines: Lines

    @cached_property
    def data(self) -> list[bytes]:
        """Lines as written, without comments and blank lines."""
        return [line for line in self.lines.text.split() if is_content(line)]

    def where(self, row: int) -> str:
        """Return file:line of a data line."""
        rows = [i for i, line in enumerate(self.lines.text.split()) if is_content(line)]
        return self.lines.where(rows[row])


def is_content(line: bytes) -> bool:
    """Return whether a line is neither blank nor a comment."""
    mark = line.lstrip()[:2]
    return bool(mark) and mark not in _COMMENTS


def without_blanks(name: str) -> str:
    """Return a name in upper case without blanks."""
    return "".join(name.upper().split())


_TAKES: Mapping[str, str] = {
    "NODE": "NSET, SYSTEM=R|C|S, INPUT",
    "SYSTEM": "",
    "ELEMENT": "TYPE*, ELSET, DLOAD",
    "NSET": "NSET*, GENERATE, INSTANCE, INTERNAL, UNSORTED, ELSET, FREQUENCY",
    "ELSET": "ELSET*, GENERATE, INSTANCE, INTERNAL, UNSORTED",
    "SURFACE": "NAME*, TYPE=ELEMENT|NODE, INTERNAL",
    "PART": "NAME*",
    "INSTANCE": "NAME*, PART*",
    "TRANSFORM": "NSET*, TYPE=R|C|S",
    "ORIENTATION": "NAME*, SYSTEM=RECTANGULAR|R|CYLINDRICAL|C, DEFINITION=COORDINATES",
    "AMPLITUDE": "NAME*, TIME=STEP TIME|TOTAL TIME, VALUE=RELATIVE, DEFINITION=TABULAR, SHIFTX, "
    "SHIFTY, SMOOTH",
    "MATERIAL": "NAME*",
    "ELASTIC": "TYPE, MODULI",
    "DENSITY": "",
    "EXPANSION": "TYPE=ISOTROPIC|ISO, ZERO",
    "SOLID SECTION": "ELSET*, MATERIAL*, ORIENTATION, CONTROLS, STACK DIRECTION",
    "SHELL SECTION": "ELSET*, MATERIAL*, OFFSET, ORIENTATION, SECTION INTEGRATION, POISSON, "
    "DENSITY, CONTROLS",
    "BEAM SECTION": "ELSET*, MATERIAL*, SECTION*, POISSON, TEMPERATURE",
    "BEAM GENERAL SECTION": "ELSET*, SECTION=GENERAL, DENSITY, POISSON",
    "SPRING": "ELSET*",
    "MASS": "ELSET*, TYPE=ISOTROPIC",
    "ROTARY INERTIA": "ELSET*",
    "BOUNDARY": "OP=MOD|NEW, TYPE=DISPLACEMENT, AMPLITUDE, TIME DELAY, FIXED, NAME",
    "CLOAD": "OP=MOD|NEW, AMPLITUDE, TIME DELAY, LOAD CASE, OMEGA0, NAME",
    "DLOAD": "OP=MOD|NEW, AMPLITUDE, TIME DELAY, CONSTANT RESULTANT, NAME",
    "DSLOAD": "OP=MOD|NEW, AMPLITUDE, TIME DELAY, CONSTANT RESULTANT, NAME",
    "TEMPERATURE": "OP=MOD|NEW, AMPLITUDE, TIME DELAY, NAME",
    "INITIAL CONDITIONS": "TYPE",
    "EQUATION": "",
    "MPC": "",
    "RIGID BODY": "NSET, ELSET, REF NODE, ROT NODE, PIN NSET, TIE NSET, POSITION=INPUT",
    "COUPLING": "CONSTRAINT NAME, REF NODE*, SURFACE*, ORIENTATION",
    "KINEMATIC": "",
    "DISTRIBUTING": "COUPLING=CONTINUUM|STRUCTURAL, WEIGHTING METHOD=UNIFORM",
    "DISTRIBUTING COUPLING": "ELSET*",
    "PRE-TENSION SECTION": "SURFACE, ELEMENT, NODE*",
    "TIE": "NAME, ADJUST, POSITION TOLERANCE, TYPE, NO ROTATION, NO THICKNESS, CONSTRAINT RATIO",
    "CONTACT INCLUSIONS": "ALL EXTERIOR",
    "CONTACT PROPERTY ASSIGNMENT": "",
    "CONTACT PAIR": "INTERACTION*, TYPE, SMALL SLIDING, ADJUST, EXTENSION ZONE, CPSET, "
    "MECHANICAL CONSTRAINT, GEOMETRIC CORRECTION, SMOOTH, HCRIT, TRACKING, "
    "SUPPLEMENTARY CONSTRAINTS, SLIDING TRANSITION, NO THICKNESS",
    "SURFACE INTERACTION": "NAME*, PAD THICKNESS",
    "SURFACE BEHAVIOR": "PRESSURE-OVERCLOSURE=HARD|LINEAR|TABULAR|EXPONENTIAL, PENALTY, DIRECT, "
    "AUGMENTED LAGRANGE, NO SEPARATION",
    "FRICTION": "LAGRANGE, SHEAR TRACTION SLOPE, SLIP TOLERANCE, ELASTIC SLIP, ROUGH, USER, "
    "TAUMAX, EXPONENTIAL DECAY, ANISOTROPIC, DEPENDENCIES, TEST DATA",
    "CLEARANCE": "MASTER*, SLAVE*, VALUE*",
    "MODEL CHANGE": "TYPE, REMOVE, ADD",
}
"""Parameters of each keyword: ``*`` is required, after ``=`` are the supported values, of
which the first is the default."""

READ = frozenset(_TAKES) - {"PART", "INSTANCE", "INITIAL CONDITIONS", "MODEL CHANGE"} | frozenset(
    (
        *("CONDUCTIVITY", "SPECIFIC HEAT", "LATENT HEAT", "INELASTIC HEAT FRACTION", "CONTACT"),
        *("TRANSVERSE SHEAR STIFFNESS", "GAP CONDUCTANCE", "SECTION CONTROLS", "DISTRIBUTION"),
    )
)
"""Keywords whose data are read, or refused for their content."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter of a keyword with its allowed values; empty allows any."""

    name: str
    required: bool
    choices: tuple[str, ...]


def _parameter(text: str) -> Parameter:
    name, _, choices = text.partition("=")
    return Parameter(
        name=name.rstrip("*"),
        required=name.endswith("*"),
        choices=tuple(filter(None, choices.split("|"))),
    )


PARAMETERS: Mapping[str, Mapping[str, Parameter]] = {
    keyword: {
        without_blanks(text.partition("=")[0].rstrip("*")): _parameter(text)
        for text in filter(None, takes.split(", "))
    }
    for keyword, takes in _TAKES.items()
}
"""Parameters of each keyword, by names without blanks."""

_STRUCTURE = (
    *("PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE", "INCLUDE"),
)


_KNOWN: Mapping[str, str] = {
    without_blanks(name): name for name in (*READ, *KEYWORDS.names(), *_STRUCTURE)
}


def keyword_name(text: str) -> str:
    """Return the usual spelling of a keyword; single blanks in an unknown one."""
    return _KNOWN.get(without_blanks(text), " ".join(text.upper().split()))


T = TypeVar("T")


@dataclass(frozen=True, eq=False, kw_only=True)
class Scope:
    """The scope of ids and names in a keyword's data: the whole deck or an instance.

    Attributes
    ----------
    name
        Name of the instance; empty for a deck without parts, for its assembly and its steps.
    offset
        Offset of node and element ids, which may repeat between instances.
    rotation : (3, 3), translation : (3,)
        Position of the instance: x = rotation · x_part + translation.
    """

    name: str = ""
    offset: int = 0
    rotation: Matrix = field(default_factory=lambda: np.eye(3))
    translation: Matrix = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True, eq=False, kw_only=True)
class Keyword:
    """A keyword of a deck with its parameters and data.

    Attributes
    ----------
    name
        Upper case, single blanks: ``"SOLID SECTION"``.
    parameters
        Values as written by upper-case name without blanks; flags have an empty value. The
        methods accept names with or without blanks.
    body
        Data lines.
    place
        File and line of the keyword line.
    step
        Number of its step, from 1; 0 before the first step.
    """

    name: str
    parameters: Mapping[str, str]
    body: Body
    place: str
    scope: Scope = field(default_factory=Scope)
    step: int = 0

    @property
    def data(self) -> list[bytes]:
        """Data lines as written, without comments and blank lines."""
        return self.body.data

    def where(self, row: int | None = None) -> str:
        """Return file:line of the keyword, or of a data line."""
        return self.place if row is None else self.body.where(row)

    def error(self, text: str, row: int | None = None) -> FormatError:
        """Return an error with file, line and keyword; ``row`` is a data line."""
        return FormatError(f"{self.where(row)}: *{self.name}: {text}")

    def refuse(self, text: str, row: int | None = None) -> NoReturn:
        """Raise the error of :meth:`error`."""
        raise self.error(text, row)

    def has(self, name: str) -> bool:
        """Return whether a parameter is given."""
        return without_blanks(name) in self.parameters

    def value(self, name: str, default: str = "") -> str:
        """Return the value of a parameter."""
        return self.parameters.get(without_blanks(name), default)

    def choice(self, name: str, default: str = "") -> str:
        """Return the value of a parameter in upper case with single blanks.

        A missing parameter has the value ``default``, or the default of the table of parameters.
        """
        row = PARAMETERS.get(self.name, {}).get(without_blanks(name))
        usual = default or next(iter(row.choices if row else ()), "")
        return " ".join(self.value(name, usual).upper().split())

    def required(self, name: str) -> str:
        """Return the value of a required parameter."""
        value = self.value(name)
        if not value:
            self.refuse(f"the parameter {name} is missing; give {name}=…")
        return value

    def check(self) -> None:
        """Refuse unknown parameters and values, and missing required parameters."""
        table = PARAMETERS[self.name]
        for name in self.parameters:
            if name not in table:
                names = ", ".join(row.name for row in table.values())
                allowed = f"known are {names}" if names else "it has no parameters"
                self.refuse(
                    f"the parameter {name} is not supported and may change the structure; {allowed}"
                )
        for row in table.values():
            if row.required:
                self.required(row.name)
            value = self.choice(row.name)
            if row.choices and value not in row.choices:
                self.refuse(f"{row.name}={value} is not supported; give {', '.join(row.choices)}")

    def rows(self) -> list[list[str]]:
        """Return the stripped fields of all data lines; for small data."""
        split = [[part.strip() for part in line.decode("latin-1").split(",")] for line in self.data]
        return [row[:-1] if len(row) > 1 and not row[-1] else row for row in split]


def scoped_names(keyword: Keyword, label: str) -> tuple[str, str]:
    """Return the upper-case names of a label: in the keyword's instance, and in the deck."""
    plain = label.strip("\"' ").upper()
    return f"{keyword.scope.name.upper()}.{plain}", plain


def named(
    keyword: Keyword, label: str, table: Mapping[str, T], what: str, row: int | None = None
) -> T:
    """Return the entry of a name in a table, first in the scope of the keyword's instance."""
    for key in scoped_names(keyword, label):
        if key in table:
            return table[key]
    message = f"there is no {what} '{label}'; known are {listed(table) or 'none'}"
    raise keyword.error(message, row)


def add(table: dict[str, T], keyword: Keyword, name: str, value: T, what: str) -> None:
    """Add a value to a table under its upper-case name; refuse an existing name."""
    if name.upper() in table:
        keyword.refuse(f"there are two {what} '{name}'; rename one of them")
    table[name.upper()] = value
