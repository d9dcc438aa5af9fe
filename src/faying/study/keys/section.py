"""What all tables of a study file have in common, and the types of their values."""

import math
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    AfterValidator,
    AllowInfNan,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    Strict,
    StringConstraints,
    ValidationInfo,
    model_validator,
)
from pydantic_core import PydanticCustomError

from faying.study.keys.errors import UNKNOWN_KEY, guess, nearest, one_of, refusal, shown
from faying.study.keys.ranges import (
    LARGEST_ID,
    MOST_PRELOAD_FACTOR,
    countable,
    identifying,
    in_range,
    nameable,
)


def check_names(
    data: dict[str, Any], names: Iterable[str], gone: Mapping[str, str] = MappingProxyType({})
) -> None:
    """Refuse the first key that is not known, naming the nearest one that is.

    Of keys that are gone it says what to do about them.
    """
    names = list(names)
    for key in data:
        if key not in names:
            remedy = gone.get(key) or nearest(key, names)
            context = {"key": key, "remedy": remedy}
            raise PydanticCustomError(UNKNOWN_KEY, "{key}: {remedy}", context)


class Section(BaseModel):
    """A table of the study file: immutable, and no key that is not known.

    What keys mean is said in ``docs/study-file.md``; a test holds it to these tables.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")
    gone: ClassVar[Mapping[str, str]] = {}

    @model_validator(mode="before")
    @classmethod
    def _known_keys_only(cls, data: Any) -> Any:
        if isinstance(data, dict):
            fields = cls.model_fields.items()
            check_names(data, [field.alias or name for name, field in fields], cls.gone)
        return data


def name_in(choices: Iterable[str]) -> BeforeValidator:
    """Return the check that a value is one of the names of a registry."""
    names = list(choices)

    def checked(value: Any) -> str:
        if isinstance(value, str) and value in names:
            return value
        raise refusal(one_of(value, names))

    return BeforeValidator(checked, json_schema_input_type=Literal[tuple(names)])


def existing_file(path: Path, info: ValidationInfo) -> Path:
    """Resolve against the folder of the study file."""
    folder = info.context.path.parent if info.context else Path()
    try:
        resolved = (folder / path.expanduser()).resolve()
        usable = resolved.is_file()
    except (OSError, RuntimeError, ValueError) as error:  # too long, a circle of links, a NUL
        message = f"file {shown(str(path))} is no possible path ({error}); correct it"
        raise refusal(message) from None
    if not usable:
        what = "is a folder" if resolved.is_dir() else "does not exist"
        message = f"file '{path}' {what} ({resolved}); paths are relative to the study file"
        if "\\" in str(path) and os.sep != "\\":
            message += ", and / separates folders here"
        raise refusal(message)
    return resolved


def number_or(words: Sequence[str], expected: str) -> BeforeValidator:
    """Return the check that a value is a positive number, or one of some words."""

    def checked(value: Any) -> float | str:
        if value in words:
            return str(value)
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if number and 0 < value < float("inf"):
            return float(in_range(value))
        meant = guess(value, words) if isinstance(value, str) else ""
        message = f"found {shown(value)}, expected {expected}" + f"; {meant}" * bool(meant)
        raise refusal(message)

    return BeforeValidator(checked, json_schema_input_type=Positive | Literal[tuple(words)])


def _step(value: Any) -> float:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if number and 0 < value < float("inf"):
        return float(in_range(value))
    message = f"found {shown(value)}, expected a positive number, or 'auto' for a motion in time"
    raise refusal(message)


def _or_auto(value: Any) -> Any:
    if value == "auto":
        return None
    if isinstance(value, str):
        message = f"found {shown(value)}, expected a whole number or 'auto'"
        raise refusal(message)
    return value


def _initial_gap(value: Any, info: ValidationInfo) -> float | Path:
    if isinstance(value, (str, Path)):
        return existing_file(Path(value), info)
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if number and abs(value) < math.inf:
        return float(in_range(value))
    message = f"found {shown(value)}, expected a finite number or the name of a csv file"
    raise refusal(message)


def _is_id(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) <= LARGEST_ID


def _id_or_name(value: Any) -> str | int:
    if _is_id(value) or (isinstance(value, str) and value):
        return value  # type: ignore[no-any-return]
    message = f"found {shown(value)}, expected a name or an id"
    raise refusal(message)


def _selection(value: Any) -> str | int | tuple[int, ...]:
    if isinstance(value, (list, tuple)) and value and all(map(_is_id, value)):
        return tuple(value)
    if _is_id(value) or (isinstance(value, str) and value):
        return value  # type: ignore[no-any-return]
    message = f"found {shown(value)}, expected a set name, an id, or a list of ids"
    raise refusal(message)


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
Penalty = Annotated[float | str, number_or(["auto", "hard"], "a positive number, 'auto' or 'hard'")]
TangentialPenalty = Annotated[float | str, number_or(["auto"], "a positive number or 'auto'")]
StepOrAuto = Annotated[
    float,
    BeforeValidator(_step, json_schema_input_type=Positive | Literal["auto"]),
]
CountOrAuto = Annotated[
    CountOrNone | None,
    BeforeValidator(_or_auto, json_schema_input_type=CountOrNone | Literal["auto"]),
]
InitialGap = Annotated[
    float | Path, BeforeValidator(_initial_gap, json_schema_input_type=Number | str)
]
Selection = Annotated[
    str | int | tuple[int, ...],
    BeforeValidator(_selection, json_schema_input_type=str | int | tuple[int, ...]),
]
IdOrName = Annotated[str | int, BeforeValidator(_id_or_name, json_schema_input_type=str | int)]
Point = tuple[Number, Number, Number]
