"""Limits of the full model's accuracy: mesh, quadrature, time step and contact law."""

from collections.abc import Iterator

import numpy as np

from faying.display.quantities import number, percent, quantity
from faying.interface.surface import curve_of
from faying.study.judgement.step_check import choice_sentence, step_check, step_choice
from faying.study.results.values import CaseResult, Results
from faying.units import Units


def trust(results: Results) -> dict[str, str]:
    """Return statements about mesh and quadrature, time step and contact law, by title."""
    units = results.unit_set
    resolution = [*_resolution(results, units), *_mesh(results)]
    statements = {"Mesh and quadrature": " ".join(resolution)}
    steps = [text for name, case in results.cases.items() if (text := _step(name, case, units))]
    if steps:
        statements["Time step"] = " ".join(steps)
    statements["Contact law"] = " ".join(_law(results, units))
    return statements


def _resolution(results: Results, units: Units) -> Iterator[str]:
    for name, record in results.interfaces.items():
        facets = sum(len(faces.minus) for faces in record.faces)
        edge = np.sqrt(float(record.weights.sum()) / max(facets, 1))
        yield (
            f"{name}: {len(record.weights)} contact points by the rule {record.quadrature} on "
            f"{facets} facets, {quantity(edge, units.length)} wide on average."
        )


def _mesh(results: Results) -> Iterator[str]:
    """Yield the estimated mesh error of each interface in its worst load case."""
    for name, record in results.interfaces.items():
        estimates = [
            (case.mesh_errors[name], case)
            for case in results.cases.values()
            if name in case.mesh_errors
        ]
        if not estimates:
            yield f"{name}: the mesh error of its pressures could not be estimated."
            continue
        field, where = max(((error.field, case.name) for error, case in estimates))
        yield (
            f"{name}: estimated from this mesh alone, pressures are off by "
            f"{percent(field)} of the peak in the root mean square ({where}), single points by up "
            f"to {percent(max(error.largest for error, _ in estimates))}."
        )
        if record.quadrature == "nodal":
            yield "With nodal quadrature true errors were up to three times the estimate."
    yield (
        "This is an estimate, not a bound, and not of the peak: refine the interface and compare. "
        "A peak at a sharp edge grows with every refinement."
    )


def _step(name: str, case: CaseResult, units: Units) -> str:
    """Return a statement about the time step of a load case; empty for static ones."""
    if case.times is None or len(case.times) < 2:
        return ""
    step = quantity(float(case.times[1] - case.times[0]), units.time)
    choice = step_choice(case)
    if choice is not None:
        return choice_sentence(name, choice)
    check = step_check(case)
    if check is None:
        return f"{name}: a step of {step}; it was not checked, so convergence in time is unknown."
    return (
        f"{name}: a step of {step}; with half of it pressures change by up to "
        f"{percent(check.largest)} of the peak, {percent(check.change.rms_relative_error)} in the "
        f"root mean square, boundary displacements by "
        f"{percent(check.change.displacement_error)} of the largest. Reduced models use the same "
        "step, so that their errors do not show this."
    )


def _law(results: Results, units: Units) -> Iterator[str]:
    """Yield a statement about the contact law and penetration of each interface."""
    for name, record in results.interfaces.items():
        points = slice(*record.slice)
        gaps = [case.reference.gap[..., points] for case in results.cases.values()]
        depth = max((float(-gap.min(initial=0.0)) for gap in gaps), default=0.0)
        edge = float(np.sqrt(record.weights.sum() / len(record.pairs)))
        if record.penalty == np.inf:
            yield f"{name}: hard contact without penetration."
            continue
        if record.penalty is None:
            yield (
                f"{name}: pressure follows closure by the curve "
                f"'{curve_of(record.closure).name}' of the study; surfaces approach by up to "
                f"{quantity(depth, units.length)} in these load cases."
            )
            continue
        yield (
            f"{name}: pressure is {number(record.penalty)} {units.of('force/length³')} times "
            f"penetration, which reaches {quantity(depth, units.length)} in these load cases, "
            f"{percent(depth / edge)} of an element's edge."
        )
