"""Integrators by their names in studies and on the command line."""

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any

from faying.exceptions import check_known
from faying.simulation.integrators.energy_decaying import EnergyDecaying
from faying.simulation.integrators.generalized_alpha import GeneralizedAlpha
from faying.simulation.integrators.implicit_euler import ImplicitEuler
from faying.simulation.integrators.integrator import Integrator

_SCHEMES: tuple[Any, ...] = (ImplicitEuler, EnergyDecaying, GeneralizedAlpha)

INTEGRATORS: Mapping[str, Callable[..., Integrator]] = {
    scheme().name: scheme for scheme in _SCHEMES
}
"""Name to integrator."""

DAMPED = [
    scheme().name for scheme in _SCHEMES if "rho_infinity" in {f.name for f in fields(scheme)}
]
"""Names of the integrators with a parameter for damping at infinite frequency."""


def named_integrator(name: str | None, rho_infinity: float | None = None) -> Integrator:
    """Return an integrator by its name; None is implicit Euler.

    ``rho_infinity`` applies to the :data:`DAMPED` ones; each has its default.
    """
    if name is None:
        return ImplicitEuler()
    check_known(name, INTEGRATORS, "integrator")
    return INTEGRATORS[name]() if rho_infinity is None else INTEGRATORS[name](rho_infinity)
