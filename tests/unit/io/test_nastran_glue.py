"""Glue of both dialects: bodies that move as one."""

from pathlib import Path

import numpy as np
import pytest

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.io.nastran import read_joint
from linear_solution import displacements_of

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
REGIONS = "BSURFS,5,,,,1,5,6,7\nBSURFS,6,,,,2,11,13,12\n"
BODIES = "BCPROP,31,1\nBSURF,32,2\nBCBODY1,7,,3D,DEFORM,31\nBCBODY,8,3D,DEFORM,32\n"
GLUE = [
    REGIONS + "BGSET,1,5,6,.01\nBGPARM,1,PENN,100.,GLUETYPE,2",
    REGIONS + "BGSET,1,5,6\nBGADD,2,1",
    REGIONS + "BCTSET,1,5,6\nBCTPARA,1,TIED,1",
    BODIES + "BCTABL1,9,3\nBCONECT,3,5,,7,8\nBCONPRG,5,,IGLUE,1",
    BODIES + "BCTABLE,2,,,1\n,SLAVE,7,,,,,1\n,MASTERS,8",
]


def cubes(*cards: str, gap: float = 0.0, one: bool = False) -> str:
    """Two cubes on top of each other, clamped below and pulled at a corner above."""
    upper = 5 if one else 11
    grids = [
        (first + i, x, y, z)
        for first, z in ((1, 0.0), (5, 1.0), (11, 1.0 + gap), (15, 2.0 + gap))
        for i, (x, y) in enumerate(SQUARE)
        if not (one and first == 11)
    ]
    lower = ",".join(str(upper + i) for i in range(4))
    return (
        "".join(f"GRID,{n},,{x}.,{y}.,{z}\n" for n, x, y, z in grids)
        + f"CHEXA,1,1,1,2,3,4,5,6\n,7,8\nCHEXA,2,2,{lower},15,16\n,17,18\n"
        + "PSOLID,1,9\nPSOLID,2,9\nMAT1,9,1000.,,.3\nSPC1,1,123,1,THRU,4\n"
        + "FORCE,3,17,0,2.,1.,.5,.3\n"
        + "\n".join(cards)
        + "\n"
    )


def top_moves(path: Path, deck: str) -> Matrix:
    path.write_text(deck)
    joint = read_joint(path)
    assembly = joint.assembly
    assert not joint.interfaces
    moved = displacements_of(assembly, assembly.loads["3"])
    return moved[np.isin(assembly.mesh.node_ids, [15, 16, 17, 18]), :3]


@pytest.mark.parametrize("cards", GLUE, ids=lambda cards: cards.splitlines()[-1])
def test_glued_cubes_are_one_body(tmp_path: Path, cards: str) -> None:
    """As the same two with common nodes; to rounding of the solution."""
    glued = top_moves(tmp_path / "a.bdf", cubes(cards))
    whole = top_moves(tmp_path / "b.bdf", cubes(one=True))
    np.testing.assert_allclose(glued, whole, rtol=0, atol=1e-10 * np.abs(whole).max())


def test_glue_reaches_across_a_gap_as_far_as_the_deck_says(tmp_path: Path) -> None:
    """Facets that move together: the upper cube's base follows whatever lies between."""
    near = top_moves(tmp_path / "a.bdf", cubes(REGIONS, "BGSET,1,5,6,.02", gap=0.01))
    whole = top_moves(tmp_path / "b.bdf", cubes(one=True))
    # The gap itself is all that differs: 1 % of the length.
    np.testing.assert_allclose(near, whole, rtol=0, atol=0.03 * np.abs(whole).max())
    with pytest.raises(ModelError, match="glue-5-6"):
        top_moves(tmp_path / "a.bdf", cubes(REGIONS, "BGSET,1,5,6,.005", gap=0.01))


def test_glue_is_told(tmp_path: Path) -> None:
    (tmp_path / "a.bdf").write_text(cubes(GLUE[0]))
    joint = read_joint(tmp_path / "a.bdf")
    assert joint.has_joined_faces
    assert any(note.startswith("glued surfaces move together") for note in joint.assembly.ignored)
