"""``faying init``: a first study of a deck or mesh; ``faying schema``: the schema for editors."""

from pathlib import Path
from typing import Annotated

import typer

from faying.cli.arguments import Ignored


def init(
    deck: Annotated[Path, typer.Argument(metavar="DECK", help="A deck or a mesh.")],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="STUDY.toml",
            help="The study to write.  [default: beside DECK, by its name]",
            show_default=False,
        ),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an existing study.")
    ] = False,
    ignore: Ignored = None,
) -> None:
    """Write a first study of a deck or mesh, with comments on what to decide."""
    from faying.draft.first_study import first_study
    from faying.draft.study_text import DECIDE
    from faying.exceptions import refuse_study
    from faying.files.atomic import write_text

    if not deck.is_file():
        refuse_study(f"{deck} is not a file; give a deck or a mesh")
    target = out or deck.with_suffix(".toml")
    if target.suffix.lower() != ".toml":
        refuse_study(f"--out {target}: the name of a study must end in .toml; add it")
    if target.exists() and not overwrite:
        refuse_study(f"{target} exists already; give another path with --out, or --overwrite")
    study = first_study(deck, target, ignore or ())
    write_text(target, study.text)
    typer.echo(f"Wrote {target}; {study.undecided} lines to decide, marked {DECIDE[:-1]}")
    if study.problem:
        typer.echo(f"It does not run yet: {study.problem}")
    else:
        typer.echo(f"Next: faying check {target}")


def schema() -> None:
    """Print the JSON Schema of study files, for editors."""
    from faying.study.keys.schema import EDITOR_SCHEMA

    typer.echo(EDITOR_SCHEMA.read_text(encoding="utf-8"), nl=False)
