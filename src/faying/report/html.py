"""The report of a run: a page on the joint and a page on the methods, readable offline."""

import re
from collections.abc import Sequence
from datetime import datetime
from math import inf
from pathlib import Path
from typing import Any
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined

from faying.assessment.check import Check
from faying.assessment.joint_verdict import (
    JointVerdict,
    PartVerdict,
    share_used,
    shown_quantity,
    verdict_rows,
)
from faying.display.quantities import as_given, number
from faying.display.table import MARKS, Cell, Column, Table, described
from faying.files.atomic import write_text
from faying.report.errors import (
    choice_table,
    doubtful_references,
    error_table,
    estimate_note,
    load_space_table,
    stage_table,
    timing_table,
)
from faying.report.figures.album import Album
from faying.report.figures.convergence import convergence_figure
from faying.report.figures.maps import initial_gap_figure, preload_figure
from faying.report.figures.model import model_figure, tightening_figure
from faying.report.methods import (
    FAIR_ERROR,
    GOOD_ERROR,
    against,
    coarse_steps,
    headline,
    meanings,
    reservations,
    verdicts,
)
from faying.report.model_tables import bolt_table, interface_table, model_table
from faying.report.questions import questions
from faying.report.trust import trust
from faying.report.view.scene import own, scene, three
from faying.study.judgement.model_warnings import barely_held, kept_share, missing_contact
from faying.study.judgement.remarks import remedies, vibrations
from faying.study.judgement.verdict import run_verdict
from faying.study.results.mode_choice import mode_sentences
from faying.study.results.values import Results

LONGEST_UNBROKEN = 22
"""Characters up to which a cell stays on one line, so that numbers stay with their unit."""
NARROW_COLUMNS = 3
"""Most columns side by side on a phone; wider tables become a card per row."""
GRADES = {"met": "good", "not met": "poor", "unknown": "fair"}


def write_report(results: Results, folder: Path) -> Path:
    """Write ``report.html``, ``methods.html`` and ``figures/*.png`` of a run into a folder.

    The folder is made if it does not exist; files are replaced atomically. Return the path of
    the page on the joint.

    Raises
    ------
    FormatError
        If a file cannot be written.
    """
    album, path = Album(results, folder / "figures"), folder / "report.html"
    write_text(path, render(album, folder))
    write_text(folder / "methods.html", render_methods(album, folder))
    return path


VERDICT_ROWS = 5
"""Visible rows of the verdict above the view; the others are folded."""


def _folded(parts: Sequence[PartVerdict]) -> list[bool]:
    """Return which rows are folded: all but the worst, with at least one bolt and interface."""
    severity = {"not met": 2, "unknown": 1, "met": 0}

    def used(part: PartVerdict) -> tuple[int, float]:
        share = 0.0 if part.worst is None else part.worst.utilisation
        return severity[part.outcome], inf if share is None else share

    order = sorted(range(len(parts)), key=lambda number: used(parts[number]), reverse=True)
    first = {parts[number].kind: number for number in reversed(order)}
    others = [number for number in order if number not in first.values()]
    shown = {*first.values(), *others[: VERDICT_ROWS - len(first)]}
    return [number not in shown for number in range(len(parts))]


def render(album: Album, folder: Path) -> str:
    """Return the page on the joint as HTML; figures are linked relative to its folder."""
    results = album.results
    verdict = run_verdict(results)
    missing = {name: _missing(results, name) for name in results.interfaces}
    return _page(
        "report.html.j2",
        results,
        folder,
        verdict=verdict,
        rows=list(zip(verdict.parts, verdict_rows(verdict), _folded(verdict.parts), strict=True)),
        checks=check_table(verdict),
        doubts=[
            *results.doubts,
            *(text for text, is_serious in missing.values() if text and is_serious),
            *barely_held(results),
            *(f"could not be computed: {text}" for text in results.omissions if _judges(text)),
            *(f"did not converge: {text}" for text in results.warnings if not _of_method(text)),
            *coarse_steps(results),
        ],
        folded=[
            *(text for text, is_serious in missing.values() if text and not is_serious),
            *(f"could not be computed: {text}" for text in results.omissions if not _judges(text)),
            *(f"did not converge: {text}" for text in results.warnings if _of_method(text)),
        ],
        vibrations=vibrations(results),
        sections=questions(results, album),
        methods=any(case.methods for case in results.cases.values()),
        headline=headline(verdicts(results), results),
        trust=trust(results),
        model=[model_table(results), interface_table(results), bolt_table(results)],
        view=scene(results),
        three=three(),
        still=album.shown(model_figure),
        preload=album.shown(initial_gap_figure, preload_figure, tightening_figure),
    )


