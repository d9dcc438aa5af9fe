"""Springs across the pairs with prescribed forces, as bolts while they are tightened.

A spring of stiffness k with force T has the initial force N₀ = T − k e, where e is its
elongation. c and ι are the displacements of pairs and spring per initial force, p the forces
between the pairs, and y₀ and e₀ the displacements due to all other loads,

    y = y₀ + S p − c N₀,   cᵀ p + (1/k − ι) N₀ = T/k − e₀.                                  (T1a)

1/k − ι vanishes where the spring alone holds a part: N₀ is then the multiplier of a condition of
equilibrium.
"""

from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix, Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class ForcedSprings:
    """Springs of prescribed force, which the structure between the pairs contains.

    Attributes
    ----------
    columns : (n_spring, n_relative) [length/force]
        c.
    between : (n_spring, n_spring) [length/force]
        ι.
    stiffness : (n_spring,) [force/length]
        k.
    """

    columns: Matrix
    between: Matrix
    stiffness: Vector

    @classmethod
    def of_none(cls, n_relative: int) -> "ForcedSprings":
        """Return a set of no springs."""
        none = np.zeros((0, n_relative))
        return cls(columns=none, between=none[:, :0], stiffness=none[:, 0])

    @property
    def yields(self) -> Matrix:
        """1/k − ι (n_spring, n_spring)."""
        return np.asarray(np.diag(1.0 / self.stiffness) - self.between)
