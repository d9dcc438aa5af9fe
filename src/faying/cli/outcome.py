"""What a run prints when it ends: how far each method's pressures are off, and where to read on."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import typer
from rich import box
from rich.console import Console
from rich.table import Table

from faying.assessment.backbone import amplitude_unit
from faying.assessment.transient_error import (
    EXACT,
    LARGE_ERROR,
    OBSERVED_ON,
    OBSERVED_RATIOS,
    REMEDY,
    TRACTIONS_OBSERVED,
    remedy_hint,
)
from faying.display.facts import with_unit
from faying.study.inputs.jumps import Jump, jump_sentence
from faying.study.judgement.step_choice import StepChoice, choice_sentence
from faying.study.results.second_solution import remedy_from, remedy_sentence, shapes_seconds
from faying.study.results.values import FULL_MODEL
from faying.units import units_of
from faying.workflow.outcome import Outcome

ESTIMATED = "estimated_max_relative_error"
"""Entry of a summary that has the estimated error of a transient's pressures."""

STYLES = {"met": "", "not met": "bold red", "unknown": "yellow"}
"""How a row of the verdict is written."""


def show_outcome(summary: Mapping[str, Any], out: Path, console: Console) -> None:
    """Print one row per method with its largest basis, one column per load case."""
    cases = summary["load_cases"]
    # Pressures of backbones are those of the preloaded joint, which tell nothing of vibrations.
    pressed = {name: case for name, case in cases.items() if case["kind"] != "backbone"} or cases
    for line in _peaks(summary):
        console.print(line, highlight=False, soft_wrap=True)
    full = all(case["reference"]["model"] == FULL_MODEL for case in cases.values())
    of = FULL_MODEL if full else "reference"
    table = Table(title=f"Largest pressure error over the largest pressure of the {of}")
    table.add_column("method")
    table.add_column("joint modes", justify="right")
    for name in pressed:
        table.add_column(name, justify="right")
    methods = dict.fromkeys(name for case in cases.values() for name in case["methods"])
    for method in methods:
        table.add_row(method, *_row(method, list(pressed.values())))
    if cases:
        console.print(table)
    for line in _backbones(cases):
        console.print(line, highlight=False, soft_wrap=True)
    for line in _estimates(cases):
        console.print(line, highlight=False)
    for name, case in cases.items():
        if case.get("steps") is not None:
            chosen = {key: value for key, value in case["steps"].items() if key != "met"}
            console.print(choice_sentence(name, StepChoice(**chosen)), highlight=False)
    for line in _chosen_modes(summary):
        console.print(line, highlight=False)
    for line in _remedies(summary):
        console.print(line, highlight=False)
    for name, case in cases.items():
        jumps = [Jump(**jump) for jump in case.get("jumps", [])]
        if jumps:
            time = units_of(summary["units"]).time
            said = jump_sentence(name, jumps, time, history=case["kind"] == "history")
            console.print(f"Doubtful: {said}", highlight=False)
    if summary["reference"]["reason"]:
        console.print(f"Reference: {summary['reference']['reason']}", highlight=False)
    report = out / "report.html"
    console.print(f"Results are in {out}", highlight=False, soft_wrap=True)
    if report.exists():
        console.print(f"Report: {report}", highlight=False, soft_wrap=True)


def show_verdict(summary: Mapping[str, Any], console: Console) -> None:
    """Print the verdict on the joint: a row for each bolt and interface, and a sentence."""
    verdict = summary["verdict"]
    if verdict["table"]:
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        for column in verdict["table"][0]:
            table.add_column(column, overflow="fold")
        for row in verdict["table"]:
            table.add_row(*row.values(), style=STYLES[row["verdict"]])
        console.print(table)
    for text in verdict["advice"]:
        console.print(f"What to do: {text}", highlight=False, soft_wrap=True)
    for text in verdict["open_questions"]:
        console.print(f"Not judged: {text}", highlight=False, soft_wrap=True)
    console.print(verdict["sentence"], highlight=False, soft_wrap=True)


def end(done: Outcome, out: Path, console: Console, solved: str) -> None:
    """Print warnings and the verdict, and exit by them.

    The status is 1 where something did not converge, 3 of a joint that does not hold, or of which
    what is demanded is not known.
    """
    for warning in done.summary["warnings"]:
        typer.echo(f"Warning: {warning}", err=True)
    if not done.converged:
        message = f"Some {solved} did not converge; {out / 'summary.json'} names them"
        typer.echo(message, err=True)
    show_verdict(done.summary, console)
    if not done.converged:
        raise typer.Exit(1)
    if not done.summary["verdict"]["holds"]:
        raise typer.Exit(3)


