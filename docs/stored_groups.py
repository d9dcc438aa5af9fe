"""Groups of ``results.h5`` and their members: ``python docs/stored_groups.py`` prints them.

The site shows the same, from the docstrings of the stored values.
"""

import sys

from faying.assessment.accuracy import Accuracy
from faying.assessment.backbone import Backbone
from faying.assessment.bolt_bending import BoltBending
from faying.assessment.check import Check
from faying.assessment.choose_joint_modes import JointModeChoice
from faying.assessment.choose_normal_modes import NormalModeChoice
from faying.assessment.clamp_range import ClampRange
from faying.assessment.joint_record import Assessment, BoltAssessment, InterfaceAssessment
from faying.assessment.measured_curve import MeasuredCurve
from faying.assessment.mesh_error import MeshError
from faying.assessment.preload_scatter import Spread
from faying.assessment.requirements import Verdict
from faying.assessment.response_curve import (
    ContactInMotion,
    FrequencyResponse,
    Period,
    ResponseCurve,
)
from faying.assessment.slip_demand import SlipDemand
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.strength.thread import ThreadStress
from faying.assessment.transient_check import TransientCheck
from faying.files.described import SPARSE
from faying.files.meanings import Meaning, Table
from faying.interface.interface import FacePairs
from faying.model.cells import CellBlock
from faying.reduction.mode_count import ModeCount
from faying.reduction.model_fields import BOUNDARY, COORDINATES, PORTS
from faying.study.inputs.jumps import Jump
from faying.study.results.check import MEANINGS
from faying.study.results.frequency_record import FrequencyRecord
from faying.study.results.nodal_motion import NodalMotion
from faying.study.results.path_record import CycleRecord, PathRecord, SlipRecord
from faying.study.results.second_solution import Remedy, Tried
from faying.study.results.solved_fields import RecoveredRecord
from faying.study.results.validation_record import (
    LoadSpaceRecord,
    LoadSpaceResult,
    ValidationRecord,
)
from faying.study.results.values import (
    BoltRecord,
    CaseResult,
    InterfaceRecord,
    MethodResult,
    Response,
    Results,
)

GROUPS: dict[str, type] = {
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
    "/assessment/checks/0": Check,
    "/validation": ValidationRecord,
    "/validation/load_space": LoadSpaceRecord,
    "/validation/load_space/methods/METHOD/N": LoadSpaceResult,
    "/validation/choices/METHOD": JointModeChoice,
    "/measurements/0": MeasuredCurve,
    "/frequencies/NAME": FrequencyRecord,
    "/frequencies/NAME/response": FrequencyResponse,
    "/frequencies/NAME/response/curves/0": ResponseCurve,
    "/frequencies/NAME/response/curves/0/contact": ContactInMotion,
    "/frequencies/NAME/response/curves/0/periods/FREQUENCY": Period,
    "/frequencies/NAME/checks/0": TransientCheck,
    "/mode_choices/NAME": NormalModeChoice,
    "/ of recovered_HISTORY.h5": RecoveredRecord,
}
"""Groups and the values that they hold; capitals and 0 stand for names and numbers."""

MODELS: dict[str, Table] = {
    "/ports": PORTS,
    "/ports/interpolation": SPARSE,
    "/ports/boundaries/NAME": BOUNDARY,
    "/reduced/METHOD/N": COORDINATES,
}
"""Groups of reduced models and what their members mean."""


def tables() -> dict[str, Table]:
    """Return groups with their members, in the order of the file."""
    return {group: MEANINGS[kind] for group, kind in GROUPS.items()} | MODELS


def page() -> list[str]:
    """Return the lines of the page of the site."""
    lines = ["Groups of results.h5", "====================", ""]
    for group, members in tables().items():
        lines += [group, "-" * len(group), "", ".. list-table::", "   :header-rows: 1", ""]
        lines += _row("member", "axes", "dimension", "what it is")
        for name, meaning in members.items():
            lines += _row(f"``{name}``", meaning.shape, meaning.dimension, meaning.description)
        lines.append("")
    return lines


def _row(*cells: str) -> list[str]:
    first, *others = (" ".join(cell.split()).replace("|", "\\|") for cell in cells)
    return [f"   * - {first}", *(f"     - {cell}" for cell in others)]


def _line(name: str, meaning: Meaning) -> str:
    return f"    {name} {meaning.shape} [{meaning.dimension}] {meaning.description}"


if __name__ == "__main__":
    for group, members in tables().items():
        rows = [group, *(_line(name, meaning) for name, meaning in members.items())]
        sys.stdout.write("\n".join(rows) + "\n")
