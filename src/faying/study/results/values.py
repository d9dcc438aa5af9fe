"""What a run leaves behind, as plain values; ``store`` beside it keeps them in HDF5."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from faying._typing import Indices, Matrix, Vector
from faying.assessment.accuracy import Accuracy
from faying.assessment.backbone import Backbone
from faying.assessment.choose_normal_modes import NormalModeChoice
from faying.assessment.joint_record import Assessment
from faying.assessment.measured_curve import MeasuredCurve
from faying.assessment.mesh_error import MeshError
from faying.assessment.slip_reserve import SlipReserve
from faying.interface.surface import ContactSurface
from faying.model.cells import CellBlock
from faying.reduction.mode_count import ModeCount
from faying.reduction.reduced_model import ReducedModel
from faying.study.inputs.jumps import Jump
from faying.study.results.frequency_record import FrequencyRecord
from faying.study.results.nodal_motion import NodalMotion
from faying.study.results.path_record import NO_SLIP, CycleRecord, PathRecord, SlipRecord
from faying.study.results.second_solution import Remedy
from faying.study.results.validation_record import ValidationRecord
from faying.units import Units, units_of

FULL_MODEL = "full model"
"""What people call the reference that is no reduced model."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """One load case solved by one model.

    Attributes
    ----------
    pressure : ([n_time,] n_point) [force/length²]
        Contact pressure, compression positive.
    gap : ([n_time,] n_point) [length]
        Gap, open positive.
    displacements : ([n_time,] n) [length]
        By boundary, in the order of its components: translations [length] and rotations [rad].
    bolt_forces : ([n_time]) [force]
        Axial force by bolt, tension positive.
    contact_forces : ([n_time]) [force]
        Total normal force by interface.
    open_fraction : ([n_time]) [1]
        Area without pressure by interface.
    iterations : ([n_time]) [1]
        Linear systems of the contact problem.
    seconds : [s]
        Wall time of the solution, offline work excluded; its share where others were beside it.
    nodal_displacement : (n_node, 3) [length]
        Displacement of the nodes, of static cases.
    motion
        Displacements in some instants or increments, of the reference.
    friction
        What friction does at each instant, of transients with friction.
    recovered_pressure : (n_time, n_point) [force/length²]
        Pressure recovered from the motion, of transients of reduced models.
    energy_gain : [1]
        Of transients: share of the energy in motion that the time integration gained from
        nothing.
    substeps : (n_time,) [1]
        Time steps that led to each instant, where the run chose them.
    step_error : (n_time,) [1]
        Largest change of a pressure when they are halved, over the largest so far; NaN of methods,
        which take the steps of the reference.
    estimate
        Errors estimated without a full solution, of transients of reduced models.
    increment_error : [1]
        Of paths of reduced models: largest certified energy error of an increment of the full
        model with these friction bounds, from this slip.
    law_residual : [1]
        Of the same: largest natural residual of Coulomb's law at the full model, over the largest
        force. It bounds nothing.
    path
        The increments of a case that is a path, or a static load with friction; the other fields
        are those of the last one.
    cycles
        Amplitude as text to cycles of that amplitude; the other fields are those of the largest
        amplitude at its positive reversal.
    backbones
        Number of a mode as text to its backbone; the other fields are those of the preloaded
        joint.
    bolt_moments : ([n_time,] 2, 2) [force·length]
        Bending moments of bolts whose bending is seen: the two ends of their beams, two components
        across the axis.
    weak_shares : ([n_time]) [1]
        What weak springs carry over the total contact force, by the bodies between which they are.
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
    motion: NodalMotion | None = None
    friction: SlipRecord = NO_SLIP
    recovered_pressure: Matrix | None = None
    energy_gain: float = 0.0
    substeps: Indices | None = None
    step_error: Vector | None = None
    estimate: Accuracy | None = None
    increment_error: float | None = None
    law_residual: float | None = None
    path: PathRecord | None = None
    cycles: Mapping[str, CycleRecord] = field(default_factory=dict)
    backbones: Mapping[str, Backbone] = field(default_factory=dict)
    bolt_moments: Mapping[str, Matrix] = field(default_factory=dict)
    weak_shares: Mapping[str, Matrix] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class MethodResult:
    """One load case solved by one reduced model, and how good it is.

    Attributes
    ----------
    joint_modes : [1]
        Number of joint modes of the basis (0 for methods without).
    n_modes : [1]
        Length of the basis.
    response
        Solution of the reduced model.
    accuracy
        Errors against the reference.
    recovered_error : [1]
        Largest relative error of the recovered pressures, of transients.
    certified_energy_error : [1]
        Bound of the error in the energy norm that needs no full solution, of static cases.
    certified_force_error : [1]
        Such a bound of the error of the total contact force.
    certified_bound : [1]
        Such a bound of ``max_relative_error``.
    dissipation_error : [1]
        Difference of the energies that friction took, over that of the full model.
    """

    joint_modes: int
    n_modes: int
    response: Response
    accuracy: Accuracy
    recovered_error: float | None = None
    certified_energy_error: float | None = None
    certified_force_error: float | None = None
    certified_bound: float | None = None
    dissipation_error: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class CaseResult:
    """One load case solved by the reference, usually the full model, and by every method.

    Attributes
    ----------
    name
        Name of the load case.
    kind
        ``"static"``, ``"step"``, ``"history"``, ``"path"``, ``"cycle"`` or ``"backbone"``.
    times : (n_time,) [time]
        Instants; absent for static cases.
    components
        Boundary name to the names of its displacement components (ux … rz).
    reference
        Solution that the methods are compared with.
    methods
        Method name to joint mode count to result.
    half_step
        The reference with half the time step: the time-step check of transients.
    half_step_times : (n_half_time,) [time]
        Instants of half_step.
    reserve
        Load factors at which the joint slips, of static loads and cycles with friction.
    reference_model
        Model that the reference is of.
    mesh_errors
        Interface name to what the mesh does to the pressures of the reference, estimated.
    jumps
        Of the loads of transients, the largest one of each that jumps.
    remedy
        Of transients: what was solved again with inertia at the interface, unasked.
    tolerance : [1]
        Of transients: largest estimated pressure error of a method, and of time steps that the run
        chose, that is left as it is.
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
    remedy: Remedy | None = None
    tolerance: float | None = None

    @property
    def is_full(self) -> bool:
        """Whether the reference is the full model's."""
        return self.reference_model == FULL_MODEL


