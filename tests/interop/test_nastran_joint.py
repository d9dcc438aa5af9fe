"""A deck with contact and a bolt is the whole joint: no [[interface]], no [[bolt]] in the study."""

from pathlib import Path

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError, StudyError
from faying.io.nastran import write_deck
from faying.model.elements import SOLIDS
from faying.study.inputs.load_model import build, load_model
from faying.study.keys.schema import read_study

STUDY = """
title = "From a deck"

[model]
source = "nastran"
file = "joint.bdf"
{model}

[[boundary]]
name = "tip"
node = {tip}

[reduction]
normal_modes = 4
methods = ["compliance"]

[sticking]
stiffness = 1e6

[[load_case]]
name = "bend"
kind = "static"
forces = [{{ boundary = "tip", component = "Fz", value = -150.0 }}]
{more}
"""


@pytest.fixture(scope="module")
def joint() -> fy.Model:
    return fy.lap_joint(element_size=5.0)


def faces_of_solids(model: fy.Model, nodes) -> list[str]:
    """Element id and three corners of the solid's face on each facet."""
    mesh = model.assembly.mesh
    found = []
    corners_of = {frozenset(row[:4].tolist()): row for row in nodes}
    for block in mesh.blocks:
        for _, local in SOLIDS[block.kind].faces:
            for number, face in zip(block.ids, block.nodes[:, local], strict=True):
                if frozenset(face.tolist()) in corners_of:
                    ids = mesh.node_ids[face[:3]]
                    found.append(",".join(map(str, [number, *ids])))
    return found


def deck(model: fy.Model, folder: Path, control: str, cards: str) -> None:
    write_deck(model.assembly, folder / "joint.bdf")
    text = (folder / "joint.bdf").read_text()
    text = text.replace("BEGIN BULK\n", f"{control}\nBEGIN BULK\n")
    (folder / "joint.bdf").write_text(text.replace("ENDDATA\n", f"{cards}\nENDDATA\n"))


def contact_by_faces(model: fy.Model) -> str:
    (faces,) = model.interfaces["joint"].faces
    lower, upper = (faces_of_solids(model, side) for side in (faces.minus, faces.plus))
    assert len(lower) == len(upper) == len(faces.minus)
    regions = [
        f"BSURFS,{number},,,,{side[0]}\n" + "\n".join(f",{face}" for face in side[1:])
        for number, side in ((1, lower), (2, upper))
    ]
    return "\n".join([*regions, "BCTSET,4,1,2,0.,,1."])


def study(folder: Path, model: fy.Model, *, selection: str = "", more: str = ""):
    tip = int(model.boundaries["tip"].nodes[0])
    path = folder / "study.toml"
    path.write_text(STUDY.format(tip=tip, model=selection, more=more))
    return read_study(path)


MSC = "BCPROP,11,1\nBCPROP,12,2\nBCBODY1,1,,3D,DEFORM,11\nBCBODY1,2,,3D,DEFORM,12\n"
DIALECTS = {
    "simcenter": ("BCSET = 4", None),
    "msc": ("BCONTACT = 3", MSC + "BCTABL1,3,9\nBCONECT,9,,,1,2"),
}


@pytest.mark.parametrize("dialect", list(DIALECTS))
def test_the_deck_alone_gives_the_same_pressures(joint: fy.Model, tmp_path, dialect: str) -> None:
    control, contact = DIALECTS[dialect]
    bolt = joint.assembly.beams[0].id
    cards = f"{contact or contact_by_faces(joint)}\nBOLT,1,1,{bolt}\nBOLTFOR,7,5000.,1"
    deck(joint, tmp_path, f"{control}\nBOLTLD = 7", cards)
    asked = study(tmp_path, joint)
    loaded = load_model(asked)
    assert loaded.preloads == {"bolt-1": 5000.0}
    model = build(asked)
    (name,) = model.interfaces
    assert name == "contact-1-2"
    theirs, ours = model.interfaces[name], joint.interfaces["joint"]
    assert theirs.area == pytest.approx(ours.area, rel=1e-12)  # sums of rounded areas
    assert theirs.normals[:, 2].min() > 0.99
    load = fy.Load({"tip.Fz": -150.0})
    found = fy.solve_static(fy.preload(model, {"bolt-1": 5000.0}), load)
    wanted = fy.solve_static(fy.preload(joint, {"bolt": 5000.0}), load)
    # The deck holds 10 digits or more; contact amplifies their rounding.
    assert found.max_pressure == pytest.approx(wanted.max_pressure, rel=1e-8)


def test_a_study_overrides_by_name_and_subcases_choose(joint: fy.Model, tmp_path) -> None:
    bolt = joint.assembly.beams[0].id
    cards = f"{MSC}BCTABL1,3,9\nBCONECT,9,,,1,2\nBOLT,1,1,{bolt}\nBOLTFOR,7,5000.,1\nBOLTFOR,8,9.,1"
    deck(joint, tmp_path, "BCONTACT=3\nSUBCASE 1\n BOLTLD=7\nSUBCASE 2\n BOLTLD=8", cards)
    assert load_model(study(tmp_path, joint, selection="subcase = 2")).preloads == {"bolt-1": 9.0}
    more = (
        '[[interface]]\nname = "contact-1-2"\npenalty = 1e5\ninitial_gap = 0.001\n'
        '[[bolt]]\nname = "bolt-1"\npreload = 3.0\n'
    )
    asked = study(tmp_path, joint, more=more)
    assert load_model(asked).preloads == {"bolt-1": 3.0}
    face = build(asked).interfaces["contact-1-2"]
    assert face.penalty == 1e5
    np.testing.assert_allclose(face.initial_gap, 0.001, atol=1e-9)
    again = '[[bolt]]\nname = "{}"\nelements = [' + f"{bolt}]\npreload = 1.0"
    with pytest.raises(StudyError, match="only its preload can be given here"):
        load_model(study(tmp_path, joint, more=again.format("bolt-1")))
    with pytest.raises(StudyError, match=f"'bolt-1' and 'M6' both tighten element {bolt}"):
        load_model(study(tmp_path, joint, more=again.format("M6")))


def test_contact_named_again_in_the_study_is_refused(joint: fy.Model, tmp_path) -> None:
    deck(joint, tmp_path, "BCONTACT = 3", f"{MSC}BCTABL1,3,9\nBCONECT,9,,,1,2")
    more = '[[interface]]\nname = "joint"\nminus = 2\nplus = 1\n'
    with pytest.raises(ModelError, match="interfaces 'contact-1-2' and 'joint' pair the same"):
        build(study(tmp_path, joint, more=more))


def test_a_bolt_without_a_selected_force_asks_for_one(joint: fy.Model, tmp_path) -> None:
    bolt = joint.assembly.beams[0].id
    deck(joint, tmp_path, "BCONTACT = 3", f"{MSC}BCTABL1,3,9\nBCONECT,9,,,1,2\nBOLT,1,1,{bolt}")
    with pytest.raises(StudyError, match="bolt 'bolt-1' of the model has no preload"):
        load_model(study(tmp_path, joint))
