"""The built-in model: plates lapped and bolted together, clamped at one end, loaded at the other.

Two plates are the bolted cantilever of the seed (Fig. 15.2), three a double lap joint.
"""

from dataclasses import replace
from itertools import pairwise
from typing import Literal

import numpy as np

from faying.model.assembly import Assembly, Material, RigidCoupling, Spring, Support
from faying.model.cells import CellBlock
from faying.model.description import JointDescription
from faying.model.generated_bolt import add_bolt
from faying.model.lap_geometry import PLATE_NAMES, LapGeometry
from faying.model.mesh import Mesh
from faying.model.specs import BoltSpec, BoundarySpec, InterfaceSpec

STEEL = Material(name="steel", youngs_modulus=210_000.0, poissons_ratio=0.29, density=7.82e-9)
"""Material of the seed's cantilever [MPa], [t/mm³]."""


SOFT_SUSPENSION = (10.0, 1e4)
"""Springs [N/mm], [N·mm/rad] at the tip of a double lap joint.

Below a thousandth of the bending stiffness of the default sizes; a hundred times softer ones cost
two digits of the pressure, because rigid motion then outweighs all elastic compliance.
"""


def lap_joint_assembly(
    *,
    element_size: float = 2.5,
    upper_element_size: float | None = None,
    length: float = 110.0,
    width: float = 20.0,
    thickness: float = 10.0,
    overlap: float = 40.0,
    plates: int = 2,
    curvature: float = 0.0,
    shape: Literal["hex8", "hex20", "tet4", "tet10", "wedge6", "wedge15"] = "hex8",
    element: Literal["incompatible", "standard"] = "incompatible",
    material: Material | None = None,
    hole_radius: float | None = 4.2,
    bolt_positions: tuple[tuple[float, float], ...] = ((0.0, 0.0),),
    bolt_diameter: float = 6.0,
    bolt_mass: bool = True,
    shear_flexible: bool = True,
    washer_radius: float = 6.0,
    washer: Literal["rbe2", "rbe3"] = "rbe2",
    penalty: float | Literal["auto", "hard"] = "auto",
    quadrature: Literal["gauss", "nodal"] | None = None,
    order: int | None = None,
    meshes: Literal["matching", "non-matching"] | None = None,
    tip_suspension: tuple[float, float] | None = None,
) -> JointDescription:
    """Describe a bolted lap joint; the default is the seed's cantilever (mm, t, s, MPa).

    The joint spans x from -length/2 (clamped) to length/2 (tip), y across the width, and is
    stacked in z about 0. The first and third plate reach from the clamp to x = overlap/2, the
    second from x = -overlap/2 to the tip. The tip's end face is tied rigidly to one node, the
    boundary ``"tip"``.

    Parameters
    ----------
    element_size
        Edge of the bricks; numbers of bricks are rounded so that the overlap's edges are grid
        lines and the plates match.
    upper_element_size
        Another edge for the bricks of the plate on top, whose mesh then does not match.
    length, width, thickness, overlap
        Whole length, width, thickness of each plate, length of the overlap.
    plates
        2: ``"lower"`` and ``"upper"`` meet at the interface ``"joint"``. 3: ``"lower"``,
        ``"middle"`` and ``"upper"`` meet at ``"joint-1"`` and ``"joint-2"``.
    curvature
        Bends the joint to an arch [1/length]: every node sinks by ½ κ x². Interfaces are then
        curved but still match, and volumes are those of the straight joint.
    shape
        Kind of solid elements the bricks are turned into.
    element
        Formulation of hex8.
    material
        Of the plates and bolts; None is the seed's steel.
    hole_radius
        Bricks whose centroid lies within this distance of a bolt's axis are left out; None or 0
        is no hole.
    bolt_positions
        (x, y) of the axes. One bolt is called ``"bolt"``, several ``"bolt-1"``, ``"bolt-2"``, …
    bolt_diameter, bolt_mass, shear_flexible, washer_radius, washer
        See :class:`faying.model.specs.BoltSpec`.
    penalty, quadrature, order
        See :class:`faying.model.specs.InterfaceSpec`.
    meshes
        The same; None is ``"non-matching"`` where ``upper_element_size`` is given.
    tip_suspension
        Springs from the tip to ground, each translation [force/length] and each rotation
        [moment/rad]. None is no spring for two plates, and :data:`SOFT_SUSPENSION` for three:
        nothing but contact holds a middle plate between two others, and a linear model needs it
        held before contact closes.

    Returns
    -------
    JointDescription
        Plates are properties 1, 2 (, 3) and element sets of their names; node sets ``"clamp"``
        and ``"tip-face"``. The bolts' specs name the beams already in the assembly.

    Raises
    ------
    ModelError
        If a measure is not positive, the overlap is too long, or a washer holds no node.
    """
    geometry = LapGeometry(
        element_size=element_size,
        length=length,
        width=width,
        thickness=thickness,
        overlap=overlap,
        hole_radius=hole_radius or 0.0,
        bolt_positions=tuple(bolt_positions),
        plates=plates,
        curvature=curvature,
        shape=shape,
        upper_element_size=element_size if upper_element_size is None else upper_element_size,
    )
    template = BoltSpec(
        name="bolt",
        diameter=bolt_diameter,
        washer_radius=washer_radius,
        washer=washer,
        shear_flexible=shear_flexible,
        mass=bolt_mass,
    )
    ends = _with_ends(geometry, _plates(geometry, material or STEEL, element))
    soft = SOFT_SUSPENSION if plates == 3 else (0.0, 0.0)
    bare = _suspended(ends, *(soft if tip_suspension is None else tip_suspension))
    assembly, bolts = _bolted(bare, geometry, template)
    contact = InterfaceSpec(
        name="joint",
        meshes=meshes or ("matching" if upper_element_size is None else "non-matching"),
        penalty=penalty,
        quadrature=quadrature,
        order=order,
    )
    tip = int(bare.mesh.node_ids[bare.rigid_couplings[0].reference])
    return JointDescription(
        assembly=assembly,
        interfaces=_interfaces(geometry, contact),
        bolts=bolts,
        boundaries=(BoundarySpec(name="tip", node=tip),),
    )


