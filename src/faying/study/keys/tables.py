"""The tables of a study file, one class each, with every key and default.

Types and ranges of single values are here, rules between values in ``consistency``.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, PrivateAttr, model_validator

from faying.assessment.growth import DEFAULT_INCREMENTS
from faying.assessment.transient_error import LARGE_ERROR
from faying.iterations import MOST_SOLVED
from faying.reduction.methods import METHODS
from faying.simulation.integrators import INTEGRATORS
from faying.study.keys.errors import StudySource, refusal, shown
from faying.study.keys.frequency_table import FrequencySection
from faying.study.keys.loading_table import Loading
from faying.study.keys.model_tables import (
    BoltSection,
    BoundarySection,
    DampingSection,
    InterfaceSection,
    MassSection,
    MaterialSection,
    ModelSection,
    StickingSection,
    SupportSection,
    TemperatureSection,
)
from faying.study.keys.parameter_tables import BandSection, ParameterSection
from faying.study.keys.requirement_tables import RequirementSection, ScatterSection
from faying.study.keys.section import (
    Count,
    CountOrAuto,
    CountOrNone,
    ExistingFile,
    Name,
    NotNegative,
    Number,
    Positive,
    PreloadFactors,
    Section,
    StepOrAuto,
    Switch,
    name_in,
    showable,
)
from faying.units import KINDS_OF_UNITS, Units, units_of


class ResponseSection(Section):
    """[[measurement.response]]: a frequency response around the mode, at one amplitude."""

    file: ExistingFile
    amplitude: Positive | None = None
    level: Positive | None = None
    factor: Positive = 1.0
    of: Literal["displacement", "velocity", "acceleration"] = "displacement"


class MeasurementSection(Section):
    """[[measurement]]: see :class:`faying.assessment.measured_curve.MeasuredCurve`."""

    one_of = ("file", "response")
    name: Name
    load_case: Name | None = None
    mode: Count | None = None
    frequency: Name | None = None
    file: ExistingFile | None = None
    response: tuple[ResponseSection, ...] = ()
    frequency_scatter: Positive | None = None
    damping_scatter: Positive | None = None


OutputField = Literal["pressure", "gap", "displacement"]


class OutputSection(Section):
    """[output]: files and fields to write."""

    times: tuple[NotNegative, ...] = ()
    fields: tuple[OutputField, ...] = ("pressure", "gap", "displacement")
    report: Switch = True


def _no_sweep(value: Any) -> Any:
    if value is not False:
        message = (
            "the sweep over the contact stiffness was removed; remove the key. The report has the "
            "penetration, and 'penalty' in [[interface]] sets another stiffness"
        )
        raise refusal(message)
    return value


class ValidationSection(Section):
    """[validation]: checks beyond the load cases.

    Twice as many further unseen loads give the best error of any linear basis.
    """

    gone: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("box", "preload_factors"),
        "remove it: the search for the worst loads was removed, random loads were worse",
    )
    unseen_loads: CountOrNone = 100
    penalty_sweep: Annotated[Literal[False], BeforeValidator(_no_sweep)] = False
    half_step: Switch = True
    reference: Literal["full", "worst", "none"] | None = None


MethodName = Annotated[str, name_in(METHODS)]
COMPARED = tuple(name for name, method in METHODS.items() if method.compared)
"""Methods that are compared by default; the others are from the literature."""


class Timed(Section):
    """Time step and duration of a transient run."""

    alternatives = (
        (("step", "steps_per_period"), "the time step"),
        (("duration", "periods"), "the duration"),
    )
    step: Positive | None = None
    duration: Positive | None = None
    periods: Positive | None = None
    steps_per_period: Count | None = None


class BoxSide(Loading):
    """A side of the box of training loads: a load between ``min`` and ``max``."""

    min: Number
    max: Number


class TrainingSection(Timed):
    """[reduction.training]: loads whose contact forces train the bases.

    Static runs use all combinations of ``levels`` values of the box (15.25); step responses, at
    nominal preload, all combinations of smallest, middle and largest values but the middle of all
    (15.28). ``subareas`` (15.23) and ``weight`` (15.22) belong to method A.
    """

    box: tuple[BoxSide, ...] = ()
    levels: Annotated[Count, Field(ge=2)] = 5
    preload_factors: PreloadFactors = (0.5, 1.0, 1.5)
    dynamics: Switch = True
    system: Literal["full", "reduced"] = "full"
    subareas: Count | None = None
    weight: Literal["K", "I"] = "K"


def _joint_modes(value: Any) -> Any:
    """Return "auto" as an empty tuple, and lists unchanged."""
    if value == "auto":
        return ()
    if value == []:
        message = "found an empty list, expected numbers of joint modes or 'auto'"
        raise refusal(message)
    if isinstance(value, str):
        message = f"found {shown(value)}, expected 'auto' or a list of numbers of joint modes"
        raise refusal(message)
    return value


JointModes = Annotated[
    tuple[Count, ...],
    BeforeValidator(_joint_modes, json_schema_input_type=tuple[Count, ...] | Literal["auto"]),
]


DEFAULT_NORMAL_MODES = 20


class ReductionSection(Section):
    """[reduction]: the bases to build and compare.

    ``normal_modes = "auto"`` is stored as None, ``joint_modes = "auto"`` as an empty tuple.
    """

    normal_modes: CountOrAuto = DEFAULT_NORMAL_MODES
    joint_modes: JointModes = (5, 10, 20, 40)
    tolerance: Positive = 0.05
    methods: Annotated[tuple[MethodName, ...], Field(min_length=1)] = COMPARED
    transient_tolerance: Positive = LARGE_ERROR
    inertia: Switch = True
    training: TrainingSection = TrainingSection()

    @model_validator(mode="before")
    @classmethod
    def _methods(cls, data: Any) -> Any:
        """Return the table with default methods; without a training box, those that need none."""
        if not isinstance(data, Mapping) or "methods" in data:
            return data
        training = data.get("training")
        if isinstance(training, Mapping) and training.get("box"):
            return data
        return {**data, "methods": [name for name in COMPARED if not METHODS[name].trained]}


class ForceSection(Loading):
    """A load, or a factor on a deck load or temperature: ``value``, or a history ``file``."""

    one_of = ("value", "file")
    value: Number | None = None
    file: ExistingFile | None = None


DEFAULT_INSTANTS = 100
"""Default time steps per longest period, and instants per period where steps are chosen."""


class LoadCaseSection(Timed):
    """[[load_case]]: loads that act on the joint, at rest or over time.

    ``step = "auto"`` is stored as tolerance. Amplitudes of backbones are displacements [length],
    or angles [rad] where ``at`` is a rotation.
    """

    name: Name
    kind: Literal["static", "step", "history", "path", "cycle", "backbone"]
    forces: tuple[ForceSection, ...] = ()
    factors: ExistingFile | None = None
    amplitudes: tuple[Positive, ...] = ()
    amplitude_range: tuple[Positive, Positive, Count] | None = None
    over: Literal["amplitude", "energy"] = "amplitude"
    maps: tuple[Positive, ...] = ()
    masing: bool = False
    modes: tuple[Count, ...] = ()
    at: Name | None = None
    increments: Annotated[Count, Field(le=MOST_SOLVED)] = DEFAULT_INCREMENTS
    slip_share: Annotated[Positive, Field(le=1)] = 0.5
    integrator: Annotated[str, name_in(INTEGRATORS)] | None = None
    rho_infinity: Annotated[Number, Field(ge=0, le=1)] | None = None
    rise_time: Positive | None = None
    step: StepOrAuto | None = None
    tolerance: Positive | None = None
    repetitions: Positive | None = None

    @model_validator(mode="before")
    @classmethod
    def _auto(cls, data: Any) -> Any:
        """Return the table with step = "auto" replaced by a tolerance and instants per period."""
        motion = isinstance(data, Mapping) and data.get("kind") in ("step", "history")
        if not motion or data.get("step") != "auto":
            return data
        values = {name: value for name, value in data.items() if name != "step"}
        return {"tolerance": LARGE_ERROR, "steps_per_period": DEFAULT_INSTANTS, **values}

    @property
    def transient(self) -> bool:
        """Whether the load case is a response over time."""
        return self.kind in ("step", "history")

    @property
    def levels(self) -> tuple[float, ...]:
        """Amplitudes of a backbone in increasing order."""
        if self.amplitude_range is None:
            return tuple(sorted(self.amplitudes))
        return tuple(np.geomspace(*self.amplitude_range).tolist())


def _units(label: str) -> str:
    parts = label.split("-")
    expected = "expected length-mass-time of a consistent set, as in 'mm-t-s'"
    if len(parts) != 3 or not all(parts):
        message = f"found {shown(label)}, {expected}"
        raise refusal(message)
    for part, quantity in zip(parts, ("a length", "a mass", "a time"), strict=True):
        kind = next((kind for kind, names in KINDS_OF_UNITS.items() if part in names), quantity)
        if kind != quantity:
            message = f"found {shown(label)}, {expected}; '{part}' is {kind}, not {quantity}"
            raise refusal(message)
    return label


class Study(Section):
    """A study file, read and checked. Paths in it are absolute."""

    title: Annotated[str, AfterValidator(showable)] = ""
    units: Annotated[Name, AfterValidator(_units)] = "mm-t-s"
    friction_during_preload: Switch = True
    preload_scatter: ScatterSection | None = None
    model: ModelSection
    materials: Mapping[str, MaterialSection] = Field(default_factory=dict, alias="material")
    temperatures: Mapping[str, TemperatureSection] = Field({}, alias="temperature")
    interfaces: tuple[InterfaceSection, ...] = Field(default=(), alias="interface")
    bolts: tuple[BoltSection, ...] = Field(default=(), alias="bolt")
    boundaries: tuple[BoundarySection, ...] = Field(default=(), alias="boundary")
    supports: tuple[SupportSection, ...] = Field(default=(), alias="support")
    masses: tuple[MassSection, ...] = Field(default=(), alias="mass")
    measurements: tuple[MeasurementSection, ...] = Field(default=(), alias="measurement")
    parameters: tuple[ParameterSection, ...] = Field(default=(), alias="parameter")
    band: BandSection = BandSection()
    sticking: StickingSection | None = None
    damping: DampingSection = DampingSection()
    reduction: ReductionSection = ReductionSection()
    load_cases: tuple[LoadCaseSection, ...] = Field(default=(), alias="load_case")
    frequencies: tuple[FrequencySection, ...] = Field(default=(), alias="frequency")
    validation: ValidationSection = ValidationSection()
    requirement: RequirementSection = RequirementSection()
    output: OutputSection = OutputSection()
    _source: StudySource = PrivateAttr()

    def model_post_init(self, context: StudySource) -> None:
        """Store the path and text of the study file."""
        self._source = context

    @property
    def path(self) -> Path:
        """Path of the study file."""
        return self._source.path

    @property
    def text(self) -> str:
        """Text of the study file."""
        return self._source.text

    @property
    def unit_set(self) -> Units:
        """Units of all numbers in the study."""
        return units_of(self.units)

    @property
    def source(self) -> StudySource:
        """The source of the study, which finds the line of a mistake."""
        return self._source
