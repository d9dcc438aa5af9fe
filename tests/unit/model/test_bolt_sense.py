"""Which way springs of bolts pull where their ends are in one place."""

import numpy as np
import pytest

from faying.model.assembly import Assembly, Spring
from faying.model.cells import CellBlock
from faying.model.clamping import spring_sense
from faying.model.mesh import Mesh


@pytest.mark.parametrize("uneven", [-0.01, 0.0, 0.01])
@pytest.mark.parametrize("order", [1, -1])
def test_a_bolt_within_its_nut_pulls_towards_its_own_body(uneven, order):
    """Uneven nodes of threads that lie beside each other do not say where the head is."""
    bolt, nut = [-20.0, 14.0 + uneven, 19.0 + uneven, 24.0], [14.0, 19.0]
    corners = (0, 0), (10, 0), (10, 10), (0, 10)
    sides = (0, bolt), (10, nut)
    nodes = [(x + left, y, z) for left, pile in sides for z in pile for x, y in corners]
    nodes = np.array([*nodes, *[(10.0, 5.0, 16.5)] * 2], dtype=float)
    cells = np.array([0, 4, 8, 16])[:, None] + np.arange(8)
    block = CellBlock(kind="hex8", nodes=cells, ids=np.arange(1, 5), properties=np.ones(4, int))
    mesh = Mesh(nodes=nodes, node_ids=np.arange(1, len(nodes) + 1), blocks=(block,))
    spring = Spring(id=1, ends=((24, 2), (25, 2))[::order], stiffness=1e5)
    seats = (np.array([5, 6, 9, 10]), np.array([16, 19, 20, 23]))[::order]
    assert spring_sense(Assembly(mesh=mesh, materials={}), spring, seats) == order
