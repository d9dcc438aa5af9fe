"""PSHELL, PCOMP, PCOMPG, PSHEAR: sections of shells."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from faying._typing import Matrix
from faying.digits import SHORT_DIGITS, SOLVED
from faying.io.nastran.cards import Card, by_id
from faying.io.nastran.grids import BulkData
from faying.io.nastran.materials import SHELL_PROPERTIES, Layer, PlaneMaterial, layers
from faying.model.shells import ShellSection, turned_law

LAMINATE = (
    "laminates (PCOMP) are equivalent plates: stresses of layers are not computed, and transverse "
    "shear has one stiffness per direction"
)

_MATERIALS = "MAT1, MAT2 or MAT8"
# Three Gauss points a layer integrate the square of a parabola exactly.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)


class ShellProperty(NamedTuple):
    """A property of shells: its thickness, and a function from thickness to section."""

    thickness: float
    section: Callable[[float], ShellSection]


def read_shell_properties(
    bulk: BulkData, materials: Mapping[int, PlaneMaterial]
) -> dict[int, ShellProperty]:
    """Read the properties of shells."""
    bulk.ignored.extend(
        LAMINATE for name in SHELL_PROPERTIES if name.startswith("PCOMP") and name in bulk.cards
    )
    return {
        number: _READERS[card.cards.name](card, materials, bulk.mass_factor)
        for number, card in by_id(bulk.cards, *SHELL_PROPERTIES, what="property").items()
    }


def _plate(card: Card, materials: Mapping[int, PlaneMaterial], mass_factor: float) -> ShellProperty:
    """Read PSHELL: membrane MID1, bending MID2, transverse shear MID3, coupling MID4."""
    membrane = _material(card, 1, materials)
    if membrane is None or card.text(3) == "-1":
        card.refuse(
            "a shell without membrane (MID1 blank) or in plane strain (MID2 = -1) is not "
            "supported; give MID1, and MID2 or a blank"
        )
    bending, coupling = _material(card, 3, materials), _material(card, 10, materials)
    sideways = _material(card, 5, materials) if bending is not None else None
    ratio, shear_ratio = card.real(4, 1.0), card.real(6, 5 / 6)
    line_mass = card.real(7, 0.0) * mass_factor
    thickness = card.real(2)
    if sideways is not None and sideways.shear is None:
        sideways = None

    def section(t: float) -> ShellSection:
        law = np.zeros((6, 6))
        law[:3, :3] = t * membrane.law
        if bending is not None:
            law[3:, 3:] = ratio * t**3 / 12 * bending.law
        if coupling is not None:
            law[:3, 3:] = law[3:, :3] = t**2 * coupling.law
        return ShellSection(
            stiffness=law,
            shear=None if sideways is None else shear_ratio * t * np.asarray(sideways.shear),
            mass=membrane.density * t + line_mass,
            inertia=membrane.density * t**3 / 12,
            materials=tuple(card.text(field) for field in (1, 3, 5, 10) if card.text(field)),
        )

    _check(card, section(thickness))
    return ShellProperty(thickness, section)


def _panel(card: Card, materials: Mapping[int, PlaneMaterial], mass_factor: float) -> ShellProperty:
    """Read MID, T, NSM of PSHEAR; F1 and F2 become rods."""
    material, thickness = _material(card, 1, materials), card.real(2)
    extra = card.real(3, 0.0) * mass_factor
    if material is None:
        card.refuse("it needs a material", 1)
    law = np.zeros((6, 6))
    law[:3, :3] = thickness * material.law
    mass = material.density * thickness + extra
    section = ShellSection(stiffness=law, shear=None, mass=mass, materials=(card.text(1),))
    _check(card, section)
    return ShellProperty(thickness, lambda _: section)


def _material(
    card: Card, field: int, materials: Mapping[int, PlaneMaterial]
) -> PlaneMaterial | None:
    number = card.integer(field, 0)
    return None if number <= 0 else card.find(materials, field, "material", _MATERIALS, number)


def _check(card: Card, section: ShellSection) -> None:
    law = section.stiffness
    if not np.isfinite(law).all() or np.linalg.eigvalsh(law[:3, :3])[0] <= 0:
        card.refuse("its membrane has a direction without stiffness; correct its materials")
    # Bending may be zero; but for rounding nothing is negative.
    size = np.sqrt(np.where(np.diag(law) > 0, np.diag(law), 1.0))
    if np.linalg.eigvalsh(law / np.outer(size, size))[0] < -SOLVED:
        card.refuse(
            "its stiffness is not positive: membrane, bending and coupling contradict each other"
        )


def _laminate(
    card: Card, materials: Mapping[int, PlaneMaterial], mass_factor: float
) -> ShellProperty:
    kind = card.text(7)
    if kind not in ("", "SYM", "SMEAR", "MEM"):
        card.refuse(f"LAM = '{kind}' is not supported; give blank, SYM, MEM or SMEAR", 7)
    plies = layers(card)
    thickness = math.fsum(ply.thickness for ply in plies)
    bottom = card.real(1, -thickness / 2)
    section = _stacked(card, plies, materials, bottom, card.real(2, 0.0) * mass_factor)
    _check(card, section)

    def fixed(t: float) -> ShellSection:
        if not math.isclose(t, thickness, rel_tol=SHORT_DIGITS):
            card.refuse(
                "a laminate has the thickness of its layers; leave T1 to T4 of shells blank"
            )
        return section

    return ShellProperty(thickness, fixed)


def _stacked(
    card: Card,
    plies: Sequence[Layer],
    materials: Mapping[int, PlaneMaterial],
    bottom: float,
    extra: float,
) -> ShellSection:
    """Integrate layers through the thickness, from the bottom."""
    t = np.array([ply.thickness for ply in plies])
    ply_materials = [card.find(materials, 8, "material", _MATERIALS, ply.material) for ply in plies]
    angle = np.radians([ply.angle for ply in plies])
    laws = turned_law(np.array([material.law for material in ply_materials]), angle)
    density = np.array([material.density for material in ply_materials])
    high = bottom + np.cumsum(t)
    low = high - t
    middle = (low + high) / 2
    law = np.zeros((6, 6))
    law[:3, :3] = np.einsum("k,kij->ij", t, laws)
    if card.text(7) == "SMEAR":
        law[3:, 3:] = law[:3, :3] * t.sum() ** 2 / 12
    elif card.text(7) != "MEM":
        law[:3, 3:] = law[3:, :3] = np.einsum("k,kij->ij", t * middle, laws)
        law[3:, 3:] = np.einsum("k,kij->ij", (high**3 - low**3) / 3, laws)
    mass = float(density @ t)
    centre = float(density @ (t * middle)) / mass if mass else 0.0
    return ShellSection(
        stiffness=law,
        shear=None if card.text(7) == "MEM" else _shear(ply_materials, laws, angle, t, low),
        mass=mass + extra,
        inertia=float(density @ (t * (middle - centre) ** 2 + t**3 / 12)),
        materials=tuple(dict.fromkeys(str(ply.material) for ply in plies)),
    )


def _shear(
    ply_materials: Sequence[PlaneMaterial], laws: Matrix, angle: Matrix, t: Matrix, low: Matrix
) -> Matrix | None:
    """Return the transverse shear stiffness of cylindrical bending in x and in y.

    The shear stress in equilibrium with bending stresses E (z - z₀) / EI has the same energy as the
    shear force: 1/S = ∫ g² / G dz / (EI)² with g = ∫ E (z - z₀) dz; S = 5/6 G t for one layer.
    J. M. Whitney, "Shear correction factors for orthotropic laminates
    under static load", J. Appl. Mech. 40 (1973) 302-304. Layers without G1Z or G2Z are rigid.
    """
    flexible = np.zeros((len(ply_materials), 2))
    for k, material in enumerate(ply_materials):
        if material.shear is not None:
            c, s = np.cos(angle[k]), np.sin(angle[k])
            turn = np.array([[c, s], [-s, c]])
            flexible[k] = 1 / np.diag(turn.T @ material.shear @ turn)
    if not flexible.any(axis=0).all():
        return None
    stiffness = np.zeros((2, 2))
    middle = low + t / 2
    for axis in (0, 1):
        modulus = laws[:, axis, axis]
        neutral = (modulus * t) @ middle / (modulus @ t)
        arm = middle - neutral
        rigidity = modulus @ (t * arm**2 + t**3 / 12)
        flow = np.concatenate([[0.0], np.cumsum(modulus * t * arm)])[:-1]
        z = (_POINTS[None] + 1) / 2 * t[:, None]
        bottom = (arm - t / 2)[:, None]
        stress = flow[:, None] + modulus[:, None] * (bottom * z + z**2 / 2)
        work = (stress**2 @ _WEIGHTS) * t / 2 @ flexible[:, axis]
        stiffness[axis, axis] = rigidity**2 / work
    return stiffness


_READERS = {"PSHELL": _plate, "PCOMP": _laminate, "PCOMPG": _laminate, "PSHEAR": _panel}
