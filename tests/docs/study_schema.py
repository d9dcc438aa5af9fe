"""The JSON Schema of study files, from the tables of the program and the meanings on their page.

``python tests/docs/study_schema.py`` writes it into the package.
"""

import json
import re
from typing import Any

from pages import DOCS
from pydantic import BaseModel

from faying.study.keys import (
    frequency_table,
    model_tables,
    parameter_tables,
    requirement_tables,
    tables,
    topographies,
)
from faying.study.keys.schema import EDITOR_SCHEMA

SECTIONS: dict[str, type[BaseModel]] = {
    "top level": tables.Study,
    "preload_scatter": requirement_tables.ScatterSection,
    "[model]": model_tables.ModelSection,
    "[model.files]": model_tables.MatrixFiles,
    "[model.sets]": model_tables.NamedSet,
    "[material.NAME]": model_tables.MaterialSection,
    "[temperature.NAME]": model_tables.TemperatureSection,
    "[[interface]]": model_tables.InterfaceSection,
    "[[interface]] topography": topographies.TopographySection,
    "[[interface]] crown": topographies.CrownSection,
    "[[bolt]]": model_tables.BoltSection,
    "[[bolt]] strength": model_tables.StrengthSection,
    "[[bolt]] thread": model_tables.ThreadSection,
    "[[boundary]]": model_tables.BoundarySection,
    "[[support]]": model_tables.SupportSection,
    "[[mass]]": model_tables.MassSection,
    "[[measurement]]": tables.MeasurementSection,
    "[[measurement]] response": tables.ResponseSection,
    "[[parameter]]": parameter_tables.ParameterSection,
    "[band]": parameter_tables.BandSection,
    "[[frequency]]": frequency_table.FrequencySection,
    "[[frequency]] forces": frequency_table.HarmonicForce,
    "[sticking]": model_tables.StickingSection,
    "[damping]": model_tables.DampingSection,
    "[reduction]": tables.ReductionSection,
    "[reduction.training]": tables.TrainingSection,
    "[reduction.training] box": tables.BoxSide,
    "[validation]": tables.ValidationSection,
    "[requirement]": requirement_tables.RequirementSection,
    "[requirement.margins]": requirement_tables.MarginsSection,
    "[requirement] closed_ring": requirement_tables.RingSection,
    "[[load_case]]": tables.LoadCaseSection,
    "[[load_case]] forces": tables.ForceSection,
    "[output]": tables.OutputSection,
}
"""Heading of docs/study-file.md to the table it lists."""

BOUNDS = {"ge": "minimum", "gt": "exclusiveMinimum", "le": "maximum", "lt": "exclusiveMaximum"}
"""What pydantic calls bounds of numbers that a function checks as well, to JSON Schema's words."""

UNSAID = ("title", "description")
"""What pydantic makes of the names and docstrings of classes."""


def page_rows() -> dict[str, dict[str, tuple[str, str]]]:
    """Heading of docs/study-file.md to its keys, with defaults and meanings as written."""
    found: dict[str, dict[str, tuple[str, str]]] = {}
    heading = ""
    for line in (DOCS / "study-file.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            heading = line.removeprefix("## ")
        row = re.match(r"\| `(\w+)` \| (.*?) \| (.*?) ?\|$", line)
        if row:
            found.setdefault(heading, {})[row[1]] = (row[2], row[3])
    return found


def study_schema() -> dict[str, Any]:
    """The schema, every key with its meaning."""
    schema = _simplified(tables.Study.model_json_schema(by_alias=True))
    rows = page_rows()
    for heading, section in SECTIONS.items():
        place = schema if section is tables.Study else schema["$defs"][section.__name__]
        _described(place["properties"], rows[heading])
    lap_joint = schema["$defs"]["ModelSection"]["properties"]["lap_joint"]
    lap_joint |= {"additionalProperties": False, "properties": {}}
    for key in rows["[model.lap_joint]"]:
        lap_joint["properties"][key] = {}
    _described(lap_joint["properties"], rows["[model.lap_joint]"])
    head = {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Study file of faying",
    }
    return head | schema


def _described(properties: dict[str, Any], rows: dict[str, tuple[str, str]]) -> None:
    for key, (_, meaning) in rows.items():
        # Draft 7 looks at nothing beside a reference.
        if "$ref" in properties[key]:
            properties[key] = {"allOf": [properties[key]]}
        if meaning:
            properties[key]["description"] = re.sub(r"\[([^]]+)\]\([^)]+\)", r"\1", meaning)


def _simplified(schema: Any) -> Any:
    """Without titles, null and class descriptions; positional items as draft 7 writes them."""
    if isinstance(schema, list):
        return [_simplified(one) for one in schema]
    if not isinstance(schema, dict):
        return schema
    found: dict[str, Any] = {}
    for key, value in schema.items():
        if key == "properties":
            found[key] = {name: _simplified(one) for name, one in value.items()}
        elif key == "anyOf":
            choices = [_simplified(one) for one in value if one != {"type": "null"}]
            found |= choices[0] if len(choices) == 1 else {key: choices}
        elif key == "prefixItems":
            found["items"] = _simplified(value)
        elif key in BOUNDS:
            found[BOUNDS[key]] = value
        elif key not in UNSAID and not (
            key == "default" and (value is None or isinstance(value, dict))
        ):
            found[key] = _simplified(value)
    return found


def schema_text() -> str:
    """The file in the package."""
    return json.dumps(study_schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    EDITOR_SCHEMA.write_text(schema_text(), encoding="utf-8")
