"""Static contact by Newton's method on the full finite element equations.

An independent check of the condensed solution: it shares nothing but K and G with it, and
factorizes the whole stiffness anew for every set of points in contact.
"""

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from faying._typing import Mask, SparseMatrix, Vector
from faying.exceptions import ConvergenceError
from faying.iterations import MOST_STEPS
from faying.joint.model import Model
from faying.joint.system import input_forces
from faying.linalg.factorization import factorize
from faying.linalg.relief import balanced
from faying.linalg.singular import SingularMatrixError
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.static import AT_REST


def solve_static_newton(model: Model, load: Load = AT_REST) -> Solution:
    """Solve K u = f + Gᵀλ(g₀ + G u) by semismooth Newton steps.

    Raises
    ------
    ModelError
        If a part moves freely, or the joint has friction.
    ConvergenceError
        If the set of points in contact does not converge, or the gaps of hard points are linearly
        dependent.

    Notes
    -----
    One sparse factorization per iteration. Penalty contact minimizes a convex energy, so steps
    are shortened until it falls and Newton cannot fail; hard contact takes full steps on the
    saddle-point equations.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> push = fy.Load({"tip.Fz": -500.0})
    >>> other = fy.solve_static_newton(joint, push)
    >>> bool(abs(other.max_pressure / fy.solve_static(joint, push).max_pressure - 1) < 1e-8)
    True
    """
    model.contact.check_frictionless()
    inputs = load.inputs(model, np.zeros(1))[0]
    structure = model.structure
    external = balanced(input_forces(model, inputs), structure.rigid_motions, structure.carried)
    hard = np.isinf(model.contact.penalty)
    solver = _solve_hard if hard.any() else _solve_penalty
    try:
        u, forces, iterations = solver(model, external)
    except SingularMatrixError as error:
        raise structure.unconstrained(error.motion) from None
    u = balanced(u, structure.carried, structure.rigid_motions)
    gap = model.contact.initial_gap + model.contact.gap_operator @ u
    return Solution(
        name=load.name,
        system=model,
        states=u,
        contact_forces=forces,
        gap=gap,
        inputs=inputs,
        iterations=np.array(iterations),
    )


def _solve_penalty(model: Model, external: Vector) -> tuple[Vector, Vector, int]:
    contact = model.contact
    G: SparseMatrix = contact.gap_operator
    stiffness = contact.penalty * contact.weights

    def energy(u: Vector) -> float:
        closed = np.minimum(contact.initial_gap + G @ u, 0.0)
        return float(0.5 * u @ (model.K @ u) - external @ u + 0.5 * stiffness @ closed**2)

    u = factorize(model.structure.supported_stiffness).solve(external)
    level = energy(u)
    for iteration in range(1, MOST_STEPS):
        active = contact.initial_gap + G @ u < 0
        target = _penalty_step(model, G, stiffness, active, external)
        settled = np.array_equal(contact.initial_gap + G @ target < 0, active)
        if settled:
            penetration = np.maximum(-(contact.initial_gap + G @ target), 0.0)
            return target, stiffness * penetration, iteration
        fraction = 1.0
        while (trial := energy(u + fraction * (target - u))) > level and fraction > 1e-6:
            fraction /= 2
        u, level = u + fraction * (target - u), trial
    raise ConvergenceError(_no_convergence_message(MOST_STEPS))


def _penalty_step(
    model: Model, G: SparseMatrix, stiffness: Vector, active: Mask, external: Vector
) -> Vector:
    closed = G[active]
    springs = sp.diags_array(stiffness[active])
    pushed = external - closed.T @ (stiffness[active] * model.contact.initial_gap[active])
    tangent = model.structure.supported_stiffness + closed.T @ springs @ closed
    return np.asarray(factorize(tangent.tocsr()).solve(pushed))


def _solve_hard(model: Model, external: Vector) -> tuple[Vector, Vector, int]:
    """Solve the saddle-point equations: only penalty points have a flexibility."""
    contact = model.contact
    G: SparseMatrix = contact.gap_operator
    K, flexibility = model.structure.supported_stiffness, contact.flexibility
    scale = float(K.diagonal().mean())  # brings the gap rows to the size of K
    active = contact.initial_gap + G @ factorize(K).solve(external) < 0
    for iteration in range(1, MOST_STEPS):
        closed = scale * G[active]
        corner = sp.diags_array(-(scale**2) * flexibility[active])
        saddle = sp.block_array([[K, -closed.T], [-closed, corner]]).tocsc()
        right = np.concatenate([external, scale * contact.initial_gap[active]])
        try:
            factors = spla.splu(saddle)
        except RuntimeError:  # SuperLU's error for a zero pivot
            raise ConvergenceError(_dependent_gaps_message(int(active.sum()))) from None
        solution = factors.solve(right)
        solution += factors.solve(right - saddle @ solution)  # the gaps cancel many digits
        u, forces = solution[: len(external)], np.zeros(contact.n_points)
        forces[active] = scale * solution[len(external) :]
        slack = contact.initial_gap + G @ u + flexibility * forces
        following = np.where(active, forces > 0, slack < 0)
        if np.array_equal(following, active):
            return u, forces, iteration
        active = following
    raise ConvergenceError(_no_convergence_message(MOST_STEPS))


def _dependent_gaps_message(closed: int) -> str:
    return (
        f"hard contact closes {closed} points whose gaps depend on each other, so that Newton's "
        "equations are singular; take nodal quadrature, a penalty, or solve_static, which finds "
        "contact forces all the same"
    )


def _no_convergence_message(limit: int) -> str:
    return (
        f"the points in contact did not settle in {limit} Newton iterations; use solve_static, "
        "whose active set cannot cycle"
    )
