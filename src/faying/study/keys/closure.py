"""The key ``closure`` of ``[[interface]]``: a curve of pressure over closure."""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ValidationInfo

from faying.contact.laws import CLOSURES, Curve
from faying.exceptions import FormatError, ModelError
from faying.interface.closure_table import COLUMNS, read_closure_table
from faying.study.keys.errors import nearest, one_of, refusal, shown
from faying.study.keys.section import Number, existing_file


def _closure(value: Any, info: ValidationInfo) -> Curve:
    """Return the curve that a study names, by a csv file or by its parameters."""
    if isinstance(value, Curve):
        return value
    if not isinstance(value, Mapping) or len(value) != 1:
        choices = ", ".join(f"{{ {_example(name)} }}" for name in CLOSURES)
        message = f"found {shown(value)}, expected one of {choices}"
        raise refusal(message)
    ((name, given),) = value.items()
    if name not in CLOSURES:
        raise refusal(one_of(name, list(CLOSURES)))
    try:
        if name in COLUMNS and isinstance(given, (str, Path)):
            return read_closure_table(existing_file(Path(given), info), name)
        return CLOSURES[name](**_parameters(name, given))
    except (ModelError, FormatError) as error:
        raise refusal(str(error)) from None


def _parameters(name: str, given: Any) -> dict[str, Any]:
    """Return the parameters of a curve, none missing, unknown or no number."""
    if not isinstance(given, Mapping):
        message = f"found {shown(given)}, expected {_example(name)}"
        raise refusal(message)
    names = [one.name for one in fields(CLOSURES[name])]  # type: ignore[arg-type]
    for key in given:
        if key not in names:
            message = f"closure '{name}' has no '{key}'; {nearest(key, names)}"
            raise refusal(message)
    missing = [key for key in names if key not in given]
    if missing:
        message = f"closure '{name}' needs '{missing[0]}'; give {_example(name)}"
        raise refusal(message)
    for key, number in given.items():
        for one in number if isinstance(number, (list, tuple)) else [number]:
            if isinstance(one, bool) or not isinstance(one, (int, float)):
                message = f"{key} of closure '{name}' is {shown(one)}; give a number"
                raise refusal(message)
    return {key: given[key] for key in names}


def _example(name: str) -> str:
    if name in COLUMNS:
        return f'{name} = "file.csv"'
    names = ", ".join(f"{one.name} = …" for one in fields(CLOSURES[name]))  # type: ignore[arg-type]
    return f"{name} = {{ {names} }}"


Closure = Annotated[
    Any,
    BeforeValidator(
        _closure,
        json_schema_input_type=dict[Literal[tuple(CLOSURES)], str | dict[str, Number]],  # type: ignore[misc]
    ),
]
