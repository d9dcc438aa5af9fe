"""The pressure error of a reduced transient, estimated without a full solution.

A model with residual compliance lacks the inertia of the shapes above its basis. Contact forces
excite those shapes, so the forces of the solution itself tell which of them matter: their dominant
patterns Λ give the Krylov shapes K⁻¹PᵀΛ, K⁻¹MK⁻¹PᵀΛ, …, and a model with the inertia of these is
the reference. ``docs/theory/transient_accuracy.md`` has the measurements.
"""

from collections.abc import Mapping

import numpy as np

from faying._typing import Indices, Matrix
from faying.assessment.accuracy import Accuracy, compare
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.model import Model
from faying.joint.system import System
from faying.reduction.attachment import refined_basis
from faying.reduction.basis import ModeKind
from faying.reduction.methods import METHODS
from faying.reduction.pod import pod
from faying.reduction.projection import projected, trial_vectors_of
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.divided_steps import divided_steps
from faying.simulation.energy_guard import MOST_GAIN, gain_message
from faying.simulation.integrators import Integrator
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.transient import solve_transient

FORCE_PATTERNS = 20
"""Number of patterns of contact forces with inertia; others are below 1 % of the first."""

KRYLOV_SHAPES = 3
"""Krylov shapes of each pattern: its static shape, the static shape of its inertia, and so on."""

OBSERVED_RATIOS = (0.4, 2.7)
"""Smallest and largest ratio of estimated to true error (``benchmarks/transient_estimate.py``)."""

OBSERVED_ON = (
    "two lap joints, a pipe flange, and a tee, a bracket, a hub and a roof joint from a mesher (10 "
    "to 80 normal modes, loads that jump or rise over a tenth or a quarter of the longest period, "
    "seen for an eighth or a quarter of it, three integrators)"
)

TRACTIONS_OBSERVED = "of tractions 0.7 to 2.2 times with friction on lap joints, a tee, a bracket"
"""Text on estimates of tractions (from the same benchmark)."""

LARGE_ERROR = 0.03
"""Default estimated error above which a remedy is named."""

REMEDY = "compliance+inertia"
"""Method with the inertia whose lack is estimated."""

HINT = (
    f"Method '{REMEDY}' has the inertia that is missing: name it under [reduction] methods to "
    "compare it (docs/theory/transient_accuracy.md says what it is worth and costs)."
)
"""Hint for methods with a residual compliance, which lack only inertia."""

EXACT = "compliance"
"""Method with the static pressures of the full model."""

STATIC_HINT = (
    "{methods}: the flexibility of the interface is missing, so that static pressures are off "
    f"too. Method '{EXACT}' has it: name it under [reduction] methods to compare it."
)
"""Hint for methods without residual compliance."""

NO_TRANSIENT = "only a transient of a reduced model can be judged by a model with more inertia"


def remedy_hint(errors: Mapping[str, float]) -> str:
    """Return a hint to further methods to compare; empty if the errors are tolerable.

    Errors are the largest estimated pressure errors of each method, over the tolerance.
    """
    large = [name for name, error in errors.items() if error > 1.0]
    if any(METHODS[name].compliance for name in large):
        return "" if REMEDY in errors else HINT
    if not large or any(METHODS[name].compliance or name == REMEDY for name in errors):
        return ""
    return STATIC_HINT.format(methods=", ".join(large))


