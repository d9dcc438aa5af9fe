"""Measurements of a mode over amplitude, for comparison with its computed backbone."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Frozen, Vector
from faying.assessment.backbone import Backbone
from faying.digits import SOLVED


@dataclass(frozen=True, eq=False, kw_only=True)
class MeasuredCurve(Frozen):
    """Frequency, damping or both of a mode at amplitudes.

    Attributes
    ----------
    name
        Name of the curve.
    case
        Load case of the backbone to compare with.
    mode
        Number of the mode, from 1.
    amplitude : (n,) [length]
        In ascending order, at the same place as that of the backbone.
    frequency : (n,) [1/time]
        Cyclic; None where it was not measured.
    damping_ratio : (n,) [1]
        Total damping ratio; None where it was not measured.
    frequency_scatter, damping_scatter : [1]
        Standard deviation of a measurement over its value; None where unknown.

    Examples
    --------
    >>> import faying as fy
    >>> import numpy as np
    >>> amplitude, frequency = np.array([0.05, 0.1]), np.array([642.0, 640.0])
    >>> test = fy.MeasuredCurve(
    ...     name="ring", case="ring", mode=1, amplitude=amplitude, frequency=frequency
    ... )
    >>> test.damping_ratio is None
    True
    """

    name: str
    case: str
    mode: int
    amplitude: Vector
    frequency: Vector | None = None
    damping_ratio: Vector | None = None
    frequency_scatter: float | None = None
    damping_scatter: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Deviations:
    """Deviations of a backbone from measurements, at the amplitudes that it reaches.

    Attributes
    ----------
    frequency, damping_ratio : (n,)
        Computed at the measured amplitudes; NaN at amplitudes that it does not reach.
    frequency_error, damping_error : (n,) [1]
        Relative to the measured values; NaN there, and where there is no measurement.
    """

    frequency: Vector
    damping_ratio: Vector
    frequency_error: Vector
    damping_error: Vector


def at_amplitudes(computed: Backbone, amplitude: Vector, values: Vector) -> Vector:
    """Return values of a backbone interpolated over the logarithm of its amplitudes, NaN beyond.

    Values (n_computed,) are given at the computed amplitudes and returned at others (n,) [length].
    """
    order = np.argsort(computed.amplitude)
    reached, logarithm = np.log(computed.amplitude[order]), np.log(amplitude)
    # Includes the smallest and the largest amplitude, which have round-off.
    within = (logarithm >= reached[0] - SOLVED) & (logarithm <= reached[-1] + SOLVED)
    return np.where(within, np.interp(logarithm, reached, values[order]), np.nan)


def deviations(measured: MeasuredCurve, computed: Backbone) -> Deviations:
    """Return the deviations of a backbone, interpolated between its amplitudes, from measurements.

    Frequencies and logarithms of damping ratios are linear over the logarithm of the amplitude.
    """
    amplitude = measured.amplitude
    frequency = at_amplitudes(computed, amplitude, computed.frequency)
    with np.errstate(divide="ignore"):
        damping = np.exp(at_amplitudes(computed, amplitude, np.log(computed.damping_ratio)))

    def error(value: Vector, truth: Vector | None) -> Vector:
        return np.full(len(amplitude), np.nan) if truth is None else value / truth - 1

    return Deviations(
        frequency=frequency,
        damping_ratio=damping,
        frequency_error=error(frequency, measured.frequency),
        damping_error=error(damping, measured.damping_ratio),
    )
