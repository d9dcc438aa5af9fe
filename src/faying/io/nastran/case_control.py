"""Case control: which constraint and load sets the deck selects."""

import re
from dataclasses import dataclass

from faying.exceptions import FormatError
from faying.io.nastran.source import Lines

_STATEMENT = re.compile(r"^([A-Z][A-Z0-9]*)\s*(?:\(([^)]*)\))?\s*(?:=\s*(.*)|\s(.*))?$")
_MATRICES = frozenset(("K2GG", "M2GG", "B2GG", "K42GG", "P2G", "K2PP", "M2PP", "B2PP", "TFL"))
_SETS = ("SPC", "MPC", "LOAD")
_SILENT = frozenset(
    ("TITLE", "SUBTITLE", "LABEL", "ECHO", "SUBCASE", "SOL", "CEND", "ID", "TIME", "INIT")
)


@dataclass(frozen=True, kw_only=True)
class CaseControl:
    """Selected sets; None where case control selects nothing."""

    spc: int | None = None
    mpc: int | None = None
    load: int | None = None


def parameter_lines(lines: Lines) -> Lines:
    """Return the PARAM lines of case control."""
    kept = [i for i, line in enumerate(lines.text) if line.lstrip()[:5] == b"PARAM"]
    return Lines(
        text=[lines.text[i].lstrip() for i in kept],
        number=lines.number[kept],
        file=lines.file[kept],
        files=lines.files,
    )


def read_case_control(lines: Lines, ignored: list[str]) -> CaseControl:
    """Read the selections of the global level and of the first subcase, which overrides it.

    Raises
    ------
    FormatError
        If a selection is no number, or matrices from DMIG enter the structure.
    """
    chosen: dict[str, int] = {}
    subcases = 0
    others: set[str] = set()
    start = next((i for i, line in enumerate(lines.text) if line.strip()[:4] == b"CEND"), -1)
    for i in range(start + 1, len(lines.text)):
        text = lines.text[i].partition(b"$")[0].decode("latin-1").strip()
        match = _STATEMENT.match(text)
        if not match or match.group(1) == "PARAM":
            continue
        name = match.group(1)
        value = (match.group(3) or match.group(4) or "").strip()
        subcases += name == "SUBCASE"
        if name in _MATRICES and start >= 0:
            message = (
                f"{lines.where(i)}: {name} adds matrices to the structure, which is not supported; "
                "remove it, or give all matrices by faying.from_matrices"
            )
            raise FormatError(message)
        if name in _SETS and subcases <= 1:
            if not re.fullmatch(r"\d{1,18}", value):
                message = f"{lines.where(i)}: {name} = '{value}'; expected the number of a set"
                raise FormatError(message)
            chosen[name] = int(value)
        elif name not in _SILENT and name not in _SETS and start >= 0:
            others.add(name)
    if others:
        ignored.append(f"case control requests {', '.join(sorted(others))}")
    if subcases > 1:
        ignored.append(f"case control subcases after the first ({subcases - 1})")
    return CaseControl(spc=chosen.get("SPC"), mpc=chosen.get("MPC"), load=chosen.get("LOAD"))
