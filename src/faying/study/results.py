"""What a run leaves behind, as plain values; :mod:`faying.study.store` keeps them in HDF5."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from faying._typing import Indices, Matrix, Vector
from faying.assessment.accuracy import Accuracy
from faying.assessment.backbone import Backbone
from faying.assessment.best_possible import BestPossible
from faying.assessment.choose import JointModeChoice
from faying.assessment.joint_record import Assessment
from faying.assessment.mesh_error import MeshError
from faying.assessment.penalty_sweep import PenaltySweep
from faying.assessment.slip_reserve import SlipReserve
from faying.interface.surface import ContactSurface
from faying.model.mesh import CellBlock
from faying.reduction.mode_count import ModeCount
from faying.reduction.reduced_model import ReducedModel
from faying.study.jumps import Jump
from faying.study.path_record import CycleRecord, PathRecord

FULL_MODEL = "full model"
"""What people call the reference that is no reduced model."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """One load case solved by one model.

    Attributes
    ----------
    pressure, gap : (n_point,) or (n_time, n_point)
    displacements
        Boundary name to (n,) or (n_time, n), in the order of its components.
    bolt_forces, contact_forces
        Bolt or interface name to () or (n_time,).
    open_fraction
        Interface name to () or (n_time,).
    iterations : () or (n_time,)
        Linear systems of the contact problem.
    seconds
        Wall time of the solution, offline work excluded; its share where others were beside it.
    nodal_displacement : (n_node, 3), optional
        Of static cases.
    recovered_pressure : (n_time, n_point), optional
        Of transients of reduced models: recovered from the motion, see
        :mod:`faying.assessment.recovery`.
    energy_gain
        Of transients: share of the energy in motion that the time integration gained from nothing.
    estimate
        Of transients of reduced models: errors estimated without a full solution, see
        :mod:`faying.assessment.transient_error`.
    path
        The increments of a case that is a path, or a static load with friction; the other fields
        are those of the last one.
    cycles
        Amplitude as text to cycles of that amplitude; the other fields are those of the largest
        amplitude at its positive reversal.
    backbones
        Number of a mode as text to its backbone; the other fields are those of the preloaded joint.
    """

    pressure: Matrix
    gap: Matrix
    displacements: Mapping[str, Matrix]
    bolt_forces: Mapping[str, Matrix]
    contact_forces: Mapping[str, Matrix]
    open_fraction: Mapping[str, Matrix]
    iterations: Indices
    seconds: float
    nodal_displacement: Matrix | None = None
    recovered_pressure: Matrix | None = None
    energy_gain: float = 0.0
    estimate: Accuracy | None = None
    path: PathRecord | None = None
    cycles: Mapping[str, CycleRecord] = field(default_factory=dict)
    backbones: Mapping[str, Backbone] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class MethodResult:
    """One load case solved by one reduced model, and how good it is.

    Attributes
    ----------
    joint_modes
        Number of joint modes of the basis (0 for methods without).
    n_modes
        Length of the basis.
    recovered_error
        Largest relative error of the recovered pressures, of transients.
    certified_energy_error, certified_force_error, certified_bound
        Bounds that need no full solution, of static cases: of the error in the energy norm, of the
        total contact force, and of the largest relative error.
    traction_error, dissipation_error
        Of cases with friction: largest difference of tractions over the largest, and difference of
        the energies that friction took, over that of the full model.
    """

    joint_modes: int
    n_modes: int
    response: Response
    accuracy: Accuracy
    recovered_error: float | None = None
    certified_energy_error: float | None = None
    certified_force_error: float | None = None
    certified_bound: float | None = None
    traction_error: float | None = None
    dissipation_error: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class CaseResult:
    """One load case solved by the reference, usually the full model, and by every method.

    Attributes
    ----------
    kind
        ``"static"``, ``"step"``, ``"history"``, ``"path"``, ``"cycle"`` or
        ``"backbone"``.
    times : (n_time,) or None
    components
        Boundary name to the names of its displacement components (ux … rz).
    methods
        Method name to joint mode count to result.
    half_step : Response or None
        The reference with half the time step: the time-step check of transients.
    reserve
        How far the load may grow until the joint slips, of static loads and cycles with friction.
    reference_model
        Which model the reference is of.
    mesh_errors
        Interface name to what the mesh does to the pressures of the reference, estimated.
    jumps
        Of the loads of transients, the largest one of each that jumps.
    """

    name: str
    kind: str
    times: Vector | None
    components: Mapping[str, tuple[str, ...]]
    reference: Response
    methods: Mapping[str, Mapping[int, MethodResult]]
    half_step: Response | None = None
    half_step_times: Vector | None = None
    reserve: SlipReserve | None = None
    reference_model: str = FULL_MODEL
    mesh_errors: Mapping[str, MeshError] = field(default_factory=dict)
    jumps: tuple[Jump, ...] = ()

    @property
    def is_full(self) -> bool:
        """Whether the reference is the full model's."""
        return self.reference_model == FULL_MODEL


