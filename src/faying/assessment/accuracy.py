"""The error of a solution relative to a reference, in the seed's measure, Eq. (15.31)."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from faying._typing import Indices, Matrix
from faying.assessment.recovery import Recovered
from faying.digits import SOLVED
from faying.display.facts import Shown
from faying.exceptions import refuse_model
from faying.simulation.solution import Solution

Compared: TypeAlias = Solution | Recovered
"""Types that can be compared: solutions, and recovered ones."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Accuracy(Shown):
    """Errors relative to the reference, as fractions (0.05 is 5 %).

    Attributes
    ----------
    max_relative_error : [1]
        Largest difference ``|p − p_ref|`` over all points and instants, over the largest p_ref.
    rms_relative_error : [1]
        Root mean square of this difference over all points and instants.
    p999_relative_error : [1]
        99.9th percentile of this difference.
    max_pressure_ratio : [1]
        Largest pressure over the largest reference pressure.
    displacement_error : [1]
        Largest difference of boundary translations over the largest reference translation of any
        boundary, or the same for rotations of boundaries without translations if that is larger.
        Zero where boundaries are at rest within round-off.
    max_traction_error : [1]
        Largest difference of tractions over all points and instants, over the largest reference
        traction; None without friction.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=5))
    >>> error = fy.compare(fy.solve_static(rom), fy.solve_static(joint))
    >>> error.rms_relative_error < error.max_relative_error
    True
    """

    max_relative_error: float
    rms_relative_error: float
    p999_relative_error: float
    max_pressure_ratio: float
    displacement_error: float
    max_traction_error: float | None = None

    @property
    def facts(self) -> Mapping[str, str]:
        """Errors in percent."""
        errors = {
            "max relative error": self.max_relative_error,
            "root mean square": self.rms_relative_error,
            "99.9th percentile": self.p999_relative_error,
            "displacement error": self.displacement_error,
            "max traction error": self.max_traction_error,
        }
        told = {name: f"{100 * error:.3g} %" for name, error in errors.items() if error is not None}
        return told | {"peak pressure ratio": f"{self.max_pressure_ratio:.4g}"}

    @property
    def told(self) -> str:
        """Largest error of pressures, and of tractions if there are any, in percent."""
        tractions = self.max_traction_error
        along = "" if tractions is None else f" (tractions {tractions:.2%})"
        return f"{self.max_relative_error:.2%}{along}"


def relative_error(pressure: Matrix, reference: Matrix) -> Matrix:
    """Return (p − p_ref) / max p_ref per contact point and instant, Eq. (15.31).

    Raises
    ------
    ModelError
        If the shapes differ, or the reference has no pressure at all and the other one has.

    Examples
    --------
    >>> import faying as fy
    >>> import numpy as np
    >>> fy.relative_error(np.array([9.0, 4.0]), np.array([10.0, 2.0]))
    array([-0.1,  0.2])
    """
    if np.shape(pressure) != np.shape(reference):
        refuse_model(
            f"pressures of shape {np.shape(pressure)} and {np.shape(reference)} cannot be "
            "compared; solve the same load case with the same time steps"
        )
    largest = float(np.max(reference, initial=0.0))
    if largest <= 0 and not np.any(pressure):
        return np.zeros(np.shape(reference))  # gaps that stay open in both
    if largest <= 0:
        refuse_model("the reference has no contact pressure, so no relative error exists")
    return (np.asarray(pressure) - reference) / largest


def compare(solution: Compared, reference: Compared) -> Accuracy:
    """Return the accuracy of a solution relative to a reference of equal load, points and instants.

    Raises
    ------
    ModelError
        If points or instants differ, or the reference has no pressure.

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
    errors = measure(
        solution.pressure,
        reference.pressure,
        [
            (solution.displacement(name), reference.displacement(name), boundary.components)
            for name, boundary in boundaries.items()
        ],
    )
    return replace(
        errors, max_traction_error=traction_error([solution.traction], [reference.traction])
    )


def traction_error(tractions: Sequence[Matrix], references: Sequence[Matrix]) -> float | None:
    """Return the largest difference of tractions (..., 3) over the largest; None if all are 0."""
    return _error(list(zip(tractions, references, strict=True)), 0.0)


def measure(
    pressure: Matrix, reference: Matrix, displacements: Iterable[tuple[Matrix, Matrix, Indices]]
) -> Accuracy:
    """Return the accuracy of pressures (..., n_point) and displacements at boundaries.

    For each boundary, ``displacements`` has the displacements and those of the reference (..., n),
    and their components 0 … 5 (n,).

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
        max_pressure_ratio=float(np.max(pressure) / np.max(reference))
        if np.any(reference)
        else 1.0,
        displacement_error=_displacement_error(list(displacements)),
    )


def _displacement_error(displacements: list[tuple[Matrix, Matrix, Indices]]) -> float:
    """Return the largest relative difference of translations, or else of rotations."""
    largest = max(
        (float(np.abs(expected).max(initial=0.0)) for _, expected, _ in displacements), default=0.0
    )
    moved, turned = list[tuple[Matrix, Matrix]](), list[tuple[Matrix, Matrix]]()
    for motion, reference, components in displacements:
        shift, turn = components < 3, components >= 3
        moved.append((motion[..., shift], reference[..., shift]))
        size = float(np.abs(reference).max(initial=0.0))
        if _longest(reference[..., shift]) <= SOLVED * size:
            turned.append((motion[..., turn], reference[..., turn]))
    return max(_error(pairs, SOLVED * largest) or 0.0 for pairs in (moved, turned))


def _error(pairs: Sequence[tuple[Matrix, Matrix]], floor: float) -> float | None:
    """Return the largest difference of vectors (..., n) over the longest reference vector.

    None where no reference is longer than a floor.
    """
    length = max((_longest(reference) for _, reference in pairs), default=0.0)
    if length <= floor:
        return None
    return max(_longest(computed - reference) for computed, reference in pairs) / length


def _longest(vectors: Matrix) -> float:
    return float(np.linalg.norm(vectors, axis=-1).max(initial=0.0))
