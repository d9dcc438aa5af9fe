"""Specifications in a study or a deck: interfaces, bolts, boundaries, gaps."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from faying.contact.laws import Curve

Selection = str | int | Sequence[int]
"""A set name (node, element, face or property set), an element or property id, or several ids."""


@dataclass(frozen=True, kw_only=True)
class InterfaceSpec:
    """Specification of the contact between two bodies.

    Attributes
    ----------
    minus, plus
        The two sides; ``"auto"`` on both finds all coincident facets of different bodies.
    meshes
        ``"matching"`` facets touch node on node (zero-thickness elements); ``"non-matching"`` ones
        are coupled by mortar projection, with the contact points on the minus side.
    quadrature
        ``"gauss"`` or ``"nodal"``; None is Gauss for penalty contact and nodal for hard contact.
    order
        Gauss points per direction (quadrilaterals) or degree of exactness (triangles); None is
        the rule that integrates the pressure of the facet's own shape functions.
    penalty
        Contact stiffness [force/length³], ``"auto"`` (10 E/h of the adjoining elements) or
        ``"hard"``.
    closure
        Curve of pressure over closure in place of a penalty, as
        :class:`faying.contact.laws.ExponentialClosure`.
    friction
        Coulomb's coefficient μ; 0 is frictionless.
    tangential_penalty
        Tangential stiffness c_t [force/length³] of sticking points; ``"auto"`` is Mindlin's ratio
        times the contact stiffness, c_n 2 (1 − ν)/(2 − ν), with the ``stiffness`` of a curve.
    tolerance
        Largest distance [length] between touching nodes, for non-matching meshes between the
        surfaces; None is 1 % of the smallest facet edge.
    search_distance
        Largest gap [length] across which facing facets are paired, ``inf`` for any; None pairs
        touching facets only. Contact surfaces declared in a deck have one.
    gap
        Initial gap of a deck; None is the gap of the mesh.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=5.0)
    >>> hard = fy.InterfaceSpec(name="joint", penalty="hard")
    >>> again = fy.build_model(joint.assembly, interfaces=[hard])
    >>> again.contact.laws
    {'joint': Hard()}
    """

    name: str
    minus: Selection = "auto"
    plus: Selection = "auto"
    meshes: Literal["matching", "non-matching"] = "matching"
    quadrature: Literal["gauss", "nodal"] | None = None
    order: int | None = None
    penalty: float | Literal["auto", "hard"] = "auto"
    closure: Curve | None = None
    friction: float = 0.0
    tangential_penalty: float | Literal["auto"] = "auto"
    tolerance: float | None = None
    search_distance: float | None = None
    gap: "GapRule | None" = None


@dataclass(frozen=True, kw_only=True)
class BoltSpec:
    """A bolt to be tightened: elements of a deck, a generated beam, or a part of given K.

    Attributes
    ----------
    elements
        Ids of the deck's beam (or axial spring) elements that form the bolt.
    nodes
        Node ids (head, nut) of the two ends of a bolt, or of a cut in it, contained in the given
        stiffness matrix.
    stiffness : [force/length]
        Axial stiffness EA/L between these nodes, contained in K.
    direction
        From the nut to the head, (x, y, z) of any length; needed where the nodes coincide.
    axis
        Centres ((x, y, z), (x, y, z)) of the two bearing surfaces of a generated bolt.
    diameter, washer_radius : [length]
    washer
        ``"rbe2"`` (rigid) or ``"rbe3"`` (average) coupling of the nodes under the washer.
    material
        Property id or material name of a generated bolt; None is the solids' first material.
    shear_flexible
        Timoshenko (True) or Euler-Bernoulli beam.
    mass
        Whether the generated beam has mass.
    end_masses : [mass]
        Masses of head and washer at the start of the axis, and of nut and washer at its end.

    Examples
    --------
    >>> import faying as fy
    >>> fy.BoltSpec(
    ...     name="M8", axis=((0, 0, -8), (0, 0, 8)), diameter=8.0, washer_radius=6.75
    ... ).washer
    'rbe2'
    """

    name: str
    elements: Sequence[int] | None = None
    nodes: tuple[int, int] | None = None
    stiffness: float | None = None
    direction: tuple[float, float, float] | None = None
    axis: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    diameter: float | None = None
    washer_radius: float | None = None
    washer: Literal["rbe2", "rbe3"] = "rbe2"
    material: int | str | None = None
    shear_flexible: bool = True
    mass: bool = True
    end_masses: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class BoundarySpec:
    """Specification of a boundary for loads: one node id or a node set.

    Attributes
    ----------
    coupling
        ``"rbe2"``: the set's nodes follow a new node rigidly; ``"rbe3"``: it moves as their
        average. Loads then enter at that node, with six components.
    at
        Position (x, y, z) of the new node [length]; by default the mean of the set's nodes.

    Examples
    --------
    >>> import faying as fy
    >>> fy.BoundarySpec(name="tip", set="tip face", coupling="rbe3").coupling
    'rbe3'
    """

    name: str
    node: int | None = None
    set: str | None = None
    coupling: Literal["rbe2", "rbe3"] | None = None
    at: tuple[float, float, float] | None = None


@dataclass(frozen=True, kw_only=True)
class Rayleigh:
    """C = alpha M + beta K, alpha [1/time], beta [time].

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=5.0, damping=fy.Rayleigh(beta=1e-6))
    >>> bool(abs(joint.C - 1e-6 * joint.K).max() == 0.0)
    True
    """

    alpha: float = 0.0
    beta: float = 0.0


@dataclass(frozen=True, kw_only=True)
class GapRule:
    """Rule of a deck for the initial gap of an interface.

    Attributes
    ----------
    value : [length]
        The gap everywhere, independent of the mesh; None is the gap of the mesh.
    closed_up_to : [length]
        Largest gap of minus nodes that start in contact without strain, as if moved onto the plus
        side: 0 for those that penetrate, ``inf`` for all.
    closed_nodes
        Ids of minus nodes that start in contact at any gap.
    offset : [length]
        Added to the gap of the mesh.
    """

    value: float | None = None
    closed_up_to: float = -np.inf
    closed_nodes: tuple[int, ...] = ()
    offset: float = 0.0
