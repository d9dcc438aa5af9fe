"""The study table [model.lap_joint], checked against the keywords of the generator."""

import inspect
import json
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError, create_model
from pydantic_core import PydanticCustomError

from faying.joint.lap_joint import STEEL, lap_joint_assembly
from faying.study.keys.errors import Problem, located, nearest, translated
from faying.study.keys.section import all_in_range
from faying.study.keys.tables import Study

ELSEWHERE = {
    "material": "[material.steel]",
    "element": "[model]",
    "penalty": "[[interface]]",
    "quadrature": "[[interface]]",
    "order": "[[interface]]",
    "meshes": "[[interface]]",
}
"""Keywords of the generator that are given in other tables of the study."""


def lap_joint_keywords(study: Study) -> dict[str, Any]:
    """Return the keywords of the study for the generator, in their declared types."""
    keywords = _schema().model_validate_json(_json(study), strict=True)
    return {name: getattr(keywords, name) for name in study.model.lap_joint}


def lap_joint_problems(study: Study) -> Iterator[Problem]:
    """Yield unknown keywords, values of a wrong type, and other materials."""
    if study.model.source != "lap-joint":
        return
    for name in study.materials:
        if name != STEEL.name:
            text = f"the material of the lap joint is '{STEEL.name}'; rename the table"
            yield from located(("material", name), [("", text)])
    schema = _schema()
    for name in study.model.lap_joint:
        location = ("model", "lap_joint", name)
        if name in ELSEWHERE:
            yield Problem(location, f": it belongs in {ELSEWHERE[name]}; move it")
        elif name not in schema.model_fields:
            yield Problem(location, f"; {nearest(name, schema.model_fields)}", "unknown key ")
        try:
            all_in_range(study.model.lap_joint[name])
        except PydanticCustomError as error:
            yield Problem(location, f": {error}")
            return
    try:
        schema.model_validate_json(_json(study), strict=True)
    except ValidationError as error:
        for entry in error.errors(include_url=False):
            yield translated({**entry, "loc": ("model", "lap_joint", *entry["loc"])})


def _schema() -> type[BaseModel]:
    """Return a schema with the keywords of the generator."""
    parameters = inspect.signature(lap_joint_assembly).parameters.values()
    keys: dict[str, Any] = {
        parameter.name: (parameter.annotation, parameter.default)
        for parameter in parameters
        if parameter.name not in ELSEWHERE
    }
    config = ConfigDict(allow_inf_nan=False, extra="ignore", strict=True)
    return create_model("LapJoint", __config__=config, **keys)


def _json(study: Study) -> str:
    # JSON, because strict validation of Python values refuses lists for tuples.
    return json.dumps(dict(study.model.lap_joint), default=str)
