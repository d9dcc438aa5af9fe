"""How small the pressure error of a linear basis of given size could be, at best.

Two kinds of bases, two curves. Where the *pressure* is a combination of fixed fields (force bases,
DEIM, any fit), the proper orthogonal modes of the true pressures are the floor. A *displacement*
basis makes the gap such a combination and the penalty law clips it, p = c_n ⟨−g⟩, so it is not
bound by that floor; its yardstick is the best fit of the true gaps, sent through the law.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import scipy.linalg as la

from faying._typing import Indices, Matrix, Vector, frozen
from faying.exceptions import ModelError
from faying.reduction.basis import Basis
from faying.reduction.pod import pod
from faying.simulation.solution import Solution

Cases = TypeVar("Cases")


@dataclass(frozen=True, eq=False, kw_only=True)
class BestPossible:
    """Errors of the best fits by the first k proper orthogonal modes of true solutions.

    Errors are relative to the largest pressure of each case, Eq. (15.31), as fractions.

    Attributes
    ----------
    counts : (n_count,) [1]
        Numbers of vectors k of the basis.
    training_rms : (n_count,) [1]
        Root mean square error over the points and cases the modes were made of.
    training_max : (n_count,) [1]
        Largest error over the same.
    unseen_rms : (n_count,) [1]
        Root mean square error over all points and cases that the modes have not seen; None
        without such cases.
    unseen_median : (n_count,) [1]
        The median of these cases' largest errors.
    unseen_max : (n_count,) [1]
        The worst of these cases' largest errors.
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
    """Find how well pressures could be combined from k fixed fields.

    The true pressures of each case, over their largest value, are fitted by their own proper
    orthogonal modes: no other k fields leave a smaller root mean square error on these cases
    (Schmidt 1907, Eckart & Young 1936), and a method that must *find* the coefficients cannot do
    better. Other fields may have a smaller largest error. Bases of displacements are another
    matter, see :func:`best_possible_gap_errors`.

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
    numbers = _checked(counts)
    training = _relative_pressures(pressures)
    modes = pod(training.T, count=int(numbers.max(initial=1))).vectors
    held_out = None if unseen is None else _relative_pressures(unseen)
    if held_out is not None and held_out.shape[1] != training.shape[1]:
        message = (
            f"unseen pressures have {held_out.shape[1]} contact points, the others "
            f"{training.shape[1]}; take both from one model"
        )
        raise ModelError(message)

    def miss(cases: Matrix, count: int) -> Matrix:
        fitted = (cases @ modes[:, :count]) @ modes[:, :count].T
        return np.abs(cases - fitted)

    return _collected(numbers, miss, training, held_out)


def best_possible_gap_errors(
    training: Solution,
    counts: Sequence[int],
    *,
    unseen: Solution | None = None,
    classic: Basis | None = None,
) -> BestPossible:
    """Find how well gaps could be combined from k fixed fields, and the pressures that follow.

    What a displacement basis with k joint modes can express at best: the true gaps of each case
    are fitted in the least-squares sense by the gaps of the classic basis and by the k proper
    orthogonal modes of what those leave, and the penalty law makes the pressures. The fit is the
    best for the gaps, hence nearly but not strictly so for the pressures.

    Parameters
    ----------
    training, unseen
        Full static solutions of many loads, from :func:`faying.solve_static_cases`.
    counts
        Numbers of joint modes.
    classic
        Vectors every basis has besides its joint modes; none unless given.

    Raises
    ------
    ModelError
        If contact is hard, so that gaps say nothing about pressures; or as
        :func:`best_possible_errors`.
    """
    numbers, contact = _checked(counts), training.system.contact
    if not np.isfinite(contact.penalty).all():
        message = "with hard contact no pressure follows from a gap; give the model a penalty"
        raise ModelError(message)
    given = np.zeros((contact.n_points, 0))
    if classic is not None:
        shapes = contact.interpolation @ (contact.relative_operator @ classic.vectors)
        given = la.orth(shapes)
    left = training.gap.T - given @ (given.T @ training.gap.T)
    modes = pod(left, count=int(numbers.max(initial=1))).vectors
    # Modes of what is left but round-off need not be orthogonal to what was taken away.
    orthonormal = la.qr(np.hstack([given, modes]), mode="economic")[0]

    def miss(cases: Solution, count: int) -> Matrix:
        fields = orthonormal[:, : given.shape[1] + count]
        gap = (cases.gap @ fields) @ fields.T
        pressure = contact.penalty * np.maximum(-gap, 0.0)
        pressed = cases.max_pressure > 0
        missed: Matrix = np.abs(pressure - cases.pressure)[pressed]
        return missed / cases.max_pressure[pressed, None]

    return _collected(numbers, miss, training, unseen)


def _checked(counts: Sequence[int]) -> Indices:
    numbers = np.asarray(counts, dtype=np.int64)
    if numbers.ndim != 1 or not len(numbers) or (numbers < 0).any():
        message = f"numbers of vectors must be zero or more; got {list(counts)}"
        raise ModelError(message)
    return numbers


def _collected(
    numbers: Indices,
    miss: Callable[[Cases, int], Matrix],
    training: Cases,
    unseen: Cases | None,
) -> BestPossible:
    """Summarize the misses (n_case, n_point) of every number of vectors."""

    def columns(cases: Cases) -> Matrix:
        return np.array([_summary(miss(cases, count)) for count in numbers.tolist()]).T

    rms, _, largest = columns(training)
    if unseen is None:
        return BestPossible(counts=numbers, training_rms=rms, training_max=largest)
    unseen_rms, unseen_median, unseen_max = columns(unseen)
    return BestPossible(
        counts=numbers,
        training_rms=rms,
        training_max=largest,
        unseen_rms=unseen_rms,
        unseen_median=unseen_median,
        unseen_max=unseen_max,
    )


def _summary(miss: Matrix) -> tuple[float, float, float]:
    """Root mean square, median case's and worst case's largest error."""
    largest = miss.max(axis=1)
    return float(np.sqrt(np.mean(miss**2))), float(np.median(largest)), float(largest.max())


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
