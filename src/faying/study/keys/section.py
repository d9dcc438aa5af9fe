"""The base class of all tables of a study file, and the types and ranges of values."""

import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    AfterValidator,
    AllowInfNan,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    Strict,
    StringConstraints,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)
from pydantic_core import PydanticCustomError, PydanticUndefined

from faying.digits import LARGEST, SMALLEST
from faying.study.keys.errors import (
    OF_TABLE,
    OWN_TYPE,
    UNKNOWN_KEY,
    guess,
    nearest,
    one_of,
    quoted,
    refusal,
    shown,
)

LARGEST_COUNT = 1_000_000
"""Most modes, levels, steps per period or loads: more would not fit in memory."""

LARGEST_ID = int(2 / sys.float_info.epsilon)
"""Largest id of a node or element that a float represents exactly."""

LONGEST_NAME = 200
"""Most characters of a name, which becomes part of file names of up to 255 bytes."""

MOST_PRELOAD_FACTOR = 10.0
"""Largest initial force of a bolt over its preload: bolts yield far below it,
so that a larger number must be meant as a force."""


def in_range(value: float) -> float:
    """Return a number whose products do not overflow or underflow."""
    if value != 0 and not SMALLEST <= abs(value) <= LARGEST:
        message = (
            f"found {shown(value)}, expected 0 or a magnitude from {SMALLEST:g} to {LARGEST:g}, "
            "because products must stay within double precision; correct it or use other "
            "units"
        )
        raise refusal(message)
    return value


def countable(value: int) -> int:
    """Return a count that fits in memory."""
    if value > LARGEST_COUNT:
        message = (
            f"found {shown(value)}, expected at most {LARGEST_COUNT}, because each needs a vector "
            "of the structure in memory; lower it"
        )
        raise refusal(message)
    return value


def identifying(value: int) -> int:
    """Return an id that a float represents exactly."""
    if abs(value) > LARGEST_ID:
        message = f"found {shown(value)}, expected an id up to 2^53; correct it"
        raise refusal(message)
    return value


def showable(value: str) -> str:
    """Return a printable text."""
    strange = next((c for c in value if not c.isprintable()), "")
    if strange:
        message = (
            f"found {value[:40]!a} with the unprintable character U+{ord(strange):04X}; remove it"
        )
        raise refusal(message)
    return value


def nameable(value: str) -> str:
    """Return a printable name that is short enough for file names."""
    showable(value)
    if len(value) > LONGEST_NAME:
        message = f"found {len(value)} characters, expected at most {LONGEST_NAME}; shorten it"
        raise refusal(message)
    return value


def all_in_range(value: Any) -> None:
    """Refuse numbers out of range in nested lists."""
    if isinstance(value, (list, tuple)):
        for entry in value:
            all_in_range(entry)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        in_range(value)


def check_names(
    data: dict[str, Any], names: Iterable[str], gone: Mapping[str, str] = MappingProxyType({})
) -> None:
    """Refuse the first unknown key, with the most similar known one.

    For removed keys the message states what to do about them.
    """
    names = list(names)
    for key in data:
        if key not in names:
            remedy = gone.get(key) or nearest(key, names)
            context = {"key": key, "remedy": remedy}
            raise PydanticCustomError(UNKNOWN_KEY, "{key}: {remedy}", context)


