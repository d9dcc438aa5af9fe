"""Solutions: states, contact forces and quantities derived from them."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from faying._typing import Indices, Matrix, SparseMatrix, Vector, frozen
from faying.display.facts import Shown, with_unit
from faying.exceptions import check_known, refuse_model
from faying.joint.system import System, unstretched_bolt_forces
from faying.model.bolt import Bolt
from faying.simulation.contact_fields import ContactFields, no_tangent, shear_everywhere
from faying.units import units_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame
    from xarray import Dataset


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Solution(ContactFields, Shown):
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
        Linear systems solved in the contact problem.
    times : (n_time,) or None
        Instants of a transient.
    velocities, accelerations : (n_time, n_dof) or None
        Of a transient.
    energy_gain
        Of a transient: largest spurious energy gain of its integration, as a share of the energy in
        motion; above a tenth its pressures mean nothing (:mod:`~.energy_guard`).
    shear_forces : (..., n_tangent, n_point) [force]
        Tangential components of the contact forces: two where some interface has friction, or none.
    shear_slip : (..., n_tangent, n_point) [length]
        Tangential components of the slip.
    dissipation : (...)
        Energy dissipated by friction in each increment or step [force·length].
    deepest : (..., n_point) or None [length]
        Largest closures so far, of a joint with gaskets.
    substeps : (n_time,) or None
        Steps that led to each instant, where they were divided to hold a tolerance.
    step_error : (n_time,) or None
        Estimated pressure error over the largest pressure so far: 5 times (first order; else 2.5
        times) the largest change of a pressure by half as many steps; NaN for given steps.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> pushed = fy.solve_static(joint, fy.Load({"tip.Fz": -500.0}))
    >>> bool(pushed.max_pressure > fy.solve_static(joint).max_pressure)
    True
    """

    name: str
    system: System
    states: Matrix
    contact_forces: Matrix
    gap: Matrix
    inputs: Matrix
    iterations: Indices
    times: Vector | None = None
    velocities: Matrix | None = None
    accelerations: Matrix | None = None
    energy_gain: float = 0.0
    shear_forces: Matrix = field(default_factory=no_tangent)
    shear_slip: Matrix = field(default_factory=no_tangent)
    dissipation: Matrix | float = 0.0
    deepest: Matrix | None = None
    substeps: Indices | None = None
    step_error: Vector | None = None

    def __post_init__(self) -> None:
        for name in ("states", "contact_forces", "gap", "inputs"):
            object.__setattr__(self, name, frozen(getattr(self, name)))
        shear_everywhere(self)

    @property
    def contact_error(self) -> float:
        """Zero, since contact is solved to round-off; deprecated."""
        warnings.warn("contact_error is always zero now", DeprecationWarning, stacklevel=2)
        return 0.0

    @property
    def facts(self) -> Mapping[str, str]:
        """Name, kind of solution, and the largest pressure."""
        units = units_of(self.system.units)
        if self.times is not None:
            span = f"{len(self.times)} instants up to {with_unit(self.times[-1], units.time)}"
        else:
            span = "static" if self.gap.ndim == 1 else f"{len(self.gap)} cases or increments"
        return {
            "name": self.name,
            "model": self.system.name,
            "kind": span,
            "contact points": str(self.gap.shape[-1]),
            "largest pressure": with_unit(float(self.max_pressure.max(initial=0)), units.pressure),
        }

    def plot(
        self,
        axes: "Axes | None" = None,
        *,
        quantity: str = "pressure",
        at: int | None = None,
        interface: str | None = None,
    ) -> "Axes":
        """Draw the solution: a map of an interface, or lines over instants or cases.

        Parameters
        ----------
        axes
            Axes of matplotlib; new ones by default.
        quantity
            ``"pressure"`` or ``"gap"``, at the contact points.
        at
            Number of the state for a map; by default the largest values over all states.
        interface
            Interface to draw; by default the first for a map, all for lines.

        Raises
        ------
        ModelError
            If there is no such quantity, state or interface.
        """
        from faying.simulation.picture import checked_quantity, plot_lines, plot_map

        values = getattr(self, checked_quantity(quantity))
        if values.ndim > 1 and at is None:
            lines: Axes = plot_lines(self.system, values, quantity, interface, self.times, axes)
            return lines
        if values.ndim > 1 and not -len(values) <= (at or 0) < len(values):
            refuse_model(f"there is no state {at}; there are {len(values)}, counted from 0")
        shown = values[at] if values.ndim > 1 else values
        drawn: Axes = plot_map(self.system, shown, quantity, interface, axes)
        return drawn

    def to_dataframe(self) -> "DataFrame":
        """Return pressures and gaps as a table of pandas, one row per contact point.

        Returns
        -------
        pandas.DataFrame
            Columns ``time`` or ``case`` where there are several, ``interface``, ``point``, ``x``,
            ``y``, ``z``, ``area``, ``pressure``, ``gap``, ``contact_force``; ``attrs["units"]``
            holds the unit of each.

        Raises
        ------
        ModelError
            If pandas is not installed.
        """
        from faying.simulation.tables import dataframe

        return dataframe(self, self.system, self.times)

    def to_xarray(self) -> "Dataset":
        """Return the solution as labelled arrays of xarray.

        Returns
        -------
        xarray.Dataset
            ``pressure``, ``gap`` and ``contact_force`` over ``point``, whose coordinates are
            ``interface``, ``x``, ``y``, ``z`` and ``area``; ``bolt_force`` over ``bolt``, and for
            each boundary ``displacement_NAME``; all of them over ``time`` or ``case`` first where
            there are several. ``attrs["units"]`` of each says its unit.

        Raises
        ------
        ModelError
            If xarray is not installed.
        """
        from faying.simulation.tables import dataset

        motions = {
            name: (at.components, self.displacement(name))
            for name, at in self.system.boundaries.items()
        }
        bolts = {name: self.bolt_force(name) for name in self.system.bolts}
        return dataset(self, self.system, self.times, motions, bolts)

    def displacement(self, boundary: str) -> Matrix:
        """Return the displacements at a boundary (..., n) in the order of its components.

        Raises
        ------
        ModelError
            If there is no such boundary.
        """
        check_known(boundary, self.system.boundaries, "boundary")
        displacement: Matrix = self.states[..., self.system.boundaries[boundary].dofs]
        return displacement

    def bolt_force(self, bolt: str) -> Matrix:
        """Return the axial force of a bolt (...) [force], tension positive."""
        bolt_of_name = self._bolt(bolt)
        unstretched = unstretched_bolt_forces(self.system, self.inputs)
        number = list(self.system.bolts).index(bolt)
        return bolt_of_name.locked(0.0).force(self.states) + unstretched[..., number]

    def bolt_bending(self, bolt: str) -> Matrix:
        """Return the bending moments of a bolt at both ends of its beams [force·length].

        Returns
        -------
        ndarray (..., 2, 2)
            End, and component across the axis, in the frame of the beam there.

        Raises
        ------
        ModelError
            If there is no such bolt, or it has no beam elements.
        """
        bolt_of_name = self._bolt(bolt)
        if bolt_of_name.bending is None:
            refuse_model(
                f"bending of bolt '{bolt}' is not known: it has no beams, or its file does not "
                "contain it; model its shank by beams with bending stiffness"
            )
        moments = self._told_by(bolt_of_name.bending, bolt_of_name.residual_bending)
        return moments.reshape(*moments.shape[:-1], 2, 2)

    def weak_force(self, bodies: str) -> Matrix:
        """Return magnitudes of the forces of the weak springs between two bodies (...) [force].

        Raises
        ------
        ModelError
            If there are no such springs.
        """
        supports = self.system.weak_supports
        if bodies not in supports:
            names = ", ".join(supports) or "none"
            refuse_model(f"there are no weak springs '{bodies}'; those there are hold {names}")
        support = supports[bodies]
        forces = _row_products(self.states, support.forces)
        at_pairs = np.linalg.norm(forces.reshape(*forces.shape[:-1], -1, 3), axis=-1)
        carried: Matrix = at_pairs.sum(axis=-1)
        return carried

    def _told_by(self, rows: SparseMatrix | Matrix, residual: Matrix | None) -> Matrix:
        """Return rows (k, n_dof) times the states, with residual compliance (..., k)."""
        seen = _row_products(self.states, rows)
        if residual is None:
            return seen
        pairs = self.system.contact.at_pairs(self.contact_forces, self.shear_forces).T
        return seen + _row_products(pairs, residual)

    def _bolt(self, name: str) -> Bolt:
        check_known(name, self.system.bolts, "bolt")
        return self.system.bolts[name]

    def full_displacement(self) -> Matrix:
        """Return displacements at the free degrees of freedom of the full model (..., n_dof).

        Raises
        ------
        ModelError
            If the model came without its trial vectors, or keeps a residual compliance, whose
            displacements take the full model: :func:`faying.full_displacement`.
        """
        return self.system.expand(self.states)


def _row_products(states: Matrix, rows: SparseMatrix | Matrix) -> Matrix:
    """Return states @ rowsᵀ, with digits that do not depend on the number of states."""
    if not isinstance(rows, np.ndarray):
        product: Matrix = states @ rows.T
        return product
    # The order of the sums in library products depends on the sizes of both matrices.
    moments: Matrix = np.einsum(
        "...k,mk->...m", np.ascontiguousarray(states), np.ascontiguousarray(rows)
    )
    return moments