def transient_error(
    model: Model | ReducedModel,
    solution: Solution,
    load: Load,
    *,
    integrator: Integrator | None = None,
    initial: Solution | None = None,
) -> Accuracy:
    """Return the estimated pressure error of a reduced transient, from a model with more inertia.

    Parameters
    ----------
    model
        The full model that was reduced, or the result of :func:`finer_model` for this solution.
    solution
        Transient of a reduced model with trial vectors, starting at rest under its bolts.
    load, integrator
        Load and integrator of the solution.
    initial
        Static solution of the finer model to start from, if the solution did not start at rest
        under its bolts.

    Returns
    -------
    Accuracy
        Accuracy of the solution with the finer one as reference: estimates, no bounds. Errors of
        the time step, which both share, are not included.

    Raises
    ------
    ModelError
        If the solution is not a transient of a reduced model of the full one, or that model has no
        trial vectors.
    ConvergenceError
        If the finer transient has a spurious gain of energy.

    Notes
    -----
    Sixty back-substitutions, one projection, and one transient of the reduced model with sixty
    more trial vectors. No time step of the full model.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    >>> tap = fy.Load({"tip.Fz": -50.0})
    >>> moved = fy.solve_transient(rom, tap, step=1e-5, duration=1e-3)
    >>> fy.transient_error(joint, moved, tap).max_relative_error < 0.02
    True
    """
    finer = finer_model(model, solution) if isinstance(model, Model) else model
    times = _instants(solution)
    step, duration = float(np.diff(times).mean()), float(times[-1])
    tolerance = None if solution.substeps is None else 1.0
    motion = stepped(finer, load, step, duration, integrator, initial, tolerance, solution.substeps)
    if motion.energy_gain > MOST_GAIN:
        gained = gain_message(motion.energy_gain)
        message = f"in the model with more inertia that the transient is judged by, {gained}"
        raise ConvergenceError(message)
    return compare(solution, motion)


def stepped(
    system: System,
    load: Load,
    step: float,
    duration: float,
    integrator: Integrator | None,
    initial: Solution | None,
    tolerance: float | None,
    substeps: Indices | None,
) -> Solution:
    """Return a transient, with steps divided by a tolerance or as in another transient."""
    if tolerance is None:
        return solve_transient(
            system, load, step=step, duration=duration, integrator=integrator, initial=initial
        )
    divided = divided_steps(system, step=step, tolerance=tolerance, integrator=integrator)
    return divided.solve(load, duration=duration, initial=initial, substeps=substeps)


def finer_model(model: Model, solution: Solution) -> ReducedModel:
    """Return a model like that of a transient, with inertia where its contact forces act.

    It has the trial vectors of that model, the Krylov shapes of the dominant patterns of changes of
    the contact forces, with the boundary held, and the residual compliance beyond them. A model
    with attachment modes gets another step of :func:`refined_basis` instead.

    Raises
    ------
    ModelError
        As :func:`transient_error`.
    """
    _instants(solution)
    rom = solution.system
    if not isinstance(rom, ReducedModel):
        raise ModelError(NO_TRANSIENT)
    _ = trial_vectors_of(rom, model)  # refuses another model
    if rom.basis.count(ModeKind.ATTACHMENT):
        # It has the inertia of all contact forces already, and no residual compliance.
        return projected(model, refined_basis(model, rom.basis))
    K = model.structure.supported_stiffness
    basis = rom.basis.extended(_krylov_shapes(model, solution), ModeKind.JOINT, K)
    return projected(model, basis, compliance=True)


def _krylov_shapes(model: Model, solution: Solution) -> Matrix:
    """Return displacements (n_dof, n_shape) under the changes of the contact forces."""
    contact = solution.system.contact
    forces = contact.at_pairs(solution.contact_forces, solution.shear_forces)
    changes = forces[:, 1:] - forces[:, :1]
    if not changes.any():
        return np.zeros((model.structure.n_dof, 0))
    at_dofs = model.contact.transposed[1] @ pod(changes, count=FORCE_PATTERNS).vectors
    shapes = [model.structure.solve_held(at_dofs)]
    for _ in range(KRYLOV_SHAPES - 1):
        shapes.append(model.structure.solve_held(model.M @ shapes[-1]))
    return np.hstack(shapes)


def _instants(solution: Solution) -> Matrix:
    """Return the instants of a transient; refuse other solutions."""
    times = solution.times
    if times is None or len(times) < 2:
        raise ModelError(NO_TRANSIENT)
    return times
