"""What estimated errors of transients and certified ones of static loads are worth in a run."""

import numpy as np

from faying.assessment.transient_error import OBSERVED_ON, OBSERVED_RATIOS, TRACTIONS_OBSERVED
from faying.display.quantities import number, percent
from faying.report.methods import GOOD
from faying.report.style import NOTHING
from faying.study.judgement.remarks import hint
from faying.study.results.values import Results


def estimate_note(results: Results) -> str:
    """Say what the estimated errors of transients are; empty where there are none."""
    estimates = [
        (case.is_full, name, result.response.estimate, result.accuracy)
        for case in results.cases.values()
        for name, sizes in case.methods.items()
        for result in sizes.values()
        if result.response.estimate is not None
    ]
    if not estimates:
        return ""
    low, high = (number(factor, 2) for factor in OBSERVED_RATIOS)
    said = (
        "Estimated max error, of transients: how far the pressures move when the shapes that the "
        "transient's own contact forces excite are given their inertia. It takes no full solution "
        "and is an estimate, no bound; what the time step adds is not in it. Against full "
        f"solutions of {OBSERVED_ON} it was {low} to {high} times the true max error"
    )
    rubbed = any(estimate.max_traction_error is not None for _, _, estimate, _ in estimates)
    said += f", {TRACTIONS_OBSERVED}, over the largest traction." if rubbed else "."
    said = f"{said} {hint(results)}".rstrip()
    ratios = [
        estimate.max_relative_error / true.max_relative_error
        for full, _, estimate, true in estimates
        if full and true.max_relative_error > NOTHING
    ]
    if not ratios:
        return said
    smallest, largest = (number(float(extreme(ratios)), 2) for extreme in (np.min, np.max))
    return f"{said} In this run it is {smallest} to {largest} times the true one."


def doubtful_references(results: Results) -> list[str]:
    """Name the transients whose reduced reference is itself estimated to be off."""
    return [
        f"{name}: pressures of the {case.reference_model}, which the errors of this load case are "
        f"against, are themselves estimated to be off by up to {percent(error)} of the "
        "peak. Read the estimated errors of the methods, not their differences to it."
        for name, case in results.cases.items()
        if not case.is_full
        and case.reference.estimate is not None
        and (error := case.reference.estimate.max_relative_error) > GOOD
    ]


def sharpness(results: Results) -> str:
    """Return what the bounds of max errors were worth in a run; empty where nothing tells."""
    ratios = [
        result.certified_bound / result.accuracy.max_relative_error
        for case in results.cases.values()
        for sizes in case.methods.values()
        for result in sizes.values()
        if result.certified_bound is not None and result.accuracy.max_relative_error > NOTHING
    ]
    if not ratios:
        return ""
    low, middle, high = (float(f(ratios)) for f in (np.min, np.median, np.max))
    return (
        f"In this run the bound of the max error is {number(low)} to {number(high)} times the true "
        f"one, {number(middle)} times in the median: it says that a pressure is wrong, not by how "
        "much."
    )
