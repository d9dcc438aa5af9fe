"""The tables of a report: rows of text, every number with its unit."""

import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from faying._typing import Matrix
from faying.interface.surface import curve_of
from faying.report.quantities import number, percent, place, quantity, seconds
from faying.report.style import label
from faying.report.verdict import grade
from faying.study.backbone_errors import backbone_errors
from faying.study.declared import kept_share, missing_contact
from faying.study.opening import Opening, opening
from faying.study.results import CaseResult, InterfaceRecord, MethodResult, Results
from faying.study.summary import timings
from faying.units import Units, units_of

Entry = TypeVar("Entry")
MARKS = {"good": "✓", "fair": "~", "poor": "✗", "": ""}


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One cell: text, and a grade that colours it and is also written as a mark."""

    text: str
    grade: str = ""

    @property
    def mark(self) -> str:
        """The grade as a character, for print and for eyes that see colours otherwise."""
        return MARKS[self.grade]


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table; the first column holds row heads."""

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]


def table(columns: Iterable[str], rows: Iterable[Iterable[str | Cell]]) -> Table:
    """Return a table of texts and cells."""
    cells = (
        tuple(cell if isinstance(cell, Cell) else Cell(text=cell) for cell in row) for row in rows
    )
    return Table(columns=tuple(columns), rows=tuple(cells))


def model_table(results: Results) -> Table:
    """Return the facts of the model."""
    units = units_of(results.units)
    kinds = ", ".join(dict.fromkeys(block.kind for block in results.blocks)) or "none"
    elements = sum(len(block.ids) for block in results.blocks)
    rows = [
        ("nodes", f"{len(results.nodes)}"),
        ("solid elements", f"{elements} ({kinds})"),
        ("bodies", f"{int(results.body.max(initial=-1)) + 1}"),
        ("free degrees of freedom", f"{results.dofs}"),
        *_factorization(results),
        ("mass", quantity(results.mass, units.mass, 4)),
        *_normal_modes(results, units),
        ("units", f"{results.units}: forces in {units.force}, pressures in {units.pressure}"),
    ]
    return table(("model", ""), rows)


def _factorization(results: Results) -> Iterator[tuple[str, str]]:
    """Say which library factorized, and how much memory that took."""
    backend = results.provenance.get("factorization")
    if backend:
        yield "factorization", f"{backend}, {results.factor_bytes / 1e6:.0f} MB of factors"


def _normal_modes(results: Results, units: Units) -> Iterator[tuple[str, str]]:
    """Say whether all fixed-interface normal modes up to some frequency are there."""
    count = results.normal_modes
    if count is None:
        return
    below = quantity(count.below, "Hz" if units.time == "s" else units.of("1/time"), 4)
    found = f"{count.found} below {below}, not counted: {count.reason}"
    if count.counted is not None:
        found = f"{count.found} of {count.counted} below {below} found"
    yield "fixed-interface normal modes", found


def interface_table(results: Results) -> Table:
    """Return geometry, contact law and preloaded state of the interfaces."""
    units = units_of(results.units)
    columns = (
        "interface", "node pairs", "contact points", "quadrature", "area", "penalty stiffness",
        "friction",
        "sticking pairs", "max preload pressure", "without pressure after preload",
    )  # fmt: skip
    rows = [
        (
            name,
            f"{len(r.pairs)}",
            f"{len(r.weights)}",
            r.quadrature,
            quantity(float(r.weights.sum()), units.of("length²"), 4) + _of_declared(r),
            _stiffness(r, units),
            _friction(r, units),
            f"{int(r.stuck.sum())}",
            quantity(float(r.preload_pressure.max(initial=0.0)), units.pressure),
            percent(_open(r)),
        )
        for name, r in results.interfaces.items()
    ]
    return table(columns, rows)


def _stiffness(record: InterfaceRecord, units: Units) -> str:
    """Say the contact stiffness, or the curve that has none."""
    if record.penalty is None:
        return f"— ({curve_of(record.closure).name})"
    if record.penalty == np.inf:
        return "hard"
    return quantity(record.penalty, units.of("force/length³"))


def _friction(record: InterfaceRecord, units: Units) -> str:
    """Say the coefficient of friction and the tangential stiffness of points that stick."""
    if not record.friction:
        return "none"
    stiffness = quantity(record.tangential_penalty, units.of("force/length³"))
    sticking = "rigid" if np.isinf(record.tangential_penalty) else f"stick stiffness {stiffness}"
    return f"{number(record.friction)}, {sticking}"


def _of_declared(record: InterfaceRecord) -> str:
    """Say the share of a declared area where something of it is missing."""
    area = float(record.weights.sum())
    missing = missing_contact("", area, record.declared_area)
    return f" ({percent(kept_share(area, record.declared_area) or 0.0)} of the declared)" * bool(
        missing
    )


