"""Shells: blocks of elements and their sections."""

from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Frozen, Indices, Mask, Matrix, Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class ShellSection(Frozen):
    """Stiffness and mass of a shell per reference area, in the axes of its material.

    Attributes
    ----------
    stiffness : (6, 6) [force/length], [force], [force·length]
        Forces (Nxx, Nyy, Nxy) and moments (Mxx, Myy, Mxy) per length for the strains
        (εxx, εyy, γxy) and curvatures (κxx, κyy, 2 κxy); membrane, coupling and bending blocks.
    shear : (2, 2) [force/length]
        Transverse shear forces for shear strains (γxz, γyz); None is rigid in shear.
    mass : [mass/length²]
    inertia : [mass]
        Rotary inertia about axes in the surface, ∫ ρ z² dz.
    materials
        Names of its materials.
    """

    stiffness: Matrix
    shear: Matrix | None
    mass: float
    inertia: float = 0.0
    materials: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class ShellBlock(Frozen):
    """Shell elements of one kind; a section may serve several blocks.

    Attributes
    ----------
    kind
        ``"tri3"``, ``"quad4"``, ``"tri6"``, ``"quad8"``: corners, then mid-sides, in a cycle; the
        normal follows the right-hand rule. ``"panel4"`` carries shear along its sides alone.
    nodes : (n_shell, n_node_per_shell)
    ids, properties : (n_shell,)
        Property ids name the section through ``Assembly.shell_sections``.
    offsets : (n_shell,) [length]
        From the nodes to the reference surface along the normal.
    directions : (n_shell, 3)
        Vectors whose projections on the surface are the material's x axes; zero for an x axis
        along the first side.
    """

    kind: str
    nodes: Indices
    ids: Indices
    properties: Indices
    offsets: Vector
    directions: Matrix

    def taken(self, which: Indices | Mask) -> "ShellBlock":
        """Return some of the elements."""
        names = ("nodes", "ids", "properties", "offsets", "directions")
        return replace(self, **{name: getattr(self, name)[which] for name in names})


def plane_stress(youngs_modulus: float, poissons_ratio: float) -> Matrix:
    """Return the isotropic law of plane stress (3, 3) [force/length²]."""
    nu = poissons_ratio
    law = np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, (1 - nu) / 2]])
    return np.asarray(youngs_modulus / (1 - nu**2) * law)


def turned_law(law: Matrix, angle: Vector) -> Matrix:
    """Return laws (n, 3, 3) of plane strains in axes behind the material's by angles (n,) [rad]."""
    T = strain_rotation(angle)
    return np.asarray(T.swapaxes(-1, -2) @ law @ T)


def strain_rotation(angle: Vector) -> Matrix:
    """Return the map of strains (εxx, εyy, γxy) to axes turned by an angle (n, 3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    rows = [
        [c * c, s * s, c * s],
        [s * s, c * c, -c * s],
        [-2 * c * s, 2 * c * s, c * c - s * s],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))
