"""How far a solution is from a reference, in the seed's measure, Eq. (15.31)."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.model.system import System


class Compared(Protocol):
    """What a comparison needs of a solution."""

    @property
    def system(self) -> System:
        """The model that was solved."""
        ...

    @property
    def pressure(self) -> Matrix:
        """Contact pressure (..., n_point)."""
        ...

    def displacement(self, boundary: str) -> Matrix:
        """Return the displacements at a boundary (..., n)."""
        ...


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


def compare(solution: Compared, reference: Compared) -> Accuracy:
    """Compare a solution with a reference of the same load, points and instants.

    Raises
    ------
    ModelError
        If they do not have the same points and instants, or the reference has no pressure.

    Examples
    --------
    >>> import faying as fy
    >>> model = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=5))
    >>> load = fy.Load({"tip.Fz": -500.0})
    >>> accuracy = fy.compare(fy.solve_static(rom, load), fy.solve_static(model, load))
    >>> accuracy.max_relative_error > 1.0  # Craig-Bampton has the pressure wrong
    True
    """
    boundaries = reference.system.boundaries
    return measure(
        solution.pressure,
        reference.pressure,
        [
            (
                solution.displacement(name)[..., boundary.components < 3],
                reference.displacement(name)[..., boundary.components < 3],
            )
            for name, boundary in boundaries.items()
        ],
    )


def measure(
    pressure: Matrix, reference: Matrix, translations: Iterable[tuple[Matrix, Matrix]]
) -> Accuracy:
    """Measure pressures (..., n_point) and pairs of boundary translations (..., n).

    Raises
    ------
    ModelError
        As :func:`relative_error`.
    """
    error = np.abs(relative_error(pressure, reference))
    return Accuracy(
        max_relative_error=float(error.max()),
        rms_relative_error=float(np.sqrt((error**2).mean())),
        p999_relative_error=float(np.percentile(error, 99.9)),
        max_pressure_ratio=float(np.max(pressure) / np.max(reference)),
        displacement_error=max([_distance(*pair) for pair in translations], default=0.0),
    )


def _distance(motion: Matrix, reference: Matrix) -> float:
    """Largest distance over the largest motion; zero where nothing moves."""
    largest = float(np.linalg.norm(reference, axis=-1).max())
    if largest == 0:
        return 0.0
    return float(np.linalg.norm(motion - reference, axis=-1).max()) / largest
