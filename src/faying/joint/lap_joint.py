"""The built-in model: plates lapped and bolted together, clamped at one end, loaded at the other.

Two plates are the bolted cantilever of the seed (Fig. 15.2), three a double lap joint.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from faying._typing import Mask, Vector
from faying.exceptions import ModelError, refuse_model
from faying.model.assembly import Assembly, Material, RigidCoupling, Spring, Support
from faying.model.cells import CellBlock
from faying.model.description import JointDescription
from faying.model.generate import Cells, brick_grid, shaped
from faying.model.generated_bolt import add_bolt
from faying.model.mesh import Mesh
from faying.model.specs import BoltSpec, BoundarySpec, InterfaceSpec

PLATE_NAMES = {2: ("lower", "upper"), 3: ("lower", "middle", "upper")}

MOST_BRICKS = 500_000
"""Most bricks of a joint: 1.6 million degrees of freedom, with factors of tens of gigabytes."""


@dataclass(frozen=True, kw_only=True)
class LapGeometry:
    """Dimensions of a lap joint [length]; see :func:`lap_joint_assembly`."""

    element_size: float
    length: float
    width: float
    thickness: float
    overlap: float
    hole_radius: float
    bolt_positions: tuple[tuple[float, float], ...]
    plates: int
    curvature: float
    shape: str
    upper_element_size: float

    def __post_init__(self) -> None:
        positive = ("element_size", "upper_element_size", "length", "width", "thickness", "overlap")
        for name in positive:
            if not 0 < getattr(self, name) < np.inf:
                refuse_model(f"lap joint: {name} is {getattr(self, name):g}; it must be positive")
        count = self._count()
        if count > MOST_BRICKS:
            refuse_model(
                f"lap joint: elements of {min(self.element_size, self.upper_element_size):g} "
                f"divide it into {count:.3g} bricks, and {MOST_BRICKS} are the most; enlarge "
                "element_size or correct the measures"
            )
        if not self.overlap < self.length:
            refuse_model(
                f"lap joint: the overlap {self.overlap:g} is not shorter than the whole length "
                f"{self.length:g}, so no plate would reach past it; shorten the overlap"
            )
        if not self.hole_radius >= 0:
            message = f"lap joint: hole_radius is {self.hole_radius:g}; give 0 or None for no hole"
            raise ModelError(message)
        if self.plates not in PLATE_NAMES:
            refuse_model(f"lap joint: plates is {self.plates}; it must be 2 or 3")
        for x, y in self.bolt_positions:
            if abs(x) > self.overlap / 2 or abs(y) > self.width / 2:
                refuse_model(
                    f"lap joint: the bolt at ({x:g}, {y:g}) lies outside the overlap, "
                    f"|x| <= {self.overlap / 2:g}, |y| <= {self.width / 2:g}"
                )

    def _count(self) -> float:
        """Return the approximate number of bricks, including those in holes."""
        bricks = np.float64(0.0)
        with np.errstate(over="ignore"):
            for number in range(min(self.plates, max(PLATE_NAMES))):
                last = number == self.plates - 1
                size = np.float64(self.upper_element_size if last else self.element_size)
                half = (self.length + self.overlap) / 2
                bricks += np.prod(
                    [max(side / size, 1) for side in (half, self.width, self.thickness)]
                )
        return float(bricks)

    def heights(self) -> Vector:
        """Heights of the surfaces of the plates, before bending (plates + 1,)."""
        levels = np.arange(self.plates + 1, dtype=np.float64) - self.plates / 2
        return np.asarray(self.thickness * levels)

    def rise(self, x: float | Vector) -> Vector:
        """Return the height added at x: the parabola -½ κ x² of an arch."""
        return np.asarray(-0.5 * self.curvature * np.square(x), dtype=np.float64)

    def plate(self, number: int) -> Cells:
        """Return the mesh of a plate; from below even ones reach the clamp, odd the tip."""
        ends = np.array([-self.length / 2, -self.overlap / 2, self.overlap / 2, self.length / 2])
        size = self.upper_element_size if number == self.plates - 1 else self.element_size
        x = _grid_lines(ends[:3] if number % 2 == 0 else ends[1:], size)
        y = _grid_lines(np.array([-self.width / 2, self.width / 2]), size)
        z = _grid_lines(self.heights()[number : number + 2], size)
        bricks = brick_grid(x, y, z)
        solid = ~self._in_hole(bricks)
        if not solid.any():
            message = f"lap joint: hole_radius {self.hole_radius:g} leaves nothing of the plates"
            raise ModelError(message)
        cells = shaped(bricks.restricted(solid), self.shape)
        # Vertical lines stay vertical, so volumes do not change and the plates still touch.
        bent = cells.nodes + np.outer(self.rise(cells.nodes[:, 0]), [0.0, 0.0, 1.0])
        return Cells(kind=cells.kind, nodes=bent, cells=cells.cells)

    def _in_hole(self, bricks: Cells) -> Mask:
        """Whether the centroid of each brick lies within the hole radius of a bolt's axis."""
        if self.hole_radius == 0 or not self.bolt_positions:
            return np.zeros(len(bricks.cells), dtype=bool)
        between = bricks.centroids()[:, None, :2] - np.asarray(self.bolt_positions)
        return np.asarray((np.linalg.norm(between, axis=2) <= self.hole_radius).any(axis=1))