class Section(BaseModel):
    """A table of the study file: immutable, without unknown keys.

    The keys are described in ``docs/study-file.md``; a test compares it with these tables.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")
    gone: ClassVar[Mapping[str, str]] = {}
    one_of: ClassVar[Sequence[str]] = ()
    """Keys of which a table must have exactly one."""
    alternatives: ClassVar[Sequence[tuple[Sequence[str], str]]] = ()
    """Keys of which a table may have at most one, and what they determine."""

    @model_validator(mode="before")
    @classmethod
    def _known_keys_only(cls, data: Any) -> Any:
        if isinstance(data, dict):
            keys = cls.model_fields.items()
            check_names(data, [field.alias or name for name, field in keys], cls.gone)
        return data

    @model_validator(mode="after")
    def _exclusive(self) -> Self:
        if self.one_of and len(self.model_fields_set.intersection(self.one_of)) != 1:
            message = f"give exactly one of {quoted(self.one_of)}"
            raise refusal(message, OF_TABLE)
        for keys, meaning in self.alternatives:
            stated = [key for key in keys if key in self.model_fields_set]
            if len(stated) > 1:
                message = f"found {quoted(stated)}, which each give {meaning}; keep one of them"
                raise refusal(message, OF_TABLE)
        return self


def stated(section: Section, kind: type) -> dict[str, Any]:
    """Return the stated keys of a table that are fields of a dataclass, with their values."""
    names = section.model_fields_set.intersection(field.name for field in fields(kind))
    return {name: getattr(section, name) for name in names}


def name_in(choices: Iterable[str]) -> BeforeValidator:
    """Return a validator for the names of a registry."""
    names = list(choices)

    def checked(value: Any) -> str:
        if isinstance(value, str) and value in names:
            return value
        raise refusal(one_of(value, names))

    return BeforeValidator(checked, json_schema_input_type=Literal[tuple(names)])


def existing_file(path: Path, info: ValidationInfo) -> Path:
    """Return the absolute path of a file relative to the study file."""
    folder = info.context.path.parent if info.context else Path()
    try:
        resolved = (folder / path.expanduser()).resolve()
        usable = resolved.is_file()
    except (OSError, RuntimeError, ValueError) as error:  # too long, circular links, NUL
        message = f"file {shown(str(path))} is not a valid path ({error}); correct it"
        raise refusal(message) from None
    if not usable:
        what = "is a folder" if resolved.is_dir() else "does not exist"
        message = f"file '{path}' {what} ({resolved}); paths are relative to the study file"
        if "\\" in str(path) and os.sep != "\\":
            message += ", and folders are separated by /"
        raise refusal(message)
    return resolved


def in_words(expected: str, words: Sequence[str] = (), schema: Any = PydanticUndefined) -> Any:
    """Return a validator of a type whose message states what was expected in words.

    ``words`` are the texts that are allowed in place of a number.
    """

    def checked(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        try:
            return handler(value)
        except ValidationError as error:
            said = [entry["msg"] for entry in error.errors() if entry["type"] == OWN_TYPE]
            meant = guess(value, words) if isinstance(value, str) else ""
            message = f"found {shown(value)}, expected {expected}" + f"; {meant}" * bool(meant)
            raise refusal(said[0] if said else message) from None

    return WrapValidator(checked, json_schema_input_type=schema)


def _or_auto(value: Any) -> Any:
    if value == "auto":
        return None
    if isinstance(value, str):
        message = f"found {shown(value)}, expected a whole number or 'auto'"
        raise refusal(message)
    return value


Number = Annotated[float, Strict(), AllowInfNan(False), AfterValidator(in_range)]
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]
PreloadFactor = Annotated[Number, Field(ge=0, le=MOST_PRELOAD_FACTOR)]
PreloadFactors = Annotated[tuple[PreloadFactor, ...], Field(min_length=1)]
Count = Annotated[int, Strict(), Field(ge=1), AfterValidator(countable)]
CountOrNone = Annotated[int, Strict(), Field(ge=0), AfterValidator(countable)]
Id = Annotated[int, Strict(), AfterValidator(identifying)]
Switch = Annotated[bool, Strict()]
Name = Annotated[str, Strict(), StringConstraints(min_length=1), AfterValidator(nameable)]
ExistingFile = Annotated[Path, AfterValidator(existing_file)]
Text = Annotated[str, Strict(), StringConstraints(min_length=1)]
Ids = Annotated[tuple[Id, ...], Field(min_length=1)]
Penalty = Annotated[
    Positive | Literal["auto", "hard"],
    in_words("a positive number, 'auto' or 'hard'", ["auto", "hard"]),
]
TangentialPenalty = Annotated[
    Positive | Literal["auto"], in_words("a positive number or 'auto'", ["auto"])
]
StepOrAuto = Annotated[
    Positive,
    in_words(
        "a positive number, or 'auto' for a motion in time", schema=Positive | Literal["auto"]
    ),
]
CountOrAuto = Annotated[
    CountOrNone | None,
    BeforeValidator(_or_auto, json_schema_input_type=CountOrNone | Literal["auto"]),
]
InitialGap = Annotated[Number | ExistingFile, in_words("a finite number or the name of a csv file")]
Selection = Annotated[Text | Id | Ids, in_words("a set name, an id, or a list of ids")]
IdOrName = Annotated[Text | Id, in_words("a name or an id")]
Point = tuple[Number, Number, Number]
