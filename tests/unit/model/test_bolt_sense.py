"""Which way springs of bolts pull where their ends are in one place."""

import numpy as np
import pytest

from faying.model.assembly import Assembly, Spring
from faying.model.bolt_sense import spring_sense
from faying.model.cells import CellBlock
from faying.model.mesh import Mesh

SQUARE = np.array([(0, 0), (10, 0), (10, 10), (0, 10)])


def layers(left: float, heights: list[float]) -> np.ndarray:
    """Return the nodes of a pile of bricks of 10 x 10."""
    return np.array([(x + left, y, z) for z in heights for x, y in SQUARE], dtype=float)


def bricks(first: int, count: int) -> list[np.ndarray]:
    return [np.arange(first + 4 * n, first + 4 * n + 8) for n in range(count)]


@pytest.mark.parametrize("uneven", [-0.01, 0.0, 0.01])
@pytest.mark.parametrize("turned", [False, True])
def test_a_bolt_within_its_nut_pulls_towards_its_own_body(uneven, turned):
    """Uneven nodes of threads that lie beside each other do not say where the head is."""
    bolt = layers(0.0, [-20.0, 14.0 + uneven, 19.0 + uneven, 24.0])
    nut = layers(10.0, [14.0, 19.0])
    nodes = np.vstack([bolt, nut, [(10.0, 5.0, 16.5)] * 2])
    cells = np.array([*bricks(0, 3), *bricks(16, 1)])
    block = CellBlock(
        kind="hex8", nodes=cells, ids=np.arange(1, 5), properties=np.ones(4, dtype=int)
    )
    mesh = Mesh(nodes=nodes, node_ids=np.arange(1, len(nodes) + 1), blocks=(block,))
    threads = np.array([5, 6, 9, 10]), np.array([16, 19, 20, 23])
    ends = ((24, 2), (25, 2))
    spring = Spring(id=1, ends=ends[::-1] if turned else ends, stiffness=1e5)
    seats = threads[::-1] if turned else threads
    assembly = Assembly(mesh=mesh, materials={})
    assert spring_sense(assembly, spring, seats) == (-1 if turned else 1)
