"""The JSON Schema of study files that editors complete and check keys with."""

from pathlib import Path

EDITOR_SCHEMA = Path(__file__).parents[1] / "study.schema.json"
"""Written by ``tests/docs/study_schema.py`` from the tables; a test compares it with them."""
