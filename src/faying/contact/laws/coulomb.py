"""Coulomb friction on elastic or hard normal contact."""

from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.laws.law import Law
from faying.exceptions import ModelError

LARGEST_FRICTION = 10.0
"""Coefficients above this are refused as typing errors; dry metals have 0.05 to 1."""


@dataclass(frozen=True)
class Coulomb:
    """|λ_t| ≤ μ λ_n; slip opposes λ_t, and sticking points have a tangential stiffness.

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
        c_t; ``inf`` is rigid sticking.

    Raises
    ------
    ModelError
        If a number is not in its range.
    """

    normal: Law
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
        """Number of components: the normal and two tangential ones."""
        return 3

    @property
    def penalty(self) -> float:
        """Contact stiffness of the normal component."""
        return self.normal.penalty

    @property
    def yields(self) -> bool:
        """Whether the normal law yields and c_t is finite."""
        return self.normal.yields and np.isfinite(self.tangential_penalty).item()

    @property
    def stiffness(self) -> float:
        """Stiffness of the normal law."""
        return self.normal.stiffness

    @property
    def proportional(self) -> bool:
        """Whether the normal law is proportional; the tangential one always is."""
        return self.normal.proportional

    @property
    def remembers(self) -> bool:
        """Whether the normal law remembers; slip is part of the displacements."""
        return self.normal.remembers

    def with_normal(self, normal: Law) -> "Coulomb":
        """Return Coulomb's law with the same μ on another normal law."""
        return replace(self, normal=normal)

    def friction_or(self, given: float) -> float:  # noqa: ARG002
        """Return μ."""
        return self.friction

    def with_coefficient(self, friction: float) -> "Coulomb":
        """Return the law with another μ."""
        return replace(self, friction=friction)

    def after(self, deepest: Vector) -> "Coulomb":
        """Return friction on the normal law of points with these largest closures so far."""
        return replace(self, normal=self.normal.after(deepest))

    def closure(self, forces: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return closures (of the normal law, and λ_t / (c_t w)) and their slopes by force."""
        closed, compliance = self.normal.closure(forces[:1], weights)
        shear = np.broadcast_to(1.0 / (self.tangential_penalty * weights), (2, len(weights)))
        return np.vstack([closed, shear * forces[1:]]), np.vstack([compliance, shear])

    def energy(self, forces: Matrix, weights: Vector) -> Vector:
        """Return the energy of the normal law and ½ |λ_t|²/(c_t w)."""
        sheared = (forces[1:] ** 2).sum(axis=0) / (2 * self.tangential_penalty * weights)
        return np.asarray(self.normal.energy(forces[:1], weights) + sheared)

    def admissible(self, forces: Matrix) -> Matrix:
        """Return ⟨λ_n⟩ and the tangential force limited to μ ⟨λ_n⟩."""
        normal, size, limit = self._limits(forces)
        cut = np.minimum(1.0, limit / np.where(size > 0, size, 1.0))
        return np.stack([normal, cut * forces[1], cut * forces[2]])

    def derivative(self, forces: Matrix) -> Matrix:
        """Return the derivative of the projection (n_point, 3, 3), unsymmetric where a point slips.

        With n = λ_t/|λ_t|: I where a point sticks. Where it slips, (μ λ_n/|λ_t|)(I − n nᵀ) by λ_t
        and μ n by λ_n.
        """
        normal, size, limit = self._limits(forces)
        closed = normal > 0
        # A point without tangential stiffness slips, even without tangential force.
        slips = (size > limit) | (limit <= 0)
        over = 1.0 / np.where(size > 0, size, 1.0)
        first, second = forces[1] * over, forces[2] * over
        cut = np.where(slips, limit * over, 1.0)
        turned = cut * slips
        result = np.zeros((forces.shape[1], 3, 3))
        result[:, 0, 0] = closed
        result[:, 1, 1] = cut - turned * first * first
        result[:, 2, 2] = cut - turned * second * second
        result[:, 1, 2] = result[:, 2, 1] = -turned * first * second
        pulled = self.friction * (closed & slips)
        result[:, 1, 0], result[:, 2, 0] = pulled * first, pulled * second
        return result

    def springs(self, weights: Vector) -> Matrix:
        """Return the springs of the normal law, and w c_t (3, n_point)."""
        shear = np.broadcast_to(self.tangential_penalty * weights, (2, len(weights)))
        return np.vstack([self.normal.springs(weights), shear])

    def respond(self, moved: Matrix, weights: Vector) -> tuple[Matrix, Matrix]:
        """Return λ_n of the normal law and −w c_t moved_t limited to μ λ_n, with the stiffness.

        The stiffness is consistent with the limit (radial return; J. C. Simo, T. J. R. Hughes,
        Computational Inelasticity, 1998, §3.3), and unsymmetric where a point slips.

        Raises
        ------
        ModelError
            If the law does not yield.
        """
        if not self.yields:
            message = "forces of rigid sticking do not follow from displacements; give a penalty"
            raise ModelError(message)
        pressed, normal = self.normal.respond(moved[:1], weights)
        shear = self.tangential_penalty * weights
        trial = -shear * moved[1:]
        size = np.hypot(trial[0], trial[1])
        limit = self.friction * pressed[0]
        # Curves may press before surfaces meet; at first touch without pressure, c_t counts.
        touching = (limit > 0) | ((moved[0] <= 0) & (self.friction > 0))
        slips = (size > limit) | ~touching
        over = 1.0 / np.where(size > 0, size, 1.0)
        first, second = trial * over
        cut = np.where(slips, limit * over, 1.0)
        turned = shear * cut
        bent = turned * slips
        stiffness = np.zeros((len(weights), 3, 3))
        stiffness[:, 0, 0] = normal[:, 0, 0]
        stiffness[:, 1, 1] = turned - bent * first * first
        stiffness[:, 2, 2] = turned - bent * second * second
        stiffness[:, 1, 2] = stiffness[:, 2, 1] = -bent * first * second
        pulled = self.friction * slips * normal[:, 0, 0]
        stiffness[:, 1, 0], stiffness[:, 2, 0] = pulled * first, pulled * second
        return np.concatenate([pressed, cut * trial]), stiffness

    def _limits(self, forces: Matrix) -> tuple[Vector, Vector, Vector]:
        """Return ⟨λ_n⟩, |λ_t| and the limit of |λ_t|."""
        normal = np.maximum(forces[0], 0.0)
        return normal, np.hypot(forces[1], forces[2]), self.friction * normal


def automatic_tangential_penalty(penalty: float, poissons_ratio: float) -> float:
    """Return c_t = c_n · 2 (1 − ν)/(2 − ν), Mindlin's ratio of tangential to normal stiffness.

    R. D. Mindlin, Compliance of elastic bodies in contact, J. Appl. Mech. 16 (1949) 259.
    """
    return penalty * 2 * (1 - poissons_ratio) / (2 - poissons_ratio)
