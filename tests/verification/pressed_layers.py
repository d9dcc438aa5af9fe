"""Two elastic layers in plane strain, pressed together; half of them by symmetry at x = 0."""

from dataclasses import dataclass

import numpy as np

import faying as fy
from faying.joint.build import build_model
from faying.model.assembly import Assembly, AverageCoupling, Material, Spring, Support
from faying.model.generate import brick_grid
from solid_blocks import stacked

STEEL = Material(youngs_modulus=210000.0, poissons_ratio=0.29, density=7.82e-9)
HOLDING_SPRING = 0.1
"""N/mm under the upper layer, which contact alone would hold; takes 1e-5 of the loads here."""


@dataclass(frozen=True)
class Layers:
    """A model with boundaries ``"top"`` and ``"bottom"`` where the strip loads enter."""

    model: object

    def pressed(self, force):
        """Solution under the force per unit width on the whole of both layers."""
        load = fy.Load({"top.Fz": -force / 2, "bottom.Fz": force / 2})
        return fy.solve_static(self.model, load)

    @property
    def joint(self):
        return self.model.interfaces["joint"]


def pressed_layers(
    x, depth, half_width, *, element="standard", penalty="hard", quadrature=None, upper_x=None,
    minus="auto", plus="auto",
):  # fmt: skip
    """Layers of unit width over grid lines ``x`` and z = ±depth, loaded up to ``half_width``.

    With grid lines ``upper_x`` of its own the upper layer does not match the lower one.
    """
    y = np.array([0.0, 1.0])
    above = x if upper_x is None else upper_x
    parts = [brick_grid(x, y, -np.sort(depth)[::-1]), brick_grid(above, y, np.sort(depth))]
    nodes = np.vstack([part.nodes for part in parts])
    # At the centroid of the strip an average passes a force on as uniform pressure.
    centre = half_width / 2
    ends = np.array([[centre, 0.5, depth.max()], [centre, 0.5, -depth.max()]])
    top, bottom = len(nodes), len(nodes) + 1
    mesh = stacked(*parts, beside=ends)
    middle = np.flatnonzero(nodes[:, 0] == 0)
    base = np.flatnonzero((nodes[:, 0] == 0) & (nodes[:, 2] == -depth.max()))
    assembly = Assembly(
        mesh=mesh,
        materials={1: STEEL, 2: STEEL},
        element=element,
        supports=(
            Support(id=1, nodes=np.arange(len(nodes)), components=(1,)),
            Support(id=2, nodes=middle, components=(0,)),
            Support(id=3, nodes=base, components=(2,)),
        ),
        average_couplings=tuple(
            pressing(number, nodes, face & (nodes[:, 0] <= half_width + 1e-9), reference)
            for number, reference, face in (
                (1, top, nodes[:, 2] == depth.max()),
                (2, bottom, nodes[:, 2] == -depth.max()),
            )
        ),
        springs=(Spring(id=1, ends=((top, 2),), stiffness=HOLDING_SPRING),),
    )
    model = build_model(
        assembly,
        interfaces=[
            fy.InterfaceSpec(
                name="joint",
                minus=minus,
                plus=plus,
                meshes="matching" if upper_x is None else "non-matching",
                penalty=penalty,
                quadrature=quadrature,
            )
        ],
        boundaries=[
            fy.BoundarySpec(name="top", node=top + 1),
            fy.BoundarySpec(name="bottom", node=bottom + 1),
        ],
    )
    return Layers(model)


def pressing(number, nodes, face, reference):
    """A uniform pressure on a rectangle of a face as the weights of an average."""
    loaded, weights = np.flatnonzero(face), 1.0
    for along in (0, 1):
        lines = np.unique(nodes[loaded, along])
        width = (np.diff(lines, prepend=lines[0]) + np.diff(lines, append=lines[-1])) / 2
        weights = weights * width[np.searchsorted(lines, nodes[loaded, along])]
    return AverageCoupling(
        id=number,
        reference=reference,
        nodes=loaded,
        weights=weights,
        components=(2,),
        reference_components=(2,),
    )


def pair_places(joint, nodes):
    """The x of the node pairs, and those with y = 0 in order of x."""
    place = nodes[joint.pairs[:, 0]]
    row = np.flatnonzero(place[:, 1] == 0)
    return place[row, 0][np.argsort(place[row, 0])], row[np.argsort(place[row, 0])]
