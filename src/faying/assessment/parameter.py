"""A parameter known by its range, and trial values in the range."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np
from scipy.stats import qmc

from faying._typing import Matrix, Vector
from faying.exceptions import refuse_model
from faying.iterations import MOST_SOLVED


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter with a range, on a logarithmic scale if both ends are positive.

    Attributes
    ----------
    name
    low, high
        Ends of the range.
    start
        Start of a search; None is the middle.

    Examples
    --------
    >>> import faying as fy
    >>> friction = fy.Parameter(name="friction", low=0.1, high=0.4)
    >>> [round(trial["friction"], 3) for trial in fy.design([friction])]
    [0.2, 0.1, 0.4]
    """

    name: str
    low: float
    high: float
    start: float | None = None

    def __post_init__(self) -> None:
        if not -np.inf < self.low < self.high < np.inf:
            refuse_model(
                f"parameter '{self.name}' goes from {self.low:g} to {self.high:g}; give finite "
                "ends, the smaller one first"
            )
        if self.start is not None and not self.low <= self.start <= self.high:
            refuse_model(
                f"parameter '{self.name}' starts at {self.start:g}, outside of {self.low:g} to "
                f"{self.high:g}; start within"
            )

    @property
    def logarithmic(self) -> bool:
        """Whether the range has a logarithmic scale."""
        return self.low > 0

    def value(self, share: float) -> float:
        """Return the value at a share of the range, from 0 to 1."""
        if self.logarithmic:
            return float(self.low * (self.high / self.low) ** share)
        return float(self.low + (self.high - self.low) * share)

    def share(self, value: float) -> float:
        """Return the share of the range at a value."""
        if self.logarithmic:
            return float(np.log(value / self.low) / np.log(self.high / self.low))
        return float((value - self.low) / (self.high - self.low))


def values_at(parameters: Sequence[Parameter], shares: Vector) -> Mapping[str, float]:
    """Return the values of parameters at shares of their ranges (n_parameter,)."""
    return {
        parameter.name: parameter.value(float(share))
        for parameter, share in zip(parameters, shares, strict=True)
    }


def design(
    parameters: Sequence[Parameter],
    kind: Literal["corners", "quasi-random"] = "corners",
    samples: int = 32,
) -> tuple[Mapping[str, float], ...]:
    """Return the values of parameters at which to compute.

    Parameters
    ----------
    kind
        ``"corners"``: the middle of the ranges and all their corners; or ``"quasi-random"``: the
        points of Halton's sequence, the same in every call.
    samples
        Number of points of that sequence.

    Raises
    ------
    ModelError
        If there are more corners than can be computed, no parameter, or no such design.

    Examples
    --------
    >>> import faying as fy
    >>> friction = fy.Parameter(name="friction", low=0.1, high=0.4)
    >>> [round(trial["friction"], 3) for trial in fy.design([friction])]
    [0.2, 0.1, 0.4]
    """
    n = len(parameters)
    if not n or kind not in ("corners", "quasi-random"):
        refuse_model(f"found design '{kind}' of {n} parameters; give 'corners' or 'quasi-random'")
    if kind == "corners" and 2**n > MOST_SOLVED:
        refuse_model(
            f"{n} parameters have {2**n} corners; take design 'quasi-random' with a number of "
            f"samples, or corners of {int(np.log2(MOST_SOLVED))} at most"
        )
    shares: Matrix
    if kind == "corners":
        shares = np.array([[0.5] * n, *product((0.0, 1.0), repeat=n)])
    else:
        # Without the first point of the sequence, which is a corner of the ranges.
        shares = qmc.Halton(n, scramble=False).random(samples + 1)[1:]
    return tuple(values_at(parameters, point) for point in shares)
