"""Which contact stiffness a penalty sweep speaks for, with the reasons in words."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Vector
from faying.assessment.penalty_sweep import PenaltySweep
from faying.interface.penalty import PENALTY_FACTOR

ROUND_OFF = 1e-7
"""Relative errors below this are not told apart."""
LARGEST_ROUGHNESS = 1.2
"""Growth of peak over nodal average that is no physics: beyond the automatic penalty's it is not
recommended, and from the recommended one to the stiff end of a sweep it is worth a warning."""


@dataclass(frozen=True, kw_only=True)
class PenaltyAdvice:
    """A recommended contact stiffness.

    Attributes
    ----------
    penalty : [force/length³]
    deviation
        Largest difference to hard contact there, over all loads.
    reached
        Whether that is within the tolerance.
    text
        The reasons, for people.
    """

    penalty: float
    deviation: float
    reached: bool
    text: str


@dataclass(frozen=True, kw_only=True)
class UnitNames:
    """What stands behind the numbers of an advice; nothing where units are not known."""

    penalty: str = ""
    length: str = ""


def recommend_penalty(
    sweep: PenaltySweep, *, tolerance: float = 0.05, units: UnitNames | None = None
) -> PenaltyAdvice:
    """Recommend the softest penalty whose pressures are those of hard contact.

    Softer is easier for every displacement basis, whose pressure error grows with c_n; stiffer
    than needed buys nothing and at Gauss points costs smoothness: a penalty that lets peaks at
    single points outgrow their nodal averages is not recommended. Where no other penalty of the
    sweep keeps the tolerance, the closest is recommended and said to be so.

    Parameters
    ----------
    tolerance
        Largest difference of nodal averages to hard contact, over the largest of hard contact, in
        any of the loads.
    units
        Written behind the numbers of the text.
    """
    units = units or UnitNames()
    worst = sweep.deviation.max(axis=1)
    rough = _roughness(sweep)
    smooth = np.flatnonzero(rough <= LARGEST_ROUGHNESS * rough[_nearest_automatic(sweep)])
    within = smooth[worst[smooth] <= tolerance]
    row = int(within[0]) if len(within) else int(smooth[worst[smooth].argmin()])
    penalty = float(sweep.penalties[row])
    texts = [_choice(sweep, row, tolerance, units, reached=bool(len(within)))]
    texts += [_automatic_text(sweep, units), *_roughness_text(sweep, row, units)]
    texts += _method_texts(sweep, row, units)
    return PenaltyAdvice(
        penalty=penalty,
        deviation=float(worst[row]),
        reached=bool(len(within)),
        text="\n".join(texts),
    )


def _roughness(sweep: PenaltySweep) -> Vector:
    """Peak at points over nodal average, of the load where it is largest (n_penalty,)."""
    return np.asarray((sweep.max_pressure / sweep.max_average).max(axis=1))


def _nearest_automatic(sweep: PenaltySweep) -> int:
    return int(np.abs(np.log(sweep.penalties / sweep.automatic)).argmin())


def _stiffness(value: float, units: UnitNames) -> str:
    return f"{value:.3g} {units.penalty}".rstrip().replace("e+0", "e").replace("e+", "e")


def _error(fraction: float) -> str:
    """Return an error as percent; round-off is not called zero."""
    return (
        f"{fraction:.2%}"
        if fraction >= ROUND_OFF
        else f"below {100 * ROUND_OFF:g}%".replace("e-0", "e-")
    )


def _choice(
    sweep: PenaltySweep, row: int, tolerance: float, units: UnitNames, *, reached: bool
) -> str:
    deviation, share = sweep.deviation[row].max(), sweep.relative_penetration[row].max()
    penetration = f"{sweep.penetration[row].max():.2e} {units.length}".rstrip()
    why = (
        f"the softest of the sweep with nodal pressures within {tolerance:.0%} of hard contact"
        if reached
        else "the closest of the sweep to hard contact whose peaks at single points are smooth; "
        f"none stays within {tolerance:.0%}"
    )
    return (
        f"Recommended contact stiffness: {_stiffness(sweep.penalties[row], units)}, {why} "
        f"(off by {deviation:.1%} in '{sweep.loads[int(sweep.deviation[row].argmax())]}'). "
        f"Largest penetration there: {penetration}, that is {share:.1e} of an element's edge."
    )


def _automatic_text(sweep: PenaltySweep, units: UnitNames) -> str:
    nearest = _nearest_automatic(sweep)
    return (
        f"The automatic value {PENALTY_FACTOR:g} E/h is {_stiffness(sweep.automatic, units)}; at "
        f"{_stiffness(sweep.penalties[nearest], units)} pressures are off hard contact by "
        f"{sweep.deviation[nearest].max():.1%} at most and by "
        f"{sweep.rms_deviation[nearest].max():.1%} in the root mean square."
    )


def _roughness_text(sweep: PenaltySweep, row: int, units: UnitNames) -> list[str]:
    """Warn where peaks at points outgrow their nodal averages: too many points for the mesh."""
    rough = _roughness(sweep)
    if rough[-1] < LARGEST_ROUGHNESS * rough[row]:
        return []
    return [
        f"Stiffer is not better here: towards {_stiffness(sweep.penalties[-1], units)} the peak at "
        f"single contact points grows to {rough[-1]:.1f} times its nodal average ({rough[row]:.1f} "
        "at the recommended value). That is the mesh holding more contact points than "
        "displacements, not physics; use nodal quadrature for stiffer contact."
    ]


def _method_texts(sweep: PenaltySweep, row: int, units: UnitNames) -> list[str]:
    return [
        f"{name}: largest pressure error {_error(error[row].max())} at the recommended value, "
        f"{_error(error[0].max())} at {_stiffness(sweep.penalties[0], units)} and "
        f"{_error(error[-1].max())} at {_stiffness(sweep.penalties[-1], units)}."
        for name, error in sweep.errors.items()
    ]
