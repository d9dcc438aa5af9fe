"""Results of a run as plain values; the module ``store`` writes them to HDF5."""

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
"""Name of the full model as a reference."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """Solution of a load case by a model.

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
        Area without pressure over the whole area, by interface.
    iterations : ([n_time]) [1]
        Number of linear systems of the contact problem.
    seconds : [s]
        Wall time of the solution without offline work; its share where solved with others.
    nodal_displacement : (n_node, 3) [length]
        Displacements of the nodes in static cases.
    motion
        Displacements of the reference in some instants or increments.
    friction
        Friction at each instant of transients.
    recovered_pressure : (n_time, n_point) [force/length²]
        Pressure recovered from the motion in transients of reduced models.
    energy_gain : [1]
        Energy that the time integration added to a transient without physical cause, over the
        energy in motion.
    substeps : (n_time,) [1]
        Number of time steps before each instant, where the run chose them.
    step_error : (n_time,) [1]
        Largest change of a pressure with half the steps, over the largest so far; NaN for methods,
        which use the steps of the reference.
    estimate
        Errors of transients of reduced models, estimated without a full solution.
    increment_error : [1]
        Largest certified energy error of an increment in paths of reduced models, against the full
        model with the same friction bounds and previous slip.
    law_residual : [1]
        Largest natural residual of Coulomb's law with the full model on such paths, over largest
        force. It is not an error bound.
    path
        Increments of a path, or of a static load with friction; the other fields
        belong to the last increment.
    cycles
        Cycles by amplitude as text; the other fields belong to the largest
        amplitude at its positive reversal.
    backbones
        Backbones by mode number as text; the other fields belong to the preloaded
        joint.
    bolt_moments : ([n_time,] 2, 2) [force·length]
        Bending moments of bolts with known bending: the two ends of their beams, two components
        across the axis.
    weak_shares : ([n_time]) [1]
        Force in weak springs over the total contact force, by the bodies that they connect.
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
    """Solution of a load case by a reduced model, with its errors.

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
        Largest relative error of the recovered pressures of transients.
    certified_energy_error : [1]
        Certified bound of the error in the energy norm, for static cases.
    certified_force_error : [1]
        Certified bound of the error of the total contact force.
    certified_bound : [1]
        Certified bound of ``max_relative_error``.
    dissipation_error : [1]
        Relative error of the energy dissipated by friction.
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
    """Solutions of a load case by the reference, usually the full model, and by every method.

    Attributes
    ----------
    name
        Name of the load case.
    kind
        ``"static"``, ``"step"``, ``"history"``, ``"path"``, ``"cycle"`` or ``"backbone"``.
    times : (n_time,) [time]
        Instants; absent for static cases.
    components
        Names of the displacement components (ux … rz) by boundary.
    reference
        Solution that the methods are compared with.
    methods
        Results by method and number of joint modes.
    half_step
        Response of the reference with half the time step, for transients.
    half_step_times : (n_half_time,) [time]
        Instants of half_step.
    reserve
        Load factors of slip, for static loads and cycles with friction.
    reference_model
        Name of the model of the reference.
    mesh_errors
        Estimated mesh errors of the pressures of the reference, by interface.
    jumps
        Largest jump of each load of transients that jumps.
    remedy
        Second solution of a transient with inertia at the interface, if its error was large.
    tolerance : [1]
        Estimated pressure error of a transient, by method or chosen time steps, above which the
        run improves it.
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
        """Whether the reference is the full model."""
        return self.reference_model == FULL_MODEL


@dataclass(frozen=True, eq=False, kw_only=True)
class InterfaceRecord(ContactSurface):
    """Geometry, law and preload pressure of an interface.

    Attributes
    ----------
    preload_pressure : (n_point,) [force/length²]
        Pressure after tightening, before the sticking area was tied (Fig. 15.3).
    """

    preload_pressure: Vector


def interface_record(surface: ContactSurface, preload_pressure: Vector) -> InterfaceRecord:
    """Return the record of an interface from its surface and its pressure at rest."""
    members = {entry.name: getattr(surface, entry.name) for entry in fields(ContactSurface)}
    return InterfaceRecord(**members, preload_pressure=preload_pressure)


@dataclass(frozen=True, eq=False, kw_only=True)
class BoltRecord:
    """A bolt and its tightening.

    Attributes
    ----------
    preload : [force]
        Nominal final force; for a bolt locked at an initial force, the resulting force.
    initial_force : [force]
        Initial force N₀ at which the bolt is locked.
    history : (n_stage,) [force]
        Axial force during the tightening of all bolts in turn.
    axis : (2, 3) [length]
        Ends of the tightened element, for pictures.
    """

    preload: float
    initial_force: float
    history: Vector
    axis: Matrix | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Results:
    """All results of a run.

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
        Node ids of the deck or mesh.
    body : (n_node,) [1]
        Number of the body of each node; -1 without a body.
    blocks
        Solid elements, one group per block of a kind.
    mass : [mass]
        Total mass.
    dofs : [1]
        Free degrees of freedom of the full model.
    interfaces
        Contact interfaces by name.
    bolts
        Bolts by name.
    tightening_stages : (n_stage,)
        Step of the tightening at each entry of the bolts' histories.
    cases
        Load cases by name.
    timings : [s]
        Wall time by stage; the sum is the time of the run before its files.
    provenance
        Origin of the results: versions of faying, Python, NumPy, SciPy; platform, date.
    warnings : (n_warning,)
        Solutions that did not converge, and other warnings.
    omissions : (n_omission,)
        Parts of the run that failed, such as validation, with the reasons.
    validation
        Errors over the load space, and chosen numbers of joint modes.
    reduced
        Reduced models by method and number of joint modes; methods without basis have none,
        ``craig-bampton`` and ``compliance`` always have one. None are read from a file where the
        interface was too large to store its compliance.
    normal_modes
        Count of the fixed-interface normal modes; None without modes, or without a frequency gap to
        count in.
    factor_bytes : [1]
        Memory of the factors of the full model with held boundaries.
    reference
        Reference of the load cases: ``full``, ``worst`` or ``none``.
    reference_reason
        Reason of the reference, where the run chose it.
    assessment
        Assessment of the joint over all load cases; None where it failed.
    mode_choices
        Chosen normal modes by load case.
    doubts : (n_doubt,)
        Implausible data in the units of the study.
    notes : (n_note,)
        Notes on the model, such as rigid-body motions without support.
    measurements
        Measured curves beside backbones.
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
        """Parsed TOML tables of the study file; empty if the text is not TOML."""
        try:
            return tomllib.loads(self.study_text)
        except tomllib.TOMLDecodeError:
            return {}

    @property
    def unit_set(self) -> Units:
        """Units of all results."""
        return units_of(self.units)
