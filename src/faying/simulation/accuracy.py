"""How far a solution is from a reference, in the seed's measure, Eq. (15.31)."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.simulation.solution import Solution


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """Errors relative to the reference, as fractions (0.05 is 5 %).

    Attributes
    ----------
    max_relative_error
        Largest |p − p_ref| over all points and instants, over the largest p_ref.
    rms_relative_error
        Root mean square of the same over all points and instants.
    p999_relative_error
        Its 99.9th percentile.
    max_pressure_ratio
        Largest pressure over the largest reference pressure.
    displacement_error
        Largest distance of boundary translations over the largest reference translation.
    """

    max_relative_error: float
    rms_relative_error: float
    p999_relative_error: float
    max_pressure_ratio: float
    displacement_error: float


def relative_error(pressure: Matrix, reference: Matrix) -> Matrix:
    """Return (p − p_ref) / max p_ref per contact point and instant, Eq. (15.31).

    Raises
    ------
    ModelError
        If the shapes differ or the reference has no pressure at all.
    """
    if np.shape(pressure) != np.shape(reference):
        message = (
            f"pressures of shape {np.shape(pressure)} and {np.shape(reference)} cannot be "
            "compared; solve the same load case with the same time steps"
        )
        raise ModelError(message)
    largest = float(np.max(reference, initial=0.0))
    if largest <= 0:
        message = "the reference has no contact pressure, so no relative error exists"
        raise ModelError(message)
    error: Matrix = (np.asarray(pressure) - reference) / largest
    return error


def compare(solution: Solution, reference: Solution) -> Accuracy:
    """Compare a solution with a reference of the same load, points and instants.

    Examples
    --------
    ``fy.compare(fy.solve_static(rom, load), fy.solve_static(model, load)).max_relative_error``
    """
    error = np.abs(relative_error(solution.pressure, reference.pressure))
    return Accuracy(
        max_relative_error=float(error.max()),
        rms_relative_error=float(np.sqrt((error**2).mean())),
        p999_relative_error=float(np.percentile(error, 99.9)),
        max_pressure_ratio=float(solution.max_pressure.max() / reference.max_pressure.max()),
        displacement_error=_displacement_error(solution, reference),
    )


def _displacement_error(solution: Solution, reference: Solution) -> float:
    """Largest over the boundaries; zero where nothing moves or there is no boundary."""
    errors = [0.0]
    for name, boundary in reference.system.boundaries.items():
        translation = boundary.components < 3
        exact = reference.displacement(name)[..., translation]
        largest = np.linalg.norm(exact, axis=-1).max()
        if largest > 0:
            distance = solution.displacement(name)[..., translation] - exact
            errors.append(float(np.linalg.norm(distance, axis=-1).max() / largest))
    return max(errors)
