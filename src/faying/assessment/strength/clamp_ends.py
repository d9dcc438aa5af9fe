"""Clamp forces of interfaces with all preloads at the end of their scatter that gives the least."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Vector
from faying.assessment.check import Check
from faying.assessment.strength.preload_ends import PreloadEnd
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import contact_areas
from faying.model.bolt import Bolt
from faying.units import units_of


def clamp_checks(
    ends: Sequence[PreloadEnd],
    surfaces: Mapping[str, ContactSurface],
    bolts: Mapping[str, Bolt],
    limits: Mapping[str, float],
    units: str,
) -> Iterator[Check]:
    """Yield the least clamp force of each interface over load cases solved at the ends.

    For several bolts also that of the area around each. Limits [force] are the required clamp
    forces of interfaces; without a limit the clamp force must stay above zero.
    """
    for (interface, bolt), weights in contact_areas(surfaces, bolts).items():
        smallest = _smallest(ends, weights)
        if smallest is None or (bolt and len(bolts) == 1):
            continue
        force, end, case, tightened = smallest
        check = Check(
            part=bolt or interface,
            kind="bolt" if bolt else "interface",
            quantity=f"clamp loss at {interface}" if bolt else "clamp loss",
            scatter=end,
        )
        if bolt or interface not in limits:
            yield from clamp_loss(check, tightened, force, case)
            continue
        demanded = replace(check, quantity="clamp force", unit=units_of(units).force, case=case)
        yield replace(demanded, required=True).at_least(force, limits[interface])


def _smallest(ends: Sequence[PreloadEnd], weights: Vector) -> tuple[float, str, str, float] | None:
    """Return the least force on an area, its end and load case, and the force there at rest."""
    forces = [
        (float(np.min(end.cases[case].pressure @ weights)), end.name, case, end)
        for end in ends
        for case in end.solved
    ]
    if not forces:
        return None
    force, name, case, end = min(forces, key=lambda entry: entry[:3])
    return force, name, case, float(end.rest.pressure[0] @ weights)


def clamp_loss(check: Check, preload: float, smallest: float, case: str) -> Iterator[Check]:
    """Yield the check of the lost share of the clamp force, if there was any."""
    if preload > 0:
        lost = max(1.0 - smallest / preload, 0.0)
        yield replace(
            check,
            outcome="met" if smallest > 0 else "not met",
            utilisation=lost,
            value=100 * lost,
            limit=100.0,
            unit="%",
            case=case,
        )
