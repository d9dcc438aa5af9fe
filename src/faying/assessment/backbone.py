"""Backbones: frequency and damping of a mode of a joint over its amplitude."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from faying._typing import Frozen, Indices, Mask, Matrix, Vector
from faying.display.facts import Shown, with_unit
from faying.exceptions import refuse_model
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.units import units_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Backbone(Frozen, Shown):
    """Frequency and damping of one mode at several amplitudes; arrays have one entry for each.

    Attributes
    ----------
    mode : [1]
        Number of the mode of small vibrations, from 1.
    small_frequency : [1/time]
        Frequency of small vibrations, with every closed point stuck: the limit of small cycles.
    measured_at
        Boundary, or one of its components, at which the amplitude is measured.
    amplitude : (n,) [length]
        Half the peak-to-peak displacement in a stationary cycle.
    load : (n,)
        Largest load on the mass-normalized mode, α of (F5).
    modal_amplitude : (n,)
        Half the peak-to-peak modal coordinate, q of (F5).
    frequency : (n,) [1/time]
        Frequency.
    damping_ratio : (n,) [1]
        Damping ratio due to friction and the damping matrix C together.
    friction_damping : (n,) [1]
        Part due to friction; from ``loop_area`` where cycles are not stationary.
    linear_damping : (n,) [1]
        Part due to the damping matrix.
    energy_per_cycle : (n,) [force·length]
        Energy dissipated by friction, from slip.
    loop_area : (n,) [force·length]
        Area of the loop of load and displacement. It tends to ``energy_per_cycle`` as increments
        shrink; not in cycles in which friction dissipates energy of the tightened joint.
    stick_share : (n,) [1]
        Smallest sticking share of the closed area during the cycle.
    macroslip : (n,) [1]
        Whether all closed points of an interface slip at the same time.
    cycles : (n,) [1]
        Number of cycles solved.
    stationary : (n,) [1]
        Whether the last cycle repeats the one before.
    loop_load : (n, n_increment + 1)
        Load α along the last cycle, from its positive reversal on.
    loop_modal : (n, n_increment + 1)
        Modal coordinate q = φᵀ M (u − u₀) along the last cycle.
    slip_distance : (n, n_point) [length]
        Total slip distance of each contact point in a cycle, while it is under pressure.
    masing_frequency : (n,) [1/time]
        Frequency by Masing's rule from the first loading alone; None unless requested.
    masing_damping : (n,) [1]
        Friction damping by Masing's rule from the first loading alone; None unless requested.
    remarks : (n_remark,)
        Remarks for the reader.
    units
        Consistent unit set of the model, length-mass-time.
    over
        Kind of the given levels: ``"amplitude"`` or ``"energy"``.
    """

    mode: int
    small_frequency: float
    measured_at: str
    amplitude: Vector
    load: Vector
    modal_amplitude: Vector
    frequency: Vector
    damping_ratio: Vector
    friction_damping: Vector
    linear_damping: Vector
    energy_per_cycle: Vector
    loop_area: Vector
    stick_share: Vector
    macroslip: Mask
    cycles: Indices
    stationary: Mask
    loop_load: Matrix
    loop_modal: Matrix
    slip_distance: Matrix | None = None
    masing_frequency: Vector | None = None
    masing_damping: Vector | None = None
    remarks: tuple[str, ...] = ()
    units: str = "mm-t-s"
    over: str = "amplitude"

    @property
    def facts(self) -> Mapping[str, str]:
        """Mode, frequency of small vibrations, and the ranges of the results."""
        units = units_of(self.units)
        ranges = {
            "amplitudes": (self.amplitude, self._amplitude_unit),
            "frequencies": (self.frequency, units.frequency),
            "damping ratios": (100 * self.damping_ratio, "%"),
        }
        return {
            "mode": str(self.mode),
            "small vibrations": with_unit(self.small_frequency, units.frequency),
            "measured at": self.measured_at,
            **{
                name: f"{values.min():.4g} to {with_unit(values.max(), unit)}"
                for name, (values, unit) in ranges.items()
            },
        }

    @property
    def _amplitude_unit(self) -> str:
        return amplitude_unit(self.measured_at, self.units)

    @property
    def energy(self) -> Vector:
        """Energy of the vibration (n,), α q/2 [force·length], an amplitude without a place."""
        return np.asarray(self.load * self.modal_amplitude / 2)

    def plot(
        self, axes: "Axes | None" = None, *, over: Literal["amplitude", "energy"] = "amplitude"
    ) -> "Axes":
        """Draw damping ratio (left) and frequency (right) over amplitude or energy.

        Parameters
        ----------
        axes
            Axes of matplotlib; new ones by default. The frequency is drawn on twin axes.
        over
            ``"amplitude"`` at the measured place, or ``"energy"`` of the vibration.

        Raises
        ------
        ModelError
            If ``over`` is neither.
        """
        from faying.display.axes import new_axes

        units = units_of(self.units)
        columns = {
            "amplitude": f"amplitude at {self.measured_at} [{self._amplitude_unit}]",
            "energy": f"energy of the vibration [{units.of('force·length')}]",
        }
        if over not in columns:
            refuse_model(f"there is no abscissa '{over}'; give 'amplitude' or 'energy'")
        abscissa: Vector = getattr(self, over)

        left: Axes = new_axes() if axes is None else axes
        right = left.twinx()
        damping, frequency = "#0072B2", "#D55E00"
        left.semilogx(abscissa, 100 * self.damping_ratio, "o-", color=damping)
        right.semilogx(abscissa, self.frequency, "s--", color=frequency)
        left.set_xlabel(columns[over])
        left.set_ylabel("damping ratio [%]", color=damping)
        right.set_ylabel(f"frequency [{units.frequency}]", color=frequency)
        left.set_title(f"mode {self.mode}")
        return left

    @property
    def energy_difference(self) -> Vector:
        """Relative difference of loop area and energy by slip (n,); zero where nothing slips."""
        slipped = self.energy_per_cycle > 0
        difference = self.loop_area - self.energy_per_cycle
        over: Vector = difference / np.where(slipped, self.energy_per_cycle, 1.0)
        return np.where(slipped, over, 0.0)

    @property
    def masing_deviation(self) -> Vector | None:
        """Relative error of damping by Masing's rule against full cycles (n,), or None."""
        if self.masing_damping is None:
            return None
        slipped = self.friction_damping > 0
        difference = self.masing_damping - self.friction_damping
        return np.where(slipped, difference / np.where(slipped, self.friction_damping, 1.0), 0.0)


def amplitude_unit(measured_at: str, units: str) -> str:
    """Return the unit of amplitudes at a boundary or a component of one."""
    turns = measured_at.rpartition(".")[2] in DISPLACEMENT_NAMES[3:]
    return "rad" if turns else units_of(units).length
