"""Two elastic blocks pressed together, a quarter of them by symmetry at x = 0 and y = 0.

With one element along y and no motion there, plane strain.
"""

import numpy as np
from pressed_layers import HOLDING_SPRING, STEEL, Layers, pressing

import faying as fy
from faying.joint.build import build_model
from faying.model.assembly import Assembly, Spring, Support
from faying.model.generate import brick_grid
from solid_blocks import stacked


def graded(fine, until, size, growth=1.25):
    """Lines at distance ``fine`` up to ``until``, then ever wider up to ``size``."""
    lines, width = list(np.arange(0.0, until + fine / 2, fine)), fine
    while lines[-1] < size:
        width *= growth
        lines.append(min(lines[-1] + width, size))
    if lines[-1] - lines[-2] < 0.5 * (lines[-2] - lines[-3]):
        del lines[-2]  # no sliver at the end
    return np.array(lines)


def pressed_blocks(
    x, y, depth, *, materials=(STEEL, STEEL), element="incompatible", penalty="auto", gap=None,
):  # fmt: skip
    """Blocks over grid lines x, y and z = ±depth; the upper one is made of the second material.

    ``gap`` of x and y [length] is the initial gap. Press them with :meth:`Layers.pressed`.
    """
    parts = [brick_grid(x, y, -np.sort(depth)[::-1]), brick_grid(x, y, np.sort(depth))]
    nodes = np.vstack([part.nodes for part in parts])
    middle, deep = np.array([x.max() / 2, y.max() / 2]), depth.max()
    ends = np.array([[*middle, deep], [*middle, -deep]])
    mesh = stacked(*parts, beside=ends)
    still = np.arange(len(nodes)) if len(y) == 2 else np.flatnonzero(nodes[:, 1] == 0)
    base = np.flatnonzero((nodes[:, :2] == 0).all(axis=1) & (nodes[:, 2] == -deep))
    assembly = Assembly(
        mesh=mesh,
        materials=dict(enumerate(materials, start=1)),
        element=element,
        supports=(
            Support(id=1, nodes=still, components=(1,)),
            Support(id=2, nodes=np.flatnonzero(nodes[:, 0] == 0), components=(0,)),
            Support(id=3, nodes=base, components=(2,)),
        ),
        average_couplings=tuple(
            pressing(number, nodes, nodes[:, 2] == place, len(nodes) + number - 1)
            for number, place in ((1, deep), (2, -deep))
        ),
        springs=(Spring(id=1, ends=((len(nodes), 2),), stiffness=HOLDING_SPRING),),
    )
    model = build_model(
        assembly,
        interfaces=[fy.InterfaceSpec(name="joint", minus="body 0", plus="body 1", penalty=penalty)],
        boundaries=[
            fy.BoundarySpec(name="top", node=len(nodes) + 1),
            fy.BoundarySpec(name="bottom", node=len(nodes) + 2),
        ],
    )
    if gap is not None:
        places = model.interfaces["joint"].points
        model = model.with_initial_gap("joint", gap(places[:, 0], places[:, 1]))
    return Layers(model)
