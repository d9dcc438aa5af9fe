"""Contact stiffness from the adjoining elements, and Coulomb friction with it."""

from typing import Literal, TypeAlias

import numpy as np

from faying.contact.laws import Coulomb, Law
from faying.contact.laws.coulomb import automatic_tangential_penalty
from faying.exceptions import ModelError, refuse_model
from faying.interface.hidden_facets import facet_depths
from faying.interface.interface import FacePairs
from faying.model.assembly import Assembly
from faying.model.surface import Facets, padded

PENALTY_FACTOR = 10.0
"""Automatic penalty over E/h: the interface is then ten times stiffer than one element layer."""


def automatic_penalty(assembly: Assembly, faces: tuple[FacePairs, ...]) -> float:
    """Return c_n = 10 E/h [force/length³] from the elements adjoining an interface.

    E is the smallest Young's modulus among them, h their mean extent normal to their facet. For the
    effect on pressures see ``docs/how-to/choose_the_mesh.md``. Faces come from
    :func:`faying.interface.pairing.pair_facets`.

    Raises
    ------
    ModelError
        If the facets belong to no solid elements (a model given as matrices) or a property has no
        material: the penalty must then be a number.
    """
    return facet_penalty(assembly, _owners(assembly, faces))


def facet_penalty(assembly: Assembly, facets: Facets) -> float:
    """Return 10 E/h [force/length³] from the elements of facets of both sides.

    Facets of shells count only where neither side has solids.
    """
    if (facets.properties >= 0).any():
        facets = facets.taken(facets.properties >= 0)
    missing = np.setdiff1d(facets.properties, np.fromiter(assembly.materials, np.int64))
    if missing.size or not len(facets):
        what = (
            "its facets belong to no solid elements"
            if not len(facets) or missing[0] < 0
            else f"property {missing[0]} has no material"
        )
        refuse_model(
            f"penalty = 'auto' needs the elements at the interface, but {what}; give the penalty "
            "as a number [force/length³] (10 E/h is a good start, h the element size)"
        )
    used = np.unique(facets.properties).tolist()
    modulus = min(assembly.materials[number].youngs_modulus for number in used)
    return PENALTY_FACTOR * modulus / float(facet_depths(assembly.mesh, facets).mean())


def _owners(assembly: Assembly, faces: tuple[FacePairs, ...]) -> Facets:
    """Return the exterior facets that form the two sides."""
    nodes = np.concatenate([padded(side) for f in faces for side in (f.minus, f.plus)])
    position = assembly.mesh.exterior.positions(nodes)
    return assembly.mesh.exterior.taken(position[position >= 0])


TangentialPenalty: TypeAlias = float | Literal["auto"]
"""c_t [force/length³], or the value from the materials."""


def with_friction(
    normal: Law,
    friction: float,
    tangential_penalty: TangentialPenalty,
    assembly: Assembly,
) -> Law:
    """Return a normal law with Coulomb friction, or the normal law if the coefficient is zero.

    The tangential penalty c_t [force/length³] ``"auto"`` is c_n 2 (1 − ν)/(2 − ν) with the smallest
    ν of the assembly's materials, and infinite where normal contact is hard. For a curve c_n is its
    ``stiffness``, the slope at its reference pressure, since Mindlin's ratio relates slopes at one
    pressure.

    Raises
    ------
    ModelError
        If a number is out of range, or ``"auto"`` finds no material.
    """
    coefficient = _number(friction, "the coefficient of friction", "a number")
    if coefficient == 0:
        return normal
    if tangential_penalty == "auto":
        return Coulomb(normal, coefficient, _automatic_shear_stiffness(normal.stiffness, assembly))
    expected = "a positive number [force/length³] or 'auto'"
    return Coulomb(
        normal, coefficient, _number(tangential_penalty, "the tangential penalty", expected)
    )


def _number(value: object, what: str, expected: str) -> float:
    """Return a value as a number; refuse others."""
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        message = f"{what} is {value!r}; give {expected}"
        raise ModelError(message) from None


def _automatic_shear_stiffness(penalty: float, assembly: Assembly) -> float:
    ratios = [material.poissons_ratio for material in assembly.materials.values()]
    if not ratios:
        refuse_model(
            "tangential_penalty = 'auto' needs materials, and the model has none; give the "
            "penalty as a number [force/length³] (0.8 times the normal one is usual)"
        )
    return automatic_tangential_penalty(penalty, min(ratios))
