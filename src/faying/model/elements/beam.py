"""Two-node Timoshenko beams: stiffness and consistent mass with rotary inertia.

The interpolation is exact for end loads (cubic deflection and quadratic rotation coupled by the
shear parameter Φ), hence the stiffness is exact and Φ = 0 is the Euler-Bernoulli beam:
Z. Friedman, J. B. Kosmatka, "An improved two-node Timoshenko beam finite element", Computers &
Structures 47 (1993) 473-481.

The local x axis runs from the first to the second node; the orientation vector lies in the local
x-y plane (CBAR, CBEAM, B31).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from faying._typing import Matrix, Vector
from faying.exceptions import refuse_model
from faying.model.assembly import Beam

# Local dofs (deflection, rotation, deflection, rotation) of the two bending planes and the sign of
# the rotation: it is +dv/dx about z, but -dw/dx about y.
_PLANE_XY = ((1, 5, 7, 11), (1.0, 1.0, 1.0, 1.0))
_PLANE_XZ = ((2, 4, 8, 10), (1.0, -1.0, 1.0, -1.0))
_AXIAL = (0, 6)
_TORSION = (3, 9)

# Mass of a deflection that is linear between the ends, without rotations.
_STRAIGHT = np.kron([[2.0, 1.0], [1.0, 2.0]], [[1.0, 0.0], [0.0, 0.0]]) / 6


class BeamProperties(NamedTuple):
    """Sections and materials of a batch of beams, each (n_beam,)."""

    length: Vector
    youngs: Vector
    shear: Vector
    density: Vector
    area: Vector
    inertia_y: Vector
    inertia_z: Vector
    torsion: Vector
    factor_y: Vector
    factor_z: Vector
    axial_factor: Vector


def beam_matrices(beams: Sequence[Beam], nodes: Matrix) -> tuple[Matrix, Matrix]:
    """Return mass and stiffness (n_beam, 12, 12) of beams in the basic frame.

    Nodes (n_node, 3) [length] are all nodes of the mesh. Order: six degrees of freedom of the
    first node, then of the second.

    Raises
    ------
    ModelError
        If a beam has no length or its orientation is parallel to it; the message names the beam.
    """
    ends = np.array([beam.nodes for beam in beams], dtype=np.int64).reshape(-1, 2)
    frames, length = beam_frames(beams, nodes[ends[:, 1]] - nodes[ends[:, 0]])
    properties = beam_properties(beams, length)
    rotation = np.zeros((len(beams), 12, 12))
    for start in range(0, 12, 3):
        rotation[:, start : start + 3, start : start + 3] = frames
    transposed = rotation.transpose(0, 2, 1)
    mass: Matrix = transposed @ _local_mass(properties) @ rotation
    stiffness: Matrix = transposed @ local_stiffness(properties) @ rotation
    return _symmetric(mass), _symmetric(stiffness)


def beam_frames(beams: Sequence[Beam], axes: Matrix) -> tuple[Matrix, Vector]:
    """Return local frames (n_beam, 3, 3), rows x, y, z, and lengths (n_beam,).

    Axes (n_beam, 3) [length] go from the first to the second node.
    """
    orientation = np.array([beam.orientation for beam in beams], dtype=float).reshape(-1, 3)
    length: Vector = np.linalg.norm(axes, axis=1)
    for index in np.flatnonzero(~(length > 0))[:1]:
        refuse_model(f"beam {beams[index].id}: its two nodes coincide; give it a length")
    x = axes / length[:, None]
    normal = np.cross(x, orientation)
    size = np.linalg.norm(normal, axis=1)
    # Below an angle of 1e-8 rad the direction of local z has no significant digit.
    parallel = ~(size > 1e-8 * np.linalg.norm(orientation, axis=1))
    for index in np.flatnonzero(parallel)[:1]:
        refuse_model(
            f"beam {beams[index].id}: the orientation vector {beams[index].orientation} is zero or "
            "parallel to the beam; give one that points sideways"
        )
    z = normal / size[:, None]
    return np.stack([x, np.cross(z, x), z], axis=1), length


def beam_properties(beams: Sequence[Beam], length: Vector) -> BeamProperties:
    """Return sections and materials of beams as columns."""
    rows = [
        (
            beam.material.youngs_modulus,
            beam.material.shear_modulus,
            beam.material.density,
            beam.section.area,
            beam.section.inertia_y,
            beam.section.inertia_z,
            beam.section.torsion,
            beam.section.shear_factor_y,
            beam.section.shear_factor_z,
            beam.section.axial_factor,
        )
        for beam in beams
    ]
    return BeamProperties(length, *np.array(rows, dtype=float).reshape(-1, 10).T)


def local_stiffness(beam: BeamProperties) -> Matrix:
    """Return the stiffness (n_beam, 12, 12) of beams in their local frames."""
    result = np.zeros((len(beam.length), 12, 12))
    bar = np.array([[1.0, -1.0], [-1.0, 1.0]])
    axial = beam.axial_factor * beam.youngs * beam.area / beam.length
    twist = beam.shear * beam.torsion / beam.length
    _put(result, _AXIAL, axial[:, None, None] * bar)
    _put(result, _TORSION, twist[:, None, None] * bar)
    for (dofs, signs), inertia, phi in bending_planes(beam):
        block = _bending_stiffness(beam.youngs * inertia, beam.length, phi)
        _put(result, dofs, block * np.outer(signs, signs))
    return result


def _local_mass(beam: BeamProperties) -> Matrix:
    result = np.zeros((len(beam.length), 12, 12))
    bar = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    line = beam.density * beam.area
    polar = beam.density * (beam.inertia_y + beam.inertia_z)
    _put(result, _AXIAL, (line * beam.length)[:, None, None] * bar)
    _put(result, _TORSION, (polar * beam.length)[:, None, None] * bar)
    for (dofs, signs), inertia, phi in bending_planes(beam):
        block = _bending_mass(line, beam.density * inertia, beam.length, phi)
        # A rod, without bending stiffness, has no slope for the deflection to follow.
        straight = (line * beam.length)[:, None, None] * _STRAIGHT
        block = np.where((inertia > 0)[:, None, None], block, straight)
        _put(result, dofs, block * np.outer(signs, signs))
    return result


def _put(matrices: Matrix, dofs: tuple[int, ...], block: Matrix) -> None:
    square = np.array(dofs)
    matrices[:, square[:, None], square] = block


def bending_planes(
    beam: BeamProperties,
) -> tuple[tuple[tuple[tuple[int, ...], tuple[float, ...]], Vector, Vector], ...]:
    """Return dofs and signs, second moment and shear parameter Φ = 12 EI / (κ A G L²) per plane."""
    shear = 12 * beam.youngs / (beam.shear * beam.length**2)
    in_xy, in_xz = beam.inertia_z, beam.inertia_y
    return (
        (_PLANE_XY, in_xy, shear * _per_area(in_xy, beam.area, beam.factor_y)),
        (_PLANE_XZ, in_xz, shear * _per_area(in_xz, beam.area, beam.factor_z)),
    )


def _per_area(inertia: Vector, area: Vector, factor: Vector) -> Vector:
    """Return I / (κ A), zero for a beam rigid in shear or without bending stiffness."""
    flexible = np.isfinite(factor) & (inertia > 0)
    return np.divide(inertia, factor * area, out=np.zeros_like(inertia), where=flexible)


def _bending_stiffness(rigidity: Vector, length: Vector, phi: Vector) -> Matrix:
    scale = rigidity / ((1 + phi) * length**3)
    slope, same_end, other_end = 6 * length, (4 + phi) * length**2, (2 - phi) * length**2
    twelve = np.full_like(length, 12.0)
    rows = [
        [twelve, slope, -twelve, slope],
        [slope, same_end, -slope, other_end],
        [-twelve, -slope, twelve, -slope],
        [slope, other_end, -slope, same_end],
    ]
    return np.array(rows).transpose(2, 0, 1) * scale[:, None, None]


def _bending_mass(line: Vector, rotary: Vector, length: Vector, phi: Vector) -> Matrix:
    """Return ∫ ρA Nᵀ N + ρI Θᵀ Θ dx, with N and Θ as polynomials in ξ = x/L."""
    deflection, rotation = bending_shapes(length, phi)
    return length[:, None, None] * (
        line[:, None, None] * _gram(deflection) + rotary[:, None, None] * _gram(rotation)
    )


def bending_shapes(length: Vector, phi: Vector) -> tuple[Matrix, Matrix]:
    """Return deflection (n_beam, 4, 4) and rotation (n_beam, 4, 3) for unit motions of the ends.

    Coefficients of 1, ξ, ξ², ξ³; rows: deflection and rotation of the first, then the second end.
    """
    zero, unity = np.zeros_like(phi), np.ones_like(phi)
    half = phi / 2
    deflection = np.array(
        [
            [unity + phi, -phi, -3 * unity, 2 * unity],
            [zero, length * (1 + half), -length * (2 + half), length],
            [zero, phi, 3 * unity, -2 * unity],
            [zero, -length * half, -length * (1 - half), length],
        ]
    ).transpose(2, 0, 1)
    rotation = np.array(
        [
            [zero, -6 / length, 6 / length],
            [unity + phi, -(4 + phi), 3 * unity],
            [zero, 6 / length, -6 / length],
            [zero, -(2 - phi), 3 * unity],
        ]
    ).transpose(2, 0, 1)
    scale = 1 / (1 + phi)[:, None, None]
    return scale * deflection, scale * rotation


def _gram(polynomials: Matrix) -> Matrix:
    """Return ∫₀¹ P Pᵀ dξ of polynomials (n_beam, 4, n_power), from ∫ ξᵃ ξᵇ = 1 / (a + b + 1)."""
    power = np.arange(polynomials.shape[-1])
    moments = 1.0 / (power[:, None] + power[None, :] + 1)
    return np.asarray(polynomials @ moments @ polynomials.transpose(0, 2, 1))


def _symmetric(matrices: Matrix) -> Matrix:
    return np.asarray(0.5 * (matrices + matrices.transpose(0, 2, 1)))
