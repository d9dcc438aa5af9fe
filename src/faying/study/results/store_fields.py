"""What every entry of ``results.h5`` means, as the docstrings of the stored values say."""

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
from faying.files.meanings import Table, meanings
from faying.reduction.mode_count import ModeCount
from faying.reduction.model_fields import GEOMETRY
from faying.study.inputs.jumps import Jump
from faying.study.results.frequency_record import FrequencyRecord
from faying.study.results.nodal_motion import NodalMotion
from faying.study.results.path_record import CycleRecord, PathRecord
from faying.study.results.recovered import RecoveredRecord
from faying.study.results.second_solution import Remedy, Tried
from faying.study.results.slip_record import SlipRecord
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

STORED = (
    InterfaceRecord,
    Results,
    Assessment,
    BoltAssessment,
    BoltBending,
    ThreadStress,
    ClampRange,
    SlipDemand,
    InterfaceAssessment,
    Spread,
    Verdict,
    Check,
    ModeCount,
    NormalModeChoice,
    RecoveredRecord,
    BoltRecord,
    CaseResult,
    Jump,
    Remedy,
    Tried,
    MeshError,
    SlipReserve,
    MethodResult,
    Accuracy,
    Response,
    NodalMotion,
    SlipRecord,
    PathRecord,
    CycleRecord,
    Backbone,
    MeasuredCurve,
    FrequencyRecord,
    FrequencyResponse,
    ResponseCurve,
    ContactInMotion,
    Period,
    TransientCheck,
    ValidationRecord,
    LoadSpaceRecord,
    LoadSpaceResult,
    JointModeChoice,
)
"""Values that have a group of their own."""

MEANINGS: dict[type, Table] = {**GEOMETRY, **{kind: meanings(kind) for kind in STORED}}
