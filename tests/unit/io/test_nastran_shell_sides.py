"""Contact regions of shells: the side that faces the solids, half a thickness off the nodes."""

import pytest

import faying as fy
from faying.exceptions import FormatError
from faying.io.nastran import read_joint
from faying.model.specs import GapRule

DECK = """CEND
BCSET = 4
SPC = 1
LOAD = 7
BEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,9.,0.,0.
GRID,3,,9.,9.,0.
GRID,4,,0.,9.,0.
GRID,5,,0.,0.,6.
GRID,6,,9.,0.,6.
GRID,7,,9.,9.,6.
GRID,8,,0.,9.,6.
GRID,11,,0.,0.,7.2
GRID,12,,9.,0.,7.2
GRID,13,,9.,9.,7.2
GRID,14,,0.,9.,7.2
CHEXA,1,1,1,2,3,4,5,6
,7,8
PSOLID,1,1
{shell}
PSHELL,2,1,2.,1,,1
MAT1,1,210000.,,.3
BSURFS,5,,,,1,5,6,7
BSURF,6,2
BCTSET,4,6,5,0.
SPC1,1,123,1,THRU,4
CELAS2,91,1.,11,1
CELAS2,92,1.,11,2
CELAS2,93,1.,12,2
CELAS2,94,100.,11,3
CELAS2,95,100.,12,3
CELAS2,96,100.,13,3
CELAS2,97,100.,14,3
PLOAD2,7,-10.,2
ENDDATA
"""
UP, DOWN = "CQUAD4,2,2,11,12,13,14", "CQUAD4,2,2,14,13,12,11"


@pytest.mark.parametrize(("shell", "sign"), [(UP, 1.0), (DOWN, -1.0)])
def test_shells_touch_on_the_side_that_faces_the_solid(tmp_path, shell, sign):
    path = tmp_path / "plate.bdf"
    path.write_text(DECK.format(shell=shell))
    (spec,) = read_joint(path).interfaces
    assert (spec.name, spec.gap) == ("contact-6-5", GapRule(offset=-1.0))
    model = fy.read_nastran(path).with_deck_loads("7")
    pressed = fy.solve_static(fy.preload(model, {}), fy.Load({"7": sign}))
    # 7.2 over 6, less half of the thickness of 2; what closes it pulls on springs of 400.
    applied, pull = 10.0 * 81.0, 400.0 * 0.2
    assert pressed.contact_force() == pytest.approx(applied - pull, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("BCTSET,4,6,5,0.", "BCTSET,4,6,6,0."), "in contact with itself"),
        (("BSURF,6,2", "BSURF,6,1,2"), "shells and solids"),
        (("BCSET = 4", "BGSET = 4"), "glue, is not supported"),
    ],
)
def test_refused_with_the_reason(tmp_path, change, message):
    path = tmp_path / "plate.bdf"
    text = DECK.format(shell=UP).replace(*change)
    path.write_text(text.replace("BCTSET,4,6,5,0.", "BGSET,4,6,5") if "BGSET" in text else text)
    with pytest.raises(FormatError, match=message):
        read_joint(path)
