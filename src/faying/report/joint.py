"""The joint itself, first on the page: requirements, bolts and interfaces over all load cases."""

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from faying._typing import Vector
from faying.assessment.clamp_range import ClampRange
from faying.assessment.joint_record import BoltAssessment, InterfaceAssessment
from faying.assessment.preload_scatter import Spread
from faying.assessment.requirements import OPEN_BELOW, Verdict
from faying.assessment.slip_demand import SlipDemand
from faying.report.quantities import number, percent, place, quantity
from faying.report.tables import Cell, Table, table, told
from faying.study.declared import barely_held, missing_contacts
from faying.study.results import Results
from faying.study.summary import required
from faying.units import Units, units_of

MEANINGS = {
    "min_clamp_force": ("clamp force", "at least", "force"),
    "max_pressure": ("largest pressure", "at most", "force/length²"),
    "max_nodal_pressure": ("largest average around a node", "at most", "force/length²"),
    "no_opening_within": ("smallest pressure around the bolt", "nothing open within", "length"),
    "min_opening_factor": (
        "opens (too little of what the preload presses is left) at",
        "at least",
        "1",
    ),
    "min_slip_safety": ("safety against slip S_G, bolts without shear", "at least", ""),
    "min_sliding_factor": ("slides as a whole at", "at least", "1"),
    "closed_ring": ("smallest pressure on the ring", "at least", "force/length²"),
}
"""Requirement to what is judged, how it is limited, and the dimension of the limit."""


GRADES: Mapping[bool | None, str] = {True: "good", False: "poor", None: "fair"}
"""Grade of a requirement that is met, that is not, and that is not known."""

METRICS = {
    "max_pressure": "largest pressure of ",
    "max_nodal_pressure": "largest nodal pressure of ",
    "clamp_force": "clamp force of ",
    "open_area": "open area of ",
    "max_gap": "largest gap of ",
    "slip_area": "slipping area of ",
    "max_slip": "largest slip of ",
    "bolt_force": "force of ",
    "bolt_bending": "bending moment of ",
}
"""What metrics that have a worst value are called, before the name of interface or bolt."""


def requirement_table(results: Results) -> Table:
    """Return the requirements of the study and whether they are met."""
    units = units_of(results.units)
    verdicts = () if results.assessment is None else results.assessment.verdicts
    rows = [_verdict(one, units) for one in verdicts]
    return table(("requirement", "demanded", "found", "where", "load case"), rows)


def joint_headline(results: Results) -> str:
    """Return the verdict on the joint in a sentence."""
    found = results.assessment
    if found is None:
        wanted = required(results.study_text)
        return "The joint was not judged; see the warnings." if wanted else ""
    if not found.verdicts:
        return "The study demands nothing of the joint ([requirement]); this is what it sees."
    failed, unknown = (
        _named(one for one in found.verdicts if one.met is met) for met in (False, None)
    )
    said = [f"The joint does not hold what the study demands: {failed}."] if failed else []
    said += [f"Whether it holds is not known of {unknown}."] if unknown else []
    if said:
        return " ".join(said)
    return "The joint holds all that the study demands in these load cases."


def _named(verdicts: Iterable[Verdict]) -> str:
    """Name requirements, each with where it is judged."""
    places: dict[str, list[str]] = {}
    for one in verdicts:
        places.setdefault(one.requirement, []).append(one.place or one.case)
    return "; ".join(
        f"{name} ({', '.join(filter(None, some))})" if any(some) else name
        for name, some in places.items()
    )


def joint_doubts(results: Results) -> list[str]:
    """Return why the joint itself may not be as computed, whatever method is used."""
    doubts = [*results.doubts, *missing_contacts(results), *barely_held(results)]
    if results.warnings:
        doubts.append(
            f"{len(results.warnings)} solution(s) did not converge or deserve notice; "
            "see the warnings"
        )
    return doubts


