"""Derivatives of paths with friction by loads, bolt forces and what the interfaces are made of.

With x = admissible(x − r z) and z = H x + z_free, (F1), an increment changes by

    (I − J + J r H) δx = ∂x/∂μ δμ − J r (δz_free + ∂c/∂c_t δc_t),                             (F6)

J the derivative of what the laws admit; z_free holds what loads move, and the slip before, whose
change is what all increments before have added to it, δs + δz_t. ``docs/theory/friction.md``.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
import scipy.linalg as la

from faying._typing import Indices, Matrix, Vector
from faying.assessment.path_derivatives import PathDerivatives
from faying.assessment.slip import slip_history
from faying.contact.dense_points import SINGULAR_PIVOT
from faying.contact.frictional import FrictionalContact
from faying.exceptions import ModelError
from faying.joint.system import System, boundary_slices, unstretched_bolt_forces
from faying.model.boundary import FORCE_NAMES
from faying.simulation.path import moved_alone
from faying.simulation.solution import Solution

LEFT = 1e-7
"""Natural residual over the largest force above which an increment is not the one of its load."""


@final
@dataclass(frozen=True, eq=False)
class LinearIncrement:
    """An increment about which the path is linear.

    Attributes
    ----------
    forces, slack : (3, n_point)
        x and z of (F1).
    tried : (3, n_point)
        x − r z, whose projection x is.
    closed : (n_closed,)
        Points in contact; the forces of the others stay zero.
    slope : (n_point, 3, 3)
        J.
    lu, pivots
        Of the system (F6) between the points in contact.
    """

    forces: Matrix
    slack: Matrix
    tried: Matrix
    closed: Indices
    slope: Matrix
    lu: Matrix
    pivots: Indices


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PathSensitivity:
    """A path with friction, ready for derivatives.

    Attributes
    ----------
    system, path
        What is differentiated.
    initial
        The state the path went on from, which stays as it is.
    """

    system: System
    path: Solution
    initial: Solution | None

    @cached_property
    def loads(self) -> PathDerivatives:
        """By every boundary force and load pattern of the last state; the way to it stays."""
        ports, places = self.system.port_compliance, boundary_slices(self.system.boundaries)
        n = len(ports.input_rows)
        names, columns = [], []
        for name, boundary in self.system.boundaries.items():
            for component in np.unique(boundary.components).tolist():
                column = np.zeros(n)
                column[places[name]] = boundary.pattern(FORCE_NAMES[component])
                names.append(f"{name}.{FORCE_NAMES[component]}")
                columns.append(column)
        patterns = tuple(self.system.load_patterns)
        columns += list(np.eye(n)[n - len(patterns) :])
        changes = np.zeros((len(self.path.inputs), n, len(columns)))
        changes[-1] = np.array(columns).reshape(len(columns), n).T
        return self._follow((*names, *patterns), inputs=changes)

    @cached_property
    def initial_bolt_forces(self) -> PathDerivatives:
        """By the initial force N₀ of every bolt, changed alike in all states of the path."""
        ports = self.system.port_compliance
        changes = np.zeros((len(ports.input_rows), len(self.system.bolts)))
        changes[ports.bolts] = np.eye(len(self.system.bolts))
        whole = np.broadcast_to(changes, (len(self.path.inputs), *changes.shape))
        return self._follow(tuple(self.system.bolts), inputs=whole)

    @cached_property
    def friction(self) -> PathDerivatives:
        """By the coefficient of friction of every interface that has one, from the start on."""
        return self._follow(self._rubbing, friction=self._members(self._rubbing))

    @cached_property
    def tangential_penalty(self) -> PathDerivatives:
        """By c_t of every interface where what sticks gives, from the start on."""
        contact = self.system.contact
        gives = np.zeros(contact.n_points)
        gives[contact.rubbing] = contact.tangential_flexibility
        names = tuple(name for name in self._rubbing if gives[contact.slices[name]].any())
        change = -(gives**2) * contact.weights  # of 1/(c_t w) by c_t
        return self._follow(names, yields=self._members(names) * change[:, None])

    @property
    def _solver(self) -> FrictionalContact:
        return self.system.static_contact.frictional

    @property
    def _rubbing(self) -> tuple[str, ...]:
        laws = self.system.contact.laws
        return tuple(name for name, law in laws.items() if law.components > 1)

    def _members(self, names: tuple[str, ...]) -> Matrix:
        """Return which points (n_point, n) belong to interfaces, as ones and zeros."""
        members = np.zeros((self.system.contact.n_points, len(names)))
        for number, name in enumerate(names):
            members[self.system.contact.slices[name], number] = 1.0
        return members

    @cached_property
    def _increments(self) -> tuple[LinearIncrement, ...]:
        return tuple(self._linearized())

    def _linearized(self) -> Iterator[LinearIncrement]:
        contact, solver, n = self.system.contact, self._solver, self.system.contact.n_points
        slips = slip_history(self.path, self.initial)
        relative = moved_alone(self.system, self.path.inputs)
        shear = self.path.shear_forces
        for number, (moved, slip) in enumerate(zip(relative, slips[:-1], strict=True)):
            x = np.vstack([self.path.contact_forces[number][None], np.zeros((2, n))])
            if shear is not None:
                x[1:] = shear[number]
            closure, compliance = solver.laws.closure(x)
            z = solver.steps.moved(x) + closure + contact.free_slack(moved, slip)
            tried = x - solver.scale * z
            left = np.abs(x - solver.laws.admissible(tried, None)).max()
            if left > LEFT * np.abs(x).max():
                message = (
                    f"load {number + 1} on the path is not one increment from the state before it: "
                    "it was divided, or the path began elsewhere; give smaller increments, or the "
                    "state it began from as initial"
                )
                raise ModelError(message)
            slope = solver.laws.derivative(tried, None)
            closed = np.flatnonzero(tried[0] > 0)
            lu, pivots = self._factors(slope, compliance, closed)
            yield LinearIncrement(x, z, tried, closed, slope, lu, pivots)

    def _factors(
        self, slope: Matrix, compliance: Matrix, closed: Indices
    ) -> tuple[Matrix, Indices]:
        """Factorize I − J + J r H between the points in contact, component by component."""
        solver, n, size = self._solver, self.system.contact.n_points, 3 * len(closed)
        rows = (np.arange(3)[:, None] * n + closed).ravel()
        G = solver.G[rows]
        H = np.asarray(G @ (G @ solver.S).T) + np.diag(compliance[:, closed].ravel())
        scale = solver.scale[:, closed]
        own = slope[closed]
        scaled = (scale.ravel()[:, None] * H).reshape(3, len(closed), size)
        system = np.einsum("pij,jpq->ipq", own, scaled).reshape(size, size)
        at = np.arange(len(closed))
        for i in range(3):
            for j in range(3):
                system[i * len(closed) + at, j * len(closed) + at] += (i == j) - own[:, i, j]
        lu, pivots = la.lu_factor(system) if size else (np.zeros((0, 0)), np.zeros(0, np.int64))
        diagonal = np.abs(np.diag(lu))
        if diagonal.min(initial=1.0) < SINGULAR_PIVOT**2 * diagonal.max(initial=1.0):
            message = (
                "the path has no unique derivative: contact is hard and has more contact points "
                "than displacements, or friction is so large that there are several solutions; "
                "use nodal quadrature or a penalty"
            )
            raise ModelError(message)
        return lu, pivots

    def _follow(
        self,
        parameters: tuple[str, ...],
        *,
        inputs: Matrix | None = None,
        friction: Matrix | None = None,
        yields: Matrix | None = None,
    ) -> PathDerivatives:
        """Differentiate increment by increment.

        Parameters
        ----------
        inputs : (n_increment, n_input, n_parameter)
            Change of the loads.
        friction : (n_point, n_parameter)
            Change of the coefficients.
        yields : (n_point, n_parameter) [length/force]
            Change of what a tangential force yields.
        """
        contact, ports, n = self.system.contact, self.system.port_compliance, len(parameters)
        count = len(self.path.inputs)
        dinputs = np.zeros((count, len(ports.input_rows), n)) if inputs is None else inputs
        slip = np.zeros((2, contact.n_points, n))
        lower, upper, rows = np.full(n, -np.inf), np.full(n, np.inf), []
        for one, change in zip(self._increments, dinputs, strict=True):
            relative = moved_alone(self.system, change.T)
            dz = np.array([contact.moved(row) for row in relative]).reshape(n, 3, contact.n_points)
            dz = np.moveaxis(dz, 0, -1).copy()
            dz[1:] -= slip
            if yields is not None:
                dz[1:] += one.forces[1:, :, None] * yields
            dx = self._forces(one, dz, friction)
            dz += self._yielded(one, dx)
            slip = slip + dz[1:]
            down, up = self._reach(one, dx - self._scaled(dz), friction)
            lower, upper = np.maximum(lower, down), np.minimum(upper, up)
            lost = -np.einsum("ip,ipq->q", one.forces[1:], dz[1:])
            lost -= np.einsum("ipq,ip->q", dx[1:], one.slack[1:])
            rows.append((dx, slip, lost, self._moved(dx, change)))
        dx, slips, lost, moved = (np.array(column) for column in zip(*rows, strict=True))
        stiffness = np.array([bolt.stiffness for bolt in self.system.bolts.values()], dtype=float)
        return PathDerivatives(
            parameters=parameters,
            system=self.system,
            contact_forces=dx[:, 0],
            shear_forces=dx[:, 1:],
            shear_slip=slips,
            dissipation=lost,
            bolt_forces=stiffness[:, None] * moved[:, ports.bolts]
            + np.swapaxes(unstretched_bolt_forces(self.system, np.swapaxes(dinputs, 1, 2)), 1, 2),
            displacements=moved[:, : ports.n_boundary],
            lower=lower,
            upper=upper,
        )

    def _reach(
        self, one: LinearIncrement, rate: Matrix, friction: Matrix | None
    ) -> tuple[Vector, Vector]:
        """Return changes of the parameters at which a first point changes its state.

        Parameters
        ----------
        rate : (3, n_point, n_parameter)
            Of what is projected.
        """
        coefficients, tried = self._solver.friction, one.tried
        held = one.closed[coefficients[one.closed] > 0]
        size = np.hypot(tried[1, held], tried[2, held])
        way = tried[1:, held] / np.where(size > 0, size, 1.0)
        bound = coefficients[held, None] * rate[0, held]
        if friction is not None:
            bound = bound + tried[0, held, None] * friction[held]
        above = np.einsum("ip,ipq->pq", way, rate[1:, held]) - bound
        value = np.concatenate([tried[0], size - coefficients[held] * tried[0, held]])[:, None]
        rates = np.concatenate([rate[0], above])
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = np.where(rates == 0, np.inf, -value / rates)
        down = np.where(reach <= 0, reach, -np.inf).max(axis=0, initial=-np.inf)
        return down, np.where(reach >= 0, reach, np.inf).min(axis=0, initial=np.inf)

    def _forces(self, one: LinearIncrement, dz: Matrix, friction: Matrix | None) -> Matrix:
        """Solve (F6) for the changes of the forces (3, n_point, n_parameter)."""
        at, shape = one.closed, dz.shape
        right = -np.einsum("pij,jpq->ipq", one.slope[at], self._scaled(dz)[:, at])
        if friction is not None:
            size = np.hypot(one.tried[1], one.tried[2])[at]
            slips = size > self._solver.friction[at] * one.tried[0, at]
            pressed = np.where(slips, one.tried[0, at] / np.where(size > 0, size, 1.0), 0.0)
            right[1:] += (pressed * one.tried[1:, at])[:, :, None] * friction[at]
        dx = np.zeros(shape)
        if len(at):
            columns = right.reshape(3 * len(at), shape[2])
            dx[:, at] = la.lu_solve((one.lu, one.pivots), columns).reshape(3, len(at), shape[2])
        return dx

    def _scaled(self, dz: Matrix) -> Matrix:
        return np.asarray(self._solver.scale[:, :, None] * dz)

    def _yielded(self, one: LinearIncrement, dx: Matrix) -> Matrix:
        """Return H δx (3, n_point, n_parameter)."""
        solver = self._solver
        columns = dx.reshape(3 * dx.shape[1], dx.shape[2])
        moved = solver.G @ (solver.S @ (solver.steps.transposed @ columns))
        compliance = solver.laws.closure(one.forces)[1]
        return np.asarray(moved.reshape(dx.shape) + compliance[:, :, None] * dx)

    def _moved(self, dx: Matrix, change: Matrix) -> Matrix:
        """Return changes of the displacements of all inputs (n_input, n_parameter)."""
        ports = self.system.port_compliance
        signed = np.array(change)
        signed[ports.bolts] *= -1.0
        pairs = self._solver.steps.transposed @ dx.reshape(3 * dx.shape[1], dx.shape[2])
        return np.asarray(ports.input_rows @ signed + ports.contact_columns @ pairs)


def path_sensitivity(
    system: System, path: Solution, initial: Solution | None = None
) -> PathSensitivity:
    """Prepare the derivatives of a path with friction.

    Parameters
    ----------
    system
        The full or reduced model that was solved.
    path
        From :func:`faying.solve_path` with that model.
    initial
        The state it went on from, as ``solve_path`` was told; it stays as it is.

    Returns
    -------
    PathSensitivity
        ``.friction`` and ``.tangential_penalty`` of every interface, ``.initial_bolt_forces``, and
        ``.loads`` of the last state, each a :class:`PathDerivatives` over all states of the path:
        pressures, tractions, slip, dissipation, bolt forces, boundary displacements.

    Raises
    ------
    ModelError
        If nothing rubs, the path is not one of this model, an increment of it was divided, or the
        derivative is not unique.

    Notes
    -----
    A path has a derivative where no point is about to open, close, stick or slip, and ``lower`` and
    ``upper`` of the derivatives say how far that is, to first order: unlike without friction paths
    are not linear between, for where points slip their directions turn. Each increment takes an LU
    factorization between the points in contact, ⅔ (3 n)³ multiplications, and a substitution for
    each parameter.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=5.0, penalty=1e6).with_bolt_forces({"bolt": 8e3})
    >>> rubbing = joint.with_friction(0.2)
    >>> path = fy.solve_path(rubbing, [fy.Load(), fy.Load({"tip.Fx": 1000.0})])
    >>> change = path_sensitivity(rubbing, path)
    >>> bool(change.friction.displacement("tip")[-1, 0, 0] < 0)  # rougher, less far
    True
    """
    contact = system.contact
    if contact.components == 1:
        message = "the model has no friction: take fy.sensitivity of a static solution"
        raise ModelError(message)
    rows = np.shape(path.inputs)
    if path.times is not None or np.shape(path.contact_forces) != (rows[0], contact.n_points):
        message = (
            f"derivatives along a path need a result of solve_path of this model; '{path.name}' "
            f"has contact forces of shape {np.shape(path.contact_forces)} for "
            f"{contact.n_points} contact points"
        )
        raise ModelError(message)
    return PathSensitivity(system=system, path=path, initial=initial)
