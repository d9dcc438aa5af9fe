"""``faying demo``: the bolted cantilever with every method."""

from pathlib import Path
from typing import Annotated

import typer

from faying.cli.run import compute


def demo(
    out: Annotated[Path, typer.Option(help="Folder for results.")] = Path("faying-demo"),
    quick: Annotated[bool, typer.Option("--quick", help="A coarse mesh: under a minute.")] = False,
) -> None:
    """Run the built-in study: a bolted cantilever, every method, a report."""
    studies = Path(__file__).parent.parent / "study"
    compute(studies / ("demo-quick.toml" if quick else "demo.toml"), out, resume=False)
