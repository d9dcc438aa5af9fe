"""``faying check``: read the study and the model, and print them without solving."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faying.cli.arguments import Ignored, usable_folder

if TYPE_CHECKING:
    from faying.joint.model import Model
    from faying.study.inputs.load_model import LoadedModel


StudyOrDeck = Annotated[
    Path, typer.Argument(metavar="STUDY.toml|DECK", help="The study file, or a deck alone.")
]


def check(
    study: StudyOrDeck,
    out: Annotated[Path | None, typer.Option(help="Folder for pictures of the model.")] = None,
    ignore: Ignored = None,
) -> None:
    """Read and check a study or a deck; print mass, bodies, constraints, interfaces and loads."""
    from rich.console import Console

    from faying.cli.description import described
    from faying.cli.progress import progress_bar
    from faying.joint.bolt_pull import misdirected
    from faying.joint.diagnosis import check_held
    from faying.model.solid_cells import tangled
    from faying.study.inputs.jumps import jump_sentence, load_jumps
    from faying.study.inputs.load_model import load_model
    from faying.study.inputs.loads import check_targets
    from faying.study.inputs.model_preview import model_preview
    from faying.study.judgement.model_warnings import (
        bolt_doubts,
        doubts,
        missing_contact,
        overlapping,
        uneven_seats,
    )
    from faying.study.keys.deck_study import is_bare, study_or_deck
    from faying.study.keys.requirement_rules import not_judged
    from faying.study.keys.schema import naming_tables

    checked, bare = study_or_deck(study, ignore or ()), is_bare(study)
    if out is not None:
        usable_folder(out)
    with progress_bar(Console(stderr=True), lines=False) as bar, naming_tables(checked):
        file = checked.model.file
        stage = bar.add_task(f"Reading {file.name}" if file else "Reading the model", total=None)
        loaded = load_model(checked)
        bar.update(stage, description="Looking at bodies, contact and bolts")
        preview = model_preview(checked, loaded, bare=bare)
    model = preview.model
    check_targets(checked, model)
    console = Console(markup=False)
    for table in described(checked, loaded, preview):
        console.print(table)
    missing = [
        missing_contact(name, interface.area, interface.declared_area)
        for name, interface in model.interfaces.items()
    ]
    # A deck without a study has no units.
    materials = loaded.assembly.materials
    constants = () if bare else [*doubts(materials, checked.units), *bolt_doubts(checked, loaded)]
    jumps = [
        jump_sentence(
            case.name,
            load_jumps(case, step=case.step),
            checked.unit_set.time,
            history=case.kind == "history",
        )
        for case in checked.load_cases
    ]
    unjudged = not_judged(checked, model)
    shapes = tangled(loaded.assembly)
    bolts = [*misdirected(model, loaded.bolts if model.bolts else ()), *uneven_seats(loaded)]
    for note in overlapping(model):
        console.print(f"Note: {note}", highlight=False)
    for doubt in [*constants, *filter(None, [shapes, *missing, *jumps]), *bolts, *unjudged]:
        console.print(f"Doubtful: {doubt}", style="bold", highlight=False)
    if out is not None:
        for path in (_picture(loaded, model, out / "model.png"), *_gap_pictures(model, out)):
            console.print(f"Wrote {path}")
    if preview.free.count and not bare:
        # Raised last, after tables and pictures have shown what can move.
        check_held(model, loaded.remedy)


def _picture(loaded: "LoadedModel", model: "Model", path: Path) -> Path:
    """Draw the model into a file, and return its path."""
    from matplotlib.figure import Figure

    from faying.joint.picture import plot_model
    from faying.model.deck_bolt import bolt_ends
    from faying.report.style import save

    ends = {spec.name: bolt_ends(model.assembly, spec) for spec in loaded.bolts}
    figure = Figure(figsize=(11, 6), dpi=150, layout="constrained")
    plot_model(model, figure.add_subplot(projection="3d"), bolts=ends)
    save(figure, path)
    return path


def _gap_pictures(model: "Model", out: Path) -> Iterator[Path]:
    """Draw the initial gaps of interfaces into a file, if any, and yield its path."""
    from faying.reduction.projection import contact_surfaces
    from faying.report.figures.maps import draw_initial_gaps
    from faying.report.style import save
    from faying.study.results.values import interface_record
    from faying.units import units_of

    surfaces = contact_surfaces(model) if model.interfaces else {}
    records = {
        name: interface_record(surface, 0 * surface.weights) for name, surface in surfaces.items()
    }
    figure = draw_initial_gaps(records, units_of(model.units))
    if figure is not None:
        path = out / "initial_gap.png"
        save(figure, path)
        yield path
