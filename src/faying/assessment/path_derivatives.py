"""What a path with friction does when a parameter changes."""

from dataclasses import dataclass, fields
from typing import final

import numpy as np

from faying._typing import Matrix, Vector, frozen
from faying.exceptions import ModelError
from faying.joint.system import System, boundary_slices


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PathDerivatives:
    """Derivatives of all states of a path; the last axis of every array is the parameter.

    Attributes
    ----------
    parameters
        Names.
    system
        The model they belong to.
    contact_forces : (n_increment, n_point, n_parameter)
    shear_forces : (n_increment, 2, n_point, n_parameter)
        Along both tangents of the points.
    shear_slip : (n_increment, 2, n_point, n_parameter)
        Of what has slipped.
    dissipation : (n_increment, n_parameter)
        Of the energy that friction takes in each increment.
    bolt_forces : (n_increment, n_bolt, n_parameter)
    displacements : (n_increment, n_boundary, n_parameter)
        At the boundary degrees of freedom, boundary by boundary.
    lower, upper : (n_parameter,)
        Change of each parameter alone (lower ≤ 0 ≤ upper) at which, to first order, a first point
        opens, closes, sticks or slips in some state; infinite where none ever does. Where one is
        zero the derivative is that to the other side.
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
        for one in fields(self)[2:]:
            object.__setattr__(self, one.name, frozen(getattr(self, one.name)))

    @property
    def pressure(self) -> Matrix:
        """Of the pressure (n_increment, n_point, n_parameter)."""
        return np.asarray(self.contact_forces / self.system.contact.weights[:, None])

    @property
    def traction(self) -> Matrix:
        """Of the tangential traction on the plus side (n_increment, n_point, 3, n_parameter)."""
        return self._along_tangents(self.shear_forces) / self.system.contact.weights[:, None, None]

    @property
    def slip(self) -> Matrix:
        """Of the slip (n_increment, n_point, 3, n_parameter)."""
        return self._along_tangents(self.shear_slip)

    def displacement(self, boundary: str) -> Matrix:
        """Return those of the displacements at a boundary (n_increment, n, n_parameter).

        Raises
        ------
        ModelError
            If there is no such boundary.
        """
        places = boundary_slices(self.system.boundaries)
        if boundary not in places:
            message = f"there is no boundary '{boundary}'; the boundaries are {', '.join(places)}"
            raise ModelError(message)
        return np.asarray(self.displacements[:, places[boundary]])

    def _along_tangents(self, values: Matrix) -> Matrix:
        tangents = self.system.contact.tangents
        if tangents is None:
            return np.zeros((*self.contact_forces.shape[:2], 3, len(self.parameters)))
        return np.asarray(np.einsum("tipq,ipk->tpkq", values, tangents))
