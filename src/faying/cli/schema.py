"""``faying schema``: what an editor completes and checks study files with."""

import typer


def schema() -> None:
    """Print the JSON Schema of study files, for editors."""
    from faying.study.keys.schema import EDITOR_SCHEMA

    typer.echo(EDITOR_SCHEMA.read_text(encoding="utf-8"), nl=False)
