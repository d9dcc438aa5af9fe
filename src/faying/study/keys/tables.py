"""The tables of a study file, one class each, with every key and default.

What single values must be is said here; what they must be together, in ``consistency``.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, PrivateAttr, model_validator

from faying.assessment.growth import DEFAULT_INCREMENTS
from faying.assessment.transient_error import LARGE_ERROR
from faying.iterations import MOST_SOLVED
from faying.reduction.methods import METHODS
from faying.simulation.integrators import INTEGRATORS
from faying.study.keys.errors import Location, Problem, StudySource, refusal, shown
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
    """[output]: what is written."""

    times: tuple[NotNegative, ...] = ()
    fields: tuple[OutputField, ...] = ("pressure", "gap", "displacement")
    report: Switch = True


def _no_sweep(value: Any) -> Any:
    if value is not False:
        message = (
            "the sweep over the contact stiffness is gone, remove it; the report tells how far "
            "surfaces penetrate, and 'penalty' in [[interface]] repeats a study with another"
        )
        raise refusal(message)
    return value


class ValidationSection(Section):
    """[validation]: what to find out beyond the load cases.

    Twice as many unseen loads more make the floor under all linear bases.
    """

    gone: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("box", "preload_factors"),
        "remove it: searches found milder loads than random ones and are gone",
    )
    unseen_loads: CountOrNone = 100
    penalty_sweep: Annotated[Literal[False], BeforeValidator(_no_sweep)] = False
    half_step: Switch = True
    reference: Literal["full", "worst", "none"] | None = None


MethodName = Annotated[str, name_in(METHODS)]
COMPARED = tuple(name for name, method in METHODS.items() if method.compared)
"""Methods compared unless the study says otherwise; the others come from the literature."""


class Timed(Section):
    """How a transient run advances."""

    alternatives = (
        (("step", "steps_per_period"), "how long the steps are"),
        (("duration", "periods"), "how long the motion is"),
    )
    step: Positive | None = None
    duration: Positive | None = None
    periods: Positive | None = None
    steps_per_period: Count | None = None


class BoxSide(Loading):
    """One side of the box of training loads: a load between ``min`` and ``max``."""

    min: Number
    max: Number


class TrainingSection(Timed):
    """[reduction.training]: loads whose contact forces train the bases.

    Static runs take all combinations of ``levels`` values of the box (15.25); step responses, at
    nominal preload, those of the smallest, middle and largest value of each side but the middle one
    (15.28). Patches (15.23) and the inner product (15.22) are those of method A.
    """

    box: tuple[BoxSide, ...] = ()
    levels: Annotated[Count, Field(ge=2)] = 5
    preload_factors: PreloadFactors = (0.5, 1.0, 1.5)
    dynamics: Switch = True
    system: Literal["full", "reduced"] = "full"
    subareas: Count | None = None
    weight: Literal["K", "I"] = "K"


def _joint_modes(value: Any) -> Any:
    """Let "auto" stand for no number at all."""
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

    ``"auto"`` of normal modes is kept as None, that of joint modes as an empty tuple.
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
        """Without a training box, compare what needs none unless methods are named."""
        if not isinstance(data, Mapping) or "methods" in data:
            return data
        training = data.get("training")
        if isinstance(training, Mapping) and training.get("box"):
            return data
        return {**data, "methods": [name for name in COMPARED if not METHODS[name].trained]}


class ForceSection(Loading):
    """A load, or a factor on one of the deck or a temperature: ``value``, or a history ``file``."""

    one_of = ("value", "file")
    value: Number | None = None
    file: ExistingFile | None = None


DEFAULT_INSTANTS = 100
"""Time steps of a longest period unless told, and instants where a run chooses the steps."""


class LoadCaseSection(Timed):
    """[[load_case]]: loads that act on the joint, at rest or over time.

    ``step = "auto"`` is kept as the tolerance. Amplitudes of backbones are displacements [length],
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
        """Let step = "auto" stand for a tolerance, at a hundred instants a period unless told."""
        motion = isinstance(data, Mapping) and data.get("kind") in ("step", "history")
        if not motion or data.get("step") != "auto":
            return data
        values = {name: value for name, value in data.items() if name != "step"}
        return {"tolerance": LARGE_ERROR, "steps_per_period": DEFAULT_INSTANTS, **values}

    @property
    def transient(self) -> bool:
        """Whether the load case is a motion in time."""
        return self.kind in ("step", "history")

    @property
    def levels(self) -> tuple[float, ...]:
        """Amplitudes of backbones, rising."""
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
        """Keep the text the study was read from."""
        self._source = context

    @property
    def path(self) -> Path:
        """The study file."""
        return self._source.path

    @property
    def text(self) -> str:
        """The study file's text, for the record of a run."""
        return self._source.text

    @property
    def unit_set(self) -> Units:
        """Units of all numbers in it."""
        return units_of(self.units)

    @property
    def source(self) -> StudySource:
        """Path, text and line numbers, to say where in the file a mistake is."""
        return self._source

    def problem(self, location: Location, text: object) -> Problem:
        """Return what is wrong with the value of a key."""
        return Problem(location, f": {text}")

    def in_table(self, location: Location, text: object) -> Problem:
        """Return what is wrong with a table."""
        return Problem(location, f": {text}", of_table=True)

    def problems(self, table: Location, wrong: Mapping[str, str]) -> Iterator[Problem]:
        """Yield what is wrong with keys of a table."""
        for key, text in wrong.items():
            yield self.problem((*table, key), text)
