"""``faying tighten``: the force to tighten each bolt to, turn by turn."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faying.cli.arguments import StudyPath, study_work

if TYPE_CHECKING:
    from collections.abc import Mapping

    from faying.simulation.tightening_plan import TighteningPlan
    from faying.units import Units


def tighten(
    study: StudyPath,
    passes: Annotated[
        int, typer.Option(min=1, help="Rounds; more rounds need smaller overshoot.")
    ] = 1,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Table of the plan.  [default: STUDY-plan.csv]", show_default=False
        ),
    ] = None,
) -> None:
    """Plan the force to tighten each bolt to in turn, so that all bolts end at their preloads.

    Bolts are tightened in the order of the study.
    """
    from faying.workflow.tighten import overstressed, plan_of_study, torques_per_force, write_plan

    target = out or Path(f"{study.stem}-plan.csv")
    with study_work(study) as (checked, bar, _):
        plan = plan_of_study(checked, passes=passes, progress=bar)
    torques = torques_per_force(checked)
    write_plan(plan, target, torques)
    _show(plan, checked.unit_set, torques)
    used = overstressed(checked, plan)
    if used:
        worst = max(used, key=used.__getitem__)
        message = (
            f"Warning: {', '.join(used)} would yield while tightening ({worst}: {used[worst]:.0%} "
            "of its yield stress); use more --passes, which need smaller overshoot"
        )
        typer.echo(message, err=True)
    typer.echo(f"Wrote {target}")


def _show(plan: "TighteningPlan", units: "Units", torques: "Mapping[str, float]") -> None:
    """Print the turns of a plan, and the bolt forces without a plan."""
    from faying.cli.tables import plain_console, shown
    from faying.display.table import FL, Column, described

    def torque(turn: int) -> float | None:
        per_force = torques.get(plan.turned[turn])
        return None if per_force is None else float(plan.settings[turn] * per_force)

    columns = (
        Column("pass", lambda turn: plan.passes[turn]),
        Column("bolt", lambda turn: plan.turned[turn]),
        Column("to", lambda turn: plan.settings[turn], "force", 5),
        Column("of its preload", lambda turn: 100 * plan.shares[turn], "%", 4),
        Column("by", torque, FL, 5),
    )
    turns = [(str(turn + 1), turn) for turn in range(len(plan.turned))]
    console = plain_console()
    console.print(shown("Tighten in this order", described("turn", turns, columns, units)))
    unplanned, reached = plan.reached_unplanned, plan.reached
    console.print(
        f"All bolts end within {abs(reached - 1).max():.2%} of their preloads. One round directly "
        f"to the preloads, in this order, would leave them at {unplanned.min():.1%} to "
        f"{unplanned.max():.1%}.",
        soft_wrap=True,
    )
