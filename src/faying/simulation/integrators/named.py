"""Integrators by the names that studies and the command line give them."""

from collections.abc import Callable, Mapping

from faying.simulation.integrators.energy_decaying import EnergyDecaying
from faying.simulation.integrators.generalized_alpha import GeneralizedAlpha
from faying.simulation.integrators.implicit_euler import ImplicitEuler
from faying.simulation.integrators.integrator import Integrator

SECOND_ORDER: Mapping[str, Callable[..., Integrator]] = {
    "energy-decaying": EnergyDecaying,
    "generalized-alpha": GeneralizedAlpha,
}


def named_integrator(name: str, rho_infinity: float | None = None) -> Integrator:
    """Return an integrator: ``implicit-euler``, ``energy-decaying`` or ``generalized-alpha``.

    ``rho_infinity`` is that of the last two; each has a default of its own.
    """
    if name not in SECOND_ORDER:
        return ImplicitEuler()
    scheme = SECOND_ORDER[name]
    return scheme() if rho_infinity is None else scheme(rho_infinity)
