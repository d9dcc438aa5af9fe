"""Output at the end of a run: pressure errors of the methods, verdict, and paths of results."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import typer
from rich.console import Console

from faying.cli.tables import text_table
from faying.display.quantities import percent
from faying.study.results.values import FULL_MODEL

STYLES = {"met": "", "not met": "bold red", "unknown": "yellow"}
"""Style of a row of the verdict."""


def show_outcome(summary: Mapping[str, Any], out: Path, console: Console) -> None:
    """Print the pressure errors, one row per method with its largest basis, and the remarks."""
    cases = summary["load_cases"]
    # Pressures of backbones belong to the preloaded joint and say nothing about vibrations.
    pressed = {name: case for name, case in cases.items() if case["kind"] != "backbone"} or cases
    full = all(case["reference"]["model"] == FULL_MODEL for case in cases.values())
    of = FULL_MODEL if full else "reference"
    methods = dict.fromkeys(name for case in cases.values() for name in case["methods"])
    if cases:
        title = f"Largest pressure error over the largest pressure of the {of}"
        rows = [(method, *_row(method, list(pressed.values()))) for method in methods]
        console.print(text_table(title, ["method", "joint modes", *pressed], rows))
    for line in summary["remarks"]:
        console.print(line, highlight=False, soft_wrap=True)
    report = out / "report.html"
    console.print(f"Results are in {out}", highlight=False, soft_wrap=True)
    if report.exists():
        console.print(f"Report: {report}", highlight=False, soft_wrap=True)


def show_verdict(summary: Mapping[str, Any], console: Console) -> None:
    """Print the verdict on the joint: a row for each bolt and interface, advice, and a sentence."""
    verdict = summary["verdict"]
    if verdict["table"]:
        rows = [row.values() for row in verdict["table"]]
        styles = [STYLES[row["verdict"]] for row in verdict["table"]]
        console.print(text_table(None, verdict["table"][0], rows, styles))
    for text in verdict["advice"]:
        console.print(f"What to do: {text}", highlight=False, soft_wrap=True)
    for text in verdict["open_questions"]:
        console.print(f"Not judged: {text}", highlight=False, soft_wrap=True)
    console.print(verdict["sentence"], highlight=False, soft_wrap=True)


def end(summary: Mapping[str, Any], out: Path, console: Console, solved: str) -> None:
    """Print warnings and the verdict, and exit with their status.

    The status is 1 where a load case did not converge, and 3 where the joint does not hold or a
    requirement could not be judged.
    """
    for warning in summary["warnings"]:
        typer.echo(f"Warning: {warning}", err=True)
    if not summary["converged"]:
        message = f"Some {solved} did not converge; {out / 'summary.json'} names them"
        typer.echo(message, err=True)
    show_verdict(summary, console)
    if not summary["converged"]:
        raise typer.Exit(1)
    if not summary["verdict"]["holds"]:
        raise typer.Exit(3)


def _row(method: str, cases: list[Mapping[str, Any]]) -> list[str]:
    sizes = [size for case in cases for size in case["methods"].get(method, {})]
    if not sizes:
        return ["-", *("not converged" for _ in cases)]
    largest = max(sizes, key=int)
    results = [case["methods"].get(method, {}).get(largest) for case in cases]
    errors = (None if entry is None else entry["max_relative_error"] for entry in results)
    return [largest, *("-" if error is None else percent(error) for error in errors)]
