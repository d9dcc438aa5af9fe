"""Derivatives of a static contact solution by loads, bolt forces and initial gaps.

Where no point is about to open or close, the points A in contact stay the same and the condensed
problem, (M3) of ``docs/theory/method.md``, is linear there:

    H_AA δλ_A = −δg_A,    δg = G K⁻¹ δf + δg₀,    δλ = 0 elsewhere.

One Cholesky factorization of H_AA and one back-substitution serve all parameters at once. The
solution is piecewise linear in its inputs, so within the range given beside each derivative it is
no approximation.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg as la

from faying._typing import Indices, Matrix, Vector
from faying.assessment.derivatives import Derivatives
from faying.contact.dense_points import SINGULAR_PIVOT
from faying.exceptions import ModelError
from faying.joint.system import System, boundary_slices, unstretched_bolt_forces
from faying.model.boundary import FORCE_NAMES
from faying.simulation.solution import Solution
from faying.simulation.static import port_forces, solve_static_inputs

NO_RESISTANCE = 1e-9
"""Change of bolt force per change of initial force below which a bolt clamps nothing."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Sensitivity:
    """A static solution with its points in contact factorized, ready for derivatives.

    Attributes
    ----------
    system, solution
        What was differentiated.
    active : (n_active,)
        Indices of the points in contact.
    """

    system: System
    solution: Solution
    active: Indices

    @cached_property
    def boundary_forces(self) -> Derivatives:
        """Derivatives by every boundary force component, ``"tip.Fz"`` … [per force]."""
        ports, places = self.system.port_compliance, boundary_slices(self.system.boundaries)
        names, columns = [], []
        for name, boundary in self.system.boundaries.items():
            for component in np.unique(boundary.components).tolist():
                column = np.zeros(len(ports.input_rows))
                column[places[name]] = boundary.pattern(FORCE_NAMES[component])
                names.append(f"{name}.{FORCE_NAMES[component]}")
                columns.append(column)
        changes = np.array(columns).reshape(len(names), len(ports.input_rows)).T
        return self._respond(tuple(names), inputs=changes)

    @cached_property
    def load_patterns(self) -> Derivatives:
        """Derivatives by the amplitudes of the load patterns."""
        names = tuple(self.system.load_patterns)
        changes = np.eye(len(self.system.port_compliance.input_rows))
        return self._respond(names, inputs=changes[:, len(changes) - len(names) :])

    @cached_property
    def initial_bolt_forces(self) -> Derivatives:
        """Derivatives by the initial forces N₀ the bolts are locked at."""
        return self._respond(tuple(self.system.bolts), inputs=self._bolt_inputs(self._unit_bolts))

    @cached_property
    def final_preloads(self) -> Derivatives:
        """Derivatives by the nominal final forces F the bolts are tightened to, without load.

        ∂N₀/∂F is the inverse of the slope of the bolt forces in the tightened state, which has
        its own points in contact; the range minds both states.

        Raises
        ------
        ModelError
            If tightening a bolt clamps nothing.
        """
        changes = self._bolt_inputs(self._tightening)
        loaded = self._respond(tuple(self.system.bolts), inputs=changes)
        tightened = self._tightened._respond(tuple(self.system.bolts), inputs=changes)
        return loaded.within(tightened)

    def initial_gap(
        self, directions: Matrix, parameters: Sequence[str] | None = None
    ) -> Derivatives:
        """Differentiate by changes of the initial gap, the bolts locked at their N₀.

        Parameters
        ----------
        directions : (n_point,) or (n_point, n_parameter)
            Change of g₀ per unit of each parameter; the identity gives all points one by one.
        parameters
            Names; numbers unless given.
        """
        columns, names = self._directions(directions, parameters)
        return self._respond(names, gap=columns)

    def initial_gap_at_final_preload(
        self, directions: Matrix, parameters: Sequence[str] | None = None
    ) -> Derivatives:
        """Differentiate by changes of the initial gap, the bolts tightened anew to the same F.

        Parameters are those of :meth:`initial_gap`.
        """
        columns, names = self._directions(directions, parameters)
        lost = self._tightened._respond(names, gap=columns).bolt_forces
        inputs = self._bolt_inputs(-self._tightening @ lost)
        loaded = self._respond(names, inputs=inputs, gap=columns)
        return loaded.within(self._tightened._respond(names, inputs=inputs, gap=columns))

    @cached_property
    def _factor(self) -> tuple[Matrix, bool]:
        """Cholesky factor of H_AA."""
        H = self.system.static_contact.flexibility[np.ix_(self.active, self.active)]
        try:
            factor = la.cholesky(H, lower=True)
        except la.LinAlgError:
            factor = np.zeros((1, 1))
        pivots = np.diag(factor)
        if pivots.min(initial=1.0) < SINGULAR_PIVOT * pivots.max(initial=1.0):
            message = (
                "contact is hard and has more contact points than normal displacements, so the "
                "derivative of single pressures is not unique; use nodal quadrature or a penalty"
            )
            raise ModelError(message)
        return factor, True

    @cached_property
    def _gap_per_input(self) -> Matrix:
        """J (n_point, n_input): free gap per input."""
        ports = self.system.port_compliance
        signed = port_forces(ports, np.eye(len(ports.input_rows)))
        gap: Matrix = self.system.contact.interpolation @ (signed @ ports.contact_columns).T
        return gap

    @cached_property
    def _unit_bolts(self) -> Matrix:
        return np.eye(len(self.system.bolts))

    @cached_property
    def _tightened(self) -> "Sensitivity":
        """The state without load, at the initial bolt forces of the solution."""
        inputs = self.solution.inputs.copy()
        bolts = self.system.port_compliance.bolts
        inputs[: bolts.start], inputs[bolts.stop :] = 0.0, 0.0
        cases = solve_static_inputs(self.system, inputs[None], "tightened")
        return Sensitivity(
            system=self.system,
            solution=_single(cases),
            active=np.flatnonzero(cases.contact_forces[0] > 0),
        )

    @cached_property
    def _tightening(self) -> Matrix:
        """∂N₀/∂F (n_bolt, n_bolt)."""
        slope = self._tightened.initial_bolt_forces.bolt_forces
        if np.linalg.svd(slope, compute_uv=False).min(initial=1.0) < NO_RESISTANCE:
            message = (
                f"the bolts {', '.join(self.system.bolts)} have no final preload to change: "
                "tightening one of them clamps nothing"
            )
            raise ModelError(message)
        return np.asarray(np.linalg.inv(slope), dtype=float)

    def _bolt_inputs(self, changes: Matrix) -> Matrix:
        """Place changes of the initial bolt forces among inputs that stay."""
        ports = self.system.port_compliance
        inputs = np.zeros((len(ports.input_rows), changes.shape[1]))
        inputs[ports.bolts] = changes
        return inputs

    def _directions(
        self, directions: Matrix, parameters: Sequence[str] | None
    ) -> tuple[Matrix, tuple[str, ...]]:
        columns = np.asarray(directions, dtype=float)
        columns = columns[:, None] if columns.ndim == 1 else columns
        if columns.ndim != 2 or len(columns) != self.system.contact.n_points:
            message = (
                f"changes of the initial gap have shape {np.shape(directions)}; give one row for "
                f"each of the {self.system.contact.n_points} contact points"
            )
            raise ModelError(message)
        names = map(str, range(columns.shape[1])) if parameters is None else parameters
        return columns, tuple(names)

    def _respond(
        self,
        parameters: tuple[str, ...],
        *,
        inputs: Matrix | None = None,
        gap: Matrix | None = None,
    ) -> Derivatives:
        """Differentiate along changes of the inputs and of the initial gap, column by column."""
        system, ports, n = self.system, self.system.port_compliance, len(parameters)
        dinputs = np.zeros((len(ports.input_rows), n)) if inputs is None else inputs
        dgap = np.zeros((system.contact.n_points, n)) if gap is None else gap
        dgap = dgap + self._gap_per_input @ dinputs
        dforces = np.zeros_like(dgap)
        if len(self.active):
            dforces[self.active] = -la.cho_solve(self._factor, dgap[self.active])
        dslack = dgap + system.static_contact.flexibility @ dforces
        dslack[self.active] = 0.0

        signed = port_forces(ports, dinputs.T)
        moved = ports.input_rows @ signed.T
        moved = moved + ports.contact_columns @ (system.contact.interpolation.T @ dforces)
        stiffness = np.array([bolt.stiffness for bolt in system.bolts.values()], dtype=float)
        elongation = moved[ports.bolts]
        lower, upper = self._range(dforces, dslack)
        return Derivatives(
            parameters=parameters,
            system=system,
            contact_forces=dforces,
            slack=dslack,
            bolt_forces=stiffness[:, None] * elongation
            + unstretched_bolt_forces(system, dinputs.T).T,
            displacements=moved[: ports.n_boundary],
            lower=lower,
            upper=upper,
        )

    def _range(self, dforces: Matrix, dslack: Matrix) -> tuple[Vector, Vector]:
        """Return changes at which the first force in contact, or slack out of contact, vanishes."""
        forces = self.solution.contact_forces
        slack = self.solution.gap + self.system.contact.flexibility * forces
        closed = np.zeros(len(forces), dtype=bool)
        closed[self.active] = True
        value = np.where(closed, forces, np.maximum(slack, 0.0))[:, None]
        rate = np.where(closed[:, None], dforces, dslack)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = -value / rate
        upper = np.where(rate < 0, reach, np.inf).min(axis=0, initial=np.inf)
        lower = np.where(rate > 0, reach, -np.inf).max(axis=0, initial=-np.inf)
        return lower, upper


