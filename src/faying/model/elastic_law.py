"""Anisotropic elastic laws: stiffness of six strains, and its tensor.

The order is that of Nastran's MAT9: xx, yy, zz, xy, yz, zx, shear strains as angles γ = 2 ε.
The angle is the work conjugate of its shear stress, so that the 6 x 6 numbers are entries of the
tensor σ_ij = C_ijkl ε_kl without factors.
"""

from collections.abc import Sequence

import numpy as np

from faying._typing import Matrix, Vector
from faying.digits import DECK_DIGITS
from faying.exceptions import refuse_value

Law = tuple[tuple[float, ...], ...]

_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
_PLACE = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])


def tensor(law: Law | Matrix) -> Matrix:
    """Return C_ijkl (3, 3, 3, 3) from a law (6, 6)."""
    matrix = np.asarray(law, dtype=float)
    return np.asarray(matrix[_PLACE[:, :, None, None], _PLACE[None, None]])


def turned(law: Law | Matrix, axes: Matrix) -> Law:
    """Return a law along axes (3, 3), the rows, as a law in the basic frame."""
    basic = np.einsum("pi,qj,rk,sl,pqrs->ijkl", axes, axes, axes, axes, tensor(law), optimize=True)
    rows, columns = np.array(_PAIRS).T
    return as_law(basic[rows[:, None], columns[:, None], rows, columns])


def prevented(law: Law | Matrix, strain: Vector) -> Matrix:
    """Return the stress (3, 3) for a strain (6,) in the order of the law."""
    return np.asarray((np.asarray(law) @ strain)[_PLACE])


def turned_strain(strain: Vector, axes: Matrix) -> Vector:
    """Return a strain along axes (rows) as a strain (6,) in the basic frame."""
    halves = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
    rows, columns = np.array(_PAIRS).T
    basic = axes.T @ (strain * halves)[_PLACE] @ axes
    return np.asarray(basic[rows, columns] / halves)


def as_law(values: Matrix | Sequence[Sequence[float]]) -> Law:
    """Return a law (6, 6) as nested tuples, which can be compared."""
    # Adding zero turns -0.0 into 0.0.
    return tuple(tuple(row) for row in (np.asarray(values, dtype=float) + 0.0).tolist())


def isotropic_law(youngs_modulus: float, poissons_ratio: float) -> Matrix:
    """Return the law (6, 6) of an isotropic material."""
    shear = youngs_modulus / (2 * (1 + poissons_ratio))
    law = np.diag([2 * shear] * 3 + [shear] * 3)
    law[:3, :3] += 2 * shear * poissons_ratio / (1 - 2 * poissons_ratio)
    return law


def orthotropic_law(moduli: Sequence[float], ratios: Sequence[float], shear: Matrix) -> Matrix:
    """Return the law (6, 6) for engineering constants along its axes.

    Moduli E1, E2, E3 and shear moduli G12, G23, G31 [force/length²]; ratios ν12, ν13, ν23: -ε2/ε1
    under σ1, and so on.
    """
    first, second, third = moduli
    if not min(*moduli, *shear) > 0:
        refuse_value("moduli must be positive")
    compliance = np.diag([1 / first, 1 / second, 1 / third])
    for (i, j), ratio in zip(((0, 1), (0, 2), (1, 2)), ratios, strict=True):
        compliance[i, j] = compliance[j, i] = -ratio / moduli[i]
    if not np.linalg.eigvalsh(compliance * np.sqrt(np.outer(moduli, moduli)))[0] > 0:
        refuse_value("Poisson's ratios are too large for the moduli")
    law = np.diag([0.0, 0.0, 0.0, *shear])
    law[:3, :3] = np.linalg.inv(compliance)
    return law


def stable(law: Law | Matrix) -> bool:
    """Return whether a law (6, 6) is finite, symmetric and positive definite."""
    matrix = np.asarray(law, dtype=float)
    if not np.isfinite(matrix).all() or not (np.diag(matrix) > 0).all():
        return False
    scale = 1 / np.sqrt(np.diag(matrix))
    even = matrix * scale[:, None] * scale
    if np.abs(even - even.T).max() > DECK_DIGITS:
        return False
    return bool(np.linalg.eigvalsh(0.5 * (even + even.T))[0] > 1e-12)


def mean_constants(law: Law | Matrix) -> tuple[float, float]:
    """Return E and ν of the isotropic material nearest to a law: its means over directions (Voigt).

    W. Voigt, Lehrbuch der Kristallphysik, 1928, § 479: bulk and shear moduli are those of the
    tensor's two invariants that are linear in it.
    """
    matrix = np.asarray(law, dtype=float)
    straight, crossed = np.trace(matrix[:3, :3]), matrix[0, 1] + matrix[0, 2] + matrix[1, 2]
    bulk = (straight + 2 * crossed) / 9
    shear = (straight - crossed + 3 * np.trace(matrix[3:, 3:])) / 15
    return float(9 * bulk * shear / (3 * bulk + shear)), float(
        (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear))
    )
