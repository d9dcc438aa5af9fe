"""Between which forces an area stays clamped over load cases."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Vector
from faying.assessment.certificate import Certificate


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class CertifiedClamps:
    """Intervals in which the full model's clamp forces lie in a static load case.

    Attributes
    ----------
    interfaces : interface to (2,) [force]
        Of whole interfaces.
    areas : (interface, bolt) to (2,) [force]
        Of the points of an interface nearest to a bolt.
    """

    interfaces: Mapping[str, Vector]
    areas: Mapping[tuple[str, str], Vector]


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class ClampRange:
    """Clamp force of an area over all load cases.

    Attributes
    ----------
    preload : [force]
        Clamp force at rest.
    least : [force]
        Smallest clamp force.
    least_case
        Load case it belongs to.
    certified_least : (2,) [force]
        Interval in which the full model's clamp force lies in that case, of static cases.
    most : [force]
        Largest clamp force.
    most_case
        Load case it belongs to.
    certified_most : (2,) [force]
        Interval in which the full model's clamp force lies in that case, of static cases.
    certified_width : [force]
        Width of the widest of these intervals over all static cases.
    """

    preload: float
    least: float
    least_case: str
    certified_least: Vector | None
    most: float
    most_case: str
    certified_most: Vector | None
    certified_width: float | None = None


def certified_clamps(certificate: Certificate, row: int) -> CertifiedClamps:
    """Return the intervals of one of several load cases that were certified together."""
    return CertifiedClamps(
        interfaces={name: ends[row] for name, ends in certificate.contact_force.items()},
        areas={area: ends[row] for area, ends in certificate.area_force.items()},
    )


def clamp_range(
    preload: float, forces: Mapping[str, Vector], certified: Mapping[str, Vector]
) -> ClampRange:
    """Return between which forces an area stays clamped, from its preload at rest [force].

    Forces of a load case are (n_instant,) [force]; certified cases have bounds (2,) [force], which
    infinite intervals of parts of hard contact are not.
    """
    certified = {case: ends for case, ends in certified.items() if np.isfinite(ends).all()}
    lows = {case: float(force.min()) for case, force in forces.items()}
    highs = {case: float(force.max()) for case, force in forces.items()}
    lowest, highest = min(lows, key=lows.__getitem__), max(highs, key=highs.__getitem__)
    return ClampRange(
        preload=preload,
        least=lows[lowest],
        least_case=lowest,
        certified_least=certified.get(lowest),
        most=highs[highest],
        most_case=highest,
        certified_most=certified.get(highest),
        certified_width=max(
            (float(ends[1] - ends[0]) for ends in certified.values()), default=None
        ),
    )
