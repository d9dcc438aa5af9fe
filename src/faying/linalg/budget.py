"""The memory budget of dense matrices, beyond which sparse factors replace them."""

from faying.linalg.memory import physical_memory

FRACTION = 0.5
"""Part of the physical memory that the dense matrices of one model may take by default."""

DENSE_COPIES = 12
"""Dense matrices between pairs in memory at once.

Measured on the roof of 4296 rows during tightening of its bolts with friction: stiffness and
compliance, boundary held and free, inverses with points closed and open, the three that change
without the springs of bolts, factors of a step and scratch. Forming contact takes four, paths ten.
"""

SPARSE_FACTORS = 2
"""Factors besides those of K in place of dense matrices: of glued pairs, and of closed points."""

POINT_COPIES = 2
"""Dense matrices between contact points in memory at once: H and its factors."""


def default_budget() -> int:
    """Return the default budget for dense matrices [bytes]: half of the physical memory."""
    return int(FRACTION * physical_memory())


def pairs_fit(n_relative: int, budget: int) -> bool:
    """Whether dense matrices between ``n_relative`` pairs stay within the budget."""
    return 8 * DENSE_COPIES * n_relative**2 <= budget


def points_fit(n_point: int, budget: int) -> bool:
    """Whether dense matrices between ``n_point`` contact points stay within the budget."""
    return 8 * POINT_COPIES * n_point**2 <= budget
