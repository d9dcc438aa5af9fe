"""Whether weak springs carry next to nothing, as they should."""

from collections.abc import Mapping

import numpy as np

from faying._typing import Matrix
from faying.simulation.solution import Solution

LARGEST_WEAK_SHARE = 1e-4
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


def weak_warnings(shares: Mapping[str, Mapping[str, float]]) -> list[str]:
    """Say in one sentence where weak springs hold what nothing else does; nothing where none do.

    Shares are the largest of a load case between two bodies that are named.
    """
    worst = [
        (share, bodies, case)
        for bodies, of_case in shares.items()
        for share, case in [max((share, case) for case, share in of_case.items())]
        if share > LARGEST_WEAK_SHARE
    ]
    if not worst:
        return []
    (share, bodies, case), *others = sorted(worst, reverse=True)
    also = "".join(
        f", those of {other} {less:.2g}" + (f" in {where}" if where != case else "")
        for less, other, where in others
    )
    return [
        f"{case}: the weak springs {bodies} carry {share:.2g} of the contact force{also}; bodies "
        "slide or lift off as wholes there, which neither contact nor friction stops, so that "
        "displacements, and what acts along the interfaces, mean nothing: give the interfaces "
        "their friction, or more clamp force, or support the free body"
    ]