@dataclass(frozen=True, eq=False, kw_only=True)
class InterfaceRecord(ContactSurface):
    """Geometry and law of one interface, and the joint as preloaded.

    Attributes
    ----------
    preload_pressure : (n_point,)
        Pressure after tightening, before the sticking area was tied (Fig. 15.3).
    """

    preload_pressure: Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class BoltRecord:
    """One bolt as tightened.

    Attributes
    ----------
    preload
        Nominal final force; of a bolt locked at an initial force, the force it is left with.
    initial_force
        N₀ it is locked at.
    history : (n_stage,)
        Its force while all bolts were tightened one after the other.
    axis : (2, 3), optional
        Ends of the element that is tightened, for pictures.
    """

    preload: float
    initial_force: float
    history: Vector
    axis: Matrix | None = None


@dataclass(frozen=True, kw_only=True)
class LoadSpaceResult:
    """Errors of one reduced model over random loads of the training box.

    Attributes
    ----------
    median_error, worst_error
        Of the largest relative pressure errors of the loads.
    """

    median_error: float
    worst_error: float


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadSpaceRecord:
    """Methods at loads they have not seen.

    Attributes
    ----------
    n_loads
        Random loads from the training box.
    methods
        Method name to joint mode count to errors.
    best_possible
        What any linear basis of pressures of as many vectors could reach at best.
    best_possible_gap
        The same for displacement bases, which represent the gap and leave the clipping to the law;
        None where contact is hard, for pressures do not follow from gaps then.
    """

    n_loads: int
    methods: Mapping[str, Mapping[int, LoadSpaceResult]]
    best_possible: BestPossible
    best_possible_gap: BestPossible | None = None


@dataclass(frozen=True, kw_only=True)
class WorstCaseRecord:
    """The load of the validation box that a method gets most wrong.

    Attributes
    ----------
    forces
        ``"boundary.component"`` to force or moment.
    bolt_forces
        Initial bolt forces there.
    bound
        Certified energy error, which the search maximizes.
    certified_bound
        Certified bound of the relative pressure error.
    max_relative_error
        The true error, confirmed by one full solution.
    evaluations
        Loads judged by their certificate, without full solution.
    within_round_off
        Whether the method is exact to round-off at all of them, so that none is worst.
    """

    joint_modes: int
    forces: Mapping[str, float]
    bolt_forces: Mapping[str, float]
    bound: float
    certified_bound: float
    max_relative_error: float
    evaluations: int
    within_round_off: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class PenaltyRecord:
    """What the contact stiffness does to the study's static load cases.

    Attributes
    ----------
    recommended : [force/length³]
    reached
        Whether its pressures are those of hard contact within the doctor's tolerance.
    advice
        The reasons, for people.
    """

    sweep: PenaltySweep
    recommended: float
    reached: bool
    advice: str


@dataclass(frozen=True, eq=False, kw_only=True)
class ValidationRecord:
    """What a run found beyond its load cases.

    Attributes
    ----------
    load_space
        None without a training box.
    worst_cases
        Method name to its worst load; empty without a validation box.
    penalty
        None where it was switched off.
    choices
        Basis name to the number of joint modes chosen automatically.
    """

    load_space: LoadSpaceRecord | None = None
    worst_cases: Mapping[str, WorstCaseRecord] = field(default_factory=dict)
    penalty: PenaltyRecord | None = None
    choices: Mapping[str, JointModeChoice] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class Results:
    """Everything a run computed.

    Attributes
    ----------
    nodes : (n_node, 3)
    body : (n_node,)
        Number of the body a node belongs to, -1 where none.
    blocks
        Solid elements.
    mass, dofs
        Of the model.
    factor_bytes
        Memory of the factors of the full model, boundary held.
    reference, reference_reason
        What the study's load cases were compared with: ``"full"``, ``"worst"`` or ``"none"``; and
        why, where the study leaves it open.
    assessment
        The joint judged over the load cases; None where that failed.
    normal_modes
        Count of the fixed-interface normal modes; None where there are none, or no gap to count in.
    tightening_stages
        What was done at each entry of the bolts' histories.
    cases
        By load case name.
    timings
        Seconds by stage.
    provenance
        faying version, Python, NumPy, SciPy, platform, date.
    warnings
        What did not converge.
    omissions
        Validation and other extras that failed, with the reasons.
    reduced
        Method name to number of joint modes to reduced model; those without basis are not there,
        ``craig-bampton`` and ``compliance`` always. None are read back from the file where the
        interface was too large to keep its compliance.
    """

    title: str
    units: str
    study_text: str
    nodes: Matrix
    node_ids: Indices
    body: Indices
    blocks: tuple[CellBlock, ...]
    mass: float
    dofs: int
    interfaces: Mapping[str, InterfaceRecord]
    bolts: Mapping[str, BoltRecord]
    tightening_stages: tuple[str, ...]
    cases: Mapping[str, CaseResult]
    timings: Mapping[str, float]
    provenance: Mapping[str, str]
    warnings: tuple[str, ...] = field(default=())
    omissions: tuple[str, ...] = field(default=())
    validation: ValidationRecord = field(default_factory=ValidationRecord)
    reduced: Mapping[str, Mapping[int, ReducedModel]] = field(default_factory=dict)
    normal_modes: ModeCount | None = None
    factor_bytes: int = 0
    reference: str = "full"
    reference_reason: str = ""
    assessment: Assessment | None = None
