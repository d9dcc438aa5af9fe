"""Coulomb friction on elastic or hard normal contact."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.laws.hard import Hard
from faying.contact.laws.penalty import Penalty
from faying.exceptions import ModelError

LARGEST_FRICTION = 10.0
"""Coefficients above this are taken for a slip of the pen; dry metals have 0.05 to 1."""


@final
@dataclass(frozen=True)
class Coulomb:
    """|λ_t| ≤ μ λ_n; slip opposes λ_t, and sticking points hold on by a tangential stiffness.

    With the relative tangential displacement v and the slip s, λ_t = −w c_t (v − s) where a point
    sticks; where it slips, |λ_t| = μ λ_n and s moves on against λ_t; where it is open, λ_t = 0 and
    s follows v. Increments are implicit: both forces are those at the end.

    Attributes
    ----------
    normal
        Law of the normal component.
    friction
        μ.
    tangential_penalty : [force/length³]
        c_t; ``inf`` lets nothing move that sticks.

    Raises
    ------
    ModelError
        If a number is not in its range.
    """

    normal: Hard | Penalty
    friction: float
    tangential_penalty: float

    def __post_init__(self) -> None:
        if not 0 <= self.friction <= LARGEST_FRICTION:
            message = (
                f"the coefficient of friction is {self.friction:g}; give a number from 0 to "
                f"{LARGEST_FRICTION:g} (dry metals have 0.05 to 1)"
            )
            raise ModelError(message)
        if not self.tangential_penalty > 0:
            message = (
                f"the tangential penalty is {self.tangential_penalty:g}; give a positive number "
                "[force/length³] or 'auto'"
            )
            raise ModelError(message)

    @property
    def name(self) -> str:
        """Name in studies and files."""
        return "coulomb"

    @property
    def components(self) -> int:
        """The normal and two tangential components."""
        return 3

    @property
    def penalty(self) -> float:
        """Contact stiffness of the normal component."""
        return self.normal.penalty

    def compliance(self, weights: Vector) -> Matrix:
        """Return 1/(c_n w) and twice 1/(c_t w) (3, n_point) [length/force]; zero where rigid."""
        shear = 1.0 / (self.tangential_penalty * weights)
        return np.vstack([self.normal.compliance(weights), shear, shear])

    def admissible(self, forces: Matrix) -> Matrix:
        """Return ⟨λ_n⟩ and the tangential force cut to μ ⟨λ_n⟩ (3, ..., n_point)."""
        normal = np.maximum(forces[0], 0.0)
        size = np.hypot(forces[1], forces[2])
        cut = np.minimum(1.0, self.friction * normal / np.where(size > 0, size, 1.0))
        return np.stack([normal, cut * forces[1], cut * forces[2]])


def automatic_tangential_penalty(penalty: float, poissons_ratio: float) -> float:
    """Return c_t = c_n · 2 (1 − ν)/(2 − ν), Mindlin's ratio of tangential to normal stiffness.

    R. D. Mindlin, Compliance of elastic bodies in contact, J. Appl. Mech. 16 (1949) 259.
    """
    return penalty * 2 * (1 - poissons_ratio) / (2 - poissons_ratio)
