"""The smallest pressure error a linear basis of a given size could reach."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix, Vector, frozen
from faying.exceptions import ModelError
from faying.reduction.pod import pod


@dataclass(frozen=True, eq=False, kw_only=True)
class BestPossible:
    """Errors of the best fits by the first k proper orthogonal modes of true pressures.

    Errors are relative to the largest pressure of each case, Eq. (15.31), as fractions.

    Attributes
    ----------
    counts : (n_count,)
        Numbers of vectors k.
    training_rms, training_max : (n_count,)
        Root mean square and largest error over the points and cases the modes were made of. No
        linear basis of k vectors has a smaller ``training_rms``; another one may have a smaller
        largest error, though hardly by much.
    unseen_rms, unseen_median, unseen_max : (n_count,)
        Of cases the modes have not seen: over all points and cases, the median case's largest
        error, the worst case's. None without such cases.
    """

    counts: Indices
    training_rms: Vector
    training_max: Vector
    unseen_rms: Vector | None = None
    unseen_median: Vector | None = None
    unseen_max: Vector | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "counts", frozen(self.counts, np.int64))
        for name in ("training_rms", "training_max", "unseen_rms", "unseen_median", "unseen_max"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, frozen(getattr(self, name)))


def best_possible_errors(
    pressures: Matrix, counts: Sequence[int], *, unseen: Matrix | None = None
) -> BestPossible:
    """Find how well any linear basis of k vectors could represent the pressures of a load space.

    The true pressures of each case, over their largest value, are fitted by their own proper
    orthogonal modes: of all bases of that size these leave the smallest root mean square error
    (Schmidt 1907, Eckart & Young 1936). A method that must *find* the coefficients cannot do
    better, so this curve is the floor for the convergence of every displacement or force basis.

    Parameters
    ----------
    pressures : (n_case, n_point) [force/length²]
        Full solutions of many loads, e.g. ``solve_static_cases(model, loads).pressure``.
    counts
        Numbers of vectors.
    unseen : (n_case, n_point), optional
        Further full solutions the modes may not be made of: the floor for loads outside training.

    Raises
    ------
    ModelError
        If there are no cases with pressure, a pressure is not finite, or a count is negative.

    Notes
    -----
    One SVD of the pressures. Cases without any pressure are left out.

    Examples
    --------
    >>> import numpy as np
    >>> best_possible_errors(np.eye(3), [1, 3]).training_max.round(3)
    array([1., 0.])
    """
    numbers = np.asarray(counts, dtype=np.int64)
    if numbers.ndim != 1 or (numbers < 0).any():
        message = f"numbers of vectors must be zero or more; got {list(counts)}"
        raise ModelError(message)
    training = _relative_pressures(pressures)
    modes = pod(training.T, count=int(numbers.max(initial=1))).vectors
    within = [_errors(training, modes[:, :count]) for count in numbers.tolist()]
    rms, _, largest = np.array(within).reshape(len(numbers), 3).T
    if unseen is None:
        return BestPossible(counts=numbers, training_rms=rms, training_max=largest)
    held_out = _relative_pressures(unseen)
    if held_out.shape[1] != training.shape[1]:
        message = (
            f"unseen pressures have {held_out.shape[1]} contact points, the others "
            f"{training.shape[1]}; take both from one model"
        )
        raise ModelError(message)
    beyond = [_errors(held_out, modes[:, :count]) for count in numbers.tolist()]
    unseen_rms, unseen_median, unseen_max = np.array(beyond).reshape(len(numbers), 3).T
    return BestPossible(
        counts=numbers,
        training_rms=rms,
        training_max=largest,
        unseen_rms=unseen_rms,
        unseen_median=unseen_median,
        unseen_max=unseen_max,
    )


def _errors(cases: Matrix, modes: Matrix) -> tuple[float, float, float]:
    """Root mean square, median case's and worst case's largest error of the L2 fit."""
    residual = np.abs(cases - (cases @ modes) @ modes.T)
    largest = residual.max(axis=1)
    rms = np.sqrt(np.mean(residual**2))
    return float(rms), float(np.median(largest)), float(largest.max())


def _relative_pressures(pressures: Matrix) -> Matrix:
    """Return the cases with any pressure, each over its largest value."""
    cases = np.asarray(pressures, dtype=float)
    if cases.ndim != 2 or not np.isfinite(cases).all():
        message = f"pressures need shape (n_case, n_point) and finite values; got {cases.shape}"
        raise ModelError(message)
    peaks = cases.max(axis=1, initial=0.0)
    if not (peaks > 0).any():
        message = "no case has any contact pressure, so there is nothing to represent"
        raise ModelError(message)
    relative: Matrix = cases[peaks > 0] / peaks[peaks > 0, None]
    return relative
