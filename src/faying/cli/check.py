"""``faying check``: read everything, solve nothing, say what was understood."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faying.cli.arguments import StudyPath, usable_folder

if TYPE_CHECKING:
    from faying.model.model import Model


def check(
    study: StudyPath,
    out: Annotated[Path | None, typer.Option(help="Folder for pictures of the model.")] = None,
) -> None:
    """Read and check a study; print mass, bodies, constraints, interfaces and loads."""
    from rich.console import Console

    from faying.cli.description import described
    from faying.study.load_model import build
    from faying.study.schema import read_study

    checked = read_study(study)
    if out is not None:
        usable_folder(out)
    model = build(checked)
    console = Console()
    for table in described(checked, model):
        console.print(table)
    if out is not None:
        console.print(f"Wrote {_picture(model, out / 'model.png')}")


def _picture(model: "Model", path: Path) -> Path:
    """Draw the model into a file."""
    from matplotlib.figure import Figure

    from faying.report.figures import plot_model

    figure = Figure(figsize=(10, 7), layout="constrained")
    plot_model(model, figure.add_subplot(projection="3d"))
    figure.savefig(path, dpi=150)
    return path