def _grid_lines(stations: Vector, size: float) -> Vector:
    """Divide each span between stations evenly into pieces of about ``size``."""
    spans = [
        np.linspace(a, b, max(1, round((b - a) / size)) + 1)[:-1]
        for a, b in zip(stations[:-1].tolist(), stations[1:].tolist(), strict=True)
    ]
    return np.concatenate([*spans, stations[-1:]])


STEEL = Material(name="steel", youngs_modulus=210_000.0, poissons_ratio=0.29, density=7.82e-9)
"""Material of the seed's cantilever [MPa], [t/mm³]."""


SOFT_SUSPENSION = (10.0, 1e4)
"""Springs [N/mm], [N·mm/rad] at the tip of a double lap joint.

Less than a thousandth of the bending stiffness of the default sizes; a hundred times softer ones
cost two digits of the pressure, because rigid motion then exceeds all elastic compliance.
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
        Edge of the bricks of the top plate, if its mesh is not to match.
    length, width, thickness, overlap
        Whole length, width, thickness of each plate, length of the overlap.
    plates
        2: ``"lower"`` and ``"upper"`` meet at the interface ``"joint"``. 3: ``"lower"``,
        ``"middle"`` and ``"upper"`` meet at ``"joint-1"`` and ``"joint-2"``.
    curvature
        Curvature κ of an arch [1/length]: every node sinks by ½ κ x². Interfaces are then curved
        but still match, and volumes are those of the straight joint.
    shape
        Kind of solid elements made from the bricks.
    element
        Formulation of hex8.
    material
        Material of the plates and bolts; None is the seed's steel.
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
        See there; None is ``"non-matching"`` where ``upper_element_size`` is given.
    tip_suspension
        Springs from the tip to ground, each translation [force/length] and each rotation
        [moment/rad]. None is no spring for two plates, and :data:`SOFT_SUSPENSION` for three:
        contact alone holds a middle plate between two others, and a linear model needs support
        for it before contact closes.

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
    bare = _with_suspension(ends, *(soft if tip_suspension is None else tip_suspension))
    assembly, bolts = _with_bolts(bare, geometry, template)
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
    """Return the meshed plates, each with its nodes, property and element set."""
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
    """Clamp one end of the joint, and tie the other to a single node."""
    mesh, half = assembly.mesh, geometry.length / 2
    # The end coordinates of the grid lines are exact.
    clamp, face = (np.flatnonzero(mesh.nodes[:, 0] == x) for x in (-half, half))
    height = geometry.heights()[1:3].mean() + geometry.rise(half)
    tip = len(mesh.nodes)
    mesh = mesh.with_nodes(np.array([half, 0.0, height]))
    largest = int(mesh.blocks[0].ids.max())
    return replace(
        assembly,
        mesh=mesh.with_node_set("clamp", clamp).with_node_set("tip-face", face),
        supports=(Support(id=1, nodes=clamp, components=(0, 1, 2, 3, 4, 5)),),
        rigid_couplings=(RigidCoupling(id=largest + 1, reference=tip, nodes=face),),
    )


def _with_suspension(assembly: Assembly, translation: float, rotation: float) -> Assembly:
    """Add springs from the tip to ground, if they have stiffness."""
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


def _with_bolts(
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
    """Return specs of the interfaces between neighbouring plates; the lower one is minus."""
    names = PLATE_NAMES[geometry.plates]
    interfaces = [
        replace(template, name=f"joint-{i + 1}", minus=below, plus=above)
        for i, (below, above) in enumerate(pairwise(names))
    ]
    return tuple(interfaces) if len(interfaces) > 1 else (replace(interfaces[0], name="joint"),)
