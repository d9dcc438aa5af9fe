"""Tables of the model, its interfaces and bolts, and the loads of a study as text."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from faying.display.quantities import as_given, quantity
from faying.display.table import Column, Table, described
from faying.interface.surface import curve_of
from faying.study.judgement.model_warnings import kept_share
from faying.study.results.values import InterfaceRecord, Results
from faying.units import Units


def model_table(results: Results) -> Table:
    """Return the table of sizes, mass and units of the model."""
    units = results.unit_set
    kinds = ", ".join(dict.fromkeys(block.kind for block in results.blocks)) or "none"
    elements = sum(len(block.ids) for block in results.blocks)
    rows = [
        ("nodes", f"{len(results.nodes)}"),
        ("solid elements", f"{elements} ({kinds})"),
        ("bodies", f"{int(results.body.max(initial=-1)) + 1}"),
        ("free degrees of freedom", f"{results.dofs}"),
        *_factorization(results),
        ("mass", quantity(results.mass, units.mass, 4)),
        *_normal_modes(results),
        ("units", f"{results.units}: forces in {units.force}, pressures in {units.pressure}"),
    ]
    return described("model", rows, (Column("", lambda text: text),), units)


def _factorization(results: Results) -> Iterator[tuple[str, str]]:
    """Yield the row of the factorization library and its memory."""
    backend = results.provenance.get("factorization")
    if backend:
        yield "factorization", f"{backend}, {results.factor_bytes / 1e6:.0f} MB of factors"


def _normal_modes(results: Results) -> Iterator[tuple[str, str]]:
    """Yield the row of fixed-interface normal modes, found and counted up to a frequency."""
    count, units = results.normal_modes, results.unit_set
    if count is None:
        return
    below = quantity(count.below, units.frequency, 4)
    statement = f"{count.found} below {below}, not counted: {count.reason}"
    if count.counted is not None:
        statement = f"{count.found} of {count.counted} below {below} found"
    yield "fixed-interface normal modes", statement


def interface_table(results: Results) -> Table:
    """Return the table of geometry, contact law and preloaded state of the interfaces."""
    columns = (
        Column("node pairs", lambda face: len(face.pairs)),
        Column("contact points", lambda face: len(face.weights)),
        Column("quadrature", lambda face: face.quadrature),
        Column("area", lambda face: float(face.weights.sum()), "length²"),
        Column("of the declared", _declared, "%", 3),
        Column("contact", _law),
        Column("penalty stiffness", _stiffness, "force/length³", 3),
        Column("friction", lambda face: face.friction or None, "", 3),
        Column("stick stiffness", _sticking, "force/length³", 3),
        Column("tied pairs", lambda face: int(face.stuck.sum()) or None),
        Column(
            "largest preload pressure",
            lambda face: float(face.preload_pressure.max(initial=0)),
            "force/length²",
        ),
        Column("without preload pressure", _open, "%", 3),
    )
    return described("interface", results.interfaces.items(), columns, results.unit_set)


def _declared(face: InterfaceRecord) -> float | None:
    share = kept_share(float(face.weights.sum()), face.declared_area)
    return None if share is None else 100 * share


def _law(face: InterfaceRecord) -> str | None:
    """Return the name of a contact law that is not a linear penalty."""
    if face.penalty is None:
        return str(curve_of(face.closure).name)
    return "hard" if face.penalty == np.inf else None


def _stiffness(face: InterfaceRecord) -> float | None:
    return None if face.penalty is None or face.penalty == np.inf else face.penalty


def _sticking(face: InterfaceRecord) -> float | str | None:
    return "rigid" if np.isinf(face.tangential_penalty) else face.tangential_penalty or None


def _open(face: InterfaceRecord) -> float:
    total = float(face.weights.sum())
    return 100 * float(face.weights[face.preload_pressure <= 0].sum()) / total if total > 0 else 0.0


def bolt_table(results: Results) -> Table:
    """Return the table of nominal preloads and of bolt forces after tightening."""
    columns = (
        Column("nominal preload", lambda bolt: bolt.preload, "force", 5),
        Column(
            "after tightening",
            lambda bolt: float(bolt.history[-1]) if len(bolt.history) else None,
            "force",
            5,
        ),
        Column("locked initial force", lambda bolt: bolt.initial_force, "force", 5),
    )
    return described("bolt", results.bolts.items(), columns, results.unit_set)


def applied_loads(results: Results) -> dict[str, str]:
    """Return the loads of each load case in the study as text; empty if it cannot be read.

    Results with a study of a later version still make a report.
    """
    try:
        cases = results.study_tables.get("load_case", [])
        return {case["name"]: _applied(case, results.unit_set) for case in cases}
    except (KeyError, TypeError, AttributeError):
        return {}


def _applied(case: dict[str, Any], units: Units) -> str:
    """Return the loads, or the modes, of a case as text."""
    if case["kind"] == "backbone":
        return f"mode{'s' * (len(case['modes']) > 1)} {', '.join(map(str, case['modes']))}"
    return ", ".join(_force(force, units) for force in case["forces"])


def _force(force: dict[str, object], units: Units) -> str:
    value = force.get("value")
    kind = next((key for key in ("deck_load", "temperature") if force.get(key) is not None), "")
    name = f"{kind.replace('_', ' ')} {force[kind]}" if kind else None
    target = name or f"{force['boundary']} {force['component']}"
    if not isinstance(value, int | float):
        return f"{target} from {force.get('file')}"
    if name is not None:
        return f"{as_given(value)} × {target}"
    is_moment = str(force["component"]).startswith("M")
    unit = f"{units.force}·{units.length}" if is_moment else units.force
    return f"{target} = {as_given(value)} {unit}"
