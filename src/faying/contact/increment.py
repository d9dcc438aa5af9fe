"""Where contact stands after an increment."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.laws_at_points import LawsAtPoints


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Increment:
    """Where contact stands after an increment.

    Attributes
    ----------
    forces : (3, n_point) [force]
        λ_n and both tangential components, zero where there is no friction.
    slack : (3, n_point) [length]
        z: the gap plus what the law yields, and the slip of the increment.
    moved : (n_relative,) [length]
        y, the relative displacements of the pairs.
    iterations
        Newton steps.
    residual
        Residual of the equations solved over the largest force.
    deepest : (n_point,) or None [length]
        Largest closures so far, where some law remembers them.
    error
        Bound on the relative error of the forces in the norm (Σ λ²/(c_n w))½; zero where the
        problem was solved to round-off.
    """

    forces: Matrix
    slack: Matrix
    moved: Vector
    iterations: int
    residual: float
    deepest: Vector | None = None
    error: float = 0.0

    def gap(self, laws: LawsAtPoints) -> Vector:
        """Return the gap (n_point,) [length], negative by the penetration where contact yields."""
        return np.asarray(self.slack[0] - laws.after(self.deepest).closure(self.forces)[0][0])

    @property
    def begun(self) -> bool:
        """Whether anything presses, or is remembered: what follows can start from here."""
        return bool(self.forces[0].any()) or self.deepest is not None

    @property
    def dissipation(self) -> float:
        """Energy that friction took in the increment, −Σ λ_t · z_t [force·length]."""
        return float(-(self.forces[1:] * self.slack[1:]).sum())
