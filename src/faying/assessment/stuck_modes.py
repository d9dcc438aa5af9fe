"""Vibration modes of a joint in which every closed point sticks: small motions with friction."""

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.linalg as la

from faying._typing import Matrix, SparseMatrix, Vector
from faying.assessment.stuck_stiffness import stuck_stiffness
from faying.joint.system import System
from faying.linalg.backends import count_negative
from faying.linalg.factorization import Factorization, factorize
from faying.linalg.relief import factorize_relieved
from faying.reduction.normal_modes import lowest_modes
from faying.simulation.solution import Solution

MISSED_MASS = 1e-4
"""Part of the mass of a motion that shapes may miss: its frequency is then 5e-5 too high."""


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
    tangent = stuck_stiffness(system, state)
    factor = factorize_relieved(tangent, system.M, system.rigid_motions)
    squares, shapes = lowest_modes(tangent, system.M, factor, number)
    shape = shapes[:, number - 1]
    bare = float(shape @ (system.K @ shape))
    return StuckMode(
        shape=shape,
        frequency=float(np.sqrt(squares[-1]) / (2 * np.pi)),
        contact_share=max(1.0 - bare / float(squares[-1]), 0.0),
    )


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class StuckModes:
    """All modes up to a frequency, and the static response of the same stuck joint.

    Attributes
    ----------
    shapes : (n_dof, n)
        Mass-normalized, in columns.
    frequencies : (n,) [1/time]
    stiffness : (n_dof, n_dof)
        Of the joint whose closed points stick.
    factor
        Its factorization, or what stands for K⁺ of (M11).
    """

    shapes: Matrix
    frequencies: Vector
    stiffness: SparseMatrix | Matrix
    factor: Factorization


def stuck_modes(system: System, state: Solution, highest: float, at_least: int = 1) -> StuckModes:
    """Return the modes of small vibrations up to a frequency, and so many at least.

    Notes
    -----
    A factorization, another that counts the modes, and one Lanczos run of a full model; dense
    matrices of a reduced one.
    """
    tangent = stuck_stiffness(system, state)
    rigid = system.rigid_motions
    factor = factorize_relieved(tangent, system.M, rigid)
    below = count_negative(tangent - (2 * np.pi * highest) ** 2 * system.M) - rigid.shape[1]
    count = min(max(below, at_least), system.K.shape[0] - rigid.shape[1])
    squares, shapes = lowest_modes(tangent, system.M, factor, count)
    usable = np.isfinite(squares) & (squares > 0)
    return StuckModes(
        shapes=shapes[:, usable],
        frequencies=np.sqrt(squares[usable]) / (2 * np.pi),
        stiffness=tangent,
        factor=factor,
    )


def with_released_modes(
    system: System,
    shapes: Matrix,
    stiffness: SparseMatrix | Matrix,
    frequencies: tuple[float, float],
) -> Matrix:
    """Return shapes and, M-orthogonal to them, what they miss of modes of a released joint.

    Shapes (n_dof, n) have ΦᵀMΦ = I. The stiffness is that of the joint without springs of contact
    that some motion overcomes; it may be singular. Of the frequencies [1/time] the first, above 0,
    shifts, the second is the highest of the modes.

    Notes
    -----
    Two factorizations and one Lanczos run of a full model; dense matrices of a reduced one.
    """
    shift, highest = (2 * np.pi * np.array(frequencies)) ** 2
    count = count_negative(stiffness - highest * system.M)
    if not count:
        return shapes
    raised = stiffness + shift * system.M
    _, released = lowest_modes(raised, system.M, factorize(raised), count)
    basis = np.column_stack([system.rigid_motions, shapes])
    outside = released - basis @ (basis.T @ (system.M @ released))
    mass, ways = la.eigh(outside.T @ (system.M @ outside))
    joins = mass > MISSED_MASS
    return np.column_stack([shapes, outside @ ways[:, joins] / np.sqrt(mass[joins])])
