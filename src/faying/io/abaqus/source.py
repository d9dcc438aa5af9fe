"""The text of a deck with its ``*INCLUDE`` files spliced in."""

import re
from pathlib import Path

from faying.exceptions import FormatError
from faying.io.abaqus.file_spans import Span, TextFile
from faying.io.deck_lines import DeckFiles
from faying.io.line_texts import with_usual_ends

_INCLUDE = re.compile(rb"^\s*\*\s*INCLUDE\s*,", re.IGNORECASE)
_INPUT = re.compile(rb"INPUT\s*=\s*(?:\"([^\"]*)\"|'([^']*)'|([^,]*))", re.IGNORECASE)


def read_spans(path: Path) -> list[Span]:
    """Read a deck and what it includes, as pieces of files in their order.

    Included files are looked for beside the deck, where both programs run, then beside the file
    that includes them.
    """
    return _expand(path, path.parent, DeckFiles("input deck", "*INCLUDE"), (), "")


def _expand(
    path: Path, home: Path, files: DeckFiles, parents: tuple[Path, ...], included_from: str
) -> list[Span]:
    text = with_usual_ends(files.read(path, included_from, parents))
    file = TextFile(name=files.names[-1], text=text)
    parts, start = [], 0
    for begin, end in Span(file=file, start=0, end=len(text)).starred():
        line = text[begin:end]
        if not (b"*" in line[:8] and _INCLUDE.match(line)):
            continue
        parts.append(Span(file=file, start=start, end=begin))
        origin = f"{file.name}:{file.line(begin)}"
        name = _file_name(line, origin)
        places = (home / name, path.parent / name)
        included = next(
            (candidate for candidate in places if _is_file(candidate, origin)), places[0]
        )
        parts += _expand(included, home, files, (*parents, path.resolve()), origin)
        start = min(end + 1, len(text))
    parts.append(Span(file=file, start=start, end=len(text)))
    return parts


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
