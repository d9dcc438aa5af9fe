"""Clamp forces of interfaces where all preloads are at the end that leaves least."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying.assessment.check import Check, PartKind
from faying.assessment.strength.preload_ends import PreloadEnd
from faying.interface.surface import ContactSurface
from faying.units import units_of


def clamp_checks(
    ends: Sequence[PreloadEnd],
    surfaces: Mapping[str, ContactSurface],
    limits: Mapping[str, float],
    units: str,
) -> Iterator[Check]:
    """Yield the least clamp force of each interface over load cases that were solved at the ends.

    Parameters
    ----------
    limits : [force]
        Interface to the least clamp force that is demanded of it; others must not lose theirs.
    """
    for name, surface in surfaces.items():
        span, weights = slice(*surface.slice), surface.weights
        forces = [
            (float(np.min(end.cases[case].pressure[:, span] @ weights)), case, end)
            for end in ends
            for case in end.solved
        ]
        if not forces:
            continue
        least, case, end = min(forces, key=lambda force: force[0])
        rest = float(end.rest.pressure[0, span] @ weights)
        if name in limits:
            limit = limits[name]
            yield Check(
                part=name,
                kind="interface",
                quantity="clamp force",
                outcome="met" if least >= limit else "not met",
                utilisation=limit / least if least > 0 else np.inf,
                value=least,
                limit=limit,
                unit=units_of(units).force,
                case=case,
                scatter=end.name,
                required=True,
            )
        else:
            for check in clamp_loss(name, "interface", "clamp loss", rest, least, case):
                yield replace(check, scatter=end.name)


def clamp_loss(
    part: str, kind: PartKind, quantity: str, preload: float, least: float, case: str
) -> Iterator[Check]:
    """Judge how much of the clamp force of the preload is lost, where there is any."""
    if preload > 0:
        lost = max(1.0 - least / preload, 0.0)
        yield Check(
            part=part,
            kind=kind,
            quantity=quantity,
            outcome="met" if least > 0 else "not met",
            utilisation=lost,
            value=100 * lost,
            limit=100.0,
            unit="%",
            case=case,
        )