@dataclass(frozen=True, eq=False, kw_only=True)
class InterfaceRecord(ContactSurface):
    """Geometry and law of one interface, and the joint as preloaded.

    Attributes
    ----------
    preload_pressure : (n_point,) [force/length²]
        Pressure after tightening, before the sticking area was tied (Fig. 15.3).
    """

    preload_pressure: Vector


def interface_record(surface: ContactSurface, preload_pressure: Vector) -> InterfaceRecord:
    """Return what results keep of an interface: its surface, and its pressure at rest."""
    members = {entry.name: getattr(surface, entry.name) for entry in fields(ContactSurface)}
    return InterfaceRecord(**members, preload_pressure=preload_pressure)


@dataclass(frozen=True, eq=False, kw_only=True)
class BoltRecord:
    """One bolt as tightened.

    Attributes
    ----------
    preload : [force]
        Nominal final force; of a bolt locked at an initial force, the force it is left with.
    initial_force : [force]
        Initial force N₀ the bolt is locked at.
    history : (n_stage,) [force]
        Axial force while all bolts were tightened one after the other.
    axis : (2, 3) [length]
        Ends of the element that is tightened, for pictures.
    """

    preload: float
    initial_force: float
    history: Vector
    axis: Matrix | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Results:
    """Everything a run computed.

    Attributes
    ----------
    title
        Title of the study.
    units
        Consistent unit set, length-mass-time.
    study_text
        The study file as run (TOML).
    nodes : (n_node, 3) [length]
        Coordinates in the basic frame.
    node_ids : (n_node,) [1]
        Node ids as the user knows them.
    body : (n_node,) [1]
        Number of the body a node belongs to; -1 where none.
    blocks
        Solid elements, one group per block of one kind.
    mass : [mass]
        Total mass.
    dofs : [1]
        Free degrees of freedom of the full model.
    interfaces
        Contact interfaces by name.
    bolts
        Bolts by name.
    tightening_stages : (n_stage,)
        What was done at each entry of the bolts' histories.
    cases
        Load cases by name.
    timings : [s]
        Wall time by stage; together that of the run before its files.
    provenance
        What computed this: faying version, Python, NumPy, SciPy, platform, date.
    warnings : (n_warning,)
        What did not converge or deserves notice.
    omissions : (n_omission,)
        Validation and other things that failed, with the reasons.
    validation
        Load space and penalty.
    reduced
        Method name to number of joint modes to reduced model; those without basis are not there,
        ``craig-bampton`` and ``compliance`` always. None are read back from the file where the
        interface was too large to keep its compliance.
    normal_modes
        Count of the fixed-interface normal modes; None where there are none, or no gap to count
        in.
    factor_bytes : [1]
        Memory of the factors of the full model, boundary held.
    reference
        What the study's load cases were compared with: ``full``, ``worst`` or ``none``.
    reference_reason
        Why, where the study leaves it open.
    assessment
        The joint judged over the load cases; None where that failed.
    mode_choices
        Load case name to the normal modes that were chosen for it.
    doubts : (n_doubt,)
        What cannot be right in the units of the study.
    notes : (n_note,)
        What is so of the model and may be meant, as motions as a whole that no support holds.
    measurements
        Curves of a test beside backbones.
    frequencies
        Harmonic loads by name.
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
    mode_choices: Mapping[str, NormalModeChoice] = field(default_factory=dict)
    doubts: tuple[str, ...] = field(default=())
    notes: tuple[str, ...] = field(default=())
    measurements: tuple[MeasuredCurve, ...] = ()
    frequencies: Mapping[str, FrequencyRecord] = field(default_factory=dict)

    @property
    def rubbing(self) -> Mapping[str, InterfaceRecord]:
        """The interfaces with friction."""
        return {name: face for name, face in self.interfaces.items() if face.friction > 0}

    @property
    def study_tables(self) -> Mapping[str, Any]:
        """Tables of the study file as TOML gives them; none of a text that is none."""
        try:
            return tomllib.loads(self.study_text)
        except tomllib.TOMLDecodeError:
            return {}

    @property
    def unit_set(self) -> Units:
        """Units of all numbers here."""
        return units_of(self.units)
