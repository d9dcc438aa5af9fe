"""``faying solve``: many loads on a reduced model, without the full model."""

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from faying.cli.arguments import (
    Integrator,
    Resume,
    Scheduler,
    results_folder,
    shared_executor,
    usable_folder,
    workers_for,
)
from faying.cli.interruption import resumable
from faying.exceptions import refuse_study

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any


def solve(
    model: Annotated[
        Path, typer.Argument(metavar="JOINT.faying", help="File that `faying reduce` wrote.")
    ],
    loads: Annotated[
        Path,
        typer.Argument(
            metavar="LOADS",
            help="TOML with load cases; csv or Parquet, a row per case, or per instant with a "
            "column time; or a folder of such histories.",
        ),
    ],
    out: Annotated[Path | None, results_folder("LOADS-solved")] = None,
    worst: Annotated[
        int, typer.Option(min=1, help="Worst cases of each metric whose fields are kept.")
    ] = 1,
    keep: Annotated[
        list[str] | None,
        typer.Option(metavar="CASE", help="Keep the fields of this case as well; repeatable."),
    ] = None,
    certificates: Annotated[
        bool,
        typer.Option("--certificates/--no-certificates", help="Bound the errors of static cases."),
    ] = True,
    table: Annotated[Literal["csv", "parquet"], typer.Option(help="Tables of metrics.")] = "csv",
    step: Annotated[
        float | None,
        typer.Option(
            help="Time step of tables over time.  [default: smallest interval]", show_default=False
        ),
    ] = None,
    integrator: Integrator = None,
    resume: Resume = False,
    workers: Annotated[int, workers_for("static cases and loads over time")] = 1,
    scheduler: Scheduler = None,
) -> None:
    """Solve many loads on a reduced model: metrics of all cases, fields of the worst ones."""
    folder = out or Path(f"{loads.stem}-solved")
    command = ["faying", "solve", str(model), str(loads), "--out", str(folder)]
    with resumable(command, folder, ", and the other options as before"):
        from rich.console import Console

        from faying.cli.outcome import end
        from faying.cli.progress import progress_bar
        from faying.reduction.model_reader import preload_path_of, read_reduced_model, study_of
        from faying.simulation.integrators import named_integrator
        from faying.study.inputs.load_set import read_loads
        from faying.study.keys.requirement_rules import requirements_of
        from faying.study.keys.schema import stored_requirement
        from faying.study.keys.threads import StudyBolts
        from faying.workflow.solve import bolt_loads, solve_loads
        from faying.workflow.solve_cases import SolveOptions

        if step is not None and not 0 < step < float("inf"):
            refuse_study(f"--step is {step:g}; give a positive time")
        rom = read_reduced_model(model)
        load_set = read_loads(loads, rom, step=step, integrator=named_integrator(integrator))
        usable_folder(folder)
        tightened, text = preload_path_of(model), study_of(model)
        demanded = load_set.requirement or stored_requirement(text)
        options = SolveOptions(
            worst=worst,
            named=tuple(keep or ()),
            certificates=certificates,
            table=table,
            requirements=requirements_of(demanded),
            strengths=StudyBolts.stored(text, rom.units).strengths,
            margins=demanded.margins,
        )
        with ExitStack() as stack:
            executor = shared_executor(workers, scheduler, stack)
            bar = stack.enter_context(progress_bar(Console(stderr=True), remaining=True))
            summary = solve_loads(
                rom,
                load_set,
                folder,
                options,
                tightening=None if tightened is None else bolt_loads(tightened),
                resume=resume,
                progress=bar,
                executor=executor,
            )
    _show(summary, folder)
    end(summary, folder, Console(markup=False), "cases")


def _show(summary: "Mapping[str, Any]", folder: Path) -> None:
    """Print the worst value of every metric, and its case."""
    from faying.cli.tables import plain_console, text_table

    console = plain_console()
    sets = {"static cases": summary["static"]} if "static" in summary else {}
    sets |= {f"{name}, instants": group for name, group in summary.get("transients", {}).items()}
    for name, group in sets.items():
        rows = []
        for metric, (entry, *_) in ((m, worst) for m, worst in group["worst"].items() if worst):
            unit = summary["metrics"][metric]["unit"]
            label = f"{metric} [{unit}]" if unit not in ("", "1") else metric
            # JSON has no infinity, such as the friction that an open interface would need.
            value = "infinite" if entry["value"] is None else f"{entry['value']:.5g}"
            rows.append((label, value, entry["case"]))
        title = f"Worst of {group['count']} {name}"
        console.print(text_table(title, ("metric", "value", "at"), rows))
    for line in summary.get("remarks", ()):
        console.print(line, soft_wrap=True)
    console.print(f"Results are in {folder}", soft_wrap=True)
