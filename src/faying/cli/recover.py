"""``faying recover``: pressures from the history of another program."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from faying.cli.arguments import Integrator

if TYPE_CHECKING:
    from faying.study.results.solved_fields import RecoveredRecord
    from faying.study.results.values import Results


def recover(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a finished run.")],
    history: Annotated[
        Path,
        typer.Argument(
            metavar="HISTORY", help="CSV or HDF5: time, q1, q2, ... and boundary forces, or these."
        ),
    ],
    method: Annotated[
        str | None,
        typer.Option(
            help="Basis of the coordinates, or model to simulate.  "
            "[default: craig-bampton; compliance for boundary forces]",
            show_default=False,
        ),
    ] = None,
    joint_modes: Annotated[
        int | None, typer.Option(help="Joint modes of the method.", show_default=False)
    ] = None,
    derivatives: Annotated[
        Literal["spline", "backward"] | None,
        typer.Option(
            help="Missing velocities and accelerations.  [default: spline]", show_default=False
        ),
    ] = None,
    step: Annotated[
        float | None,
        typer.Option(
            help="Time step under boundary forces.  [default: smallest interval]",
            show_default=False,
        ),
    ] = None,
    integrator: Integrator = None,
) -> None:
    """Recover contact pressures from a modal or boundary-force history of another program."""
    from faying.simulation.integrators import named_integrator
    from faying.study.stages.recover import RecoverOptions, results_of
    from faying.study.stages.recover import recover as recover_history

    results = results_of(folder)
    options = RecoverOptions(
        method=method,
        joint_modes=joint_modes,
        derivatives=derivatives,
        step=step,
        integrator=named_integrator(integrator) if integrator else None,
    )
    recovered = recover_history(results, history, options)
    _print_recovered(results, recovered)
    for path in _written(results, recovered, folder, history.stem):
        typer.echo(f"Wrote {path}")


def _print_recovered(results: "Results", recovered: "RecoveredRecord") -> None:
    """Print how the history was read, and the largest pressures."""
    from faying.cli.tables import plain_console, shown
    from faying.study.stages.recover import peak_table

    console = plain_console()
    modes = f" with {recovered.joint_modes} joint modes" if recovered.joint_modes else ""
    derived = recovered.derivatives
    if "velocities" not in derived and "accelerations" not in derived:
        derived = f"velocities and accelerations: {derived}"
    console.print(
        f"{recovered.history}: {recovered.route}, {len(recovered.times)} instants, "
        f"{recovered.method}{modes}; {derived}"
    )
    names = ", ".join(recovered.loads)
    console.print(f"Boundary forces: {names or 'none'} from the history; all others are zero")
    console.print(shown("Largest pressures", peak_table(results, recovered)))


def _written(
    results: "Results", recovered: "RecoveredRecord", folder: Path, stem: str
) -> list[Path]:
    """Write recovered pressures and fields at the instant of largest pressure; return the paths."""
    from faying.export.vtk import write_fields_vtu
    from faying.files.names import file_names
    from faying.study.results.store import write_results
    from faying.study.stages.recover import peak_fields

    label = f"recovered_{file_names([stem])[stem]}"
    paths = [folder / f"{label}.h5"]
    write_results(recovered, paths[0])
    time = float(recovered.times[int(recovered.max_pressure.argmax())])
    stems = file_names(results.interfaces)
    for name, record in results.interfaces.items():
        paths.append(folder / f"{label}_{stems[name]}.vtu")
        write_fields_vtu(record, peak_fields(results, recovered, name), paths[-1], time=time)
    return paths