def render_methods(album: Album, folder: Path) -> str:
    """Return the page on methods, their errors and cost as HTML."""
    results = album.results
    judged = verdicts(results)
    return _page(
        "methods.html.j2",
        results,
        folder,
        headline=headline(judged, results),
        verdicts=judged,
        methods=meanings(results),
        reservations=[
            *doubtful_references(results),
            *mode_sentences(results.mode_choices, results.unit_set),
            *remedies(results),
            *reservations(results),
        ],
        good=f"{100 * GOOD_ERROR:g} %",
        fair=f"{100 * FAIR_ERROR:g} %",
        errors={name: error_table(case) for name, case in results.cases.items()},
        unseen=load_space_table(results),
        choices=choice_table(results),
        timings=timing_table(results),
        stages=stage_table(results),
        reference=against(results.cases.values()).removeprefix("the "),
        estimates=estimate_note(results),
        convergence=album.shown(convergence_figure),
    )


def _page(template: str, results: Results, folder: Path, **values: Any) -> str:
    environment = Environment(
        loader=PackageLoader("faying.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["link"] = lambda path: quote(Path(path).relative_to(folder).as_posix())
    environment.filters["instant"] = _instant
    environment.filters["used"], environment.filters["shown"] = share_used, shown_quantity
    environment.globals |= {
        "LONG": LONGEST_UNBROKEN,
        "NARROW": NARROW_COLUMNS,
        "GRADES": GRADES,
        "MARKS": MARKS,
    }
    return environment.get_template(template).render(results=results, own=own(), **values)


def _deciding_scatter(check: Check) -> str | None:
    """Return the deciding end of the scatter as text, with its kind: bound or sample."""
    if not check.scatter:
        return None
    return f"{check.scatter}, {'bound' if check.bound else 'sample'}"


def _used(check: Check) -> Cell | float | None:
    """Return the utilisation in percent; a bound where the value is one."""
    if check.utilisation is None or not check.beyond:
        return None if check.utilisation is None else 100 * check.utilisation
    return Cell(text=f"< {number(100 * check.utilisation)}")


def _found(check: Check) -> Cell | float | None:
    """Return the value; a bound where it is the largest load factor that was tried."""
    if check.value is None or not check.beyond:
        return check.value
    return Cell(text=f"> {as_given(check.value)}")


def check_table(verdict: JointVerdict) -> Table:
    """Return the table of all checks of a verdict."""
    columns = (
        Column("check", lambda judged: judged.quantity),
        Column("verdict", lambda judged: judged.outcome),
        Column("used", _used, "%"),
        Column("found", _found, "", 5),
        Column("allowed", lambda judged: judged.limit, "", 5),
        Column("unit", lambda judged: judged.unit or None),
        Column("load case", lambda judged: judged.case or None),
        Column("at", lambda judged: judged.instant, "time"),
        Column("scatter", _deciding_scatter),
        Column("demanded", lambda judged: "yes" if judged.required else "no"),
        Column("source", lambda judged: judged.source or None),
        Column("reason", lambda judged: judged.reason or None),
    )
    checks = [(part.part, check) for part in verdict.parts for check in part.checks]
    return described("part", checks, columns, verdict.units)


def _missing(results: Results, name: str) -> tuple[str, bool]:
    """Return a warning about unpaired declared area, and whether most of it is unpaired."""
    record = results.interfaces[name]
    area = float(record.weights.sum())
    share = kept_share(area, record.declared_area)
    decides = share is not None and share < 0.5
    return missing_contact(name, area, record.declared_area), decides


JUDGING = (
    "joint assessment",
    "slip by sums",
    "slip reserve",
    "preload scatter",
    "load factors of opening",
    "strength of bolts",
    "margins of bolts",
)
"""Parts of a run that judge the joint, by their names in omissions."""


def _judges(omission: str) -> bool:
    """Return whether an omission concerns the assessment of the joint."""
    return any(f"{part}: " in omission for part in JUDGING)


def _of_method(warning: str) -> bool:
    """Return whether a warning concerns a reduced model rather than the reference."""
    return re.search(r" with \d+ joint modes?: ", warning) is not None


def _instant(text: str) -> str:
    """Return the date of a run in readable form; other texts unchanged."""
    try:
        return datetime.fromisoformat(text).strftime("%Y-%m-%d %H:%M %Z")
    except ValueError:
        return text
