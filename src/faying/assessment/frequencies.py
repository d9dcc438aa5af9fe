"""Natural frequencies of a preloaded joint, its contact linearized."""

from typing import cast

import numpy as np

from faying._typing import SparseMatrix, Vector
from faying.assessment.stuck_stiffness import stuck_stiffness
from faying.joint.model import Model
from faying.linalg.backends import count_negative
from faying.linalg.relief import factorize_relieved
from faying.reduction.normal_modes import lowest_modes
from faying.simulation.path import last_of
from faying.simulation.solution import Solution
from faying.simulation.start import at_rest


def preloaded_frequencies(model: Model, count: int, *, state: Solution | None = None) -> Vector:
    """Compute the lowest frequencies of small vibrations about a static state.

    Points in contact stay closed and open ones stay open, K + Gᵀ diag(c_n w) G over the former. The
    stiffness is the unstressed one, on a preloaded beam up to 1 % low in ω (docs/accuracy.md).
    With friction every closed point sticks, and their tangential stiffness c_t w is part of it.

    Parameters
    ----------
    state
        Static solution to vibrate about, or a path, about its end; by default the joint under its
        bolts alone.

    Returns
    -------
    ndarray (count,) [1/time]

    Notes
    -----
    One factorization and one Lanczos run. :func:`faying.count_frequencies_below` proves that none
    is missing.
    """
    tangent = _tangent(model, state)
    factor = factorize_relieved(tangent, model.M, model.rigid_motions)
    squares, _ = lowest_modes(tangent, model.M, factor, count)
    return np.sqrt(squares) / (2 * np.pi)


def count_frequencies_below(
    model: Model, frequency: float, *, state: Solution | None = None
) -> int:
    """Count the frequencies of small vibrations about a static state below one [1/time].

    Parameters
    ----------
    state
        As in :func:`preloaded_frequencies`, which computes them.

    Raises
    ------
    InertiaError
        If the frequency is so close to one of theirs that round-off decides.

    Notes
    -----
    One factorization of K − ω²M with the closed contact in K, by Sylvester's law of inertia.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> fy.preloaded_frequencies(joint, 3).round()
    array([ 352.,  635., 1622.])
    >>> fy.count_frequencies_below(joint, 1e3)
    2
    """
    below = count_negative(_tangent(model, state) - (2 * np.pi * frequency) ** 2 * model.M)
    rigid: int = model.rigid_motions.shape[1]
    return below - rigid


def _tangent(model: Model, state: Solution | None) -> SparseMatrix:
    about = at_rest(model) if state is None else last_of(state)
    return cast("SparseMatrix", stuck_stiffness(model, about))
