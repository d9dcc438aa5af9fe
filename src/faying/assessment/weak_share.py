"""Whether weak springs carry next to nothing, as they should."""

import numpy as np

from faying._typing import Matrix
from faying.simulation.solution import Solution

NEGLIGIBLE = 1e-4
"""Share of the contact force up to which weak springs may be forgotten.

Springs that friction lets carry nothing have 1e-6 of it; those that carry the load have as much of
the clamp force as it has, some percent.
"""


def weak_share(solution: Solution, bodies: str) -> Matrix:
    """Return what the weak springs between two bodies carry over the total contact force (...).

    The sum of magnitudes; infinite where nothing is in contact and they carry something.

    Raises
    ------
    ModelError
        If there are no such springs.
    """
    carried = np.asarray(solution.weak_force(bodies))
    pressed = np.asarray(solution.contact_forces.sum(axis=-1))
    share = carried / np.where(pressed > 0, pressed, 1.0)
    return np.where(pressed > 0, share, np.where(carried > 0, np.inf, 0.0))


def weak_warning(bodies: str, case: str, share: float) -> str:
    """Say that weak springs hold what nothing else does; nothing where they do not."""
    if share <= NEGLIGIBLE:
        return ""
    return (
        f"{case}: the weak springs {bodies} carry {share:.2g} of the contact force, for neither "
        "contact nor friction holds the bodies together there; displacements, and what acts along "
        "the interfaces, mean nothing: give the interface friction, or support the free body"
    )
