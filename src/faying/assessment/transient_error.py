"""How far off the pressures of a reduced transient are, estimated without a full solution.

What a model with residual compliance lacks is the inertia of shapes above its basis. A model with
twice the normal modes has the inertia of the next of them, and these carry most of the error as
long as it falls with the number of modes at all; ``docs/theory/transient_accuracy.md`` has what
was measured.
"""

import numpy as np

from faying.assessment.accuracy import Accuracy, compare
from faying.exceptions import ModelError
from faying.joint.model import Model
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.craig_bampton import craig_bampton
from faying.reduction.projection import projected
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.integrators import Integrator
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.transient import solve_transient


def transient_error(
    model: Model | ReducedModel,
    solution: Solution,
    load: Load,
    *,
    integrator: Integrator | None = None,
) -> Accuracy:
    """Estimate the pressure error of a reduced transient by one with twice the normal modes.

    Parameters
    ----------
    model
        The full model that was reduced; or what :func:`finer_model` makes of it, where several
        transients of one reduced model are judged.
    solution
        Transient of a reduced model, from the rest under its bolts.
    load, integrator
        Those of the solution.

    Returns
    -------
    Accuracy
        Of the solution, with the finer one as reference: estimates, no bounds. They do not know
        of the time step, which both take.

    Raises
    ------
    ModelError
        If the solution is no transient of a reduced model with normal modes and trial vectors.

    Notes
    -----
    Twice as many normal modes, one projection, and one transient of the reduced model with them.
    No time step of the full model.
    """
    times = solution.times
    if not isinstance(solution.system, ReducedModel) or times is None or len(times) < 2:
        message = "only a transient of a reduced model can be judged by one of more modes"
        raise ModelError(message)
    finer = finer_model(model, solution.system) if isinstance(model, Model) else model
    step = float(np.diff(times).mean())
    motion = solve_transient(
        finer, load, step=step, duration=float(times[-1]), integrator=integrator
    )
    return compare(solution, motion)


def finer_model(model: Model, rom: ReducedModel) -> ReducedModel:
    """Return a model like a reduced one, of twice its normal modes and with residual compliance.

    Raises
    ------
    ModelError
        If the reduced model has no normal modes, or joint modes without their vectors.
    """
    count = rom.basis.count(ModeKind.NORMAL)
    if count == 0:
        message = (
            f"the basis of '{rom.method}' has no normal modes to take twice of; reduce with some"
        )
        raise ModelError(message)
    basis = craig_bampton(model, normal_modes=2 * count)
    if rom.joint_modes:
        kinds = (ModeKind.JOINT,) * rom.joint_modes
        shapes = rom.trial_vectors[:, [kind is ModeKind.JOINT for kind in rom.basis.kinds]]
        basis = (basis + Basis(vectors=shapes, kinds=kinds)).orthonormalized(model.K)
    return projected(model, basis, compliance=True)
