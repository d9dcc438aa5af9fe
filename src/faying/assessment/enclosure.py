"""Where the exact contact forces must lie, given any candidate: a ball in the energy norm.

For a candidate λ̂ ≥ 0 of the problem s = Hλ + g_free ≥ 0, λ ≥ 0, λᵀs = 0 and *any* z ≥ 0,

    ½ ‖λ̂ − λ*‖²_H  ≤  B(z) = λ̂ᵀ z + ½ (s − z)ᵀ H⁻¹ (s − z),   s = Hλ̂ + g_free,      (C6)

is the gap between the energy of λ̂ and a lower bound of the least energy. ``docs/theory/
certificate.md`` derives it and the choices of z; equation numbers (C…) are of that page.
"""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.flexibility import Flexibility


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Enclosure:
    """Where the exact contact forces λ* must lie, of one or many candidates.

    Attributes
    ----------
    energy : (...) [force·length]
        B ≥ ½ ‖λ̂ − λ*‖²_H.
    centre : (..., n_point) [force]
        c of the ball ‖λ* − c‖_H ≤ r, (C12).
    radius : (...) [√(force·length)]
        r.
    """

    energy: Vector
    centre: Matrix
    radius: Vector


def enclose(flexibility: Flexibility, g_free: Matrix, forces: Matrix) -> Enclosure:
    """Enclose the exact contact forces of bare contact problems.

    Parameters
    ----------
    g_free : (..., n_point) [length]
    forces : (..., n_point) [force]
        Candidates λ̂ ≥ 0.

    Notes
    -----
    The best of three z: s⁺, (C18); s⁺ where λ̂ = 0 and 0 elsewhere, (C8), second order in the
    error and usually the sharpest; and the minimizer point by point, (s − λ̂/(H⁻¹)_kk)⁺, (C9).
    O(n²) a candidate.
    """
    slack = forces @ flexibility.H + g_free
    open_gap = np.maximum(slack, 0.0)
    wishes = (
        open_gap,
        np.where(forces > 0, 0.0, open_gap),
        np.maximum(slack - forces / flexibility.point_norms**2, 0.0),
    )
    pairs = [flexibility.admissible(slack, wish) for wish in wishes]
    works = np.array([(forces * z).sum(axis=-1) for z, _ in pairs])
    energies = np.array([flexibility.energy(slack - z) for z, _ in pairs])
    possible = np.array([exists for _, exists in pairs])
    bounds = np.where(possible, works + 0.5 * energies, np.inf)
    best = np.argmin(bounds, axis=0)[None]
    z = np.take_along_axis(np.array([z for z, _ in pairs]), best[..., None], axis=0)[0]
    energy = np.take_along_axis(bounds, best, axis=0)[0]
    squared = np.take_along_axis(works + 0.25 * energies, best, axis=0)[0]
    return Enclosure(
        energy=energy,
        centre=forces - 0.5 * flexibility.forces(slack - z),
        radius=np.where(np.isfinite(energy), np.sqrt(squared), np.inf),
    )
