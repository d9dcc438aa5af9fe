"""Two pipe flanges under six bolts: straight-sided tet10 of gmsh (mm, t, s, MPa).

A joint that has nothing of the lap joints every method was tried on: a ring as interface, bolts in
a circle, unstructured facets. Needs gmsh (``pip install gmsh``).
"""

from math import cos, radians, sin
from pathlib import Path

import faying as fy

BOLTS, PITCH, BOLT, HOLE = 6, 80.0, 12.0, 6.75
"""Number of bolts, radius of their circle, their diameter, radius of their holes."""
INNER, PIPE, RIM = 50.0, 60.0, 100.0
"""Radii of bore, pipe and flange."""
THICKNESS, LENGTH = 18.0, 78.0
"""Of a flange; from the joint to the end of a pipe."""

PLACES = [
    (PITCH * cos(angle), PITCH * sin(angle))
    for angle in (radians(30 + 360 * number / BOLTS) for number in range(BOLTS))
]


def write_mesh(path: Path, size: float) -> None:
    """Mesh both flanges into one file, sharing the nodes of the joint."""
    import gmsh

    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    halves = [_flange(occ, up) for up in (-1, 1)]
    _, parts = occ.fragment(*halves)
    occ.synchronize()
    for name, volumes in zip(("lower", "upper"), parts, strict=True):
        gmsh.model.addPhysicalGroup(3, [tag for _, tag in volumes], name=name)
    for _, face in gmsh.model.getEntities(2):
        z = occ.getCenterOfMass(2, face)[2]
        for name, place in (("clamp", -LENGTH), ("end", LENGTH)):
            if abs(z - place) < 1e-6:
                gmsh.model.addPhysicalGroup(2, [face], name=name)
    for option, value in (
        ("MeshSizeMax", size),
        ("MeshSizeMin", 0.6 * size),
        ("ElementOrder", 2),
        ("SecondOrderLinear", 1),  # curved edges turn corners of such coarse elements inside out
    ):
        gmsh.option.setNumber(f"Mesh.{option}", value)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(path))
    gmsh.finalize()


def _flange(occ, up: int) -> list[tuple[int, int]]:
    def cylinder(radius: float, height: float, x: float = 0.0, y: float = 0.0) -> tuple[int, int]:
        return 3, occ.addCylinder(x, y, 0, 0, 0, up * height, radius)

    body, _ = occ.fuse([cylinder(RIM, THICKNESS)], [cylinder(PIPE, LENGTH)])
    holes = [cylinder(HOLE, THICKNESS, x, y) for x, y in PLACES]
    bored, _ = occ.cut(body, [cylinder(INNER, LENGTH), *holes])
    return bored


def pipe_flange(path: Path, size: float = 14.0) -> fy.Model:
    """Return the joint with loose bolts; writes its mesh first where there is none.

    The lower pipe is clamped at its end, the face of the upper one follows the boundary ``end``.
    With the default size some 36 000 degrees of freedom, 3300 contact points and 1200 pairs.
    """
    if not path.exists():
        write_mesh(path, size)
    steel = fy.Material(name="steel", youngs_modulus=210e3, poissons_ratio=0.3, density=7.85e-9)
    bolts = [
        fy.BoltSpec(
            name=f"M12-{number}",
            axis=((x, y, -THICKNESS), (x, y, THICKNESS)),
            diameter=BOLT,
            washer_radius=BOLT,
        )
        for number, (x, y) in enumerate(PLACES, start=1)
    ]
    return fy.read_mesh(
        path,
        materials={"default": steel},
        separate=["upper"],
        supports={"clamp": (0, 1, 2)},
        interfaces=[fy.InterfaceSpec(name="joint", minus="lower", plus="upper")],
        bolts=bolts,
        boundaries=[fy.BoundarySpec(name="end", set="end", coupling="rbe2", at=(0, 0, LENGTH))],
        damping=fy.Rayleigh(alpha=160.0, beta=5e-7),
    )
