"""``faying export``: write a reduced model in the format of another program."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faying.display.facts import MOST_SHOWN

if TYPE_CHECKING:
    from faying.reduction.reduced_model import ReducedModel


def model_sizes(rom: "ReducedModel") -> str:
    """Return the method, sizes and units of a reduced model as text."""
    units = rom.unit_set
    counts = {
        "coordinate": len(rom.K),
        "boundary displacement": sum(len(boundary.dofs) for boundary in rom.boundaries.values()),
        "bolt": len(rom.bolts),
        "contact point": rom.contact.n_points,
    }
    sizes = ", ".join(f"{n} {name}{'s' * (n != 1)}" for name, n in counts.items())
    modes = f" with {rom.joint_modes} joint modes" if rom.joint_modes else ""
    measures = (units.length, units.mass, units.time, units.force, units.pressure)
    return f"Model: {rom.method}{modes}, {sizes}\nUnits: {', '.join(measures)}"


def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a finished run.")],
    to: Annotated[
        str,
        typer.Option(metavar="FORMAT", help="nastran, mat, fmu, exudyn, vtk or npz."),
    ],
    method: Annotated[
        str | None,
        typer.Option(help="Reduced model of the run.  [default: compliance]", show_default=False),
    ] = None,
    joint_modes: Annotated[
        int | None,
        typer.Option(help="Its joint modes.  [default: the most it has]", show_default=False),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="File to write.  [default: in DIR, named after the model]",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Write a reduced model of a run in the format of another program."""
    from faying.export.formats import MEANINGS, default_name, format_named, run_model
    from faying.export.formats import export as write
    from faying.study.stages.recover import results_of

    chosen, run = format_named(to), results_of(folder)
    rom = run_model(run, method, joint_modes)
    target = out or folder / default_name(rom, to)
    paths = write(run, to, out=target, method=method, joint_modes=joint_modes)
    typer.echo(f"{chosen.kind.capitalize()}: {MEANINGS[chosen.kind]}")
    typer.echo(model_sizes(rom))
    for path in _shown(paths):
        typer.echo(f"Wrote {path}")


def _shown(paths: tuple[Path, ...]) -> Iterator[str]:
    for folder in dict.fromkeys(path.parent for path in paths):
        inside = [path for path in paths if path.parent == folder]
        if len(inside) > MOST_SHOWN:
            yield f"{folder} ({len(inside)} files)"
        else:
            yield from map(str, inside)
