"""The preload of a bolt from its tightening torque or utilisation, and its scatter.

A torque gives F_M = M_A / (P/(2π) + d₂/2 1.155 μ_G + D_Km/2 μ_K). A utilisation ν of the yield
strength under tension and torsion gives σ² + 3 τ² = (ν R_p0.2)² with σ = F_M / A_S (VDI symbols).
The extremes are c (1 ± Γ) F_M (NASA-STD-5020B 4.3.1, eqs. 3 to 5), with Γ = (α_A − 1)/(α_A + 1) for
a tightening factor α_A = F_max / F_min about the mean.
"""

from dataclasses import dataclass

import numpy as np

from faying.assessment.strength.thread import Thread, torsion_of
from faying.exceptions import ModelError, refuse_model


def force_of_torque(thread: Thread, torque: float) -> float:
    """Return the preload F_M for a torque [force]."""
    if thread.friction is None or thread.head_friction is None:
        refuse_model("a torque gives a preload by friction; give thread_friction and head_friction")
    ratio = thread.torque_per_force(np.array([thread.friction]), np.array([thread.head_friction]))
    return float(torque / ratio[0])


def force_of_utilisation(thread: Thread, utilisation: float, units: str) -> float:
    """Return the preload F_M for a share of the yield strength in tension and torsion [force].

    Raises
    ------
    ModelError
        If the friction in the thread is not given, or the units are not known.
    """
    if thread.friction is None:
        refuse_model("how far tightening uses a bolt depends on friction; give thread_friction")
    twisted = np.sqrt(3) * torsion_of(thread, 1.0)
    used = utilisation * thread.strengths(units).yields
    return float(used / np.hypot(1 / thread.stress_area, twisted))


@dataclass(frozen=True, kw_only=True)
class PreloadRange:
    """Range of the preload of a bolt about its nominal value, NASA-STD-5020B 4.3.1.

    Attributes
    ----------
    variation
        Γ.
    loss
        Share of P_pi,min lost by relaxation, P_pr: 0.05 for all-metallic joints.
    creep : [force]
        P_pc.
    gained, lost : [force]
        P_Δt,max and P_Δt,min, the largest gain and loss by temperature.
    least_control, most_control
        c_min and c_max of the controlled parameter, as torque over the nominal one.
    """

    variation: float = 0.0
    loss: float = 0.0
    creep: float = 0.0
    gained: float = 0.0
    lost: float = 0.0
    least_control: float = 1.0
    most_control: float = 1.0

    def __post_init__(self) -> None:
        if not 0 <= self.variation < 1:
            message = f"the variation Γ of the preload is {self.variation:g}; give 0 up to below 1"
            raise ModelError(message)

    def most(self, nominal: float) -> float:
        """Return P_p,max = c_max (1 + Γ) P_pi,nom + P_Δt,max [force], eqs. (1, 3)."""
        return self.most_control * (1 + self.variation) * nominal + self.gained

    def least(self, nominal: float, fasteners: int = 1) -> float:
        """Return P_p,min [force], eq. (2) with (4), or (5) for n_f fasteners together."""
        variation = self.variation / np.sqrt(fasteners)
        initial = self.least_control * (1 - variation) * nominal
        return float(initial * (1 - self.loss) - self.creep - self.lost)


def variation_of(tightening_factor: float) -> float:
    """Return Γ for a tightening factor α_A."""
    return (tightening_factor - 1) / (tightening_factor + 1)
