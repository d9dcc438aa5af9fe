"""Time integrators: one frozen value each, the same for full and reduced models."""

from faying.simulation.integrators.energy_decaying import EnergyDecaying
from faying.simulation.integrators.generalized_alpha import GeneralizedAlpha
from faying.simulation.integrators.implicit_euler import ImplicitEuler
from faying.simulation.integrators.integrator import Integrator, Motion
from faying.simulation.integrators.named import DAMPED, INTEGRATORS, named_integrator

__all__ = [
    "DAMPED",
    "INTEGRATORS",
    "EnergyDecaying",
    "GeneralizedAlpha",
    "ImplicitEuler",
    "Integrator",
    "Motion",
    "named_integrator",
]
