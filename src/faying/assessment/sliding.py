"""How much of the friction that resists sliding as a whole an interface already uses.

A rigid motion v of one side over the other meets at most Σ μ F_i |v_i|, where F_i presses at point
i and v_i is the motion along the interface there. While the F_i stay as they are, the load that the
tangential forces t_i carry can therefore grow by no more than 1 / η, and by as much,

    η = max over v of  Σ t_i · v_i / Σ μ F_i |v_i|,

after D. C. Drucker, "Coulomb friction, plasticity, and limit loads", Journal of Applied Mechanics
21 (1954) 71-74. η is one where everything slips in the directions of one rigid motion. It is small
where what slips here cancels what slips there: under a flange that is bent by an axial load.
"""

import numpy as np

from faying._typing import Matrix, Vector

MOST_PASSES = 200
"""Passes after which the search for the motion ends; each raises η."""

SETTLED = 1e-6
"""Growth of η in a pass, over it, at which the search ends."""

NEAR = 1e-9
"""Motion of a point, over the largest, that counts as none: about this point the side turns."""


def resistance_used(places: Matrix, tangents: Matrix, shear: Matrix, bounds: Vector) -> float:
    """Return η, between 0 and 1; 0 where nothing is pressed.

    Parameters
    ----------
    places : (n, 3) [length]
        Points that are pressed.
    tangents : (2, n, 3)
        Directions along the interface.
    shear : (2, n) [force]
        Tangential forces in these directions.
    bounds : (n,) [force]
        μ F, the most they can be.

    Notes
    -----
    The search is that of a weighted geometric median: least squares whose weights are those of the
    motion before (E. Weiszfeld, Tohoku Math. J. 43 (1937) 355-386). Curved interfaces have six
    motions, flat ones three that count.
    """
    if not bounds.sum() > 0:
        return 0.0
    arms = places - places.mean(axis=0)
    arms /= max(float(np.abs(arms).max()), np.finfo(float).tiny)
    moves = np.concatenate([tangents, np.cross(arms, tangents)], axis=-1)
    load = np.einsum("in,inm->m", shear, moves)
    used, speeds = 0.0, np.ones(len(places))
    for _ in range(MOST_PASSES):
        weights = bounds / np.maximum(speeds, NEAR * speeds.max())
        motion = np.linalg.pinv(np.einsum("n,inm,ink->mk", weights, moves, moves)) @ load
        speeds = np.linalg.norm(moves @ motion, axis=0)
        resisted = float(bounds @ speeds)
        before, used = used, float(load @ motion) / resisted if resisted > 0 else 0.0
        if used <= before * (1 + SETTLED):
            break
    return max(before, used)
