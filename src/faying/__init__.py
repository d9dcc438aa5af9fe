"""faying: contact pressure in bolted joints at the cost of a reduced model.

The names below are in the order of the work: model, preload, basis, reduced model, solution,
comparison.

>>> import faying as fy
>>> model = fy.lap_joint(element_size=5.0)
>>> preloaded = fy.preload(model, {"bolt": 10e3})
>>> basis = fy.craig_bampton(preloaded, normal_modes=10)
>>> rom = fy.reduce(preloaded, basis, compliance=True)
>>> load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
>>> fast, full = fy.solve_static(rom, load), fy.solve_static(preloaded, load)
>>> fy.compare(fast, full).max_relative_error < 1e-8
True
"""

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

__version__ = version("faying")

if TYPE_CHECKING:
    from faying.assessment.accuracy import Accuracy, compare, relative_error
    from faying.assessment.best_possible import best_possible_errors
    from faying.assessment.certificate import certify
    from faying.assessment.choose import choose_joint_modes
    from faying.assessment.energy import energy_balance
    from faying.assessment.frequencies import count_frequencies_below, preloaded_frequencies
    from faying.assessment.imported_recovery import recover_from_boundary_loads, recover_from_modal
    from faying.assessment.penalty_advice import recommend_penalty
    from faying.assessment.penalty_sweep import penalty_sweep
    from faying.assessment.recovery import recover_pressure, recovery_operator
    from faying.assessment.sensitivity import sensitivity
    from faying.assessment.worst_case import worst_case_load
    from faying.contact.problem import contact_problem
    from faying.export.transient_stream import stream_transient
    from faying.joint.build import build_model
    from faying.joint.model import Model
    from faying.linalg.factorization import factorize
    from faying.model.assembly import Material, NodalLoads
    from faying.model.specs import BoltSpec, BoundarySpec, InterfaceSpec, Rayleigh
    from faying.reduction.basis import Basis
    from faying.reduction.compliance import interface_compliance
    from faying.reduction.craig_bampton import craig_bampton
    from faying.reduction.jim_a import jim_a
    from faying.reduction.jim_b import jim_b
    from faying.reduction.mode_count import count_modes_below
    from faying.reduction.pod import pod
    from faying.reduction.reduced_model import ReducedModel, reduce
    from faying.reduction.snapshots import LoadBox, static_snapshots, step_snapshots
    from faying.simulation.frame_motion import FrameMotion
    from faying.simulation.integrators import EnergyDecaying, GeneralizedAlpha, ImplicitEuler
    from faying.simulation.load import History, Load
    from faying.simulation.newton import solve_static_newton
    from faying.simulation.preload import Sticking, preload, tighten
    from faying.simulation.solution import Solution
    from faying.simulation.static import solve_static, solve_static_cases
    from faying.simulation.transient import solve_transient, solve_transient_cases
    from faying.sources import from_matrices, lap_joint, read_abaqus, read_mesh, read_nastran

# Names are imported when first used, so that `faying --help` need not wait for SciPy.
_HOMES = {
    "lap_joint": "faying.sources",
    "read_mesh": "faying.sources",
    "read_nastran": "faying.sources",
    "read_abaqus": "faying.sources",
    "from_matrices": "faying.sources",
    "build_model": "faying.joint.build",
    "Model": "faying.joint.model",
    "Material": "faying.model.assembly",
    "NodalLoads": "faying.model.assembly",
    "InterfaceSpec": "faying.model.specs",
    "BoltSpec": "faying.model.specs",
    "BoundarySpec": "faying.model.specs",
    "Rayleigh": "faying.model.specs",
    "contact_problem": "faying.contact.problem",
    "factorize": "faying.linalg.factorization",
    "interface_compliance": "faying.reduction.compliance",
    "preload": "faying.simulation.preload",
    "tighten": "faying.simulation.preload",
    "Sticking": "faying.simulation.preload",
    "Load": "faying.simulation.load",
    "History": "faying.simulation.load",
    "Basis": "faying.reduction.basis",
    "pod": "faying.reduction.pod",
    "craig_bampton": "faying.reduction.craig_bampton",
    "jim_a": "faying.reduction.jim_a",
    "jim_b": "faying.reduction.jim_b",
    "LoadBox": "faying.reduction.snapshots",
    "static_snapshots": "faying.reduction.snapshots",
    "step_snapshots": "faying.reduction.snapshots",
    "ReducedModel": "faying.reduction.reduced_model",
    "reduce": "faying.reduction.reduced_model",
    "solve_static": "faying.simulation.static",
    "solve_static_cases": "faying.simulation.static",
    "solve_static_newton": "faying.simulation.newton",
    "solve_transient": "faying.simulation.transient",
    "solve_transient_cases": "faying.simulation.transient",
    "stream_transient": "faying.export.transient_stream",
    "ImplicitEuler": "faying.simulation.integrators",
    "EnergyDecaying": "faying.simulation.integrators",
    "GeneralizedAlpha": "faying.simulation.integrators",
    "Solution": "faying.simulation.solution",
    "count_modes_below": "faying.reduction.mode_count",
    "count_frequencies_below": "faying.assessment.frequencies",
    "preloaded_frequencies": "faying.assessment.frequencies",
    "FrameMotion": "faying.simulation.frame_motion",
    "compare": "faying.assessment.accuracy",
    "relative_error": "faying.assessment.accuracy",
    "Accuracy": "faying.assessment.accuracy",
    "certify": "faying.assessment.certificate",
    "recover_pressure": "faying.assessment.recovery",
    "recovery_operator": "faying.assessment.recovery",
    "recover_from_modal": "faying.assessment.imported_recovery",
    "recover_from_boundary_loads": "faying.assessment.imported_recovery",
    "worst_case_load": "faying.assessment.worst_case",
    "choose_joint_modes": "faying.assessment.choose",
    "sensitivity": "faying.assessment.sensitivity",
    "penalty_sweep": "faying.assessment.penalty_sweep",
    "recommend_penalty": "faying.assessment.penalty_advice",
    "best_possible_errors": "faying.assessment.best_possible",
    "energy_balance": "faying.assessment.energy",
}

__all__ = [
    "Accuracy",
    "Basis",
    "BoltSpec",
    "BoundarySpec",
    "EnergyDecaying",
    "FrameMotion",
    "GeneralizedAlpha",
    "History",
    "ImplicitEuler",
    "InterfaceSpec",
    "Load",
    "LoadBox",
    "Material",
    "Model",
    "NodalLoads",
    "Rayleigh",
    "ReducedModel",
    "Solution",
    "Sticking",
    "best_possible_errors",
    "build_model",
    "certify",
    "choose_joint_modes",
    "compare",
    "contact_problem",
    "count_frequencies_below",
    "count_modes_below",
    "craig_bampton",
    "energy_balance",
    "factorize",
    "from_matrices",
    "interface_compliance",
    "jim_a",
    "jim_b",
    "lap_joint",
    "penalty_sweep",
    "pod",
    "preload",
    "preloaded_frequencies",
    "read_abaqus",
    "read_mesh",
    "read_nastran",
    "recommend_penalty",
    "recover_from_boundary_loads",
    "recover_from_modal",
    "recover_pressure",
    "recovery_operator",
    "reduce",
    "relative_error",
    "sensitivity",
    "solve_static",
    "solve_static_cases",
    "solve_static_newton",
    "solve_transient",
    "solve_transient_cases",
    "static_snapshots",
    "step_snapshots",
    "stream_transient",
    "tighten",
    "worst_case_load",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        message = f"module 'faying' has no attribute '{name}'"
        raise AttributeError(message)
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
