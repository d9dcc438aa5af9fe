"""The linear export: a joint linearized at a static state, for programs without contact.

Points in contact at the state stay closed, open ones stay open. With the residual compliance R of
the model, the closed points A obey

    g_A = g₀_A + (GΦ)_A q + R_AA λ_A = −D_A λ_A,

so that the contact forces follow q exactly, λ_A = −(D_A + R_AA)⁻¹ (g₀_A + (GΦ)_A q), and

    K_lin = K_r + (GΦ)_Aᵀ (D_A + R_AA)⁻¹ (GΦ)_A.

The static response equals that of the full model linearized at the same state, because R holds
the residual compliance. Hard contact (D = 0) is the limit; its points get a millionth of their
compliance, as in :func:`faying.preloaded_frequencies`, because they may be dependent.

With friction every closed point sticks: G also has the tangential displacements of closed points,
and D their tangential flexibility. The model is then valid until the first point slips, and
has no friction damping.

The model cannot open or close the joint, so it has no softening when the joint opens and no
stiffening when it closes. It cannot slide outside the sticking area, damp by impact, or be valid
under loads or bolt forces far from the state. :meth:`LinearModel.contact_forces` shows the limit
of validity: a negative force is tension, a negative gap is penetration.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la

from faying._typing import Frozen, Indices, Mask, Matrix, Vector
from faying.assessment.stuck_modes import stuck_springs
from faying.joint.system import (
    System,
    boundary_dofs,
    elongations,
    input_forces,
    unstretched_bolt_forces,
)
from faying.linalg.relief import factorize_relieved
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES
from faying.reduction.normal_modes import lowest_modes
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.path import last_of, solve_static
from faying.simulation.solution import Solution


@dataclass(frozen=True, eq=False, kw_only=True)
class LinearModel(Frozen):
    """Small motions x = q − q₀ of a joint about a static state: M ẍ + C ẋ + K x = B f.

    Outputs are y = L x + D f.

    Attributes
    ----------
    M, C, K : (n_mode, n_mode)
        Mass, damping and stiffness with the tangent of the contact.
    state : (n_mode,)
        The static state q₀.
    boundary : (n_boundary,)
        Coordinate of each boundary degree of freedom, boundary by boundary.
    inputs : (n_mode, n_input)
        B: columns of boundary forces and moments, then of initial bolt forces, then of
        load patterns; f are changes from the state.
    outputs : (n_output, n_mode)
        L: rows of boundary displacements, then of bolt forces, then of clamp forces of interfaces,
        per x of the motion.
    feedthrough : (n_output, n_input)
        D: direct effect of inputs on outputs: a bolt's initial force is part of its force.
    input_names, output_names
        Such as ``"tip.Fz"``, ``"bolt.N0"``, the name of a load; ``"tip.uz"``, ``"bolt.N"``,
        ``"joint.clamp"``; with the node id between where a boundary has several nodes.
    rigid_motions : (n_mode, n_motion)
        Rigid-body motions without resistance, orthonormal in M.
    closed : (n_point,)
        Contact points in contact at the state.
    force_rows, gap_rows : (n_point, n_mode)
        Changes of contact forces and gaps per x.
    force_offsets, gap_offsets : (n_point,)
        Contact forces and gaps at the state.
    """

    M: Matrix
    C: Matrix
    K: Matrix
    state: Vector
    boundary: Indices
    inputs: Matrix
    outputs: Matrix
    feedthrough: Matrix
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]
    rigid_motions: Matrix
    closed: Mask
    force_rows: Matrix
    gap_rows: Matrix
    force_offsets: Vector
    gap_offsets: Vector

    def frequencies(self, count: int | None = None) -> Vector:
        """Return the lowest natural frequencies [1/time]; all by default.

        Rigid-body motions are not included.
        """
        return self.modes(count)[0]

    def modes(self, count: int | None = None) -> tuple[Vector, Matrix]:
        """Return the lowest frequencies [1/time] and their shapes (n_mode, count)."""
        elastic = len(self.K) - self.rigid_motions.shape[1]
        factor = factorize_relieved(self.K, self.M, self.rigid_motions)
        squares, shapes = lowest_modes(self.K, self.M, factor, min(count or elastic, elastic))
        return np.sqrt(squares) / (2 * np.pi), shapes

    def contact_forces(self, motion: Matrix) -> Matrix:
        """Return contact forces (..., n_point) of a motion x (..., n_mode); invalid if negative."""
        return self.force_offsets + motion @ self.force_rows.T

    def gaps(self, motion: Matrix) -> Matrix:
        """Return gaps (..., n_point) of a motion (..., n_mode); invalid if negative where open."""
        return self.gap_offsets + motion @ self.gap_rows.T


def linearize(about: ReducedModel | Solution) -> LinearModel:
    """Linearize a reduced model about a static solution, or the end of a path.

    Parameters
    ----------
    about
        Solution of a reduced model with dense matrices; or such a model, linearized about the joint
        under its bolts alone, tightened in one increment, with friction if any.

    Notes
    -----
    It takes one Cholesky factorization of the size of the closed points.
    """
    state = last_of(about) if isinstance(about, Solution) else solve_static(about)
    system = state.system
    closed = np.asarray(state.contact_forces > 0)
    added, forces, gaps = _contact_rows(state, closed)
    return LinearModel(
        M=np.asarray(system.M),
        C=np.asarray(system.C),
        K=_symmetric(np.asarray(system.K) + added),
        state=state.states,
        boundary=boundary_dofs(system.boundaries),
        inputs=input_forces(system, np.eye(len(_inputs(system)))).T,
        outputs=_output_rows(system, forces),
        feedthrough=_feedthrough(system),
        input_names=_inputs(system),
        output_names=_outputs(system),
        rigid_motions=system.rigid_motions,
        closed=closed,
        force_rows=forces,
        gap_rows=gaps,
        force_offsets=state.contact_forces,
        gap_offsets=state.gap,
    )


def _contact_rows(state: Solution, closed: Mask) -> tuple[Matrix, Matrix, Matrix]:
    """Return the contact stiffness, and derivatives of forces and gaps (n_point, n_mode) by q."""
    system, contact = state.system, state.system.contact
    gaps = np.array(contact.gap_operator)
    rows, flexibility = stuck_springs(system, state)
    forces = np.zeros_like(gaps)
    if not closed.any():
        return np.zeros((gaps.shape[1], gaps.shape[1])), forces, gaps
    seen = np.asarray(rows @ contact.relative_operator)
    residual = contact.residual_compliance
    if residual is None:
        springs = -seen / flexibility[:, None]
    else:
        moved = residual @ rows.T.toarray()
        total = np.diag(flexibility) + rows @ moved
        springs = -la.cho_solve(la.cho_factor(_symmetric(total)), seen)
        gaps = gaps + contact.interpolation @ (moved @ springs)
    forces[closed] = springs[: np.count_nonzero(closed)]
    return -seen.T @ springs, forces, gaps


def _symmetric(matrix: Matrix) -> Matrix:
    return (matrix + matrix.T) / 2


def _inputs(system: System) -> tuple[str, ...]:
    return (
        *boundary_names(system, FORCE_NAMES),
        *(f"{name}.N0" for name in system.bolts),
        *system.load_patterns,
    )


def _outputs(system: System) -> tuple[str, ...]:
    return (
        *boundary_names(system, DISPLACEMENT_NAMES),
        *(f"{name}.N" for name in system.bolts),
        *(f"{name}.clamp" for name in system.contact.slices),
    )


def boundary_names(system: System, components: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of all boundary degrees of freedom."""
    return tuple(
        f"{place}.{components[component]}"
        for boundary in system.boundaries.values()
        for place, component in boundary.places
    )


def _output_rows(system: System, forces: Matrix) -> Matrix:
    n_mode = int(system.K.shape[0])
    bolts = elongations(system.bolts, n_mode)
    stiffness = np.array([bolt.stiffness for bolt in system.bolts.values()])
    clamp = [forces[points].sum(axis=0) for points in system.contact.slices.values()]
    rows: Matrix = np.vstack(
        [
            np.eye(n_mode)[boundary_dofs(system.boundaries)],
            stiffness.reshape(-1, 1) * bolts,
            np.reshape(clamp, (len(clamp), n_mode)),
        ]
    )
    return rows


def _feedthrough(system: System) -> Matrix:
    """Return D, the bolt forces from inputs at zero elongation."""
    n_boundary, n_bolt = len(boundary_dofs(system.boundaries)), len(system.bolts)
    matrix = np.zeros((len(_outputs(system)), len(_inputs(system))))
    bolts = slice(n_boundary, n_boundary + n_bolt)
    matrix[bolts] = unstretched_bolt_forces(system, np.eye(matrix.shape[1])).T
    return matrix