def _row(method: str, cases: list[Mapping[str, Any]]) -> list[str]:
    sizes = [size for case in cases for size in case["methods"].get(method, {})]
    if not sizes:
        return ["-", *("not converged" for _ in cases)]
    largest = max(sizes, key=int)
    results = [case["methods"].get(method, {}).get(largest) for case in cases]
    return [largest, *(_percent(entry) for entry in results)]


def _peaks(summary: Mapping[str, Any]) -> Iterator[str]:
    """Say where responses to harmonic loads peak, and what transients say of it."""
    for name, figures in summary.get("frequencies", {}).items():
        units = units_of(summary["units"])
        for entry in figures["levels"]:
            size = amplitude_unit(figures["component"], summary["units"])
            ratio = f"damping ratio {entry['damping_ratio']:.2%}"
            missed = f", {entry['missed']} frequencies without a motion" if entry["missed"] else ""
            yield (
                f"{name}, level {entry['level']:g}: {figures['component']} peaks at "
                f"{with_unit(entry['frequency'], '1/' + units.time)} with "
                f"{with_unit(entry['amplitude'], size)}, {ratio}{missed}"
            )
        for entry in figures["checks"]:
            yield f"{name}, {entry['sentence']}"


def _backbones(cases: Mapping[str, Any]) -> Iterator[str]:
    """Say how far backbones of reduced models are from those of the full model."""
    for name, case in cases.items():
        for method, sizes in case["methods"].items():
            for entry in list(sizes.values())[-1:]:
                if "frequency_error" in entry:
                    yield (
                        f"Backbones {name}, {method}: frequencies off by at most "
                        f"{_small(entry['frequency_error'])}, damping ratios by "
                        f"{_small(entry['damping_error'])}"
                    )


def _chosen_modes(summary: Mapping[str, Any]) -> list[str]:
    """Say how many normal modes were chosen for each load case."""
    choice = summary.get("normal_mode_choice")
    return [] if choice is None else [entry["reason"] for entry in choice["load_cases"].values()]


def _remedies(summary: Mapping[str, Any]) -> list[str]:
    """Say of each transient that was solved again what it was solved by, and what that cost."""
    shapes = shapes_seconds(summary["timings"]["stages"])
    remedies = {name: case.get("remedy") for name, case in summary["load_cases"].items()}
    return [
        remedy_sentence(name, remedy_from(remedy), shapes)
        for name, remedy in remedies.items()
        if remedy is not None
    ]


def _estimates(cases: Mapping[str, Any]) -> list[str]:
    """Say of each transient how far off the methods are estimated to be, their largest bases."""
    said: list[str] = []
    worst: dict[str, float] = {}
    for name, case in cases.items():
        largest = {
            method: sizes[max(sizes, key=int)] for method, sizes in case["methods"].items() if sizes
        }
        estimates = {method: entry.get(ESTIMATED) for method, entry in largest.items()}
        shown = [
            f"{method} {_estimated(entry)}"
            for method, entry in largest.items()
            if ESTIMATED in entry
        ]
        reference_estimate = case["reference"].get(ESTIMATED)
        if reference_estimate is not None:
            judged = _estimated(case["reference"])
            shown.append(f"the reference, {case['reference']['model']} {judged}")
        if shown:
            said.append(f"{name}, errors estimated without a full solution: {', '.join(shown)}")
        errors = {method: error or 0.0 for method, error in estimates.items()}
        if reference_estimate is not None:
            errors[EXACT] = max(reference_estimate, errors.get(EXACT, 0.0))
        if case.get("remedy") is not None:
            errors.setdefault(REMEDY, 0.0)
        tolerated = case.get("tolerance") or LARGE_ERROR
        worst |= {
            method: max(error / tolerated, worst.get(method, 0.0))
            for method, error in errors.items()
        }
    if said:
        low, high = OBSERVED_RATIOS
        rubbed = any("(tractions" in line for line in said)
        of_tractions = f"; {TRACTIONS_OBSERVED}" if rubbed else ""
        said.append(
            f"(Estimates, {low:g} to {high:g} times the true error on {OBSERVED_ON}{of_tractions}.)"
        )
    hint = remedy_hint(worst)
    return [*said, hint] if hint else said


def _estimated(entry: Mapping[str, float]) -> str:
    """Return estimated errors of pressures and, where something rubs, of tractions."""
    rubbed = entry.get("estimated_max_traction_error")
    tractions = "" if rubbed is None else f" (tractions {rubbed:.2%})"
    return f"{entry[ESTIMATED]:.2%}{tractions}"


def _percent(entry: Mapping[str, float] | None) -> str:
    if entry is None:
        return "-"
    return _small(entry["max_relative_error"])


def _small(error: float) -> str:
    """Return an error in percent, as a bound where it is round-off."""
    return "< 1e-7" if error < 1e-7 else f"{error:.2%}"
