"""What a solution does when a parameter changes: derivatives and where they hold."""

from dataclasses import dataclass, fields, replace
from typing import final

import numpy as np

from faying._typing import Matrix, Vector, frozen
from faying.exceptions import ModelError
from faying.joint.system import System, boundary_slices


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Derivatives:
    """Derivatives by some parameters; the last axis of every array is the parameter.

    The first axis of those of a path is the increment; those of a static solution have none.

    Attributes
    ----------
    parameters
        Names.
    system
        The model they belong to.
    contact_forces : (..., n_point, n_parameter)
    shear_forces : (..., 2, n_point, n_parameter)
        Along both tangents of the points.
    shear_slip : (..., 2, n_point, n_parameter)
        Of what has slipped.
    dissipation : (..., n_parameter)
        Of the energy that friction takes in each increment.
    bolt_forces : (..., n_bolt, n_parameter)
    displacements : (..., n_boundary, n_parameter)
        At the boundary degrees of freedom, boundary by boundary.
    lower, upper : (n_parameter,)
        Change of each parameter alone (lower ≤ 0 ≤ upper) at which a first point opens, closes,
        sticks or slips in some state; infinite where none ever does. Between them derivatives
        without friction are exact, those with it hold to first order: where points slip their
        directions turn.
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

    def __post_init__(self) -> None:
        for field in fields(self)[2:]:
            object.__setattr__(self, field.name, frozen(getattr(self, field.name)))

    @property
    def pressure(self) -> Matrix:
        """Of the pressure (..., n_point, n_parameter)."""
        return np.asarray(self.contact_forces / self.system.contact.weights[:, None])

    @property
    def traction(self) -> Matrix:
        """Of the tangential traction on the plus side (..., n_point, 3, n_parameter)."""
        return self._along_tangents(self.shear_forces) / self.system.contact.weights[:, None, None]

    @property
    def slip(self) -> Matrix:
        """Of the slip (..., n_point, 3, n_parameter)."""
        return self._along_tangents(self.shear_slip)

    def contact_force(self, interface: str | None = None) -> Matrix:
        """Return those of the total normal force of one interface, or of all (..., n_parameter).

        Raises
        ------
        ModelError
            If there is no such interface.
        """
        slices = self.system.contact.slices
        if interface is not None and interface not in slices:
            message = f"there is no interface '{interface}'; the interfaces are {', '.join(slices)}"
            raise ModelError(message)
        points = slice(None) if interface is None else slices[interface]
        return np.asarray(self.contact_forces[..., points, :].sum(axis=-2))

    def displacement(self, boundary: str) -> Matrix:
        """Return those of the displacements at a boundary (..., n, n_parameter).

        Raises
        ------
        ModelError
            If there is no such boundary.
        """
        columns = boundary_slices(self.system.boundaries)
        if boundary not in columns:
            message = f"there is no boundary '{boundary}'; the boundaries are {', '.join(columns)}"
            raise ModelError(message)
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
        """Return these with their range narrowed to that of others by the same parameters."""
        return replace(
            self,
            lower=np.maximum(self.lower, limit.lower),
            upper=np.minimum(self.upper, limit.upper),
        )

    def _along_tangents(self, values: Matrix) -> Matrix:
        tangents = self.system.contact.tangents
        if tangents is None:
            return np.zeros((*self.contact_forces.shape[:-1], 3, len(self.parameters)))
        return np.asarray(np.einsum("...ipq,ipk->...pkq", values, tangents))
