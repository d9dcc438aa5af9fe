"""Loads whose direction grids or shells give, by hand."""

from collections.abc import Callable

import numpy as np
import pytest

from faying._typing import Matrix
from faying.exceptions import FormatError

# A plate of 2 x 4 in x-y, a triangle beside it, and a parallelogram that stands askew.
PLACES = [(0, 0, 0), (2, 0, 0), (2, 4, 0), (0, 4, 0), (5, 0, 0), (0, 0, 3), (2, 0, 1), (2, 4, 1)]
MODEL = (
    "".join(f"GRID,{i},,{x}.,{y}.,{z}.\n" for i, (x, y, z) in enumerate(PLACES, 1))
    + "CQUAD4,1,1,1,2,3,4\nCTRIA3,2,1,2,3,5\nPSHELL,1,1,.1,1\nMAT1,1,1000.,,.3\n"
)
Read = Callable[[str], Matrix]


@pytest.fixture
def forces(nastran) -> Read:
    def read(card: str) -> Matrix:
        assembly = nastran(MODEL, card).assembly
        table = np.zeros((len(assembly.mesh.nodes), 6))
        load = assembly.loads["7"]
        table[load.nodes] = load.forces
        return table

    return read


def test_forces_and_moments_along_and_across_lines(forces: Read) -> None:
    np.testing.assert_allclose(
        forces("FORCE1,7,3,10.,2,4")[2, :3], 10 * np.array([-1, 2, 0]) / 5**0.5
    )
    np.testing.assert_allclose(forces("MOMENT1,7,3,10.,1,6")[2], [0, 0, 0, 0, 0, 10])
    np.testing.assert_allclose(forces("FORCE2,7,3,10.,1,2,1,4")[2], [0, 0, 10, 0, 0, 0])
    np.testing.assert_allclose(forces("MOMENT2,7,3,10.,1,4,1,2")[2], [0, 0, 0, 0, 0, -10])


def test_pressure_on_grids_acts_along_their_normal(forces: Read) -> None:
    """Rectangles and triangles share it equally among their corners."""
    rectangle = forces("PLOAD,7,3.,1,2,3,4")
    np.testing.assert_allclose(rectangle[:4, 2], 3 * 8 / 4)
    np.testing.assert_allclose(forces("PLOAD,7,3.,4,3,2,1")[:4, 2], -3 * 8 / 4)
    triangle = forces("PLOAD,7,3.,2,5,3")
    np.testing.assert_allclose(triangle[[1, 2, 4], 2], 3 * 6 / 3)
    askew = forces("PLOAD,7,3.,1,7,8,4")
    np.testing.assert_allclose(askew[:, :3].sum(axis=0), 3 * np.cross([2, 0, 1], [0, 4, 0]))


def test_pressure_on_shells_acts_along_their_normals(forces: Read) -> None:
    np.testing.assert_allclose(forces("PLOAD2,7,3.,1")[:4, 2], 6.0)
    # The triangle's corners 2, 3, 5 go round the other way.
    both = forces("PLOAD2,7,3.,1,THRU,9")
    np.testing.assert_allclose(both, forces("PLOAD2,7,3.,1\nPLOAD2,7,3.,2"))
    np.testing.assert_allclose(both[:, 2].sum(), 3 * (8 - 6))


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("FORCE1,7,3,10.,2,2", "FORCE1: its grids give no direction"),
        ("FORCE2,7,3,10.,1,2,4,3", "FORCE2: its grids give no direction"),
        ("FORCE1,7,3,10.,2,99", "GRID 99 is not in the deck"),
        ("PLOAD,7,1.E308,1,2,3,4", "too large"),
        ("PLOAD2,7,3.,1,9", "element 9 is not a shell"),
        ("PLOAD2,7,3.,8,THRU,9", "is not a shell"),
    ],
)
def test_loads_that_make_no_sense(forces: Read, card: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        forces(card)
