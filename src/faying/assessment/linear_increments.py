"""Derivatives of solutions by parameters, and the linearized increments behind them, (F6)."""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

import numpy as np
import scipy.linalg as la

from faying._typing import Frozen, Indices, Matrix, Vector
from faying.assessment.natural_map import NaturalMap
from faying.assessment.slip import slip_history
from faying.digits import DECK_DIGITS, ROUND_OFF
from faying.exceptions import ModelError, check_known, refuse_model
from faying.joint.system import System, boundary_slices
from faying.simulation.path import moved_alone
from faying.simulation.solution import Solution


@dataclass(frozen=True, eq=False, kw_only=True)
class Derivatives(Frozen):
    """Derivatives by some parameters; the last axis of every array is the parameter.

    For a path the first axis is the increment; for a static solution there is none.

    Attributes
    ----------
    parameters
        Names.
    system
        The model of the solution.
    contact_forces : (..., n_point, n_parameter)
    shear_forces : (..., 2, n_point, n_parameter)
        Along both tangents of the points.
    shear_slip : (..., 2, n_point, n_parameter)
        Derivatives of the slip so far.
    dissipation : (..., n_parameter)
        Derivatives of the energy dissipated by friction in each increment.
    bolt_forces : (..., n_bolt, n_parameter)
    displacements : (..., n_boundary, n_parameter)
        At the boundary degrees of freedom, boundary by boundary.
    lower, upper : (n_parameter,)
        Change of each parameter alone (lower ≤ 0 ≤ upper) at which a first point opens, closes,
        sticks or slips in some state; infinite where none ever does. Between them derivatives
        without friction are exact. With friction they hold to first order, because directions of
        slip turn.
    """

    parameters: tuple[str, ...]
    system: System
    contact_forces: Matrix
    shear_forces: Matrix
    shear_slip: Matrix
    dissipation: Matrix
    bolt_forces: Matrix
    displacements: Matrix
    lower: Vector
    upper: Vector

    @property
    def pressure(self) -> Matrix:
        """Derivatives of the pressure (..., n_point, n_parameter)."""
        return np.asarray(self.contact_forces / self.system.contact.weights[:, None])

    @property
    def traction(self) -> Matrix:
        """Derivatives of the traction on the plus side (..., n_point, 3, n_parameter)."""
        return self._along_tangents(self.shear_forces) / self.system.contact.weights[:, None, None]

    @property
    def slip(self) -> Matrix:
        """Derivatives of the slip (..., n_point, 3, n_parameter)."""
        return self._along_tangents(self.shear_slip)

    def contact_force(self, interface: str | None = None) -> Matrix:
        """Return derivatives (..., n_parameter) of the normal force of one interface, or of all.

        Raises
        ------
        ModelError
            If there is no such interface.
        """
        slices = self.system.contact.slices
        if interface is not None:
            check_known(interface, slices, "interface")
        points = slice(None) if interface is None else slices[interface]
        return np.asarray(self.contact_forces[..., points, :].sum(axis=-2))

    def displacement(self, boundary: str) -> Matrix:
        """Return derivatives (..., n, n_parameter) of the displacements at a boundary.

        Raises
        ------
        ModelError
            If there is no such boundary.
        """
        columns = boundary_slices(self.system.boundaries)
        check_known(boundary, columns, "boundary")
        return np.asarray(self.displacements[..., columns[boundary], :])

    def of(self, parameter: str) -> "Derivatives":
        """Return the derivatives by one parameter, in arrays with one column.

        Raises
        ------
        ModelError
            If there is no such parameter.
        """
        if parameter not in self.parameters:
            message = f"there is no parameter '{parameter}'; they are {', '.join(self.parameters)}"
            raise ModelError(message)
        column = [self.parameters.index(parameter)]
        arrays = {field.name: getattr(self, field.name)[..., column] for field in fields(self)[2:]}
        return replace(self, parameters=(parameter,), **arrays)

    def within(self, limit: "Derivatives") -> "Derivatives":
        """Return the derivatives with ranges restricted to those of other derivatives."""
        return replace(
            self,
            lower=np.maximum(self.lower, limit.lower),
            upper=np.minimum(self.upper, limit.upper),
        )

    def _along_tangents(self, values: Matrix) -> Matrix:
        tangents = self.system.contact.tangents
        return np.asarray(np.einsum("...ipq,ipk->...pkq", values, tangents))


