# Public names, each once: what type checkers read, and what __init__.py imports on first use.

from faying.assessment.accuracy import Accuracy as Accuracy
from faying.assessment.accuracy import compare as compare
from faying.assessment.accuracy import relative_error as relative_error
from faying.assessment.backbone import backbone as backbone
from faying.assessment.best_possible import best_possible_errors as best_possible_errors
from faying.assessment.certificate import certify as certify
from faying.assessment.choose import choose_joint_modes as choose_joint_modes
from faying.assessment.decay import free_decay as free_decay
from faying.assessment.energy import energy_balance as energy_balance
from faying.assessment.frequencies import count_frequencies_below as count_frequencies_below
from faying.assessment.frequencies import preloaded_frequencies as preloaded_frequencies
from faying.assessment.imported_recovery import (
    recover_from_boundary_loads as recover_from_boundary_loads,
)
from faying.assessment.imported_recovery import recover_from_modal as recover_from_modal
from faying.assessment.joint_assessment import assess as assess
from faying.assessment.load_path import load_path as load_path
from faying.assessment.mesh_error import mesh_error as mesh_error
from faying.assessment.penalty_advice import recommend_penalty as recommend_penalty
from faying.assessment.penalty_sweep import penalty_sweep as penalty_sweep
from faying.assessment.recovery import recover_pressure as recover_pressure
from faying.assessment.requirements import ClosedRing as ClosedRing
from faying.assessment.requirements import Requirements as Requirements
from faying.assessment.sensitivity import sensitivity as sensitivity
from faying.assessment.slip_reserve import slip_reserve as slip_reserve
from faying.assessment.thread import Thread as Thread
from faying.assessment.transient_error import transient_error as transient_error
from faying.assessment.worst_case import worst_case_load as worst_case_load
from faying.contact.problem import contact_problem as contact_problem
from faying.export.transient_stream import stream_transient as stream_transient
from faying.joint.build import build_model as build_model
from faying.joint.model import Model as Model
from faying.linalg.factorization import factorize as factorize
from faying.model.assembly import Material as Material
from faying.model.specs import BoltSpec as BoltSpec
from faying.model.specs import BoundarySpec as BoundarySpec
from faying.model.specs import InterfaceSpec as InterfaceSpec
from faying.model.specs import Rayleigh as Rayleigh
from faying.reduction.basis import Basis as Basis
from faying.reduction.compliance import interface_compliance as interface_compliance
from faying.reduction.craig_bampton import craig_bampton as craig_bampton
from faying.reduction.jim_a import jim_a as jim_a
from faying.reduction.jim_b import jim_b as jim_b
from faying.reduction.mode_count import count_modes_below as count_modes_below
from faying.reduction.model_reader import load as load
from faying.reduction.projection import full_displacement as full_displacement
from faying.reduction.projection import reduce as reduce
from faying.reduction.recovery import recovery_operator as recovery_operator
from faying.reduction.reduced_model import ReducedModel as ReducedModel
from faying.reduction.snapshots import LoadBox as LoadBox
from faying.reduction.snapshots import static_snapshots as static_snapshots
from faying.reduction.snapshots import step_snapshots as step_snapshots
from faying.simulation.cycles import solve_cycles as solve_cycles
from faying.simulation.frame_motion import FrameMotion as FrameMotion
from faying.simulation.integrators import EnergyDecaying as EnergyDecaying
from faying.simulation.integrators import GeneralizedAlpha as GeneralizedAlpha
from faying.simulation.integrators import ImplicitEuler as ImplicitEuler
from faying.simulation.load import History as History
from faying.simulation.load import Load as Load
from faying.simulation.newton import solve_static_newton as solve_static_newton
from faying.simulation.path import solve_path as solve_path
from faying.simulation.preload import Sticking as Sticking
from faying.simulation.preload import preload as preload
from faying.simulation.preload import tighten as tighten
from faying.simulation.solution import Solution as Solution
from faying.simulation.static import solve_static as solve_static
from faying.simulation.static import solve_static_cases as solve_static_cases
from faying.simulation.transient import solve_transient as solve_transient
from faying.simulation.transient import solve_transient_cases as solve_transient_cases
from faying.sources import from_matrices as from_matrices
from faying.sources import lap_joint as lap_joint
from faying.sources import read_abaqus as read_abaqus
from faying.sources import read_mesh as read_mesh
from faying.sources import read_nastran as read_nastran

__version__: str