def _open(record: InterfaceRecord) -> float:
    total = float(record.weights.sum())
    is_open = record.preload_pressure <= 0
    return float(record.weights[is_open].sum() / total) if total > 0 else 0.0


def bolt_table(results: Results) -> Table:
    """Return preloads and what the tightening reached."""
    unit = units_of(results.units).force
    rows = [
        (
            name,
            quantity(bolt.preload, unit, 5),
            quantity(float(bolt.history[-1]), unit, 5) if len(bolt.history) else "not tightened",
            quantity(bolt.initial_force, unit, 5),
        )
        for name, bolt in results.bolts.items()
    ]
    columns = ("bolt", "nominal preload", "force after tightening", "initial force it is locked at")
    return table(columns, rows)


def case_table(results: Results) -> Table:
    """Return the load cases and what the full model answers."""
    units = units_of(results.units)
    loads = applied_loads(results.study_text, units)
    columns = (
        "load case", "kind", "loads", "max pressure", "where", "contact force",
        "opened by the load", "largest gap", "without pressure", "max penetration", "bolt force",
    )  # fmt: skip
    rows = [
        (name, case.kind, loads.get(name, "see the study"), *_reference(results, case, units))
        for name, case in results.cases.items()
    ]
    return table(columns, rows)


def _reference(results: Results, case: CaseResult, units: Units) -> Iterator[str]:
    response = case.reference
    pressure = np.atleast_2d(response.pressure)
    yield quantity(float(pressure.max(initial=0.0)), units.pressure)
    yield _peak_place(results, case, pressure, units)
    yield _each(response.contact_forces, lambda f: _range(f, units.force))
    yield from _opening(results, case, units)
    yield _each(response.open_fraction, lambda f: _range(100 * np.asarray(f), "%", 2))
    yield quantity(float(np.maximum(-response.gap, 0.0).max(initial=0.0)), units.length)
    yield _each(response.bolt_forces, lambda f: _range(f, units.force))


def _opening(results: Results, case: CaseResult, units: Units) -> Iterator[str]:
    """Yield the share of the pressed area that opened, and the largest gap with its place."""
    found = {
        name: (record, one)
        for name, record in results.interfaces.items()
        if (one := opening(record, case)) is not None
    }
    yield _each({name: one for name, (_, one) in found.items()}, lambda one: percent(one.opened))
    yield _each(found, lambda pair: _gap(*pair, case, units))


def _gap(record: InterfaceRecord, found: Opening, case: CaseResult, units: Units) -> str:
    if found.gap <= 0:
        return "none"
    size = float(np.ptp(record.points, axis=0).max())
    text = f"{quantity(found.gap, units.length)} at {place(found.point, units.length, size)}"
    if case.times is None or found.instant is None:
        return text
    return f"{text} at {quantity(float(case.times[found.instant]), units.time)}"


def _each(values: Mapping[str, Entry], text: Callable[[Entry], str]) -> str:
    """Return one text per name, the name left out where there is only one."""
    return "; ".join(
        f"{name}: {text(value)}" if len(values) > 1 else text(value)
        for name, value in values.items()
    )


def _range(values: Matrix, unit: str, digits: int = 4) -> str:
    low, high = (number(float(extreme(values)), digits) for extreme in (np.min, np.max))
    return f"{low} {unit}" if low == high else f"{low} … {high} {unit}"


def _peak_place(results: Results, case: CaseResult, pressure: Matrix, units: Units) -> str:
    if pressure.size == 0 or pressure.max() <= 0:
        return "no contact"
    instant, point = np.unravel_index(int(pressure.argmax()), pressure.shape)
    for name, record in results.interfaces.items():
        first, last = record.slice
        if first <= point < last:
            size = float(np.ptp(record.points, axis=0).max())
            where = f"{name} {place(record.points[point - first], units.length, size)}"
            if case.times is None:
                return where
            return f"{where} at {quantity(float(case.times[instant]), units.time)}"
    return ""


def applied_loads(study_text: str, units: Units) -> dict[str, str]:
    """Return the loads of each load case as the study states them; empty where it cannot be read.

    Results of a study that a later version wrote still make a report.
    """
    try:
        cases = tomllib.loads(study_text).get("load_case", [])
        return {case["name"]: _applied(case, units) for case in cases}
    except (tomllib.TOMLDecodeError, KeyError, TypeError, AttributeError):
        return {}


def _applied(case: dict[str, Any], units: Units) -> str:
    """Return the loads of a case, or what it has in their place."""
    if case["kind"] == "backbone":
        return f"mode{'s' * (len(case['modes']) > 1)} {', '.join(map(str, case['modes']))}"
    return ", ".join(_force(force, units) for force in case["forces"])


