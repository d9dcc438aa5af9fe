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
    ((name, parameters),) = value.items()
    if name not in CLOSURES:
        raise refusal(one_of(name, list(CLOSURES)))
    try:
        if name in COLUMNS and isinstance(parameters, (str, Path)):
            return read_closure_table(existing_file(Path(parameters), info), name)
        return CLOSURES[name](**_parameters(name, parameters))
    except (ModelError, FormatError) as error:
        raise refusal(str(error)) from None


def _parameters(name: str, values: Any) -> dict[str, Any]:
    """Return the parameters of a curve, none missing, unknown or no number."""
    if not isinstance(values, Mapping):
        message = f"found {shown(values)}, expected {_example(name)}"
        raise refusal(message)
    names = [entry.name for entry in fields(CLOSURES[name])]  # type: ignore[arg-type]
    for key in values:
        if key not in names:
            message = f"closure '{name}' has no '{key}'; {nearest(key, names)}"
            raise refusal(message)
    missing = [key for key in names if key not in values]
    if missing:
        message = f"closure '{name}' needs '{missing[0]}'; give {_example(name)}"
        raise refusal(message)
    for key, number in values.items():
        for entry in number if isinstance(number, (list, tuple)) else [number]:
            if isinstance(entry, bool) or not isinstance(entry, (int, float)):
                message = f"{key} of closure '{name}' is {shown(entry)}; give a number"
                raise refusal(message)
    return {key: values[key] for key in names}


def _example(name: str) -> str:
    if name in COLUMNS:
        return f'{name} = "file.csv"'
    names = ", ".join(f"{parameter.name} = …" for parameter in fields(CLOSURES[name]))  # type: ignore[arg-type]
    return f"{name} = {{ {names} }}"


Closure = Annotated[
    Any,
    BeforeValidator(
        _closure,
        json_schema_input_type=dict[Literal[tuple(CLOSURES)], str | dict[str, Number]],  # type: ignore[misc]
    ),
]
