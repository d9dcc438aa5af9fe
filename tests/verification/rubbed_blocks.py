"""Two bodies of bricks on one another with friction, and nodes above that hold or pull them."""

import numpy as np

import faying as fy
from faying.joint.build import build_model
from faying.model.assembly import Assembly
from faying.model.generate import brick_grid
from solid_blocks import stacked


def two_bodies(x, y, depth, height, *, ends=()):
    """Bricks over the lines x and y, from −depth to 0 and from 0 to height, and nodes apart.

    Nodes of the lower body come first, then those of the upper one, then ``ends``.
    """
    below, above = brick_grid(x, y, -np.sort(depth)[::-1]), brick_grid(x, y, np.sort(height))
    n = len(below.nodes)
    return stacked(below, above, beside=ends), np.arange(n), np.arange(n, n + len(above.nodes))


def rubbing(mesh, material, *, boundaries, penalty, friction, tangential_penalty, **held):
    """A model of two bodies of one material; ``held`` are supports, springs and couplings."""
    assembly = Assembly(mesh=mesh, materials={1: material, 2: material}, **held)
    joint = fy.InterfaceSpec(
        name="joint",
        minus="body 0",
        plus="body 1",
        penalty=penalty,
        friction=friction,
        tangential_penalty=tangential_penalty,
    )
    ends = [fy.BoundarySpec(name=name, node=node + 1) for name, node in boundaries.items()]
    return build_model(assembly, interfaces=[joint], boundaries=ends)