def _force(force: dict[str, object], units: Units) -> str:
    value, name = force.get("value"), force.get("deck_load")
    target = f"{force['boundary']} {force['component']}" if name is None else f"deck load {name}"
    if not isinstance(value, int | float):
        return f"{target} from {force.get('file')}"
    if name is not None:
        return f"{value:g} × {target}".replace("-", "−")
    is_moment = str(force["component"]).startswith("M")
    unit = f"{units.force}·{units.length}" if is_moment else units.force
    return f"{target} = {value:g} {unit}".replace("-", "−")


def backbone_error_table(case: CaseResult) -> Table:
    """Return how far the backbones of every method are from those of the full model."""
    rows = [
        (label(name, count), percent(found.frequency), percent(found.damping), f"{result.n_modes}")
        for name, sizes in case.methods.items()
        for count, result in sorted(sizes.items())
        if (found := backbone_errors(result.response, case.reference)) is not None
    ]
    columns = ("method", "frequency off by at most", "damping ratio off by at most", "coordinates")
    return table(columns, rows)


def error_table(case: CaseResult) -> Table:
    """Return the errors of every method and size in one load case, without columns of none."""
    if case.reference.backbones:
        return backbone_error_table(case)
    columns = (
        "method", "max error", "rms error", "99.9th percentile", "peak pressure ratio",
        "displacement error", "max error of recovered pressures", "estimated max error",
        "certified: energy error", "certified: clamp force error", "certified: max error",
        "certified: increment, bounds fixed", "residual of friction", "coordinates",
    )  # fmt: skip
    rows: list[tuple[str | Cell, ...]] = [
        (
            label(name, count),
            Cell(
                text=percent(result.accuracy.max_relative_error),
                grade=grade(result.accuracy.max_relative_error),
            ),
            percent(result.accuracy.rms_relative_error),
            percent(result.accuracy.p999_relative_error),
            Cell(
                text=number(result.accuracy.max_pressure_ratio, 4),
                grade=grade(abs(result.accuracy.max_pressure_ratio - 1.0)),
            ),
            percent(result.accuracy.displacement_error),
            _recovered(result),
            _estimated(result),
            *_certified(result),
            f"{result.n_modes}",
        )
        for name, sizes in case.methods.items()
        for count, result in sorted(sizes.items())
    ]
    return told(table(columns, rows))


def told(whole: Table) -> Table:
    """Return a table without the columns in which nothing stands."""
    kept = [
        number
        for number in range(len(whole.columns))
        if not whole.rows or any(row[number].text != "—" for row in whole.rows)
    ]
    return Table(
        columns=tuple(whole.columns[number] for number in kept),
        rows=tuple(tuple(row[number] for number in kept) for row in whole.rows),
    )


def _certified(result: MethodResult) -> Iterator[str]:
    """Yield the bounds, the sharpest first."""
    for bound in (
        result.certified_energy_error, result.certified_force_error, result.certified_bound,
        result.response.increment_error, result.response.law_residual,
    ):  # fmt: skip
        yield "—" if bound is None or not np.isfinite(bound) else percent(bound)


def _recovered(result: MethodResult) -> Cell:
    if result.recovered_error is None:
        return Cell(text="—")
    return Cell(text=percent(result.recovered_error), grade=grade(result.recovered_error))


def _estimated(result: MethodResult) -> Cell:
    if result.response.estimate is None:
        return Cell(text="—")
    error, rubbed = (
        result.response.estimate.max_relative_error,
        result.response.estimate.max_traction_error,
    )
    tractions = "" if rubbed is None else f", tractions {percent(rubbed)}"
    return Cell(text=f"{percent(error)}{tractions}", grade=grade(error))


def timing_table(results: Results) -> Table:
    """Return what the full model and each method cost."""
    cost = timings(results)
    full = cost["full"]
    rows: list[tuple[str, ...]] = []
    for name, entry in {"full": full, **cost["methods"]}.items():
        cells = [seconds(entry["offline"]) if "offline" in entry else "—"]
        for key in ("per_static_case", "per_step"):
            cells += [seconds(entry[key]) if key in entry else "—", _ratio(full, entry, key, name)]
        rows.append(("full model" if name == "full" else name, *cells))
    columns = (
        "model", "offline", "per static case", "full model's time over it", "per time step",
        "full model's time over it",
    )  # fmt: skip
    return table(columns, rows)


def _ratio(full: dict[str, float], entry: dict[str, float], key: str, name: str) -> str:
    if name == "full" or key not in full or not entry.get(key):
        return "—"
    return f"{number(full[key] / entry[key], 2)} ×"


def stage_table(results: Results) -> Table:
    """Return the wall time of every stage, and of the run until its report was drawn."""
    times = {
        name: float(value)
        for name, value in results.timings.items()
        if isinstance(value, int | float)
    }
    rows = [(name, seconds(value)) for name, value in times.items()]
    if rows:
        rows.append(("all of it, without files and report", seconds(sum(times.values()))))
    return table(("stage", "wall time"), rows)
