"""Frequency and damping over amplitude, from a motion that dies out."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Vector
from faying.exceptions import ModelError

FEWEST_SWINGS = 3
"""Half swings from which a damping ratio is told."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Decay:
    """A free motion, period by period.

    Attributes
    ----------
    times : (n,) [time]
        Middle of each period.
    amplitude : (n,)
        Half of the swing there, in the unit of the motion.
    frequency : (n,) [1/time]
        Of the damped motion.
    damping_ratio : (n,)
        ζ = δ/√(4π² + δ²) of the logarithmic decrement δ of that period.
    """

    times: Vector
    amplitude: Vector
    frequency: Vector
    damping_ratio: Vector


def free_decay(times: Vector, motion: Vector) -> Decay:
    """Take frequency and damping from a free motion in one mode.

    The motion is followed from extreme to extreme, so that it may come to rest elsewhere than at
    zero, as a joint does that has slipped.

    Parameters
    ----------
    times : (n_time,) [time]
    motion : (n_time,)
        A modal coordinate, φᵀ M (u − u₀) with the mode φ, or a displacement that one mode makes.

    Raises
    ------
    ModelError
        If it does not swing often enough, is constant, or holds NaN or infinity.

    Notes
    -----
    Extremes are those of parabolas through three instants: of a motion in one mode alone 20 steps a
    period give a damping ratio of 1e-2 to 1e-5 of itself.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 5, 1000)
    >>> decay = free_decay(t, 0.3 + np.exp(-0.1 * t) * np.cos(20 * t))
    >>> bool(abs(decay.damping_ratio[0] - 0.1 / 20) < 1e-4)
    True
    """
    t, x = np.asarray(times, dtype=float), np.asarray(motion, dtype=float)
    if t.shape != x.shape or t.ndim != 1 or not np.isfinite(x).all():
        message = (
            f"the motion has shape {x.shape} and the times {t.shape}; give one finite number for "
            "each instant"
        )
        raise ModelError(message)
    instants, extremes = _extremes(t, x)
    swings = np.abs(np.diff(extremes)) / 2
    if len(swings) < FEWEST_SWINGS or not (swings > 0).all():
        message = (
            f"the motion has {len(swings)} half swings, and its decay is told from "
            f"{FEWEST_SWINGS} on; take a longer time, or a coordinate that the mode moves"
        )
        raise ModelError(message)
    decrement = np.log(swings[:-2] / swings[2:])
    middle = (instants[1:] + instants[:-1]) / 2
    return Decay(
        times=middle[1:-1],
        amplitude=swings[1:-1],
        frequency=1 / (middle[2:] - middle[:-2]),
        damping_ratio=decrement / np.hypot(2 * np.pi, decrement),
    )


def _extremes(t: Vector, x: Vector) -> tuple[Vector, Vector]:
    """Return instants and values of the extremes in between, refined by parabolas."""
    if len(x) < FEWEST_SWINGS:
        return t[:0], x[:0]
    rise_before, rise_after = x[1:-1] - x[:-2], x[2:] - x[1:-1]
    inner = (
        np.flatnonzero((rise_before * rise_after < 0) | ((rise_before != 0) & (rise_after == 0)))
        + 1
    )
    low, high = x[inner] - x[inner - 1], x[inner + 1] - x[inner]
    offset = 0.5 * (low + high) / (low - high)
    step = (t[inner + 1] - t[inner - 1]) / 2
    return t[inner] + offset * step, x[inner] + 0.25 * (low + high) * offset
