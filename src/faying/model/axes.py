"""Axes from two directions, and sections of beams that decks know by name."""

import math

import numpy as np

from faying._typing import Matrix, Vector
from faying.digits import SOLVED
from faying.model.assembly import BeamSection


def axes_along(x: Vector, plane: Vector) -> Matrix | None:
    """Return axes (3, 3) as rows: along x, across it towards ``plane``, and the normal of both.

    None where one has zero length, or the angle between them is nearly zero.
    """
    z = np.cross(x, plane)
    with np.errstate(over="ignore", invalid="ignore"):
        lengths = float(np.linalg.norm(x)), float(np.linalg.norm(z))
        size = lengths[0] * float(np.linalg.norm(plane))
    if not (lengths[1] > SOLVED * size and np.isfinite(size)):
        return None
    x, z = x / lengths[0], z / lengths[1]
    return np.stack([x, np.cross(z, x), z])


def any_across(axis: Vector) -> tuple[float, float, float]:
    """Return a direction not parallel to an axis, for members without an orientation."""
    x, y, z = np.eye(3)[int(np.abs(axis).argmin())].tolist()
    return (x, y, z)


def round_section(outer: float, inner: float, poisson: float) -> BeamSection:
    """Return the section of a round bar or pipe, by its radii.

    Shear factors: G. R. Cowper, "The shear coefficient in Timoshenko's beam theory", J. Appl.
    Mech. 33 (1966) 335-340.
    """
    inertia = math.pi / 4 * (outer**4 - inner**4)
    ratio = (1 + (inner / outer) ** 2) ** 2
    thin = (20 + 12 * poisson) * (inner / outer) ** 2
    shear = 6 * (1 + poisson) * ratio / ((7 + 6 * poisson) * ratio + thin)
    return BeamSection(
        area=math.pi * (outer**2 - inner**2),
        inertia_y=inertia,
        inertia_z=inertia,
        torsion=2 * inertia,
        shear_factor_y=shear,
        shear_factor_z=shear,
    )


def rectangular_section(y: float, z: float, torsion: float, poisson: float) -> BeamSection:
    """Return the section of a rectangle by its sizes along y and z; shear factors as Cowper's."""
    shear = 10 * (1 + poisson) / (12 + 11 * poisson)
    return BeamSection(
        area=y * z,
        inertia_z=z * y**3 / 12,
        inertia_y=y * z**3 / 12,
        torsion=torsion,
        shear_factor_y=shear,
        shear_factor_z=shear,
    )
