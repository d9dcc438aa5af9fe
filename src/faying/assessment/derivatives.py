"""What a static solution does when a parameter changes: derivatives and where they hold."""

from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Matrix, Vector, frozen
from faying.exceptions import ModelError
from faying.joint.system import System, boundary_slices


@dataclass(frozen=True, eq=False, kw_only=True)
class Derivatives:
    """Derivatives by some parameters; the last axis of every array is the parameter.

    Attributes
    ----------
    parameters
        Names.
    system
        The model they belong to.
    contact_forces : (n_point, n_parameter)
        ∂λ.
    slack : (n_point, n_parameter)
        ∂s, the opening of the gap at the points without contact.
    bolt_forces : (n_bolt, n_parameter)
    displacements : (n_boundary, n_parameter)
        At the boundary degrees of freedom, boundary by boundary.
    lower, upper : (n_parameter,)
        Change of each parameter alone (lower ≤ 0 ≤ upper) at which the first point opens or
        closes; infinite where none ever does. Between them the derivative is exact.
    """

    parameters: tuple[str, ...]
    system: System
    contact_forces: Matrix
    slack: Matrix
    bolt_forces: Matrix
    displacements: Matrix
    lower: Vector
    upper: Vector

    def __post_init__(self) -> None:
        names = ("contact_forces", "slack", "bolt_forces", "displacements", "lower", "upper")
        for name in names:
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def pressure(self) -> Matrix:
        """Derivative of the pressure (n_point, n_parameter)."""
        pressure: Matrix = self.contact_forces / self.system.contact.weights[:, None]
        return pressure

    def contact_force(self, interface: str | None = None) -> Vector:
        """Return the derivative of the total normal force of one interface, or of all.

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
        total: Vector = self.contact_forces[points].sum(axis=0)
        return total

    def displacement(self, boundary: str) -> Matrix:
        """Return the derivative of the displacements at a boundary (n, n_parameter)."""
        places = boundary_slices(self.system.boundaries)
        if boundary not in places:
            message = f"there is no boundary '{boundary}'; the boundaries are {', '.join(places)}"
            raise ModelError(message)
        displacement: Matrix = self.displacements[places[boundary]]
        return displacement

    def of(self, parameter: str) -> "Derivatives":
        """Return the derivatives by one parameter, as a response with one column."""
        if parameter not in self.parameters:
            message = f"there is no parameter '{parameter}'; they are {', '.join(self.parameters)}"
            raise ModelError(message)
        place = [self.parameters.index(parameter)]
        return replace(
            self,
            parameters=(parameter,),
            contact_forces=self.contact_forces[:, place],
            slack=self.slack[:, place],
            bolt_forces=self.bolt_forces[:, place],
            displacements=self.displacements[:, place],
            lower=self.lower[place],
            upper=self.upper[place],
        )

    def within(self, other: "Derivatives") -> "Derivatives":
        """Return this response with its range narrowed to that of another."""
        return replace(
            self,
            lower=np.maximum(self.lower, other.lower),
            upper=np.minimum(self.upper, other.upper),
        )