def bolt_judgement(results: Results) -> Table:
    """Return what the bolts see over all load cases."""
    units = units_of(results.units)
    bolts = {} if results.assessment is None else results.assessment.bolts
    columns = ["bolt", "preload", "smallest force", "largest force", "load factor Φ = ΔF_S / F_A"]
    stressed = any(one.thread is not None for one in bolts.values())
    columns.append("bending added")
    columns += ["stress in the thread", "safety"] if stressed else []
    rows = [(name, *_bolt(one, units, stressed=stressed)) for name, one in bolts.items()]
    return table(columns, rows)


def interface_judgement(results: Results) -> Table:
    """Return what the interfaces see over all load cases."""
    units = units_of(results.units)
    found = {} if results.assessment is None else results.assessment.interfaces
    share = OPEN_BELOW if results.assessment is None else results.assessment.open_below
    columns = (
        "interface", "largest pressure", "smallest area under pressure",
        f"below {percent(share)} of what the preload presses from", "nothing pressed from",
    )  # fmt: skip
    rows = [(name, *_interface(name, one, results, units)) for name, one in found.items()]
    return told(table(columns, rows))


def clamp_judgement(results: Results) -> Table:
    """Return the clamp forces of interfaces and, where several bolts share one, around each."""
    force = units_of(results.units).force
    bolts = {} if results.assessment is None else results.assessment.bolts
    interfaces = {} if results.assessment is None else results.assessment.interfaces
    columns = (
        "clamp force of", "at rest", "smallest", "smallest, certified", "largest",
        "largest, certified", "certified to",
    )  # fmt: skip
    rows: list[tuple[str, ...]] = []
    for name, one in interfaces.items():
        whole = ClampRange(
            preload=one.preload,
            least=one.least_clamp,
            least_case=one.least_clamp_case,
            certified_least=one.certified,
            most=one.most_clamp,
            most_case=one.most_clamp_case,
            certified_most=one.certified_most,
            certified_width=one.certified_width,
        )
        rows.append((name, *_clamp(whole, force)))
        near = {
            bolt: area.clamp_around[name]
            for bolt, area in bolts.items()
            if name in area.clamp_around
        }
        if len(near) > 1:
            rows += [(f"{name} around {bolt}", *_clamp(area, force)) for bolt, area in near.items()]
    return told(table(columns, rows))


def slip_judgement(results: Results) -> Table:
    """Return the friction that interfaces without any need, and their bolts' surroundings."""
    force = units_of(results.units).force
    bolts = {} if results.assessment is None else results.assessment.bolts
    interfaces = {} if results.assessment is None else results.assessment.interfaces
    columns = (
        "slip of", "friction needed at most", "tangential force there", "clamp force there",
        "judged with", "safety S_G, bolts without shear", "slides, bolts with theirs, from",
    )  # fmt: skip
    rows: list[tuple[str, ...]] = []
    for name, one in interfaces.items():
        if one.slip is None:
            continue
        rows.append((name, *_slip(one.slip, force), _least(_sliding(results, name))))
        near = {b: area.slip_around[name] for b, area in bolts.items() if name in area.slip_around}
        if len(near) > 1 and not one.slip.unknown:
            rows += [
                (f"{name} around {bolt}", *_slip(area, force), "—") for bolt, area in near.items()
            ]
    return told(table(columns, rows))


def _sliding(results: Results, interface: str) -> dict[str, float]:
    """Return the load cases followed with friction, with the factor at which an interface slides.

    Of several interfaces the first one that does is told.
    """
    return {
        name: one.gross_slip if one.gross_slip and one.slides == interface else np.inf
        for name, case in results.cases.items()
        if (one := case.reserve) is not None and results.interfaces[interface].friction > 0
    }


def _slip(one: SlipDemand, unit: str) -> Iterator[str]:
    if one.unknown:
        yield f"not known: {one.unknown}"
        yield from ("—", "—", "—" if one.coefficient is None else number(one.coefficient), "—")
        return
    case = max(one.needed_friction, key=one.needed_friction.__getitem__)
    needed = one.needed_friction[case]
    yield f"{number(needed) if np.isfinite(needed) else 'nothing is pressed'} ({case})"
    yield quantity(one.tangential_force[case], unit, 5)
    yield quantity(one.clamp_force[case], unit, 5)
    if one.coefficient is None:
        yield from ("—", "—")
        return
    yield number(one.coefficient)
    yield number(one.safety[case]) if case in one.safety else "nothing to carry"


