"""Frequency and damping of a mode, from a measured frequency response around it."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from faying._typing import ComplexVector, Matrix, Vector
from faying.exceptions import refuse_model

FEWEST = 5
"""Fewest points of a response: six real unknowns need three complex values, plus a margin."""


@dataclass(frozen=True, kw_only=True)
class SingleMode:
    """One mode of a frequency response.

    Attributes
    ----------
    frequency : [1/time]
        Undamped, cyclic.
    damping_ratio : [1]
    residual : [1]
        Root mean square of the residual of the fit, over that of the response.
    """

    frequency: float
    damping_ratio: float
    residual: float


def single_mode(frequency: Vector, response: ComplexVector) -> SingleMode:
    """Return a mode fitted, with a constant, to the displacement per force around a resonance.

    Frequencies (n,) [1/time] are in ascending order. Responses (n,) are complex, in any unit; for
    nonlinear joints they are at one amplitude.

    Raises
    ------
    ModelError
        If there are fewer than five points, or the resonance is not among them.

    Notes
    -----
    Least squares of A/(ω₀² − ω² + 2iζω₀ω) + B with complex A and B: these follow from ω₀ and ζ,
    which SciPy seeks, starting at the largest response.

    Examples
    --------
    >>> f = np.linspace(79.0, 81.0, 41)
    >>> mode = single_mode(f, 1 / (80.3**2 - f**2 + 2j * 0.002 * 80.3 * f) + 1e-4)
    >>> round(mode.frequency, 6), round(mode.damping_ratio, 8)
    (80.3, 0.002)
    """
    if len(frequency) < FEWEST:
        refuse_model(f"a mode needs {FEWEST} points of a response at least; found {len(frequency)}")
    top = int(np.argmax(np.abs(response)))
    if top in (0, len(frequency) - 1):
        refuse_model(
            f"the response is largest at its end, {frequency[top]:g}; give frequencies on both "
            "sides of the resonance"
        )

    def shapes(logarithms: Vector) -> Matrix:
        centre, ratio = np.exp(logarithms)
        mode = centre**2 / (centre**2 - frequency**2 + 2j * ratio * centre * frequency)
        return np.asarray(np.column_stack([mode, np.ones(len(frequency))]))

    def deviation(logarithms: Vector) -> Vector:
        columns = shapes(logarithms)
        factors = np.linalg.lstsq(columns, response, rcond=None)[0]
        difference = (columns @ factors - response) / np.linalg.norm(response)
        return np.concatenate([difference.real, difference.imag])

    wide = np.abs(response) > np.abs(response[top]) / np.sqrt(2)
    width = max(np.ptp(frequency[wide]), float(np.diff(frequency).min()))
    start = np.log([frequency[top], width / (2 * frequency[top])])
    ended = least_squares(deviation, start, x_scale=[width / frequency[top], 1.0], xtol=1e-12)
    centre, ratio = np.exp(ended.x)
    return SingleMode(
        frequency=float(centre),
        damping_ratio=float(ratio),
        residual=float(np.linalg.norm(ended.fun)),
    )
