"""``faying reduce``: a reduced model in a file."""

from pathlib import Path
from typing import Annotated

import typer

from faying.cli.arguments import StudyPath, study_work


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
    """Reduce the model of a study into one file for `faying solve`."""
    from faying.cli.export import model_sizes
    from faying.workflow.reduce import reduce_study

    target = out or Path(f"{study.stem}.faying")
    with study_work(study) as (checked, bar, _):
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
