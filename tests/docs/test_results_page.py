"""docs/results.md lists what results.h5 and summary.json hold."""

import re

import pytest
from pages import DOCS

from faying.assessment.accuracy import Accuracy
from faying.assessment.backbone import Backbone
from faying.assessment.best_possible import BestPossible
from faying.assessment.bolt_bending import BoltBending
from faying.assessment.choose import JointModeChoice
from faying.assessment.choose_normal_modes import NormalModeChoice
from faying.assessment.clamp_range import ClampRange
from faying.assessment.joint_record import Assessment, BoltAssessment, InterfaceAssessment
from faying.assessment.mesh_error import MeshError
from faying.assessment.penalty_sweep import PenaltySweep
from faying.assessment.preload_scatter import Spread
from faying.assessment.requirements import Verdict
from faying.assessment.slip_demand import SlipDemand
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.thread import ThreadStress
from faying.files.described import SPARSE
from faying.interface.interface import FacePairs
from faying.model.mesh import CellBlock
from faying.reduction.mode_count import ModeCount
from faying.reduction.model_fields import BOUNDARY, COORDINATES, PORTS
from faying.study.jumps import Jump
from faying.study.nodal_motion import NodalMotion
from faying.study.path_record import CycleRecord, PathRecord
from faying.study.recovered import RecoveredRecord
from faying.study.remedy import Remedy, Tried
from faying.study.results import (
    BoltRecord,
    CaseResult,
    InterfaceRecord,
    MethodResult,
    Response,
    Results,
)
from faying.study.slip_record import SlipRecord
from faying.study.store_fields import MEANINGS
from faying.study.validation_record import (
    LoadSpaceRecord,
    LoadSpaceResult,
    PenaltyRecord,
    ValidationRecord,
)

GROUPS = {
    "/": Results,
    "/normal_modes": ModeCount,
    "/blocks/0": CellBlock,
    "/interfaces/NAME": InterfaceRecord,
    "/interfaces/NAME/faces/0": FacePairs,
    "/bolts/NAME": BoltRecord,
    "/cases/NAME": CaseResult,
    "/cases/NAME/jumps/0": Jump,
    "/cases/NAME/remedy": Remedy,
    "/cases/NAME/remedy/first": Tried,
    "/cases/NAME/reserve": SlipReserve,
    "/cases/NAME/mesh_errors/INTERFACE": MeshError,
    "/cases/NAME/reference": Response,
    "/cases/NAME/reference/motion": NodalMotion,
    "/cases/NAME/reference/friction": SlipRecord,
    "/cases/NAME/reference/path": PathRecord,
    "/cases/NAME/reference/cycles/AMPLITUDE": CycleRecord,
    "/cases/NAME/reference/backbones/MODE": Backbone,
    "/cases/NAME/methods/METHOD/N": MethodResult,
    "/cases/NAME/methods/METHOD/N/accuracy": Accuracy,
    "/assessment": Assessment,
    "/assessment/bolts/NAME": BoltAssessment,
    "/assessment/bolts/NAME/bending": BoltBending,
    "/assessment/bolts/NAME/clamp_around/INTERFACE": ClampRange,
    "/assessment/bolts/NAME/thread": ThreadStress,
    "/assessment/interfaces/NAME": InterfaceAssessment,
    "/assessment/interfaces/NAME/slip": SlipDemand,
    "/assessment/scatter/0": Spread,
    "/assessment/verdicts/0": Verdict,
    "/validation": ValidationRecord,
    "/validation/load_space": LoadSpaceRecord,
    "/validation/load_space/methods/METHOD/N": LoadSpaceResult,
    "/validation/load_space/best_possible": BestPossible,
    "/validation/penalty": PenaltyRecord,
    "/validation/penalty/sweep": PenaltySweep,
    "/validation/choices/METHOD": JointModeChoice,
    "/mode_choices/NAME": NormalModeChoice,
    "/` of `recovered_HISTORY.h5": RecoveredRecord,
}
MODELS = {
    "/ports": PORTS,
    "/ports/interpolation": SPARSE,
    "/ports/boundaries/NAME": BOUNDARY,
    "/reduced/METHOD/N": COORDINATES,
}
TEXT = (DOCS / "results.md").read_text(encoding="utf-8")
PAGE = {
    group: re.sub(r"\(as `\w+`\)", "", members)
    for group, members in re.findall(r"^\| `(/[^|]*)` \| (.*) \|$", TEXT, re.MULTILINE)
}


def test_every_kind_of_group_is_there():
    assert set(PAGE) == {*GROUPS, *MODELS}
    assert set(GROUPS.values()) == set(MEANINGS)


@pytest.mark.parametrize("group", GROUPS)
def test_members_are_those_that_are_stored(group):
    stored = list(MEANINGS[GROUPS[group]])
    if group == "/":  # reduced models of a run share their ports and shapes
        place = stored.index("reduced")
        stored[place : place + 1] = ["ports", "reduced", "shapes"]
    assert re.findall(r"`(\w+)`", PAGE[group]) == stored


@pytest.mark.parametrize("group", MODELS)
def test_members_of_reduced_models_are_those_that_are_stored(group):
    assert re.findall(r"`(\w+)`", PAGE[group]) == list(MODELS[group])
