"""Natural frequencies of a preloaded joint, its contact linearized."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Vector
from faying.linalg.factorization import factorize
from faying.model.model import Model
from faying.reduction.normal_modes import lowest_modes
from faying.simulation.solution import Solution
from faying.simulation.static import solve_static

NEARLY_RIGID = 1e-6
"""Flexibility of a closed hard contact point, over its own compliance."""


def preloaded_frequencies(model: Model, count: int, *, state: Solution | None = None) -> Vector:
    """Compute the lowest frequencies of small vibrations about a static state.

    Points in contact stay closed and open ones stay open, K + Gᵀ diag(c_n w) G over the former.

    Parameters
    ----------
    state
        Static solution to vibrate about; by default the joint under its bolts alone.

    Returns
    -------
    ndarray (count,) [1/time]

    Notes
    -----
    One factorization and one Lanczos run.
    """
    contact = model.contact
    about = solve_static(model) if state is None else state
    closed = about.contact_forces > 0
    own = model.static_contact.own_compliance
    flexibility = np.maximum(contact.flexibility, NEARLY_RIGID * own)
    G = contact.gap_operator[closed]
    tangent = (model.K + G.T @ sp.diags_array(1 / flexibility[closed]) @ G).tocsr()
    squares, _ = lowest_modes(tangent, model.M, factorize(tangent), count)
    return np.sqrt(squares) / (2 * np.pi)
