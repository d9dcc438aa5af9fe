"""Solutions are data: states, contact forces and what follows from them."""

from dataclasses import dataclass

from faying._typing import Indices, Matrix, Vector, frozen
from faying.exceptions import ModelError
from faying.joint.system import System, bolt_input
from faying.simulation.contact_fields import ContactFields


@dataclass(frozen=True, eq=False, kw_only=True)
class Solution(ContactFields):
    """One static solution, several static cases, or a transient.

    Arrays have no leading axis for one static solution, otherwise one entry per case or instant.

    Attributes
    ----------
    name
        Name of the load (or of the set of cases).
    system
        The full or reduced model that was solved.
    states : (..., n_dof)
        Displacements or generalized coordinates.
    contact_forces : (..., n_point) [force]
        λ = w ∘ p.
    gap : (..., n_point) [length]
    inputs : (..., n_input) [force]
        Boundary forces, initial bolt forces, amplitudes of load patterns [-].
    iterations : (...)
        Linear systems the contact problem took.
    contact_error : (...)
        Bound on the relative error of the contact forces, (Σ λ²/(c_n w))½, that compression and
        iteration make on large interfaces; zero where contact is solved to round-off.
    times : (n_time,) or None
        Instants of a transient.
    velocities, accelerations : (n_time, n_dof) or None
        Of a transient.
    energy_gain
        Of a transient: share of the energy in motion that its integration gained from nothing, at
        worst; above a tenth its pressures mean nothing (:mod:`~.energy_guard`).
    shear_forces : (..., 2, n_point) or None [force]
        Tangential components of the contact forces of a joint with friction.
    shear_slip : (..., 2, n_point) or None [length]
        Tangential components of the slip.
    dissipation : (...)
        Energy that friction took in each increment or step [force·length].
    """

    name: str
    system: System
    states: Matrix
    contact_forces: Matrix
    gap: Matrix
    inputs: Matrix
    iterations: Indices
    contact_error: Matrix | float = 0.0
    times: Vector | None = None
    velocities: Matrix | None = None
    accelerations: Matrix | None = None
    energy_gain: float = 0.0
    shear_forces: Matrix | None = None
    shear_slip: Matrix | None = None
    dissipation: Matrix | float = 0.0

    def __post_init__(self) -> None:
        for name in ("states", "contact_forces", "gap", "inputs"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    def displacement(self, boundary: str) -> Matrix:
        """Return the displacements at a boundary (..., n) in the order of its components.

        Raises
        ------
        ModelError
            If there is no such boundary.
        """
        if boundary not in self.system.boundaries:
            message = (
                f"there is no boundary '{boundary}'; "
                f"the boundaries are {', '.join(self.system.boundaries) or 'none'}"
            )
            raise ModelError(message)
        displacement: Matrix = self.states[..., self.system.boundaries[boundary].dofs]
        return displacement

    def bolt_force(self, bolt: str) -> Matrix:
        """Return the axial force of a bolt (...) [force], tension positive."""
        if bolt not in self.system.bolts:
            message = f"there is no bolt '{bolt}'; the bolts are {', '.join(self.system.bolts)}"
            raise ModelError(message)
        locked = self.inputs[..., bolt_input(self.system, bolt)]
        return self.system.bolts[bolt].locked(0.0).force(self.states) + locked

    def full_displacement(self) -> Matrix:
        """Return displacements at the free degrees of freedom of the full model (..., n_dof).

        Raises
        ------
        ModelError
            If the model came without its trial vectors, or keeps a residual compliance, whose
            displacements take the full model: :func:`faying.full_displacement`.
        """
        return self.system.expand(self.states)
