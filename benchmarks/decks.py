"""Which decks of a folder are read, which are refused, and why.

    python benchmarks/decks.py FOLDER [--limit SECONDS] [--ignore plastic,friction,temperature]
    python benchmarks/decks.py FOLDER --with 'CONTACT *PAIR' --without 'CYCLIC|HEAT *TRANSFER'

Every deck below the folder is read and built in a process of its own, as ``faying check DECK``
does. The tables count outcomes of decks with solids, in them or in what they include (a file that
another deck includes is a piece of that one and no deck), and the names that stop them; a name that
stops a deck is counted once for it, however often it stands there. ``--with`` and ``--without``
choose decks by regular expressions at the start of a line, behind the asterisk of a keyword.
"""

import argparse
import re
import sys
import time
from collections import Counter
from dataclasses import dataclass
from multiprocessing import Pipe, Process
from multiprocessing.connection import Connection
from pathlib import Path

from faying.exceptions import FayingError
from faying.sources import SOURCES

SOLID = {
    "abaqus": re.compile(rb"^\s*\*\s*ELEMENT\s*,.*TYPE\s*=\s*C3D", re.IGNORECASE | re.MULTILINE),
    "nastran": re.compile(rb"^\s*(CHEXA|CPENTA|CTETRA|CPYRAM)", re.IGNORECASE | re.MULTILINE),
}
INCLUDE = {
    "abaqus": re.compile(rb"^\s*\*\s*INCLUDE\s*,\s*INPUT\s*=\s*([^\s,]+)", re.I | re.M),
    "nastran": re.compile(rb"^[ \t]*INCLUDE[ \t]*['\"]?([^'\"\r\n$]+)", re.I | re.M),
}
PLACE = re.compile(r"^\s*\S.*?:\d+: ([^:]+?)(?: \(\d+\))?(?::|$)")


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What became of one deck: a class, the reasons or needs, and how long it took [s]."""

    path: Path
    kind: str
    reasons: tuple[str, ...]
    text: str
    seconds: float


def names_in(message: str) -> tuple[str, ...]:
    """Return the keywords or cards a refusal names, else its text without place."""
    places = [PLACE.match(line) for line in message.splitlines()]
    found = dict.fromkeys(match[1] for match in places if match)
    return tuple(found) or (message.splitlines()[0].split(": ", 1)[-1][:80],)


def tried(path: Path, ignore: tuple[str, ...]) -> tuple[str, tuple[str, ...], str]:
    """Read and build one deck."""
    from faying.study.inputs.load_model import load_model
    from faying.study.inputs.model_preview import model_preview
    from faying.study.keys.deck_study import study_or_deck

    try:
        study = study_or_deck(path, ignore)
        loaded = load_model(study)
    except FayingError as error:
        return "refused", names_in(str(error)), str(error)
    try:
        found = model_preview(study, loaded, bare=True)
    except FayingError as error:
        return "read, not built", (str(error)[:100],), str(error)
    needs = tuple(need for need in found.needs if need.startswith("contact and"))
    kind = "read, contact or bolts not built" if needs else "read and built"
    return kind, needs, "\n".join(found.needs)


def worker(pipe: Connection, ignore: tuple[str, ...]) -> None:
    """Try decks as they come."""
    while True:
        path = pipe.recv()
        try:
            pipe.send(tried(path, ignore))
        except Exception as error:  # any traceback is a finding
            pipe.send(("bug", (f"{type(error).__name__}: {error}"[:100],), repr(error)))


def outcomes(paths: list[Path], limit: float, ignore: tuple[str, ...]) -> list[Outcome]:
    """Try all decks, each no longer than the limit."""
    found = []
    ours: Connection | None = None
    process: Process | None = None
    for path in paths:
        if process is None or ours is None:
            ours, theirs = Pipe()
            process = Process(target=worker, args=(theirs, ignore), daemon=True)
            process.start()
        start = time.monotonic()
        ours.send(path)
        kind, reasons, text = "too slow", (f"more than {limit:g} s",), ""
        try:
            if ours.poll(limit):
                kind, reasons, text = ours.recv()
        except EOFError:
            kind, reasons = "bug", ("the process died",)
        if kind == "too slow" or not process.is_alive():
            process.kill()
            process.join()
            process = None
        seconds = time.monotonic() - start
        found.append(Outcome(path=path, kind=kind, reasons=reasons, text=text, seconds=seconds))
    return found


def parts_of(path: Path, top: Path, seen: dict[Path, bytes]) -> dict[Path, bytes]:
    """Return the text of a deck and of what it includes, as far as it is there."""
    here = path.resolve()
    if here not in seen and path.is_file():
        seen[here] = path.read_bytes()
        for match in INCLUDE[program(top)].finditer(seen[here]):
            name = match[1].decode("latin-1").strip()
            for folder in dict.fromkeys((path.parent, top.parent)):
                parts_of(folder / name, top, seen)
    return seen


def program(path: Path) -> str:
    """Return whose deck a file is, by its suffix."""
    return "abaqus" if path.suffix.lower() == ".inp" else "nastran"


def with_solids(paths: list[Path]) -> list[Path]:
    """Return the decks that have solids, without the pieces that other decks include."""
    parts = {path: parts_of(path, path, {}) for path in paths}
    pieces = {one for path, found in parts.items() for one in found if one != path.resolve()}
    return [
        path
        for path, found in parts.items()
        if path.resolve() not in pieces
        and any(SOLID[program(path)].search(text) for text in found.values())
    ]


def chosen(path: Path, wanted: str, unwanted: str) -> bool:
    """Say whether a line of a deck starts as wished, and none as not wished."""
    text = path.read_bytes()

    def found(expression: str) -> bool:
        pattern = rf"^\s*\*?\s*(?:{expression})".encode()
        return re.search(pattern, text, re.IGNORECASE | re.MULTILINE) is not None

    return found(wanted) and not (unwanted and found(unwanted))


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--limit", type=float, default=20.0, help="seconds for each deck")
    parser.add_argument("--ignore", default="", help="words for [model] ignore, with commas")
    parser.add_argument("--match", default="*", help="names of the decks, as in *contact*")
    parser.add_argument("--with", default="", dest="wanted", help="a regular expression")
    parser.add_argument("--without", default="", dest="unwanted", help="a regular expression")
    parser.add_argument("--all", action="store_true", help="print a line for every deck")
    wished = parser.parse_args()
    suffixes = {suffix for source in SOURCES.values() for suffix in source.suffixes}
    paths = sorted(p for p in wished.folder.rglob(wished.match) if p.suffix.lower() in suffixes)
    solid = [p for p in with_solids(paths) if chosen(p, wished.wanted, wished.unwanted)]
    ignore = tuple(word for word in wished.ignore.split(",") if word)
    found = outcomes(solid, wished.limit, ignore)
    lines = []
    if wished.all:
        for one in found:
            first = one.text.splitlines()[0] if one.text else ""
            name = one.path.relative_to(wished.folder)
            lines.append(f"{one.kind}\t{name}\t{one.seconds:.1f}\t{first}")
    lines += [f"{len(paths)} decks, {len(solid)} with solids", "", "| outcome | decks | share |"]
    lines.append("|---|---|---|")
    for kind, count in Counter(one.kind for one in found).most_common():
        lines.append(f"| {kind} | {count} | {count / len(found):.0%} |")
    lines += ["", "| what stops decks | decks |", "|---|---|"]
    stops = Counter(reason for one in found for reason in dict.fromkeys(one.reasons))
    lines += [f"| {reason} | {count} |" for reason, count in stops.most_common(60)]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
