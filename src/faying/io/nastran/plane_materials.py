"""MAT1, MAT2, MAT8 as layers of shells: plane stress and transverse shear."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card
from faying.io.nastran.layers import materials_of_shells, named_materials
from faying.model.assembly import Material
from faying.model.shells import plane_stress


@dataclass(frozen=True, eq=False, kw_only=True)
class PlaneMaterial:
    """A layer in its own axes.

    Attributes
    ----------
    law : (3, 3) [force/length²]
        Plane stresses per strains (εxx, εyy, γxy).
    shear : (2, 2) [force/length²]
        Transverse shear stresses per strains; None is rigid.
    density : [mass/length³]
    """

    law: Matrix
    shear: Matrix | None
    density: float


def read_plane_materials(
    bulk: BulkData, materials: Mapping[int, Material], factors: Mapping[int, float]
) -> dict[int, PlaneMaterial]:
    """Return the materials of shells by id.

    Factors are those of the transverse shear, as
    :func:`faying.io.nastran.materials.read_materials`.
    """
    by_number = {
        number: PlaneMaterial(
            law=plane_stress(material.youngs_modulus, material.poissons_ratio),
            shear=factors.get(number, 1.0) * material.shear_modulus * np.eye(2),
            density=material.density,
        )
        for number, material in materials.items()
    }
    named = materials_of_shells(bulk.cards)
    for name, read in (("MAT2", _anisotropic), ("MAT8", _orthotropic)):
        for number, card in named_materials(bulk, name, named, by_number):
            by_number[number] = read(card, bulk.mass_factor)
    return by_number


def _anisotropic(card: Card, mass_factor: float) -> PlaneMaterial:
    g11, g12, g13, g22, g23, g33 = (card.real(j, 0.0) for j in range(1, 7))
    law = np.array([[g11, g12, g13], [g12, g22, g23], [g13, g23, g33]])
    # Where it stands for transverse shear, G33 is blank and the rest is a matrix of two rows.
    return PlaneMaterial(law=law, shear=law[:2, :2], density=card.real(7, 0.0) * mass_factor)


def _orthotropic(card: Card, mass_factor: float) -> PlaneMaterial:
    first, second, ratio = card.real(1), card.real(2), card.real(3)
    in_plane = card.real(4, 0.0)
    sideways = [card.real(5, 0.0), card.real(6, 0.0)]
    minor_ratio = ratio * second / first
    if not abs(ratio * minor_ratio) < 1:
        card.refuse(
            f"E1 = {first:g}, E2 = {second:g}, NU12 = {ratio:g} is no stable material; correct it"
        )
    scale = 1 / (1 - ratio * minor_ratio)
    law = np.diag([scale * first, scale * second, in_plane])
    law[0, 1] = law[1, 0] = scale * ratio * second
    return PlaneMaterial(
        law=law,
        shear=np.diag(sideways) if min(sideways) > 0 else None,
        density=card.real(7, 0.0) * mass_factor,
    )
