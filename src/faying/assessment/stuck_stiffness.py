"""Stiffness of a joint for small motions: what is closed stays closed and, with friction, stuck."""

from typing import cast

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.laws_at_points import LawsAtPoints
from faying.joint.system import System
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import check_points

SMALLEST_FLEXIBILITY = 1e-6
"""Flexibility of a closed point that is hard in a direction, over its own compliance in it."""


def stuck_stiffness(system: System, state: Solution) -> SparseMatrix | Matrix:
    """Return K + Pᵀ (B⁻¹ + R)⁻¹ P with the springs B between the pairs of closed points.

    Closed points have the springs of their laws at the forces they carry, 1/(c_n w) of a penalty
    and with friction 1/(c_t w) along both tangents; open ones have none. R is the residual
    compliance of a reduced model that has one. The state is a solution to linearize about, or a
    path, about its end. Sparse of a full model, dense of a reduced one.

    Notes
    -----
    Where a law is hard the compliance between the pairs is needed, which a system computes once.
    """
    return _on_springs(system, *stuck_springs(system, state))


def slipping_stiffness(system: System, state: Solution) -> SparseMatrix | Matrix:
    """Return the same with the springs along normals alone: all that is closed slips."""
    rows, flexibility = stuck_springs(system, state)
    closed = int((np.atleast_2d(state.contact_forces)[-1] > 0).sum())
    return _on_springs(system, rows[:closed], flexibility[:closed])


def _on_springs(system: System, rows: SparseMatrix, flexibility: Vector) -> SparseMatrix | Matrix:
    contact = system.contact
    B = (rows.T @ sp.diags_array(1 / flexibility) @ rows).tocsr()
    P = contact.relative_operator
    if contact.residual_compliance is None:
        tangent = system.K + P.T @ B @ P
        return tangent if isinstance(tangent, np.ndarray) else tangent.tocsr()
    R = np.asarray(contact.residual_compliance)
    between = np.linalg.solve(np.eye(len(R)) + B @ R, B.toarray())
    tangent = np.asarray(system.K + P.T @ between @ P)
    return cast("Matrix", (tangent + tangent.T) / 2)


def stuck_springs(system: System, state: Solution) -> tuple[SparseMatrix, Vector]:
    """Return the springs of closed points: what the pairs move in each, and how it yields.

    Rows (n_spring, n_relative) are first along the normals of closed points, then along both
    tangents of those that rub; flexibilities are (n_spring,) [length/force]. Of a path, the end
    counts.
    """
    check_points(system, state)
    contact = system.contact
    forces = np.zeros((3, contact.n_points))
    forces[0] = np.atleast_2d(state.contact_forces)[-1]
    closed = forces[0] > 0
    deepest = None if state.deepest is None else np.atleast_2d(state.deepest)[-1]
    compliance = LawsAtPoints(contact=contact, deepest=deepest).closure(forces)[1]
    stuck = np.tile(closed[contact.rubbing], 2)
    rows = sp.vstack([contact.interpolation[closed], contact.shear[stuck]]).tocsr()
    along = compliance[1:, contact.rubbing].ravel()[stuck]
    flexibility = np.concatenate([compliance[0, closed], along])
    if (flexibility == 0).any():
        flexibility = np.maximum(flexibility, SMALLEST_FLEXIBILITY * _own_compliance(system, rows))
    return rows, flexibility


def _own_compliance(system: System, rows: SparseMatrix) -> Vector:
    """Return the displacement along each row per force along it [length/force]."""
    forces, residual = rows.T.toarray(), system.contact.residual_compliance
    moved = system.port_compliance.relative @ forces
    if residual is not None:
        moved = moved + residual @ forces
    return np.asarray(rows.multiply(moved.T).sum(axis=1)).ravel()
