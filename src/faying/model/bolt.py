"""Bolt: an axial spring with an initial force that pretension sets and then locks."""

from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Matrix, SparseMatrix, Vector, frozen
from faying.model.shank import Shank


@dataclass(frozen=True, eq=False, kw_only=True)
class Bolt:
    """Axial behaviour of a bolt: force N = k e + N₀ with elongation e = elongation · u.

    Its stiffness k is part of the system's K; N₀ (Young's modulus × area × initial strain) acts as
    the load −elongationᵀ N₀, which pulls head and nut together.

    Attributes
    ----------
    elongation : (n_dof,)
        Row that takes displacements to the elongation of the bolt.
    stiffness : [force/length]
        EA/L of the element that is tightened.
    initial_force : [force]
        N₀; zero for a bolt not yet tightened.
    ends : (2, 3) or None [length]
        Where what is tightened begins and ends.
    bending : (4, n_dof) or None
        Rows that take displacements to the bending moments [force·length]: two components where
        the beams of the bolt begin, two where they end; None of a bolt without beams.
    residual_bending : (4, n_relative) or None [length]
        Moments per force between the contact pairs that the trial vectors of a reduced model lack.
    shank
        What it carries across its axis; None of bolts in given matrices, and in reduced models.
    """

    name: str
    elongation: Vector
    stiffness: float
    initial_force: float = 0.0
    ends: Matrix | None = None
    bending: SparseMatrix | Matrix | None = None
    residual_bending: Matrix | None = None
    shank: Shank | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "elongation", frozen(self.elongation))
        if self.ends is not None:
            object.__setattr__(self, "ends", frozen(self.ends))

    def force(self, displacement: Matrix) -> Matrix:
        """Axial force for displacements of shape (..., n_dof); tension is positive."""
        elongation: Matrix = displacement @ self.elongation
        return self.stiffness * elongation + self.initial_force

    def locked(self, initial_force: float) -> "Bolt":
        """Return the bolt with another initial force."""
        return replace(self, initial_force=float(initial_force))

    def projected(self, vectors: Matrix) -> "Bolt":
        """Return the bolt as seen by coordinates q of u = vectors q."""
        bending = None if self.bending is None else np.asarray(self.bending @ vectors)
        return replace(self, elongation=self.elongation @ vectors, bending=bending, shank=None)

    def at_ports(self) -> "Bolt":
        """Return what is known of the bolt without any coordinates."""
        return replace(
            self, elongation=np.zeros(0), bending=None, residual_bending=None, shank=None
        )
