"""A deck without a study, read as a study that contains only its path."""

import json
import re
from collections.abc import Sequence
from pathlib import Path

from faying.exceptions import StudyError, refuse_study
from faying.sources import SOURCES
from faying.study.keys.schema import parse_study, read_study
from faying.study.keys.tables import Study

STUDY = ".toml"

MESHES = frozenset((".cdb", ".msh", ".med", ".mail", ".vtu", ".unv"))
"""Suffixes of meshes, which need a study with materials and contact."""

_ANSYS = re.compile(rb"(?im)^\s*/(?:prep7|batch|com\b|solu|title)")
_BEGINNING = 20_000
"""Number of first bytes that are searched for commands of Ansys."""


def is_bare(path: Path) -> bool:
    """Return whether a file is a deck or mesh rather than a study, by its suffix."""
    return path.suffix.lower() != STUDY


def study_or_deck(path: Path, ignore: Sequence[str] = ()) -> Study:
    """Read a study, or a deck as a study without further keys.

    ``ignore`` lists what to leave out of the deck, as the key of [model].

    Raises
    ------
    StudyError
        As :func:`faying.study.keys.schema.read_study`, if the suffix is unknown, or if ``ignore``
        is given for a study.
    """
    if not is_bare(path):
        if ignore:
            refuse_study(f"{path}: --ignore is for decks; add 'ignore' to [model] of the study")
        return read_study(path)
    lines = ["[model]", f'source = "{_source(path)}"', f"file = {quoted(path.name)}"]
    if ignore:
        lines.append(f"ignore = [{', '.join(map(quoted, ignore))}]")
    return parse_study("\n".join(lines), path)


def check_not_ansys(path: Path) -> None:
    """Refuse a .dat file that is Ansys input, such as ds.dat of Workbench."""
    if path.suffix.lower() != ".dat" or not path.is_file():
        return
    with path.open("rb") as file:
        if _ANSYS.search(file.read(_BEGINNING)) is None:
            return
    message = (
        f"{path}: this is Ansys input, not a Nastran deck; write an archive of the model by "
        "CDWRITE,DB,joint,cdb in Ansys, and start its study with faying init joint.cdb"
    )
    raise StudyError(message)


def quoted(text: str) -> str:
    """Return a text as a TOML basic string."""
    return json.dumps(text, ensure_ascii=False)


def _source(path: Path) -> str:
    """Return the name of the source that reads files of a suffix."""
    suffix = path.suffix.lower()
    check_not_ansys(path)
    if suffix in MESHES:
        refuse_study(
            f"{path}: a mesh alone has no contact or loads; write its study with faying init "
            f"{path.name}"
        )
    for source in SOURCES.values():
        if suffix in source.suffixes:
            return source.name
    suffixes = ", ".join(suffix for source in SOURCES.values() for suffix in source.suffixes)
    message = (
        f"{path}: '{path.suffix}' is neither {STUDY} nor a suffix of decks ({suffixes}); rename "
        "the file, or give it and its source in a study"
    )
    raise StudyError(message)
