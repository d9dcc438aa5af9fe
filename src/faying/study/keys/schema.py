"""Reading a study file: :func:`read_study` returns a checked :class:`Study` or raises."""

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from faying.exceptions import ModelError, StudyError, refuse_study
from faying.files.contents import file_text
from faying.study.keys.consistency import inconsistencies
from faying.study.keys.errors import Problem, StudySource, reject, translated
from faying.study.keys.model_tables import BoltSection, BoundarySection, InterfaceSection
from faying.study.keys.requirement_tables import RequirementSection
from faying.study.keys.tables import LoadCaseSection, Study

__all__ = ["EDITOR_SCHEMA", "Study", "parse_study", "read_load_cases", "read_study"]

EDITOR_SCHEMA = Path(__file__).parents[1] / "study.schema.json"
"""JSON schema for editors; ``tests/docs/study_schema.py`` writes it."""


def read_study(path: Path | str) -> Study:
    """Read and check a study file.

    Parameters
    ----------
    path
        A TOML file; relative paths in it are resolved against its folder.

    Returns
    -------
    Study

    Raises
    ------
    StudyError
        If the file cannot be read or is inconsistent. The message
        lists every mistake with its place, what was found and expected, and the remedy.
    """
    return parse_study(_text(Path(path)), Path(path))


def parse_study(text: str, path: Path) -> Study:
    """Check the text of a study file as :func:`read_study` does; the file need not exist."""
    return parse_tables(_tables(text, path), StudySource(path.resolve(), text))


def read_load_cases(
    path: Path | str,
) -> tuple[tuple[LoadCaseSection, ...], RequirementSection | None]:
    """Read load cases and requirements of a file of load cases, or of a study.

    Returns
    -------
    tuple of LoadCaseSection
    RequirementSection or None
        The requirements, if any.
    """
    text = _text(Path(path))
    tables = _tables(text, Path(path))
    source = StudySource(Path(path).resolve(), text)
    if "model" not in tables:
        allowed = ["title", "load_case", "requirement"]
        unknown = [key for key in tables if key not in allowed]
        if unknown:
            where = source.place((unknown[0],))
            refuse_study(
                f"unknown key {where}; a file of load cases has [[load_case]], [requirement] and a "
                "title"
            )
        # Load cases are checked as in a study; any model will do.
        tables = {**tables, "model": {"source": "lap-joint"}}
    study = parse_tables(tables, source)
    if not study.load_cases:
        message = f"{source.path.name} has no [[load_case]], there is nothing to compute; add one"
        raise StudyError(message)
    return study.load_cases, study.requirement if "requirement" in tables else None


def stored_requirement(text: str) -> RequirementSection:
    """Return the requirements in the text of a checked study, whose files may be missing."""
    return RequirementSection.model_validate(tomllib.loads(text).get("requirement", {}))


def _tables(text: str, path: Path) -> dict[str, Any]:
    """Return the tables of a TOML text."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = f"{path.name} is not valid TOML: {error}; {_remedy(text, str(error))}"
        raise StudyError(message) from None
    except (ValueError, RecursionError) as error:  # numbers of thousands of digits, nested lists
        message = f"{path.name} cannot be read ({error}); shorten numbers and nest lists less"
        raise StudyError(message) from None


def parse_tables(tables: Mapping[str, Any], source: StudySource) -> Study:
    """Check the tables of a study file as :func:`read_study` does."""
    try:
        study = Study.model_validate(tables, context=source)
    except ValidationError as error:
        reject(source, _mistakes(error))
        raise
    reject(source, inconsistencies(study))
    return study


def _remedy(text: str, error: str) -> str:
    """Return advice about a line that is not TOML."""
    position = re.search(r"at line (\d+)", error)
    line = text.splitlines()[int(position[1]) - 1] if position else ""
    if "overwrite" in error or "twice" in error:
        return "the key or table occurs twice, keep one"
    if re.search(r"[=\[{,]\s*[-+]?\d+,\d", line):
        return "write numbers with a decimal point, as in 5.0"
    if "\\" in line:
        return "write paths with /, or in single quotes, as in 'C:\\models\\deck.bdf'"
    return "correct the line"


def _text(path: Path) -> str:
    """Return the text of a UTF-8 file."""
    try:
        return file_text(path)
    except UnicodeDecodeError as error:
        message = f"{path} is not UTF-8 text (byte {error.start}); save it as UTF-8"
    except ValueError:
        message = f"cannot read study file {str(path)!a}: the path has a NUL character; correct it"
    except OSError as error:
        message = f"cannot read study file {path}: {error.strerror}; check the path"
    raise StudyError(message)


def _mistakes(error: ValidationError) -> list[Problem]:
    """Return the mistakes of a validation error, without consequences of other mistakes.

    A list whose entries are refused is reported as too short as well, which is dropped.
    """
    entries = error.errors(include_url=False)
    inner = {entry["loc"][:depth] for entry in entries for depth in range(len(entry["loc"]))}
    return [
        translated(dict(entry))
        for entry in entries
        if entry["type"] != "too_short" or entry["loc"] not in inner
    ]


_NAMED = re.compile(r"^(interface|bolt|boundary) '([^']+)'")


@contextmanager
def naming_tables(study: Study) -> Iterator[None]:
    """Add the place in the study to errors about interfaces, bolts and boundaries.

    The model builder knows only their names. Those of a deck have no place in the study.
    """
    try:
        yield
    except ModelError as error:
        named = _NAMED.match(str(error))
        if named is None:
            raise
        kind, name = named.groups()
        tables: Mapping[str, Sequence[InterfaceSection | BoltSection | BoundarySection]] = {
            "interface": study.interfaces,
            "bolt": study.bolts,
            "boundary": study.boundaries,
        }
        for number, section in enumerate(tables[kind]):
            if section.name == name:
                message = f"{study.source.table((kind, number))}: {error}"
                raise ModelError(message) from error
        raise
