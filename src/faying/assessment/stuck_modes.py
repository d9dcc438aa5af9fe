"""Vibration modes of a joint in which every closed point sticks: small motions with friction."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix, SparseMatrix, Vector
from faying.assessment.frequencies import NEARLY_RIGID
from faying.joint.system import System
from faying.linalg.factorization import factorize
from faying.reduction.normal_modes import lowest_modes
from faying.simulation.solution import Solution


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class StuckMode:
    """One mode.

    Attributes
    ----------
    shape : (n_dof,)
        φ, mass-normalized.
    frequency : [1/time]
        Cyclic.
    contact_share
        Share of its strain energy that is in the law of the closed points.
    """

    shape: Vector
    frequency: float
    contact_share: float


def stuck_mode(system: System, state: Solution, number: int) -> StuckMode:
    """Return a mode, counted from 1, of small vibrations about a state in which all points stick.

    Closed points stay closed and stuck, open ones open: their laws are springs in all components
    that they have.

    Notes
    -----
    One factorization and one Lanczos run of a full model; dense matrices of a reduced one.
    """
    tangent = _tangent(system, state)
    squares, shapes = lowest_modes(tangent, system.M, factorize(tangent), number)
    shape = shapes[:, number - 1]
    bare = float(shape @ (system.K @ shape))
    return StuckMode(
        shape=shape,
        frequency=float(np.sqrt(squares[-1]) / (2 * np.pi)),
        contact_share=max(1.0 - bare / float(squares[-1]), 0.0),
    )


def _tangent(system: System, state: Solution) -> SparseMatrix | Matrix:
    """Return K + Pᵀ (B⁻¹ + R)⁻¹ P with the springs B of closed points, stuck, between the pairs."""
    contact, solver = system.contact, system.static_contact.frictional
    normal = np.atleast_2d(state.contact_forces)[-1]
    forces = np.stack([normal, np.zeros_like(normal), np.zeros_like(normal)])
    yielding = np.maximum(solver.laws.closure(forces)[1], NEARLY_RIGID * solver.steps.own)
    springs = np.zeros((contact.n_points, 3, 3))
    springs[:, 0, 0] = np.where(normal > 0, 1.0 / yielding[0], 0.0)
    rubbing = contact.rubbing[normal[contact.rubbing] > 0]
    springs[rubbing, 1, 1] = springs[rubbing, 2, 2] = 1.0 / yielding[1, rubbing]
    B, P = solver.steps.springs(springs), contact.relative_operator
    if contact.residual_compliance is None:
        return system.K + P.T @ B @ P
    R = np.asarray(contact.residual_compliance)
    between = np.linalg.solve(np.eye(len(R)) + B @ R, B.toarray())
    tangent = system.K + P.T @ between @ P
    return np.asarray((tangent + tangent.T) / 2)
