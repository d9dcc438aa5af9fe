"""Displacements of all nodes over the states of a load case, as a few shapes times amplitudes."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la

from faying._typing import Indices, Matrix, Vector
from faying.joint.model import Model
from faying.reduction.projection import full_displacement
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import some_states

MOST_STATES = 41
"""Number of states whose displacements are stored, beside the state of largest pressure."""

MOST_SHAPES = 12
"""Most shapes: a page has room for as many of a surface of 60 000 nodes."""

LARGEST_MISS = 2e-3
"""Error over the largest displacement: the largest is drawn as a twentieth of the size
of the model, of which this is a ten-thousandth, less than a pixel."""


@dataclass(frozen=True, eq=False, kw_only=True)
class NodalMotion:
    """Displacements of all nodes in some states of a load case: amplitudes times shapes.

    Attributes
    ----------
    chosen : (n_state,) [1]
        Numbers of the states among all instants or increments.
    amplitudes : (n_state, n_shape) [1]
        Factors of the shapes.
    shapes : (n_shape, n_node, 3) [length]
        Displacements of all nodes.
    missed : [1]
        Largest error of a displacement component, over the largest component.
    """

    chosen: Indices
    amplitudes: Matrix
    shapes: Matrix
    missed: float


def even_states(count: int) -> Indices:
    """Return evenly spaced numbers of at most :data:`MOST_STATES` among ``count`` states."""
    even = np.linspace(0, count - 1, min(MOST_STATES, count))
    return np.unique(np.rint(even).astype(np.int64))


def shown_states(peaks: Vector) -> Indices:
    """Return the numbers of evenly spaced states, and of the state of largest pressure.

    Peaks (n,) are the largest pressures of each instant or increment.
    """
    return np.unique(np.append(even_states(len(peaks)), int(peaks.argmax())))


def nodal_motion(model: Model, solution: Solution) -> NodalMotion:
    """Return the displacements of all nodes of the full model in a transient or a path.

    Notes
    -----
    Each state costs a back-substitution where the solution belongs to a reduced model with a
    residual compliance.
    """
    chosen = shown_states(solution.max_pressure)
    return motion_in(model, some_states(solution, chosen), chosen)


def motion_in(model: Model, states: Solution, chosen: Indices) -> NodalMotion:
    """Return the displacements of all nodes in some states; ``chosen`` are their numbers."""
    moved = model.dofs.translations @ full_displacement(model, states).T
    amplitudes, shapes, missed = few_shapes(moved)
    return NodalMotion(
        chosen=chosen,
        amplitudes=amplitudes,
        shapes=shapes.T.reshape(amplitudes.shape[1], -1, 3),
        missed=missed,
    )


def few_shapes(states: Matrix) -> tuple[Matrix, Matrix, float]:
    """Return amplitudes (n_state, n_shape) and shapes (n, n_shape) of states (n, n_state).

    The fewest proper orthogonal modes with an error of :data:`LARGEST_MISS` of the largest entry,
    up to :data:`MOST_SHAPES`; and this error.
    """
    largest = float(np.abs(states).max(initial=0.0))
    # Eigenvectors of the Gram matrix (15.22) have half the digits, which is enough here.
    amplitudes = la.eigh(states.T @ states)[1][:, ::-1][:, :MOST_SHAPES]
    shapes = states @ amplitudes
    remainder, count, missed = states.copy(), 0, 1.0 if largest > 0 else 0.0
    while missed > LARGEST_MISS and count < amplitudes.shape[1]:
        remainder -= np.outer(shapes[:, count], amplitudes[:, count])
        count, missed = count + 1, float(np.abs(remainder).max()) / largest
    return amplitudes[:, :count], shapes[:, :count], missed
