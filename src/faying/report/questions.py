"""The sections of a report, each on a question about the joint."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from faying.assessment.backbone_response import HONEST
from faying.assessment.joint_record import Assessment, CaseState, ClampRange
from faying.assessment.preload_scatter import Spread
from faying.display.quantities import as_given, number, percent, place
from faying.display.table import FL, PRESSURE, Cell, Column, Table, described, largest
from faying.report.figures.album import Album, FigureEntry
from faying.report.figures.backbone import (
    abscissa,
    backbone_figure,
    backbone_slip_figure,
    unit_of,
)
from faying.report.figures.frequency import frequency_figure
from faying.report.figures.maps import fretting_figure, gap_figure, pressure_figure, slip_figure
from faying.report.figures.response import (
    loop_figure,
    motion_slip_figure,
    path_figure,
    response_figure,
)
from faying.report.model_tables import applied_loads
from faying.report.slip import (
    demand_table,
    friction_table,
    measured_table,
    most_slip,
    peak_table,
    slip_sentence,
)
from faying.study.judgement.comparison import rubbed, state_of_case
from faying.study.judgement.opening import opening
from faying.study.results.values import CaseResult, InterfaceRecord, Results
from faying.units import Units


@dataclass(frozen=True, kw_only=True)
class Section:
    """A section of the report on a question.

    Attributes
    ----------
    title
    sentence
        The answer, if one sentence can give it.
    tables
    notes
        Explanation of terms in the tables.
    figures
        Figures of the deciding load case.
    """

    title: str
    sentence: str = ""
    tables: tuple[Table, ...] = ()
    notes: str = ""
    figures: Sequence[FigureEntry] = field(default=())


def questions(results: Results, album: Album) -> list[Section]:
    """Return the sections that are not empty, with their figures."""
    assessment, sections = results.assessment, list[Section]()
    if assessment is not None:
        sections = [_bolts(results, assessment)]
        sections += [of(results, assessment, album) for of in (_opening, _slip, _pressure)]
    sections += [of(results, album) for of in (_damping, _under_harmonic_loads, _load_cases)]
    return [
        section for section in sections if section.sentence or any(t.rows for t in section.tables)
    ]


def _bolts(results: Results, assessment: Assessment) -> Section:
    units = results.unit_set
    columns = (
        Column("preload", lambda bolt: bolt.preload, "force", 5),
        Column("smallest force", lambda bolt: bolt.least, "force", 5),
        Column("in", lambda bolt: bolt.least_case),
        Column("largest force", lambda bolt: bolt.most, "force", 5),
        Column("in", lambda bolt: bolt.most_case),
        Column("load factor Φ", lambda bolt: max(bolt.load_factors.values(), default=None), "", 3),
        Column("in", lambda bolt: largest(bolt.load_factors)),
        Column("bending added", lambda bolt: bolt.bending and bolt.bending.added, FL),
        Column("in", lambda bolt: bolt.bending and bolt.bending.added_case),
        Column("stress amplitude", lambda bolt: bolt.thread and bolt.thread.amplitude, PRESSURE),
    )
    bolts = described("bolt", assessment.bolts.items(), columns, units)
    phi = any(bolt.load_factors for bolt in assessment.bolts.values())
    return Section(
        title="Bolts",
        tables=(bolts, _scatter(assessment.scatter, units)),
        notes="Φ = ΔF_S / F_A: the share of the axial load that the bolt takes." if phi else "",
    )


def _scatter(spreads: Sequence[Spread], units: Units) -> Table:
    """Return the table of metrics of static load cases over the scatter of preloads."""
    columns = (
        Column("over scattered preloads", lambda spread: spread.metric.replace(".", " of ")),
        Column("unit", lambda spread: units.of(spread.dimension)),
        Column("nominal", lambda spread: spread.meant),
        Column("smallest", lambda spread: spread.least),
        Column("5 % below", lambda spread: spread.p05),
        Column("half below", lambda spread: spread.median),
        Column("95 % below", lambda spread: spread.p95),
        Column("largest", lambda spread: spread.most),
    )
    return described("load case", [(spread.case, spread) for spread in spreads], columns, units)


@dataclass(frozen=True, kw_only=True)
class _Area:
    """Clamp force and opening of an interface, or of its part nearest to a bolt."""

    clamp: ClampRange
    opening: Mapping[str, float]
    followed: Mapping[str, float]
    closed: float | None = None
    closed_case: str | None = None
    gap: float | None = None
    gap_case: str | None = None


def clamp_table(areas: Mapping[str, _Area], units: Units) -> Table:
    """Return the table of clamp forces and openings of interfaces and their parts near bolts."""
    columns = (
        Column("clamp force of the preload", lambda area: area.clamp.preload, "force", 5),
        Column("smallest", lambda area: area.clamp.least, "force", 5),
        Column("in", lambda area: area.clamp.least_case),
        Column("certified to ±", lambda area: _half(area.clamp), "force", 2),
        Column("opens at", lambda area: _least(area), "× load"),
        Column("in", lambda area: _least_case(area.opening)),
        Column("smallest area under pressure", lambda area: area.closed, "length²"),
        Column("in", lambda area: area.closed_case),
        Column("largest gap", lambda area: area.gap, "length"),
        Column("in", lambda area: area.gap_case),
    )
    return described("interface", areas.items(), columns, units)


def _opening(results: Results, assessment: Assessment, album: Album) -> Section:
    areas = dict(clamped_areas(results, assessment))
    opened = any(area.opening for area in areas.values())
    widest = max(areas.values(), key=lambda area: area.gap or 0.0, default=None)
    return Section(
        title="Opening",
        tables=(clamp_table(areas, results.unit_set),),
        notes=(
            f"Opens: less than {percent(assessment.open_below)} of the area pressed by the preload "
            "is still pressed; the load grows in proportion with locked bolts."
            if opened
            else ""
        ),
        figures=album.shown(
            gap_figure, of=_drawn(results, None if widest is None else widest.gap_case)
        ),
    )


def clamped_areas(results: Results, assessment: Assessment) -> Iterator[tuple[str, _Area]]:
    """Yield interfaces, and the areas around bolts where several share an interface."""
    for name, face in assessment.interfaces.items():
        gaps = {
            case.name: seen.gap
            for case in results.cases.values()
            if (seen := opening(results.interfaces[name], case)) is not None and seen.gap > 0
        }
        yield (
            name,
            _Area(
                clamp=ClampRange(
                    preload=face.preload,
                    least=face.least_clamp,
                    least_case=face.least_clamp_case,
                    certified_least=face.certified,
                    most=face.most_clamp,
                    most_case=face.most_clamp_case,
                    certified_most=face.certified_most,
                    certified_width=face.certified_width,
                ),
                opening=face.opening,
                followed=assessment.followed,
                closed=face.closed_area,
                closed_case=face.closed_area_case,
                gap=max(gaps.values(), default=None),
                gap_case=largest(gaps),
            ),
        )
        around = {b: bolt for b, bolt in assessment.bolts.items() if name in bolt.clamp_around}
        if len(around) > 1:
            for b, bolt in around.items():
                factors = bolt.opening_around.get(name, {})
                clamp = bolt.clamp_around[name]
                area = _Area(clamp=clamp, opening=factors, followed=assessment.followed)
                yield f"{name} around {b}", area


def _half(clamp: ClampRange) -> float | None:
    ends = clamp.certified_least
    return None if ends is None else float(np.ptp(ends)) / 2


def _least(area: _Area) -> Cell | float | None:
    """Return the smallest load factor of opening, or the smallest that no load case opened at."""
    smallest = min(area.opening.values(), default=None)
    if smallest != np.inf:
        return smallest
    followed = min((area.followed.get(case, np.inf) for case in area.opening), default=np.inf)
    return Cell(text=f"> {as_given(followed)}")


def _least_case(factors: Mapping[str, float]) -> str | None:
    case = min(factors, key=factors.__getitem__, default=None)
    return case if case is not None and np.isfinite(factors[case]) else None


def _slip(results: Results, assessment: Assessment, album: Album) -> Section:
    demands, paths, notes = demand_table(results), friction_table(results), list[str]()
    if any(item.slip.needed_friction for item in assessment.interfaces.values()):
        notes.append(
            "Friction needed: to carry all tangential load by friction, with no shear in the bolts."
        )
    if any(case.reserve for case in results.cases.values()) and paths.rows:
        notes.append(
            "The load grows in proportion from the preloaded joint. Points that tightening left at "
            "their friction limit slip under almost any load; slip begins where a twentieth of the "
            "others slips."
        )
    slips = {
        name: max((most_slip(item) for item in rubbed(case.reference)), default=0.0)
        for name, case in results.cases.items()
    }
    worst = largest(slips)
    shown = worst is not None and slips[worst] > 0
    return Section(
        title="Slip",
        sentence=slip_sentence(results),
        tables=(demands, paths),
        notes=" ".join(notes),
        figures=album.shown(slip_figure, of=_drawn(results, worst if shown else None)),
    )


def _pressure(results: Results, assessment: Assessment, album: Album) -> Section:
    units = results.unit_set

    def at(name: str) -> str:
        size = float(np.ptp(results.interfaces[name].points, axis=0).max())
        return place(assessment.interfaces[name].max_pressure_point, "", size).rstrip()

    faces = assessment.interfaces
    columns = (
        Column("largest at a point", lambda name: faces[name].max_pressure, PRESSURE),
        Column("in", lambda name: faces[name].max_pressure_case),
        Column(f"at (x, y, z) [{units.length}]", at),
        Column("largest average around a node", lambda n: faces[n].max_nodal_pressure, PRESSURE),
        Column("in", lambda name: faces[name].max_nodal_pressure_case),
    )
    mapped = {
        name: float(case.reference.pressure.max(initial=0.0))
        for name, case in results.cases.items()
        if case.times is None and not case.reference.backbones
    }
    return Section(
        title="Pressure",
        tables=(described("interface", [(name, name) for name in faces], columns, units),),
        figures=album.shown(pressure_figure, of=_drawn(results, largest(mapped))),
    )


def _damping(results: Results, album: Album) -> Section:
    """Return the section on frequency and damping over amplitude, and on cycles."""
    units = results.unit_set
    curves = {
        f"{case.name}, mode {mode}": item
        for case in results.cases.values()
        for mode, item in case.reference.backbones.items()
    }
    modes = (
        Column("frequency of small vibrations", lambda item: item.small_frequency, "1/time"),
        Column("smallest amplitude", lambda item: _measured(item, 0, units)),
        Column("damping ratio there", lambda item: 100 * item.damping_ratio[0], "%", 3),
        Column("largest amplitude", lambda item: _measured(item, -1, units)),
        Column("damping ratio there", lambda item: 100 * item.damping_ratio[-1], "%", 3),
        Column("frequency there", lambda item: item.frequency[-1], "1/time"),
    )
    cycles = {
        f"{case.name}, ± {number(item.amplitude)} × load": item
        for case in results.cases.values()
        for item in case.reference.cycles.values()
    }
    loops = (
        Column("energy per cycle", lambda item: float(item.energies[-1]), FL),
        Column("cycles solved", lambda item: len(item.energies)),
        Column("repeats", lambda item: "yes" if item.stationary else "still changing"),
        Column(
            "largest slip range", lambda item: float(item.slip_range.max(initial=0.0)), "length"
        ),
    )
    cases = [item for item in results.cases.values() if item.kind in ("backbone", "cycle")]
    return Section(
        title="Damping",
        tables=(
            described("vibration", curves.items(), modes, units),
            described("cycle", cycles.items(), loops, units),
        ),
        figures=album.shown(
            backbone_figure, backbone_slip_figure, loop_figure, fretting_figure, of=cases
        ),
    )


def _under_harmonic_loads(results: Results, album: Album) -> Section:
    """Return the section on peaks over frequency, with friction at the peaks."""
    records = results.frequencies.values()
    checks = [check.sentence for record in records for check in record.checks]
    return Section(
        title="Vibration under load",
        sentence="; ".join(checks) + "." if checks else "",
        tables=(peak_table(results), measured_table(results)),
        notes=f"By the backbone: {HONEST}." if any(record.expected for record in records) else "",
        figures=album.shown(frequency_figure, of=results.frequencies),
    )


def _measured(backbone: Any, index: int, units: Units) -> str:
    return f"{number(float(abscissa(backbone)[index]))} {unit_of(backbone, units)}"


def _load_cases(results: Results, album: Album) -> Section:
    units = results.unit_set
    loads = applied_loads(results)
    rows = {name: (case, state_of_case(case)) for name, case in results.cases.items()}
    columns = (
        Column("kind", lambda row: row[0].kind),
        Column("loads", lambda row: loads.get(row[0].name, "see the study")),
        Column("largest pressure", lambda row: float(row[1].pressure.max()), PRESSURE),
        *(
            Column(f"least clamp force of {name}", _least_force(record), "force", 5)
            for name, record in results.interfaces.items()
        ),
        Column("largest bolt force", lambda row: _bolt_force(row[1]), "force", 5),
        Column("opened by the load", lambda row: _opened(results, row[0]), "%", 3),
    )
    shown = results.cases.values()
    vibrating = any(case.reference.backbones for case in results.cases.values())
    return Section(
        title="Load cases",
        tables=(described("load case", rows.items(), columns, units),),
        notes="Backbones: values of the joint at rest." if vibrating else "",
        figures=album.shown(response_figure, motion_slip_figure, path_figure, of=shown),
    )


def _least_force(record: InterfaceRecord) -> Any:
    points = slice(*record.slice)
    return lambda row: float((row[1].pressure[:, points] @ record.weights).min())


def _bolt_force(state: CaseState) -> float | None:
    return max((float(force.max()) for force in state.bolt_forces.values()), default=None)


def _opened(results: Results, case: CaseResult) -> float:
    openings = (opening(record, case) for record in results.interfaces.values())
    return 100 * max((item.opened for item in openings if item is not None), default=0.0)


def _drawn(results: Results, name: str | None) -> list[CaseResult]:
    """Return a load case to draw; an empty list without a name, or for backbones."""
    case = results.cases.get(str(name))
    return [] if case is None or case.reference.backbones else [case]
