"""Time integrators: one frozen value each, the same for full and reduced models."""

from faying.simulation.integrators.generalized_alpha import GeneralizedAlpha
from faying.simulation.integrators.implicit_euler import ImplicitEuler
from faying.simulation.integrators.integrator import Integrator, Motion

__all__ = ["GeneralizedAlpha", "ImplicitEuler", "Integrator", "Motion"]
