"""Contact forces are data: the solution of one contact problem."""

from dataclasses import dataclass, field

import numpy as np

from faying._typing import Mask, Matrix, Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactForces:
    """Solution of one contact problem.

    Attributes
    ----------
    forces : (n_point,) [force]
        λ = w ∘ p ≥ 0.
    slack : (n_point,) [length]
        s = H λ + g_free ≥ 0: the gap plus the penetration that the law admits.
    active : (n_point,)
        Points in contact; a warm start for a neighbouring problem.
    iterations
        Linear systems solved.
    error
        Bound on the relative error of the forces in the norm (Σ λ²/(c_n w))½; zero where the
        problem was solved to round-off.
    shear_forces : (n_tangent, n_point) [force]
        Tangential components; by default none.
    slip : (n_tangent, n_point) [length]
        Tangential components of what has slipped so far.
    dissipation
        Energy that friction took [force·length].
    """

    forces: Vector
    slack: Vector
    active: Mask
    iterations: int
    error: float = 0.0
    shear_forces: Matrix = field(default_factory=lambda: np.zeros((0, 1)))
    slip: Matrix = field(default_factory=lambda: np.zeros((0, 1)))
    dissipation: float = 0.0
