"""Derivatives of static solutions and of paths with friction by loads, bolts and interfaces.

With x = admissible(x − r z) and z = H x + z_free, (F1), an increment changes by

    (I − J + J r H) δx = ∂x/∂μ δμ − J r (δz_free + ∂c/∂c_t δc_t),                             (F6)

J is the derivative of the projection; z_free contains displacements due to loads, and the slip
before, whose change is the sum over all earlier increments, δs + δz_t.
``docs/theory/friction.md``. Without friction these are H_AA δλ_A = −δg_A of the points A in
contact, and a static solution is a path of one state.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.linear_increments import Derivatives, LinearIncrement, linear_increments
from faying.digits import SOLVED
from faying.exceptions import refuse_model
from faying.joint.system import System, boundary_slices, unstretched_bolt_forces
from faying.model.boundary import FORCE_NAMES
from faying.simulation.path import moved_alone, state_of
from faying.simulation.solution import Solution
from faying.simulation.static import solve_static_inputs


@dataclass(frozen=True, eq=False, kw_only=True)
class Sensitivity:
    """A static solution or a path, prepared for derivatives.

    Attributes
    ----------
    system, solution
        Model and solution to differentiate.
    initial
        The constant state from which a path continued.
    """

    system: System
    solution: Solution
    initial: Solution | None = None

    @cached_property
    def loads(self) -> Derivatives:
        """Derivatives by boundary forces, as ``"tip.Fz"``, and load patterns, of the last state.

        The path to the last state does not change.
        """
        ports, slices = self.system.port_compliance, boundary_slices(self.system.boundaries)
        n = len(ports.input_rows)
        names, columns = [], []
        for name, boundary in self.system.boundaries.items():
            for component in np.unique(boundary.components).tolist():
                column = np.zeros(n)
                column[slices[name]] = boundary.pattern(FORCE_NAMES[component])
                names.append(f"{name}.{FORCE_NAMES[component]}")
                columns.append(column)
        patterns = tuple(self.system.load_patterns)
        columns += list(np.eye(n)[n - len(patterns) :])
        changes = np.zeros((len(self._inputs), n, len(columns)))
        changes[-1] = np.array(columns).reshape(len(columns), n).T
        return self._follow((*names, *patterns), inputs=changes)

    @cached_property
    def initial_bolt_forces(self) -> Derivatives:
        """Derivatives by the initial force N₀ of every bolt, changed in all states."""
        return self._by_bolts(np.eye(len(self.system.bolts)))

    @cached_property
    def final_preloads(self) -> Derivatives:
        """Derivatives by the nominal final forces F of the tightened bolts, without load.

        ∂N₀/∂F is the inverse of the slope of the bolt forces in the tightened state, which has
        its own points in contact; the range respects both states.

        Raises
        ------
        ModelError
            If tightening a bolt clamps nothing, or with friction, where the effect of a preload
            depends on the path to it.
        """
        self.system.contact.check_frictionless(
            "so that final preloads depend on the order of tightening; take initial_bolt_forces"
        )
        slope = self._tightened_state.initial_bolt_forces.bolt_forces
        if np.linalg.svd(slope, compute_uv=False).min(initial=1.0) < SOLVED:
            refuse_model(
                f"the bolts {', '.join(self.system.bolts)} have no final preload to change: "
                "tightening one of them clamps nothing"
            )
        changes = np.asarray(np.linalg.inv(slope), dtype=float)
        return self._by_bolts(changes).within(self._tightened_state._by_bolts(changes))

    @cached_property
    def friction(self) -> Derivatives:
        """Derivatives by the coefficient of friction of every interface that has one."""
        names = self._where(self.system.contact.coefficients)
        return self._follow(names, friction=self._members(names))

    @cached_property
    def tangential_penalty(self) -> Derivatives:
        """Derivatives by c_t of every interface with compliant sticking points."""
        contact = self.system.contact
        flexibility = np.zeros(contact.n_points)
        flexibility[contact.rubbing] = contact.tangential_flexibility
        names = self._where(flexibility)
        change = -(flexibility**2) * contact.weights  # of 1/(c_t w) by c_t
        return self._follow(names, yields=self._members(names) * change[:, None])

    def initial_gap(
        self, directions: Matrix, parameters: Sequence[str] | None = None
    ) -> Derivatives:
        """Return derivatives by changes of the initial gap, with bolts locked at their N₀.

        Parameters
        ----------
        directions : (n_point,) or (n_point, n_parameter)
            Change of g₀ per unit of each parameter; the identity for single points.
        parameters
            Names; by default numbers.

        Raises
        ------
        ModelError
            If there is not one row for each contact point.
        """
        columns = np.asarray(directions, dtype=float)
        columns = columns[:, None] if columns.ndim == 1 else columns
        if columns.ndim != 2 or len(columns) != self.system.contact.n_points:
            refuse_model(
                f"changes of the initial gap have shape {np.shape(directions)}; give one row for "
                f"each of the {self.system.contact.n_points} contact points"
            )
        names = map(str, range(columns.shape[1])) if parameters is None else parameters
        return self._follow(tuple(names), gap=columns)

    @property
    def _inputs(self) -> Matrix:
        return np.atleast_2d(self.solution.inputs)

    def _where(self, values: Vector) -> tuple[str, ...]:
        """Return the interfaces with a nonzero value (n_point,) at some point."""
        slices = self.system.contact.slices.items()
        return tuple(name for name, points in slices if values[points].any())

    def _members(self, names: tuple[str, ...]) -> Matrix:
        """Return the points (n_point, n) of interfaces, as ones and zeros."""
        members = np.zeros((self.system.contact.n_points, len(names)))
        for number, name in enumerate(names):
            members[self.system.contact.slices[name], number] = 1.0
        return members

    @cached_property
    def _tightened_state(self) -> "Sensitivity":
        """The state without load, at the initial bolt forces of the last state."""
        inputs = self._inputs[-1:].copy()
        bolts = self.system.port_compliance.bolts
        inputs[:, : bolts.start], inputs[:, bolts.stop :] = 0.0, 0.0
        cases = solve_static_inputs(self.system, inputs, "tightened")
        return Sensitivity(system=self.system, solution=state_of(cases, 0))

    def _by_bolts(self, changes: Matrix) -> Derivatives:
        """Return derivatives along changes of the initial bolt forces (n_bolt, n_bolt)."""
        ports = self.system.port_compliance
        inputs = np.zeros((len(ports.input_rows), changes.shape[1]))
        inputs[ports.bolts] = changes
        whole = np.broadcast_to(inputs, (len(self._inputs), *inputs.shape))
        return self._follow(tuple(self.system.bolts), inputs=whole)

    @cached_property
    def _increments(self) -> tuple[LinearIncrement, ...]:
        return tuple(linear_increments(self.solution, self.initial))

    def _follow(
        self,
        parameters: tuple[str, ...],
        *,
        inputs: Matrix | float = 0.0,
        gap: Matrix | float = 0.0,
        friction: Matrix | float = 0.0,
        yields: Matrix | float = 0.0,
    ) -> Derivatives:
        """Return derivatives, increment by increment, from changes per unit of each parameter.

        Changes of the loads are (n_increment, n_input, n_parameter). Changes of the initial gap
        [length], the coefficients of friction and the tangential compliances [length/force] are
        (n_point, n_parameter).
        """
        contact, ports, n = self.system.contact, self.system.port_compliance, len(parameters)
        count = len(self._inputs)
        dinputs = np.broadcast_to(inputs, (count, len(ports.input_rows), n))
        dfriction = np.broadcast_to(friction, (contact.n_points, n))
        slip = np.zeros((2, contact.n_points, n))
        lower, upper, rows = np.full(n, -np.inf), np.full(n, np.inf), []
        for increment, change in zip(self._increments, dinputs, strict=True):
            relative = moved_alone(self.system, change.T)
            dz = np.array([contact.moved(row) for row in relative]).reshape(n, 3, contact.n_points)
            dz = np.moveaxis(dz, 0, -1).copy()
            dz[1:] -= slip
            dz[0] += gap
            dz[1:] += increment.forces[1:, :, None] * yields
            dx = increment.changes(dz, dfriction)
            dz += increment.yielded(dx)
            slip = slip + dz[1:]
            down, up = increment.reach(dx - increment.scaled(dz), dfriction)
            lower, upper = np.maximum(lower, down), np.minimum(upper, up)
            lost = -np.einsum("ip,ipq->q", increment.forces[1:], dz[1:])
            lost -= np.einsum("ipq,ip->q", dx[1:], increment.slack[1:])
            rows.append((dx, slip, lost, self._displacement_changes(dx, change)))
        columns = [np.array(column) for column in zip(*rows, strict=True)]
        forces = np.swapaxes(unstretched_bolt_forces(self.system, np.swapaxes(dinputs, 1, 2)), 1, 2)
        if self.solution.inputs.ndim == 1:
            columns, forces = [column[0] for column in columns], forces[0]
        dx, slips, lost, moved = columns
        stiffness = np.array([bolt.stiffness for bolt in self.system.bolts.values()], dtype=float)
        return Derivatives(
            parameters=parameters,
            system=self.system,
            contact_forces=dx[..., 0, :, :],
            shear_forces=dx[..., 1:, :, :],
            shear_slip=slips,
            dissipation=lost,
            bolt_forces=stiffness[:, None] * moved[..., ports.bolts, :] + forces,
            displacements=moved[..., : ports.n_boundary, :],
            lower=lower,
            upper=upper,
        )

    def _displacement_changes(self, dx: Matrix, change: Matrix) -> Matrix:
        """Return changes of the displacements of all inputs (n_input, n_parameter)."""
        ports = self.system.port_compliance
        signed = np.array(change)
        signed[ports.bolts] *= -1.0
        pairs = self.system.contact.at_pairs(dx[0].T, np.moveaxis(dx[1:], 2, 0))
        return np.asarray(ports.input_rows @ signed + ports.contact_columns @ pairs)


def sensitivity(system: System, solution: Solution, initial: Solution | None = None) -> Sensitivity:
    """Return the prepared derivatives of a static solution, or of a path with friction.

    Parameters
    ----------
    system
        The full or reduced model that was solved.
    solution
        From :func:`faying.solve_static` or, with friction, :func:`faying.solve_path`, with that
        model.
    initial
        The state from which a path continued, as given to ``solve_path``; it is constant.

    Returns
    -------
    Sensitivity
        ``.loads`` (of the last state), ``.initial_bolt_forces``, ``.initial_gap(directions)``,
        without friction ``.final_preloads``, with it ``.friction`` and ``.tangential_penalty`` of
        every interface; each a :class:`~faying.assessment.linear_increments.Derivatives`:
        pressures, tractions, slip, dissipation, bolt forces, boundary displacements, and the range
        in which no point changes its state.

    Raises
    ------
    ModelError
        If the solution is not one of this model, an increment of it was divided, or the derivative
        is not unique.

    Notes
    -----
    Each state takes an LU factorization between the points in contact, ⅔ (k n)³ multiplications
    with k = 3 components with friction and 1 without, and a substitution for each parameter. A
    point that just touches (no force, no gap) makes the derivative one-sided: its range ends at
    zero on the other side.

    Examples
    --------
    >>> import faying as fy
    >>> model = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> change = sensitivity(model, fy.solve_static(model)).final_preloads
    >>> change.parameters, round(float(change.bolt_forces[0, 0]), 9)
    (('bolt',), 1.0)
    """
    contact, n_input = system.contact, len(system.port_compliance.input_rows)
    shapes = np.shape(solution.contact_forces), np.shape(solution.inputs)
    count, last = shapes[1][:-1], int(np.prod(shapes[1][:-1])) - 1
    # Independent cases are no path: each has its derivatives.
    path = len(contact.way_to(np.array([last]))) == last + 1
    expected = (*count, contact.n_points), (*count, n_input)
    if solution.times is not None or not path or shapes != expected:
        refuse_model(
            "sensitivities need one static solution of this model, or a path of it with friction; "
            f"'{solution.name}' has contact forces of shape {shapes[0]} for {contact.n_points} "
            "contact points"
        )
    return Sensitivity(system=system, solution=solution, initial=initial)
