"""docs/study-file.md lists every key of the study file with its default, and no other."""

import inspect
from collections.abc import Iterator

import pytest
from pydantic import BaseModel
from pydantic_core import PydanticUndefined
from study_schema import SECTIONS, page_rows

from faying.joint.lap_joint import lap_joint_assembly
from faying.study.keys import tables
from faying.study.keys.lap_joint import ELSEWHERE

NOTHING = {"—", "none"}
"""How the page writes a default that is not a value."""


PAGE = {
    heading: {key: default for key, (default, _) in rows.items()}
    for heading, rows in page_rows().items()
}


def toml(value: object) -> str:
    """A value as TOML writes it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(toml, value))}]"
    return str(value)


def model_defaults(section: type[BaseModel]) -> Iterator[tuple[str, object]]:
    for name, field in section.model_fields.items():
        required = field.default is PydanticUndefined and field.default_factory is None
        value = "required" if required else field.get_default(call_default_factory=True)
        yield field.alias or name, value


def generator_defaults() -> Iterator[tuple[str, object]]:
    for name, parameter in inspect.signature(lap_joint_assembly).parameters.items():
        if name not in ELSEWHERE:
            yield name, parameter.default


def check(written: dict[str, str], defaults: dict[str, object]) -> None:
    assert set(written) == set(defaults)
    for key, value in defaults.items():
        text = written[key]
        if value == "required":
            assert text == "required", key
        elif value is None or value in ((), {}):
            assert text in NOTHING, key
        elif isinstance(value, BaseModel):
            assert text in {*NOTHING, "defaults below"}, key
        elif value == tables.COMPARED:
            assert text.startswith("all six"), key
        else:
            assert text == f"`{toml(value)}`", key


def test_every_table_has_its_section():
    assert set(PAGE) == {*SECTIONS, "[model.lap_joint]"}


@pytest.mark.parametrize("heading", SECTIONS)
def test_keys_and_defaults_are_those_of_the_program(heading):
    check(PAGE[heading], dict(model_defaults(SECTIONS[heading])))


def test_keys_of_the_lap_joint_are_those_of_the_generator():
    check(PAGE["[model.lap_joint]"], dict(generator_defaults()))