def scatter_table(results: Results) -> Table:
    """Return what scatter of the preloads does to static load cases."""
    units = units_of(results.units)
    spreads = () if results.assessment is None else results.assessment.scatter
    columns = (
        "load case", "over scattered preloads", "as meant", "smallest", "5 % below", "half below",
        "95 % below", "largest",
    )  # fmt: skip
    return table(columns, [tuple(_spread(one, units)) for one in spreads])


def _spread(one: Spread, units: Units) -> Iterator[str]:
    yield one.case
    yield METRICS[one.metric.partition(".")[0]] + one.metric.partition(".")[2]
    for value in (one.meant, one.least, one.p05, one.median, one.p95, one.most):
        yield quantity(value, units.of(one.dimension), 4)


def _verdict(one: Verdict, units: Units) -> tuple[str | Cell, ...]:
    what, how, dimension = MEANINGS[one.requirement]
    of_value = "force/length²" if one.requirement == "no_opening_within" else dimension
    return (
        Cell(text=one.requirement, grade=GRADES[one.met]),
        f"{how} {_measured(one.limit, dimension, units)}",
        f"not known: {one.reason}"
        if one.met is None
        else f"{what} {_measured(one.value, of_value, units)}",
        one.place,
        one.case,
    )


def _measured(value: float, dimension: str, units: Units) -> str:
    if not np.isfinite(value):
        return "not reached"
    if not dimension:
        return number(value)
    if dimension == "1":
        return f"{number(value)} times the load"
    return quantity(value, units.of(dimension), 4)


def _bolt(one: BoltAssessment, units: Units, *, stressed: bool) -> Iterator[str]:
    yield quantity(one.preload, units.force, 5)
    yield f"{quantity(one.least, units.force, 5)} ({one.least_case})"
    yield f"{quantity(one.most, units.force, 5)} ({one.most_case})"
    factors = [f"{number(factor)} ({case})" for case, factor in one.load_factors.items()]
    yield "; ".join(factors) or "—"
    bent = one.bending
    yield (
        "not seen"
        if bent is None
        else f"{quantity(bent.added, units.of('force·length'), 4)} ({bent.added_case})"
    )
    if not stressed:
        return
    found = one.thread
    if found is None:
        yield from ("—", "—")
        return
    proof = quantity(found.proof, units.pressure, 4)
    yield f"{quantity(found.reduced, units.pressure, 4)} of {proof}"
    yield number(found.safety)


def _clamp(one: ClampRange, unit: str) -> Iterator[str]:
    yield quantity(one.preload, unit, 5)
    yield f"{quantity(one.least, unit, 5)} ({one.least_case})"
    yield _interval(one.certified_least, unit)
    yield f"{quantity(one.most, unit, 5)} ({one.most_case})"
    yield _interval(one.certified_most, unit)
    width = one.certified_width
    yield "—" if width is None else f"± {quantity(width / 2, unit, 2)}"


def _interval(ends: Vector | None, unit: str) -> str:
    return "—" if ends is None else " … ".join(quantity(end, unit, 5) for end in ends.tolist())


def _interface(
    name: str, one: InterfaceAssessment, results: Results, units: Units
) -> Iterator[str]:
    size = float(np.ptp(results.interfaces[name].points, axis=0).max())
    where = place(one.max_pressure_point, units.length, size)
    yield f"{quantity(one.max_pressure, units.pressure, 4)} at {where} ({one.max_pressure_case})"
    yield f"{quantity(one.closed_area, units.of('length²'), 4)} ({one.closed_area_case})"
    yield _least(one.opening)
    yield _least(one.loss_of_clamp)


def _least(factors: Mapping[str, float]) -> str:
    """Return the smallest load factor and its case."""
    if not factors:
        return "—"
    case = min(factors, key=factors.__getitem__)
    if not np.isfinite(factors[case]):
        return "not reached"
    return f"{number(factors[case])} times {case}"
