"""A deck without a study, as the study that says nothing but where it is."""

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
"""Suffixes of meshes, of which a study must say what they are a mesh of."""

_ANSYS = re.compile(rb"(?im)^\s*/(?:prep7|batch|com\b|solu|title)")
_BEGINNING = 20_000
"""Bytes in which input of Ansys shows what it is."""


def is_bare(path: Path) -> bool:
    """Whether a file is no study, by its suffix."""
    return path.suffix.lower() != STUDY


def study_or_deck(path: Path, ignore: Sequence[str] = ()) -> Study:
    """Read a study, or take a deck as one that adds nothing to it.

    What the deck has and the model shall not is ignored, as by the key of [model].

    Raises
    ------
    StudyError
        As :func:`faying.study.keys.schema.read_study`, if the suffix is that of no source, or if
        something is to be ignored of a study, which says so itself.
    """
    if not is_bare(path):
        if ignore:
            refuse_study(f"{path}: a study says what to ignore itself; add it to its [model]")
        return read_study(path)
    lines = ["[model]", f'source = "{_source(path)}"', f"file = {quoted(path.name)}"]
    if ignore:
        lines.append(f"ignore = [{', '.join(map(quoted, ignore))}]")
    return parse_study("\n".join(lines), path)


def check_not_ansys(path: Path) -> None:
    """Refuse a .dat that is input of Ansys, as the ds.dat of Workbench, and no Nastran deck."""
    if path.suffix.lower() != ".dat" or not path.is_file():
        return
    with path.open("rb") as file:
        if _ANSYS.search(file.read(_BEGINNING)) is None:
            return
    message = (
        f"{path}: this is input of Ansys and no Nastran deck; write an archive of the model by "
        "CDWRITE,DB,joint,cdb in Ansys, and begin its study by faying init joint.cdb"
    )
    raise StudyError(message)


def quoted(text: str) -> str:
    """Return a TOML basic string."""
    return json.dumps(text, ensure_ascii=False)


def _source(path: Path) -> str:
    """Return the source that reads files of this suffix."""
    suffix = path.suffix.lower()
    check_not_ansys(path)
    if suffix in MESHES:
        refuse_study(
            f"{path}: a mesh says too little of a joint to be checked alone; faying init "
            f"{path.name} begins its study"
        )
    for source in SOURCES.values():
        if suffix in source.suffixes:
            return source.name
    suffixes = ", ".join(suffix for source in SOURCES.values() for suffix in source.suffixes)
    message = (
        f"{path}: '{path.suffix}' is neither {STUDY} nor a suffix of decks ({suffixes}); rename "
        "the file, or name it and its source in a study"
    )
    raise StudyError(message)
