"""Pressures, tractions and resultants of contact, for every kind of solution."""

import numpy as np

from faying._typing import Matrix
from faying.exceptions import check_known
from faying.joint.system import Joint


def no_tangent() -> Matrix:
    """Return the tangential components of a frictionless state: none."""
    return np.zeros((0, 0))


class ContactFields:
    """Pressures, tractions and resultants of contact forces and gaps (..., n_point)."""

    system: Joint
    contact_forces: Matrix
    gap: Matrix
    shear_forces: Matrix
    shear_slip: Matrix

    @property
    def pressure(self) -> Matrix:
        """Contact pressure p (..., n_point) [force/length²], compression positive."""
        return self.contact_forces / self.system.contact.weights

    @property
    def traction(self) -> Matrix:
        """Traction on the plus side in the tangent plane (..., n_point, 3) [force/length²]."""
        weights = self.system.contact.weights[:, None]
        return self._along_tangents(self.shear_forces) / weights

    @property
    def slip(self) -> Matrix:
        """Slip of the plus side over the minus side (..., n_point, 3) [length]."""
        return self._along_tangents(self.shear_slip)

    @property
    def along_surfaces(self) -> dict[str, Matrix]:
        """Traction and slip by name; empty for a joint without friction."""
        carried = self.shear_forces.size > 0
        return {"traction": self.traction, "slip": self.slip} if carried else {}

    def _along_tangents(self, components: Matrix) -> Matrix:
        """Return vectors (..., n_point, 3) from components (..., n_tangent, n_point)."""
        tangents = self.system.contact.tangents[: components.shape[-2]]
        return np.asarray(np.einsum("...cp,cpk->...pk", components, tangents))

    @property
    def max_pressure(self) -> Matrix:
        """Largest pressure over the contact points (...)."""
        return np.asarray(self.pressure.max(axis=-1, initial=0.0))

    @property
    def max_penetration(self) -> Matrix:
        """Largest penetration max ⟨−g⟩ over the contact points (...) [length]."""
        return np.asarray(np.maximum(-self.gap, 0.0).max(axis=-1, initial=0.0))

    def contact_force(self, interface: str | None = None) -> Matrix:
        """Return the total normal force Σ λ of one interface, or of all (...) [force]."""
        return np.asarray(self.contact_forces[..., self._points(interface)].sum(axis=-1))

    def open_fraction(self, interface: str | None = None) -> Matrix:
        """Return the fraction of the area without pressure, of one interface or all (...)."""
        points = self._points(interface)
        weights = self.system.contact.weights[points]
        is_open = self.contact_forces[..., points] <= 0
        return np.asarray((is_open * weights).sum(axis=-1) / weights.sum())

    def _points(self, interface: str | None) -> slice:
        if interface is None:
            return slice(None)
        check_known(interface, self.system.contact.slices, "interface")
        return self.system.contact.slices[interface]


def shear_everywhere(fields: ContactFields) -> None:
    """Give fields without tangential components arrays of shape (..., 0, n_point)."""
    *many, n_point = fields.contact_forces.shape
    for name in ("shear_forces", "shear_slip"):
        if getattr(fields, name).shape[-2] == 0:
            object.__setattr__(fields, name, np.zeros((*many, 0, n_point)))
