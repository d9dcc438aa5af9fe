"""The report of a run: one page that works offline, its figures beside it."""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined

from faying.files.atomic import write_text
from faying.files.names import file_names
from faying.report.certified import sharpness
from faying.report.estimates import doubtful_references, estimate_note, remedies
from faying.report.figures import write_figures
from faying.report.figures.entry import FigureEntry
from faying.report.friction_table import friction_table
from faying.report.joint import (
    bolt_judgement,
    clamp_judgement,
    interface_judgement,
    joint_doubts,
    joint_headline,
    requirement_table,
    scatter_table,
    slip_judgement,
)
from faying.report.limits import limits
from faying.report.meanings import meanings
from faying.report.quantities import percent, quantity
from faying.report.reference import against
from faying.report.slip import slip_sentence
from faying.report.tables import (
    Table,
    bolt_table,
    case_table,
    error_table,
    interface_table,
    model_table,
    stage_table,
    timing_table,
)
from faying.report.unseen_loads import choice_table, load_space_table
from faying.report.verdict import FAIR, GOOD, STEP_MATTERS, headline, reservations, verdicts
from faying.report.view.scene import scene
from faying.report.view.scripts import own, three
from faying.study.mode_choice import mode_sentences
from faying.study.results import CaseResult, Results
from faying.study.step_check import StepCheck, step_check
from faying.study.step_choice import choice_sentence, step_choice
from faying.units import Units, units_of

LONG = 22
"""Characters of a cell that may be broken into lines; a number stays with its unit."""
NARROW = 3
"""Most columns that a phone shows side by side; wider tables become a card per row there."""


@dataclass(frozen=True, kw_only=True)
class CaseSection:
    """What the report says of one load case."""

    anchor: str
    name: str
    kind: str
    errors: Table
    figures: list[FigureEntry]
    step_check: str


def write_report(results: Results, folder: Path) -> Path:
    """Write ``report.html`` and ``figures/*.png`` of a run.

    Parameters
    ----------
    folder
        Made if it does not exist; files in it are replaced atomically.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    FormatError
        If a file cannot be written.
    """
    figures = write_figures(results, folder / "figures")
    path = folder / "report.html"
    write_text(path, render(results, figures, folder))
    return path


def render(results: Results, figures: list[FigureEntry], folder: Path) -> str:
    """Return the page as text; it links figures relative to its folder."""
    environment = Environment(
        loader=PackageLoader("faying.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["link"] = lambda path: quote(Path(path).relative_to(folder).as_posix())
    environment.filters["instant"] = _instant
    environment.globals |= {"LONG": LONG, "NARROW": NARROW}
    found = verdicts(results)
    return environment.get_template("report.html.j2").render(
        results=results,
        joint=joint_headline(results),
        doubts=joint_doubts(results),
        slips=slip_sentence(results),
        vibrations=any(case.reference.backbones for case in results.cases.values()),
        joint_tables=[
            one
            for of in (
                requirement_table,
                bolt_judgement,
                clamp_judgement,
                interface_judgement,
                slip_judgement,
                scatter_table,
            )
            if (one := of(results)).rows
        ],
        headline=headline(found, results),
        verdicts=found,
        methods=meanings(results),
        reservations=[
            *doubtful_references(results),
            *mode_sentences(results.mode_choices, units_of(results.units)),
            *remedies(results),
            *reservations(results),
        ],
        good=f"{100 * GOOD:g} %",
        fair=f"{100 * FAIR:g} %",
        model=model_table(results),
        interfaces=interface_table(results),
        bolts=bolt_table(results),
        load_cases=case_table(results),
        friction=friction_table(results),
        cases=_sections(results, figures),
        unseen=load_space_table(results),
        choices=choice_table(results),
        timings=timing_table(results),
        stages=stage_table(results),
        limits=limits(results),
        reference=against(results.cases.values()).removeprefix("the "),
        sharpness=sharpness(results),
        view=scene(results),
        three=three(),
        own=own(),
        still=[entry for entry in figures if entry.path.stem == "model"],
        estimates=estimate_note(results),
        figures={
            section: [entry for entry in figures if entry.section == section]
            for section in ("model", "preload", "convergence", "beyond")
        },
    )


def _instant(text: str) -> str:
    """Return the instant of a run as people write it; another text as it is."""
    try:
        return datetime.fromisoformat(text).strftime("%Y-%m-%d %H:%M %Z")
    except ValueError:
        return text


def _sections(results: Results, figures: list[FigureEntry]) -> list[CaseSection]:
    units, stems = units_of(results.units), file_names(results.cases)
    return [
        CaseSection(
            anchor=f"case-{quote(stems[name])}",
            name=name,
            kind=case.kind,
            errors=error_table(case),
            figures=[e for e in figures if e.section == name and e.path.stem.startswith("case_")],
            step_check=_step_check(case, units),
        )
        for name, case in results.cases.items()
    ]


def _step_check(case: CaseResult, units: Units) -> str:
    """Return what the half-step run says about the pressures of a transient case."""
    if case.times is None:
        return ""
    choice = step_choice(case)
    if choice is not None:
        return choice_sentence(case.name, choice)
    check = step_check(case)
    if check is None:
        return "No run with half the time step was made: convergence in time is open."
    return f"{_numbers(check, case.reference_model, units)} {_judgement(check.largest)}"


def _numbers(check: StepCheck, model: str, units: Units) -> str:
    change = check.change
    return (
        f"The {model} was run with the study's step of "
        f"{quantity(check.step, units.time)} and with half of it, and their pressure fields "
        "compared at every contact point and common instant: they differ by up to "
        f"{percent(check.largest)} of the peak (at {quantity(check.instant, units.time)}), "
        f"{percent(change.rms_relative_error)} root mean square, 99.9 % of them by less than "
        f"{percent(change.p999_relative_error)}. The peak itself goes from "
        f"{quantity(check.peak, units.pressure)} to {quantity(check.half_peak, units.pressure)} "
        f"({percent(check.peak_change)}), boundary displacements move by "
        f"{percent(change.displacement_error)} of the largest."
    )


def _judgement(changed: float) -> str:
    if changed <= STEP_MATTERS:
        return (
            "As far as the error keeps shrinking with the step, that at the study's step is about "
            "twice this change with a scheme of first order, four thirds of it with one of second."
        )
    return (
        "The pressures of this load case are not converged in time: refine the step before using "
        "them, or let the load rise over several steps instead of jumping. Schemes of first order "
        "such as implicit Euler are off by about twice the change. The errors of the methods below "
        "compare models at the same step and do not contain this."
    )