def sensitivity(system: System, solution: Solution) -> Sensitivity:
    """Prepare the derivatives of one static solution.

    Parameters
    ----------
    system
        The full or reduced model that was solved.
    solution
        From :func:`faying.solve_static` with that model.

    Returns
    -------
    Sensitivity
        ``.boundary_forces``, ``.load_patterns``, ``.initial_bolt_forces``, ``.final_preloads`` and
        ``.initial_gap(directions)``, each a :class:`Derivatives` with pressures, contact forces,
        bolt forces, boundary displacements, and the range in which it is exact.

    Raises
    ------
    ModelError
        If the solution is not a single static one of this model.

    Notes
    -----
    One dense Cholesky factorization of the points in contact; 464 points and all parameters of
    the default cantilever take milliseconds. A point that just touches (no force, no gap) makes
    the derivative one-sided: its range then ends at zero on the other side.

    Examples
    --------
    >>> import faying as fy
    >>> model = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> change = sensitivity(model, fy.solve_static(model)).final_preloads
    >>> change.parameters, round(float(change.bolt_forces[0, 0]), 9)
    (('bolt',), 1.0)
    """
    n_input = len(system.port_compliance.input_rows)
    shapes = solution.contact_forces.shape, solution.inputs.shape
    if solution.times is not None or shapes != ((system.contact.n_points,), (n_input,)):
        message = (
            f"sensitivities need one static solution of this model; found contact forces of shape "
            f"{shapes[0]} for {system.contact.n_points} contact points (of paths with friction "
            "take fy.path_sensitivity)"
        )
        raise ModelError(message)
    return Sensitivity(
        system=system,
        solution=solution,
        active=np.flatnonzero(solution.contact_forces > 0),
    )


def _single(cases: Solution) -> Solution:
    """Return the first of several cases as a solution of its own."""
    return Solution(
        name=cases.name,
        system=cases.system,
        states=cases.states[0],
        contact_forces=cases.contact_forces[0],
        gap=cases.gap[0],
        inputs=cases.inputs[0],
        iterations=cases.iterations[0],
    )
