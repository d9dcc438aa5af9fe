"""Vibration modes of a joint with every closed point stuck: small motions with friction."""

from dataclasses import dataclass
from typing import cast

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.laws_at_points import LawsAtPoints
from faying.digits import DECK_DIGITS, SHOWN_DIGITS, SOLVED
from faying.joint.model import Model
from faying.joint.system import System
from faying.linalg.backends import count_negative
from faying.linalg.factorization import factorize
from faying.linalg.interface import Factorization
from faying.linalg.relief import factorize_relieved
from faying.reduction.normal_modes import lowest_modes
from faying.simulation.path import last_of, solve_static
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import check_points


@dataclass(frozen=True, eq=False, kw_only=True)
class StuckMode:
    """A vibration mode with every closed point stuck.

    Attributes
    ----------
    shape : (n_dof,)
        φ, mass-normalized.
    frequency : [1/time]
        Cyclic.
    contact_share
        Share of its strain energy in the law of the closed points.
    """

    shape: Vector
    frequency: float
    contact_share: float


def stuck_mode(system: System, state: Solution, number: int) -> StuckMode:
    """Return a mode, counted from 1, of small vibrations about a state in which all points stick.

    Closed points stay closed and stuck, open ones open: laws are springs in all their components.

    Notes
    -----
    One factorization and one Lanczos run for a full model; dense matrices for a reduced one.
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


@dataclass(frozen=True, eq=False, kw_only=True)
class StuckModes:
    """All modes up to a frequency, and the static response of the stuck joint.

    Attributes
    ----------
    shapes : (n_dof, n)
        Mass-normalized, in columns.
    frequencies : (n,) [1/time]
    stiffness : (n_dof, n_dof)
        Stiffness of the joint with closed points stuck.
    factor
        Its factorization, or K⁺ of (M11) for a free structure.
    """

    shapes: Matrix
    frequencies: Vector
    stiffness: SparseMatrix | Matrix
    factor: Factorization


def stuck_modes(system: System, state: Solution, highest: float, at_least: int = 1) -> StuckModes:
    """Return the modes of small vibrations up to a frequency, and a least number of them.

    Notes
    -----
    A factorization, another that counts the modes, and one Lanczos run for a full model; dense
    matrices for a reduced one.
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
    """Return shapes extended by the M-orthogonal remainders of modes of a released joint.

    Shapes (n_dof, n) have ΦᵀMΦ = I. The stiffness is that of the joint without springs of contact
    that some motion overcomes; it may be singular. The first of the frequencies [1/time], above 0,
    is the shift, the second the highest of the modes.

    Notes
    -----
    Two factorizations and one Lanczos run for a full model; dense matrices for a reduced one.
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
    # A frequency is too high by half the missing share of the mass of its shape.
    joins = mass > SHOWN_DIGITS
    return np.column_stack([shapes, outside @ ways[:, joins] / np.sqrt(mass[joins])])


def stuck_stiffness(system: System, state: Solution) -> SparseMatrix | Matrix:
    """Return K + Pᵀ (B⁻¹ + R)⁻¹ P with the springs B between the pairs of closed points.

    Closed points have the springs of their laws at their forces, 1/(c_n w) for a penalty and with
    friction 1/(c_t w) along both tangents; open ones have none. R is the residual compliance of a
    reduced model, if any. The state is a static solution, or a path, of which the end is taken.
    Sparse for a full model, dense for a reduced one.

    Notes
    -----
    If a law is hard the compliance between the pairs is needed, which a system computes once.
    """
    return _on_springs(system, *stuck_springs(system, state))


def slipping_stiffness(system: System, state: Solution) -> SparseMatrix | Matrix:
    """Return the stiffness on springs along normals alone: all closed points slip."""
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
    """Return the springs of closed points: displacements of the pairs to each, and flexibilities.

    Rows (n_spring, n_relative) are first along the normals of closed points, then along both
    tangents of those with friction; flexibilities are (n_spring,) [length/force]. For a path at its
    end. Laws that remember unload: a vibration's first period closes them deepest.
    """
    check_points(system, state)
    contact = system.contact
    forces = np.zeros((3, contact.n_points))
    forces[0] = np.atleast_2d(state.contact_forces)[-1]
    closed = forces[0] > 0
    deepest = None if state.deepest is None else np.atleast_2d(state.deepest)[-1]
    laws = LawsAtPoints(contact=contact, deepest=deepest)
    deepest = laws.closed_to(np.atleast_2d(state.gap)[-1])
    if deepest is not None:
        deepest = deepest + SOLVED * np.abs(deepest)
    compliance = laws.after(deepest).closure(forces)[1]
    stuck = np.tile(closed[contact.rubbing], 2)
    rows = sp.vstack([contact.interpolation[closed], contact.shear[stuck]]).tocsr()
    along = compliance[1:, contact.rubbing].ravel()[stuck]
    flexibility = np.concatenate([compliance[0, closed], along])
    if (flexibility == 0).any():
        # A direction without flexibility gets a share of the structure's compliance there.
        flexibility = np.maximum(flexibility, DECK_DIGITS * _own_compliance(system, rows))
    return rows, flexibility


def _own_compliance(system: System, rows: SparseMatrix) -> Vector:
    """Return the displacement along each row per force along it [length/force]."""
    forces, residual = rows.T.toarray(), system.contact.residual_compliance
    moved = system.port_compliance.pairs @ forces
    if residual is not None:
        moved = moved + residual @ forces
    return np.asarray(rows.multiply(moved.T).sum(axis=1)).ravel()


def preloaded_frequencies(model: Model, count: int, *, state: Solution | None = None) -> Vector:
    """Return the lowest frequencies of small vibrations about a static state.

    Points in contact stay closed and open ones stay open, K + Gᵀ diag(c_n w) G over the former. The
    stiffness is the unstressed one, on a preloaded beam up to 1 % low in ω (docs/accuracy.md).
    With friction every closed point sticks, with its tangential stiffness c_t w.

    Parameters
    ----------
    state
        Static solution to vibrate about, or a path, of which the end is taken; by default the
        joint under its bolts alone.

    Returns
    -------
    ndarray (count,) [1/time]

    Notes
    -----
    One factorization and one Lanczos run. :func:`faying.count_frequencies_below` proves that none
    is missing.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> fy.preloaded_frequencies(joint, 3).round()
    array([ 352.,  635., 1622.])
    """
    tangent = _tangent(model, state)
    factor = factorize_relieved(tangent, model.M, model.rigid_motions)
    squares, _ = lowest_modes(tangent, model.M, factor, count)
    return np.sqrt(squares) / (2 * np.pi)


def count_frequencies_below(
    model: Model, frequency: float, *, state: Solution | None = None
) -> int:
    """Return the number of natural frequencies about a static state below a limit [1/time].

    Parameters
    ----------
    state
        As in :func:`preloaded_frequencies`, which computes them.

    Raises
    ------
    InertiaError
        If the limit is so close to a natural frequency that round-off decides.

    Notes
    -----
    One factorization of K − ω²M with the closed contact in K, by Sylvester's law of inertia.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> fy.preloaded_frequencies(joint, 3).round()
    array([ 352.,  635., 1622.])
    >>> fy.count_frequencies_below(joint, 1e3)
    2
    """
    below = count_negative(_tangent(model, state) - (2 * np.pi * frequency) ** 2 * model.M)
    rigid: int = model.rigid_motions.shape[1]
    return below - rigid


def _tangent(model: Model, state: Solution | None) -> SparseMatrix:
    about = solve_static(model) if state is None else last_of(state)
    return cast("SparseMatrix", stuck_stiffness(model, about))
