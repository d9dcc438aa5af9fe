"""Case control: selected sets of constraints, loads, contact and bolt forces."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from faying.exceptions import refuse
from faying.io.deck_lines import Lines, joined
from faying.io.nastran.cards import Bulk, Card, Cards

_STATEMENT = re.compile(r"^([A-Z][A-Z0-9]*)\s*(?:\(([^)]*)\))?\s*(?:=\s*(.*)|\s(.*))?$")
_MATRICES = frozenset(("K2GG", "M2GG", "B2GG", "K42GG", "P2G", "K2PP", "M2PP", "B2PP", "TFL"))
_HEAT = re.compile(rb"^\s*(SOL\s+(HEAT|53|61|74|89|153|159)\b|APP\s+HEAT)")
_SETS = frozenset(("SPC", "MPC", "LOAD", "BCSET", "BGSET", "BOLTLD", "DEFORM", "NSM"))
"""Commands that select a set."""
_ABBREVIATED = ("SUBCASE", "TEMPERATURE", "DEFORM", "BCONTACT", "BOLTLD", "ANALYSIS")
_TEMPERATURES = {
    **dict.fromkeys(("", "BOTH"), ("LOAD", "MATERIAL")),
    **{"LOAD": ("LOAD",), "INIT": ("INITIAL",), "MATE": ("MATERIAL",)},
}
"""Use of a set of temperatures, by the first letters of the option."""
_SHORTEST_COMMAND = 4
"""Number of letters that identify a command."""
_BCONTACT = frozenset(("ALLBODY", "NONE", "AUTO"))
_COMBINATIONS = frozenset(("SUBCOM", "SYM", "SYMCOM", "REPCASE"))
_SILENT = frozenset(
    (
        *("TITLE", "SUBTITLE", "LABEL", "ECHO", "SUBCASE", "SOL", "CEND", "ID", "TIME", "INIT"),
        *("SET", "SUBSEQ", "SYMSEQ"),
    )
)


_Choices = dict[str, int | str]
"""Sets selected by commands of the global level or of a subcase."""


@dataclass(frozen=True, kw_only=True)
class CaseControl:
    """Sets selected by case control.

    Attributes
    ----------
    chosen
        Commands to the selected sets; for BCONTACT (MSC) the id of a table, or ``"ALLBODY"``,
        ``"AUTO"``, ``"NONE"``. Temperatures are ``TEMPERATURE(LOAD)``, ``(INITIAL)``,
        ``(MATERIAL)``.
    present
        Whether the deck has a case control section (CEND, or selections), so that sets not
        selected are inactive.
    heat
        Whether the analysis is heat transfer, whose constraints are temperatures.
    """

    chosen: Mapping[str, int | str] = field(default_factory=dict)
    present: bool = False
    heat: bool = False

    def set_of(self, command: str) -> int | None:
        """Return the set selected by a command."""
        chosen = self.chosen.get(command)
        return chosen if isinstance(chosen, int) else None


def parameter_lines(lines: Lines) -> Lines:
    """Return the PARAM lines of case control; PARAM before CEND is DMAP."""
    start = _behind_cend(lines)
    rows = [i for i in range(start, len(lines.text)) if lines.text[i].lstrip()[:5] == b"PARAM"]
    return Lines(
        text=joined([[lines.text[i].lstrip() for i in rows]]),
        number=lines.number[rows],
        file=lines.file[rows],
        files=lines.files,
    )


def _behind_cend(lines: Lines) -> int:
    """Return the index of the first line after CEND; 0 without one."""
    return next((i + 1 for i, line in enumerate(lines.text) if line.strip()[:4] == b"CEND"), 0)


def read_case_control(lines: Lines, ignored: list[str], subcase: int | None = None) -> CaseControl:
    """Read the selections of the global level, overridden by those of one subcase.

    The subcase is the first unless its id is given. The first of its steps counts, except for
    contact that begins later.
    """
    start = _behind_cend(lines) - 1
    common: _Choices = {}
    subcases: dict[int, _Choices] = {}
    places: dict[int, str] = {}
    combinations: dict[int, str] = {}
    others: set[str] = set()
    heat = any(_HEAT.match(line) for line in lines.text[: start + 1])
    level, of_subcase, steps = common, common, 0
    for i, name, option, value in _statements(lines, start + 1):
        if name in _MATRICES and start >= 0:
            refuse(
                f"{lines.where(i)}: {name} adds matrices to the structure, which is not supported; "
                "remove it, or give all matrices by faying.from_matrices"
            )
        if name == "SUBCASE" or name in _COMBINATIONS:
            number = _number(lines, i, name, value, "an id")
            level, steps = _Choices(), 0
            of_subcase = level
            if name in _COMBINATIONS:
                combinations[number] = name
            elif number in subcases:
                refuse(
                    f"{lines.where(i)}: SUBCASE {number} is already at {places[number]}; "
                    "renumber one"
                )
            else:
                subcases[number], places[number] = level, lines.where(i)
        elif name == "STEP":
            steps += 1
            if steps == 2:
                level = _Choices()
                others.add("STEP after the first")
        elif name == "BCONTACT":
            word = value.partition(",")[0].strip()
            choice = word if word in _BCONTACT else _number(lines, i, name, value, "a table's id")
            if steps > 1 and of_subcase.get(name, common.get(name, 0)) == 0:
                ignored.append(f"BCONTACT = {word} comes from a later STEP, as the first has none")
                of_subcase[name] = choice
            level[name] = choice
        elif name == "ANALYSIS":
            heat = heat or value == "HEAT"
            others.add(name)
        elif name == "TEMPERATURE":
            for use in _TEMPERATURES.get(option[:4], ()):
                level[f"TEMPERATURE({use})"] = _number(lines, i, name, value, "a set")
        elif name in _SETS:
            level[name] = _number(lines, i, name, value, "the number of a set")
        elif name not in _SILENT and start >= 0:
            others.add(name)
    if others:
        ignored.append(f"case control requests {', '.join(sorted(others))}")
    chosen = {**common, **_subcase(subcases, combinations, subcase, ignored)}
    return CaseControl(chosen=chosen, present=start >= 0 or bool(chosen), heat=heat)


def _statements(lines: Lines, first: int) -> Iterator[tuple[int, str, str, str]]:
    """Yield line, name, first option and value of each statement."""
    for i in range(first, len(lines.text)):
        text = lines.text[i].partition(b"$")[0].decode("latin-1").strip()
        match = _STATEMENT.match(text)
        if not match or match.group(1) == "PARAM":
            continue
        name = match.group(1)
        if len(name) >= _SHORTEST_COMMAND:
            name = next((whole for whole in _ABBREVIATED if whole.startswith(name)), name)
        option = (match.group(2) or "").partition(",")[0].strip()
        yield i, name, option, (match.group(3) or match.group(4) or "").strip()


def _number(lines: Lines, i: int, name: str, value: str, expected: str) -> int:
    if not re.fullmatch(r"\d{1,18}", value):
        refuse(f"{lines.where(i)}: {name} = '{value}'; expected {expected}")
    return int(value)


def _subcase(
    subcases: dict[int, _Choices],
    combinations: dict[int, str],
    subcase: int | None,
    ignored: list[str],
) -> _Choices:
    """Return the selections of the chosen subcase, and note the others."""
    if subcase is not None and subcase not in subcases:
        numbers = ", ".join(map(str, subcases)) or "none"
        kind = combinations.get(subcase)
        refuse(
            f"subcase {subcase} is a {kind}, a combination of others; choose one of {numbers}"
            if kind
            else f"case control has no subcase {subcase}; subcases are {numbers}"
        )
    if combinations:
        listed = ", ".join(f"{kind} {number}" for number, kind in combinations.items())
        ignored.append(f"case control combinations ({listed})")
    if not subcases:
        return {}
    chosen = next(iter(subcases)) if subcase is None else subcase
    others = [str(number) for number in subcases if number != chosen]
    if others:
        ignored.append(
            f"case control subcases other than {chosen} ({', '.join(others)}); choose by 'subcase'"
        )
    return subcases[chosen]


LUMPED = (
    "masses are consistent here; Nastran lumps them unless PARAM,COUPMASS,1 is given, which lowers "
    "frequencies: by about 3 % at 10 linear elements to a wave, 14 % at 5, and CBAR then have no "
    "rotary inertia about their axis; compare with COUPMASS"
)
"""Elements of length h: consistent over lumped frequencies are
√(3 / (2 + cos k h)), nearly 1 + 3.3 / n² with n elements to a wave."""

_SCALES = frozenset(("CB1", "CB2", "CK1", "CK2", "CK3", "CM1", "CM2", "CP1", "CP2"))


def parameters(cards: Mapping[str, Cards], control: Bulk) -> dict[str, Card]:
    """Return the last PARAM of each name; those of case control come before those of bulk data."""
    listed = (*control.cards().get("PARAM", ()), *cards.get("PARAM", ()))
    return {card.text(0): card for card in listed if card.text(0)}


def mass_factor(parameters: Mapping[str, Card], ignored: list[str]) -> float:
    """Return PARAM,WTMASS (1 if absent) and note the parameters that are not read."""
    for name in _SCALES & parameters.keys():
        if parameters[name].real(1) != 1.0:
            parameters[name].refuse(
                f"{name} scales input matrices, which is not supported; remove it", 1
            )
    others = parameters.keys() - {"COUPMASS", "WTMASS", *_SCALES}
    if others:
        ignored.append(f"PARAM {', '.join(sorted(others))}")
    factor = parameters["WTMASS"].real(1) if "WTMASS" in parameters else 1.0
    if not factor > 0:
        parameters["WTMASS"].refuse(f"WTMASS = {factor:g} must be positive", 1)
    return factor
