"""Vibration modes of a joint in which every closed point sticks: small motions with friction."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Vector
from faying.assessment.stuck_stiffness import stuck_stiffness
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
    tangent = stuck_stiffness(system, state)
    squares, shapes = lowest_modes(tangent, system.M, factorize(tangent), number)
    shape = shapes[:, number - 1]
    bare = float(shape @ (system.K @ shape))
    return StuckMode(
        shape=shape,
        frequency=float(np.sqrt(squares[-1]) / (2 * np.pi)),
        contact_share=max(1.0 - bare / float(squares[-1]), 0.0),
    )
