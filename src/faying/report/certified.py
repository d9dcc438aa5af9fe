"""How far the certified errors of a run lie above the true ones."""

import numpy as np

from faying.display.quantities import number
from faying.report.style import NOTHING
from faying.study.results.values import Results


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