@dataclass(frozen=True, eq=False)
class LinearIncrement:
    """An increment with the linearized equations of its solution.

    Attributes
    ----------
    equations
        Equations of the increment.
    forces, slack : (3, n_point)
        x and z of (F1).
    tried : (3, n_point)
        x − r z, with the projection x.
    closed : (n_closed,)
        Points in contact; the forces of all others stay zero.
    slope : (n_point, 3, 3)
        J.
    lu, pivots
        Factors of the system (F6) between the points in contact.
    """

    equations: NaturalMap
    forces: Matrix
    slack: Matrix
    tried: Matrix
    closed: Indices
    slope: Matrix
    lu: Matrix
    pivots: Indices

    def changes(self, dz: Matrix, friction: Matrix) -> Matrix:
        """Return the changes of the forces (3, n_point, n_parameter) by (F6)."""
        closed, k, tried = self.closed, self.equations.contact.components, self.tried
        right = -np.einsum("pij,jpq->ipq", self.slope[closed], self.scaled(dz)[:, closed])
        size = np.hypot(tried[1], tried[2])[closed]
        slips = size > self.equations.contact.coefficients[closed] * tried[0, closed]
        pressed = np.where(slips, tried[0, closed] / np.where(size > 0, size, 1.0), 0.0)
        right[1:] += (pressed * tried[1:, closed])[:, :, None] * friction[closed]
        dx = np.zeros(dz.shape)
        if len(closed):
            columns = right[:k].reshape(k * len(closed), dz.shape[2])
            solved = la.lu_solve((self.lu, self.pivots), columns)
            dx[:k, closed] = solved.reshape(k, len(closed), dz.shape[2])
        return dx

    def scaled(self, dz: Matrix) -> Matrix:
        """Return r δz (3, n_point, n_parameter)."""
        return np.asarray(self.equations.scale[:, :, None] * dz)

    def yielded(self, dx: Matrix) -> Matrix:
        """Return H δx (3, n_point, n_parameter)."""
        compliance = self.equations.laws.closure(self.forces)[1]
        return np.asarray(self.equations.moved(dx) + compliance[:, :, None] * dx)

    def reach(self, rate: Matrix, friction: Matrix) -> tuple[Vector, Vector]:
        """Return changes of the parameters at which a first point changes its state.

        Rates (3, n_point, n_parameter) are those of the argument of the projection.
        """
        coefficients, tried = self.equations.contact.coefficients, self.tried
        rubbing = self.closed[coefficients[self.closed] > 0]
        size = np.hypot(tried[1, rubbing], tried[2, rubbing])
        way = tried[1:, rubbing] / np.where(size > 0, size, 1.0)
        bound = coefficients[rubbing, None] * rate[0, rubbing]
        bound = bound + tried[0, rubbing, None] * friction[rubbing]
        above = np.einsum("ip,ipq->pq", way, rate[1:, rubbing]) - bound
        value = np.concatenate([tried[0], size - coefficients[rubbing] * tried[0, rubbing]])
        rates = np.concatenate([rate[0], above])
        towards = np.where(value[:, None] > 0, -rates, rates)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = np.abs(value[:, None] / rates)
        down = np.where(towards < 0, -reach, -np.inf).max(axis=0, initial=-np.inf)
        return down, np.where(towards > 0, reach, np.inf).min(axis=0, initial=np.inf)


def linear_increments(solution: Solution, initial: Solution | None) -> Iterator[LinearIncrement]:
    """Yield the linearization of every increment of a path, or of a static solution.

    Raises
    ------
    ModelError
        If an increment was divided, or its derivative is not unique.
    """
    system = solution.system
    contact, equations = system.contact, NaturalMap.of(system)
    n = contact.n_points
    slips = slip_history(solution, initial)
    relative = moved_alone(system, np.atleast_2d(solution.inputs))
    normal = solution.contact_forces.reshape(-1, 1, n)
    acting = np.concatenate([normal, solution.shear_forces.reshape(len(normal), -1, n)], axis=1)
    for number, (moved, slip) in enumerate(zip(relative, slips[:-1], strict=True)):
        x = np.zeros((3, n))
        x[: contact.components] = acting[number]
        closure, compliance = equations.laws.closure(x)
        z = equations.moved(x) + closure + contact.free_slack(moved, slip)
        tried = x - equations.scale * z
        residual = np.abs(x - equations.laws.admissible(tried)).max()
        # Far above SOLVED, the accuracy of increments.
        if residual > DECK_DIGITS * np.abs(x).max():
            refuse_model(
                f"load {number + 1} on the path is not one increment from the state before it: "
                "it was divided, or the path began elsewhere; give smaller increments, or the "
                "state it began from as initial"
            )
        slope = equations.laws.derivative(tried)
        closed = np.flatnonzero(tried[0] > 0)
        lu, pivots = _factors(equations, slope, compliance, closed)
        yield LinearIncrement(equations, x, z, tried, closed, slope, lu, pivots)


def _factors(
    equations: NaturalMap, slope: Matrix, compliance: Matrix, closed: Indices
) -> tuple[Matrix, Indices]:
    """Return factors of I − J + J r H between the points in contact, component by component."""
    n, k = equations.contact.n_points, equations.contact.components
    size, count = k * len(closed), len(closed)
    rows = (np.arange(k)[:, None] * n + closed).ravel()
    G = equations.G[rows]
    H = np.asarray(G @ (G @ equations.S).T) + np.diag(compliance[:k, closed].ravel())
    scale = equations.scale[:k, closed]
    local = slope[closed][:, :k, :k]
    scaled = (scale.ravel()[:, None] * H).reshape(k, count, size)
    system = np.einsum("pij,jpq->ipq", local, scaled).reshape(size, size)
    diagonal = np.arange(count)
    for i in range(k):
        for j in range(k):
            system[i * count + diagonal, j * count + diagonal] += (i == j) - local[:, i, j]
    lu, pivots = la.lu_factor(system) if size else (np.zeros((0, 0)), np.zeros(0, np.int64))
    sizes = np.abs(np.diag(lu))
    if sizes.min(initial=1.0) < ROUND_OFF * sizes.max(initial=1.0):
        refuse_model(
            "the derivative is not unique: contact is hard and has more contact points than "
            "displacements, or friction is so large that there are several solutions; use "
            "nodal quadrature or a penalty"
        )
    return lu, pivots
