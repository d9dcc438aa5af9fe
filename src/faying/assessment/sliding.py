"""The used share of the friction that resists sliding of an interface as a whole.

A rigid motion v of one side over the other meets a resistance of at most Σ μ F_i |v_i|, where F_i
is the normal force at point i and v_i the motion along the interface there. With constant F_i, the
load carried by the tangential forces t_i can therefore grow by exactly 1 / η at most,

    η = max over v of  Σ t_i · v_i / Σ μ F_i |v_i|,

after D. C. Drucker, "Coulomb friction, plasticity, and limit loads", Journal of Applied Mechanics
21 (1954) 71-74. Motions that press the sides into each other, or lift them apart, are no sliding: v
is tangential everywhere, in three directions for a plane, around and along a cylinder, in none for
a closed box. η is one where all points slip in the directions of one such motion. It is small where
tangential forces cancel over the interface: under a flange bent by an axial load.
"""

import numpy as np

from faying._typing import Matrix, Vector
from faying.digits import DECK_DIGITS, SOLVED

LARGEST_LIFT = 0.1
"""Normal motion over all motion, as root mean squares, below which a motion is tangential.

Around a circle of 24 flat facets it is 0.075, across slopes of 6 degrees 0.1.
"""


def resistance_used(places: Matrix, tangents: Matrix, shear: Matrix, bounds: Vector) -> float:
    """Return η, between 0 and 1; NaN where nothing resists, without contact or friction.

    Points in contact at places (n, 3) [length] carry shear (2, n) [force] along tangents (2, n, 3)
    of the interface, at most the bounds μ F (n,) [force].

    Notes
    -----
    As for a weighted geometric median: least squares with weights from the motion before
    (E. Weiszfeld, Tohoku Math. J. 43 (1937) 355-386).
    """
    if not bounds.sum() > 0:
        return np.nan
    arms = places - places.mean(axis=0)
    arms /= max(float(np.abs(arms).max()), np.finfo(float).tiny)
    moves = _moves(tangents, arms)
    moves = moves @ _sliding(moves, _moves(np.cross(*tangents)[None], arms), bounds)
    if not moves.size:
        return 0.0
    load = np.einsum("in,inm->m", shear, moves)
    previous, used, speeds = -1.0, 0.0, np.ones(len(places))
    # Each pass raises η, which is one at most; 100 passes were the most of 300 random interfaces.
    while used > previous * (1 + DECK_DIGITS):
        weights = bounds / np.maximum(speeds, SOLVED * speeds.max())
        motion = np.linalg.pinv(np.einsum("n,inm,ink->mk", weights, moves, moves)) @ load
        speeds = np.linalg.norm(moves @ motion, axis=0)
        resisted = float(bounds @ speeds)
        previous, used = used, float(load @ motion) / resisted if resisted > 0 else 0.0
    return max(previous, used)


def _moves(directions: Matrix, arms: Matrix) -> Matrix:
    """Return displacements in some directions (n_direction, n, 6) for six rigid motions."""
    return np.concatenate([directions, np.cross(arms, directions)], axis=-1)


def _sliding(along: Matrix, across: Matrix, bounds: Vector) -> Matrix:
    """Return rigid motions (6, n_motion) that are tangential at all points in contact."""
    sums = [
        np.einsum("n,inm,ink->mk", bounds, direction, direction) for direction in (along, across)
    ]
    sizes, axes = np.linalg.eigh(sum(sums))
    moving = sizes > np.finfo(float).eps * len(sizes) * sizes.max()
    scaled = axes[:, moving] / np.sqrt(sizes[moving])
    shares, motions = np.linalg.eigh(scaled.T @ sums[1] @ scaled)
    return np.asarray(scaled @ motions[:, shares <= LARGEST_LIFT**2])
