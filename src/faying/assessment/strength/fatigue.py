"""Fatigue of threads: cycles in a history, amplitudes against the endurance, and Miner's sum.

The endurance of threads rolled before heat treatment is widely quoted, in the symbols of VDI 2230,
as σ_ASV = 0.85 (150 mm/d + 45) MPa for property classes 8.8 to 12.9 at N_D = 2·10⁶ cycles, and as
σ_AZSV = σ_ASV (N_D/N)^{1/3} for fewer cycles.
"""

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.strength.grades import strength_of
from faying.assessment.strength.thread import Thread
from faying.digits import DECK_DIGITS
from faying.exceptions import refuse_model
from faying.units import LENGTHS, pascals

ENDURANCE_CYCLES = 2e6
"""N_D."""

EXPONENT = 3
"""Exponent of the amplitude, below N_D cycles."""


def endurance(thread: Thread, units: str) -> float:
    """Return σ_ASV [force/length²]."""
    pascal, metre = pascals(units), LENGTHS.get(units.split("-")[0])
    if pascal is None or metre is None:
        refuse_model(f"endurance is a stress in MPa, and what that is in {units} is not known")
    return 0.85 * (150 / (thread.diameter * metre * 1e3) + 45) * 1e6 / pascal


def is_rated(thread: Thread, units: str) -> bool:
    """Return whether σ_ASV is known: for steels of 800 MPa or more that are not stainless."""
    least = strength_of("8.8", units).ultimate * (1 - DECK_DIGITS)
    return thread.strengths(units).ultimate >= least and not thread.grade.startswith("A")


def miner_sums(stresses: Matrix, repetitions: float, limit: float) -> Vector:
    """Return Miner's sum of each fibre (n_fibre,) over a repeated history.

    Amplitudes below the endurance cause no damage. Stresses (n_instant, n_fibre) have the unit of
    the limit σ_ASV [force/length²].
    """
    sums = np.zeros(stresses.shape[1])
    # Fibres whose whole range is below the endurance need no counting.
    for fibre in np.flatnonzero(np.ptp(stresses, axis=0) / 2 > limit):
        ranges, counts = rainflow(stresses[:, fibre]).T
        harmful = ranges / 2 > limit
        lives = ENDURANCE_CYCLES * (limit / (ranges[harmful] / 2)) ** EXPONENT
        sums[fibre] = repetitions * (counts[harmful] / lives).sum()
    return sums


def rainflow(values: Vector) -> Matrix:
    """Return the cycles of a history: ranges and their counts (n_cycle, 2).

    A count of a half is an open range.

    Notes
    -----
    One pass over the reversals, by the package ``rainflow``.
    """
    from rainflow import extract_cycles

    cycles = [(size, count) for size, _, count, _, _ in extract_cycles(values.tolist()) if size > 0]
    return np.array(cycles).reshape(-1, 2)
