"""The JSON Schema that editors use says what the program reads."""

import json
import tomllib
from pathlib import Path

import pytest
from pages import ROOT
from study_schema import EDITOR_SCHEMA, schema_text
from typer.testing import CliRunner

import faying.study
from faying.cli import app

STUDIES = [*(ROOT / "examples").glob("*.toml"), *Path(faying.study.__path__[0]).glob("*.toml")]


def errors(text: str) -> list[str]:
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads(EDITOR_SCHEMA.read_text(encoding="utf-8"))
    found = jsonschema.Draft7Validator(schema).iter_errors(tomllib.loads(text))
    return [error.message for error in found]


def test_the_file_in_the_package_is_that_of_the_tables():
    written = json.loads(EDITOR_SCHEMA.read_text(encoding="utf-8"))
    assert written == json.loads(schema_text()), "run python tests/docs/study_schema.py"


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.stem)
def test_complete_studies_pass(path):
    assert errors(path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    "text",
    [
        "title = 3",
        "[modell]\nsource = 'abaqus'",
        "[model]\nsource = 'ansys'",
        "[model]\nsource = 'mesh'\nfile = 3",
        "[model]\nsource = 'lap-joint'\n[[interface]]\nname = 'a'\npenalty = 'soft'",
        "[model]\nsource = 'lap-joint'\n[[bolt]]\nname = 'a'\npreload = -1.0",
        "[model]\nsource = 'lap-joint'\n[model.lap_joint]\nlenght = 1.0",
        "[model]\nsource = 'lap-joint'\n[reduction]\nmethods = ['guyan']",
    ],
)
def test_mistakes_are_seen(text):
    assert len(errors(text)) >= 1


def test_short_forms_pass():
    sets = "a = 1\nb = 'PLATE'\nc = [1, 2]\nd = { nodes = [3] }"
    model = f"[model]\nsource = 'lap-joint'\n[model.sets]\n{sets}"
    assert errors(f"{model}\n[reduction]\njoint_modes = 'auto'") == []


def test_the_command_prints_it():
    result = CliRunner().invoke(app, ["schema"])
    assert json.loads(result.output) == json.loads(EDITOR_SCHEMA.read_text(encoding="utf-8"))
