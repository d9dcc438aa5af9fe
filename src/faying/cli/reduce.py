"""``faying reduce``: one reduced model in one file."""

from pathlib import Path
from typing import Annotated

import typer

from faying.cli.arguments import StudyPath


def reduce(
    study: StudyPath,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="File.  [default: STUDY.faying]", show_default=False),
    ] = None,
    method: Annotated[
        str, typer.Option(help="Method; with compliance static pressures are exact.")
    ] = "compliance",
    joint_modes: Annotated[
        int | None,
        typer.Option(
            min=1, help="Its joint modes.  [default: the most of the study]", show_default=False
        ),
    ] = None,
    shapes: Annotated[
        bool,
        typer.Option("--shapes/--no-shapes", help="Keep displacements of all nodes, for pictures."),
    ] = True,
) -> None:
    """Reduce the model of a study into one file, which `faying solve` needs nothing else with."""
    from rich.console import Console

    from faying.cli.export import model_sizes
    from faying.cli.progress import progress_bar
    from faying.study.keys.schema import naming_tables, read_study
    from faying.workflow.reduce import reduce_study

    checked = read_study(study)
    target = out or Path(f"{study.stem}.faying")
    with progress_bar(Console(stderr=True)) as bar, naming_tables(checked):
        rom = reduce_study(
            checked,
            target,
            method=method,
            joint_modes=joint_modes,
            shapes=shapes,
            progress=bar,
            report=typer.echo,
        )
    typer.echo(model_sizes(rom))
    typer.echo(f"Wrote {target} ({target.stat().st_size / 1e6:.3g} MB)")
