"""The band covered by the backbones of many possible joints."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Frozen, Indices, Vector
from faying.assessment.backbone import Backbone, amplitude_unit
from faying.assessment.measured_curve import at_amplitudes
from faying.display.facts import Shown, with_unit
from faying.exceptions import refuse_model
from faying.units import units_of


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class BackboneBand(Frozen, Shown):
    """Bounds of frequency and damping over amplitude; arrays have one entry for each amplitude.

    They are the extremes of the samples; curves of other joints may lie outside.

    Attributes
    ----------
    amplitude : (n,) [length]
    frequency_low, frequency_high : (n,) [1/time]
    damping_low, damping_high : (n,) [1]
    samples : (n,) [1]
        Number of backbones that reach the amplitude.
    measured_at
        Place of the measured amplitude.
    units
        Consistent unit set of the model, length-mass-time.
    """

    amplitude: Vector
    frequency_low: Vector
    frequency_high: Vector
    damping_low: Vector
    damping_high: Vector
    samples: Indices
    measured_at: str
    units: str = "mm-t-s"

    @property
    def facts(self) -> Mapping[str, str]:
        """Ranges of amplitude, frequency and damping."""
        units = units_of(self.units)
        length = amplitude_unit(self.measured_at, self.units)
        ranges = {
            "amplitudes": (self.amplitude, self.amplitude, length),
            "frequencies": (self.frequency_low, self.frequency_high, units.frequency),
            "damping ratios": (100 * self.damping_low, 100 * self.damping_high, "%"),
        }
        return {
            name: f"{low.min():.4g} to {with_unit(high.max(), unit)}"
            for name, (low, high, unit) in ranges.items()
        } | {"backbones": str(int(self.samples.max()))}


def backbone_band(backbones: Sequence[Backbone]) -> BackboneBand:
    """Return the band of backbones of one mode of different joints.

    Amplitudes are those of the first backbone. Frequencies and logarithms of damping ratios are
    linear over the logarithm of the amplitude between those of a backbone.

    Raises
    ------
    ModelError
        If there is no backbone.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
    >>> joint = joint.with_bolt_forces({"bolt": 10e3})
    >>> friction = fy.Parameter(name="friction", low=0.1, high=0.4)
    >>> rubbing = [joint.with_friction(trial["friction"]) for trial in fy.design([friction])]
    >>> band = fy.backbone_band([fy.backbone(one, 1, [0.05, 0.2]) for one in rubbing])
    >>> bool((band.damping_low < band.damping_high).all())
    True
    """
    if not backbones:
        refuse_model("a band needs backbones; give one at least")
    amplitude = np.sort(backbones[0].amplitude)
    frequency: list[Vector] = []
    damping: list[Vector] = []
    for backbone in backbones:
        with np.errstate(divide="ignore"):
            logarithm = np.log(backbone.damping_ratio)
        frequency.append(at_amplitudes(backbone, amplitude, backbone.frequency))
        damping.append(at_amplitudes(backbone, amplitude, logarithm))
    ratio = np.exp(damping)
    return BackboneBand(
        amplitude=amplitude,
        frequency_low=np.nanmin(frequency, axis=0),
        frequency_high=np.nanmax(frequency, axis=0),
        damping_low=np.nanmin(ratio, axis=0),
        damping_high=np.nanmax(ratio, axis=0),
        samples=np.count_nonzero(np.isfinite(frequency), axis=0),
        measured_at=backbones[0].measured_at,
        units=backbones[0].units,
    )
