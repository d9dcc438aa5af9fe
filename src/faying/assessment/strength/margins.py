"""Margins of safety of bolts in the notation of NASA-STD-5020B (2021), with its equation numbers.

Where linear theory adds n φ P_t to the preload (8), a contact model gives the bolt's force P_tb
under the factored load itself: φ is then (P_tb − P_p) / P_t, and (10) and (7) give MS of (7).
The loss of clamp force under the load takes the place of P_tL in (19).
"""

from dataclasses import dataclass

import numpy as np

from faying._typing import Vector
from faying.exceptions import refuse_model

SHANK, THREAD = (2.5, 1.5), (1.2, 2.0)
"""Exponents of shear and tension in (20) and (22), by what is in the shear plane."""

TOLERANCE_FACTORS = {
    2: 31.092, 3: 8.306, 4: 5.368, 5: 4.291, 6: 3.733, 7: 3.390, 8: 3.156, 9: 2.986, 10: 2.856,
    11: 2.754, 12: 2.670, 13: 2.601, 14: 2.542, 15: 2.492, 16: 2.449, 17: 2.410, 18: 2.376,
    19: 2.346, 20: 2.319, 21: 2.294, 22: 2.272, 23: 2.251, 24: 2.232, 25: 2.215, 26: 2.199,
    27: 2.184, 28: 2.170, 29: 2.157, 30: 2.145, 35: 2.094, 40: 2.055, 45: 2.024, 50: 1.999,
    55: 1.978, 60: 1.960, 65: 1.944, 70: 1.931, 80: 1.908, 90: 1.890, 100: 1.875,
}  # fmt: skip
"""Two-sided 90/95 tolerance factors s of a normal distribution by the number of tests, Table 5."""


def contact_margin(allowed: float, preload: float, tension: float) -> float:
    """Return MS_u or MS_y by (7, 10) or (16, 17) with a tension from a contact model.

    ``allowed`` is P_tu,allow or P_ty,allow, ``preload`` P_p,max, and ``tension`` P_tb under the
    factored load, with P_p,max in all bolts. The margin is infinite where the load does not pull
    the bolt, −1 where the preload alone is too large.
    """
    if preload >= allowed:
        return -1.0
    return (allowed - preload) / (tension - preload) - 1 if tension > preload else np.inf


def interaction(
    shear: float, tension: float, bending: float, exponents: tuple[float, float] = THREAD
) -> float:
    """Return the left side of (20) or (22), which must not exceed 1.

    Each argument is a ratio to its allowable: P_su / P_su,allow, P_tu / P_tu,allow and f_bu / F_tu.
    Exponents are :data:`THREAD` where the thread is in the shear plane (22), else :data:`SHANK`
    (20).
    """
    return float(shear ** exponents[0] + (tension + bending) ** exponents[1])


def slip_margin(friction: float, clamp: float, shear: float, tension: float = 0.0) -> float:
    """Return MS_slip = μ F / (FS (P_sL + μ P_tL)) − 1, (84); (85) without tension, (86) for a bolt.

    The clamp force is n_f P_p,min for a joint, P_p,min for a bolt; shear and tension include their
    factors.
    """
    resisted = shear + friction * tension
    return friction * clamp / resisted - 1 if resisted > 0 else np.inf


@dataclass(frozen=True, kw_only=True)
class TorqueTests:
    """Statistics of preloads measured at one torque, A.2.

    Attributes
    ----------
    nominal : [force]
        P_pi,nom, their mean, (31).
    nut_factor
        K_nom = T / (D P_pi,nom), (32).
    most, least
        Γ_a-max and Γ_a-min, (33) and (34).
    deviation : [force]
        σ_pi, (35).
    statistical
        Γ_90/95, (36).
    """

    nominal: float
    nut_factor: float
    most: float
    least: float
    deviation: float
    statistical: float


def torque_tests(preloads: Vector, torque: float, diameter: float) -> TorqueTests:
    """Return the statistics of measured preloads (n_test,) [force].

    Parameters
    ----------
    torque : [force·length]
        T, common to all tests.
    diameter : [length]
        D.

    Raises
    ------
    ModelError
        If there are fewer than two tests.

    Examples
    --------
    >>> import faying as fy
    >>> import numpy as np
    >>> fy.torque_tests(np.array([9.1e3, 10.2e3, 10.9e3, 9.8e3]), 15e3, 8.0).nominal
    10000.0
    """
    if len(preloads) < 2:
        refuse_model(f"found {len(preloads)} measured preloads, and two are the least that scatter")
    nominal, deviation = float(preloads.mean()), float(preloads.std(ddof=1))
    listed = max(count for count in TOLERANCE_FACTORS if count <= len(preloads))
    return TorqueTests(
        nominal=nominal,
        nut_factor=torque / (diameter * nominal),
        most=float(preloads.max()) / nominal - 1,
        least=1 - float(preloads.min()) / nominal,
        deviation=deviation,
        statistical=TOLERANCE_FACTORS[listed] * deviation / nominal,
    )
