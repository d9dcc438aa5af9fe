"""The lines of a deck with its ``*INCLUDE`` files spliced in."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from faying.exceptions import FormatError
from faying.io.deck_lines import DeckFiles, Lines

_INCLUDE = re.compile(rb"^\s*\*\s*INCLUDE\s*,", re.IGNORECASE)
_INPUT = re.compile(rb"INPUT\s*=\s*(?:\"([^\"]*)\"|'([^']*)'|([^,]*))", re.IGNORECASE)
_DEEPEST = 20


@dataclass(frozen=True, eq=False, kw_only=True)
class _Piece:
    text: list[bytes]
    first: int
    file: int


def read_lines(path: Path) -> Lines:
    """Read a deck and what it includes.

    Included files are looked for beside the deck, where both programs run, then beside the file
    that includes them.

    Raises
    ------
    FormatError
        If a file is missing or includes itself.
    """
    files = DeckFiles("input deck", "*INCLUDE")
    pieces = _expand(path, path.parent, files, (), "")
    return Lines(
        text=[line for piece in pieces for line in piece.text],
        number=np.concatenate(
            [np.arange(p.first, p.first + len(p.text), dtype=np.int64) for p in pieces]
        ),
        file=np.repeat([p.file for p in pieces], [len(p.text) for p in pieces]).astype(np.int64),
        files=tuple(files.names),
    )


def _expand(
    path: Path, home: Path, files: DeckFiles, parents: tuple[Path, ...], included_from: str
) -> list[_Piece]:
    index = len(files.names)
    text = files.read(path, included_from).splitlines()
    here = path.resolve()
    if here in parents or len(parents) >= _DEEPEST:
        message = f"{included_from}: *INCLUDE of '{path}' goes in a circle; remove one of them"
        raise FormatError(message)
    pieces, start = [], 0
    for line in [i for i, t in enumerate(text) if b"*" in t[:8] and _INCLUDE.match(t)]:
        pieces.append(_Piece(text=text[start:line], first=start + 1, file=index))
        origin = f"{files.names[index]}:{line + 1}"
        name = _file_name(text[line], origin)
        places = (home / name, path.parent / name)
        found = next((place for place in places if _is_file(place, origin)), places[0])
        pieces += _expand(found, home, files, (*parents, here), origin)
        start = line + 1
    pieces.append(_Piece(text=text[start:], first=start + 1, file=index))
    return pieces


def _is_file(path: Path, origin: str) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name too long for any file
        return False
    except ValueError as error:  # a path with a NUL character
        message = f"{origin}: *INCLUDE names an impossible path; correct it"
        raise FormatError(message) from error


def _file_name(line: bytes, origin: str) -> str:
    match = _INPUT.search(line)
    name = next((group for group in match.groups() if group), b"") if match else b""
    if not name.strip():
        message = f"{origin}: *INCLUDE names no file; give INPUT=file"
        raise FormatError(message)
    return name.strip().decode("utf-8", "surrogateescape")
