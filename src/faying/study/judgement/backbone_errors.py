"""How far backbones of a reduced model are from those of the reference."""

from dataclasses import dataclass

import numpy as np

from faying.study.results.values import Response


@dataclass(frozen=True, kw_only=True)
class BackboneErrors:
    """Largest differences over modes and amplitudes, over the values of the reference.

    Attributes
    ----------
    frequency, damping
        Of frequencies and damping ratios, as fractions.
    """

    frequency: float
    damping: float


def backbone_errors(response: Response, reference: Response) -> BackboneErrors | None:
    """Compare two responses amplitude by amplitude; None where there are no backbones."""
    frequency, damping = [], []
    for mode, exact in reference.backbones.items():
        mine = response.backbones[mode]
        frequency.append(np.abs(mine.frequency / exact.frequency - 1).max())
        some = exact.damping_ratio > 0
        off = np.abs(mine.damping_ratio - exact.damping_ratio)[some] / exact.damping_ratio[some]
        damping.append(off.max(initial=0.0))
    if not frequency:
        return None
    return BackboneErrors(frequency=float(max(frequency)), damping=float(max(damping)))