def _plates(geometry: LapGeometry, material: Material, element: str) -> Assembly:
    """Mesh the plates, each with nodes, property and element set of its own."""
    names = PLATE_NAMES[geometry.plates]
    parts = [geometry.plate(number) for number in range(geometry.plates)]
    first_node = np.cumsum([0, *(len(part.nodes) for part in parts)])
    first_id = 1 + np.cumsum([0, *(len(part.cells) for part in parts)])
    block = CellBlock(
        kind=parts[0].kind,
        nodes=np.concatenate([p.cells + n for p, n in zip(parts, first_node[:-1], strict=True)]),
        ids=np.arange(1, first_id[-1]),
        properties=np.repeat(np.arange(1, len(parts) + 1), np.diff(first_id)),
    )
    sets = {name: np.arange(first_id[i], first_id[i + 1]) for i, name in enumerate(names)}
    mesh = Mesh(
        nodes=np.concatenate([part.nodes for part in parts]),
        node_ids=np.arange(1, first_node[-1] + 1),
        blocks=(block,),
        element_sets=sets,
    )
    materials = dict.fromkeys(range(1, len(parts) + 1), material)
    return Assembly(mesh=mesh, materials=materials, element=element, name="lap joint")


def _with_ends(geometry: LapGeometry, assembly: Assembly) -> Assembly:
    """Clamp one end of the joint and tie the other to a node of its own."""
    mesh, half = assembly.mesh, geometry.length / 2
    # The ends of the grid lines are exact.
    clamp, face = (np.flatnonzero(mesh.nodes[:, 0] == x) for x in (-half, half))
    height = geometry.heights()[1:3].mean() + geometry.rise(half)
    tip = len(mesh.nodes)
    mesh = replace(
        mesh,
        nodes=np.vstack([mesh.nodes, [half, 0.0, height]]),
        node_ids=np.append(mesh.node_ids, tip + 1),
    )
    largest = int(mesh.blocks[0].ids.max())
    return replace(
        assembly,
        mesh=mesh.with_node_set("clamp", clamp).with_node_set("tip-face", face),
        supports=(Support(id=1, nodes=clamp, components=(0, 1, 2, 3, 4, 5)),),
        rigid_couplings=(RigidCoupling(id=largest + 1, reference=tip, nodes=face),),
    )


def _suspended(assembly: Assembly, translation: float, rotation: float) -> Assembly:
    """Hang the tip in springs to ground, where they have stiffness."""
    tip = assembly.rigid_couplings[0].reference
    first = assembly.rigid_couplings[0].id + 1
    springs = [
        Spring(id=first + i, ends=((tip, i),), stiffness=float(stiffness))
        for i, stiffness in enumerate([translation] * 3 + [rotation] * 3)
        if stiffness > 0
    ]
    note = (
        f"springs of {translation:g} and {rotation:g} at the tip, for contact alone holds nothing"
    )
    return replace(assembly, springs=tuple(springs), ignored=(note,) if springs else ())


def _bolted(
    assembly: Assembly, geometry: LapGeometry, template: BoltSpec
) -> tuple[Assembly, tuple[BoltSpec, ...]]:
    """Add the bolts and return them with specs that name their beams."""
    bottom, top = geometry.heights()[[0, -1]]
    specs = []
    for i, (x, y) in enumerate(geometry.bolt_positions):
        name = "bolt" if len(geometry.bolt_positions) == 1 else f"bolt-{i + 1}"
        rise = float(geometry.rise(x))
        axis = ((x, y, float(bottom) + rise), (x, y, float(top) + rise))
        assembly = add_bolt(assembly, replace(template, name=name, axis=axis))
        specs.append(BoltSpec(name=name, elements=(assembly.beams[-1].id,)))
    return assembly, tuple(specs)


def _interfaces(geometry: LapGeometry, template: InterfaceSpec) -> tuple[InterfaceSpec, ...]:
    """Name the interfaces between neighbouring plates; the minus side is the lower one."""
    names = PLATE_NAMES[geometry.plates]
    interfaces = [
        replace(template, name=f"joint-{i + 1}", minus=below, plus=above)
        for i, (below, above) in enumerate(pairwise(names))
    ]
    return tuple(interfaces) if len(interfaces) > 1 else (replace(interfaces[0], name="joint"),)
