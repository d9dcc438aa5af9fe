"""Plots of solutions: a map of one state, lines over several."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from faying._typing import Matrix, Vector
from faying.display.axes import draw_areas, new_axes
from faying.display.plane import plane_of
from faying.exceptions import check_known, refuse_model
from faying.joint.system import System
from faying.units import units_of

QUANTITIES = {"pressure": ("contact pressure", "force/length²"), "gap": ("gap", "length")}
"""Quantities for plots, with their names and dimensions."""


def plot_map(
    system: System, values: Vector, quantity: str, interface: str | None, axes: Any = None
) -> Any:
    """Draw values at all contact points (n_point,) on one interface, the first by default.

    Raises
    ------
    ModelError
        If there is no such interface.
    """
    chosen = _checked_interface(system, interface)
    surface = system.interfaces[chosen]
    plane = plane_of(surface.points, surface.normals, surface.weights)
    units, (meaning, dimension) = units_of(system.units), QUANTITIES[quantity]
    axes = new_axes() if axes is None else axes
    places = plane.project(surface.points)
    chosen_values = values[system.contact.slices[chosen]]
    draw_areas(axes, places, surface.weights, chosen_values, f"{meaning} [{units.of(dimension)}]")
    axes.set_xlabel(f"{plane.labels[0]} [{units.length}]")
    axes.set_ylabel(f"{plane.labels[1]} [{units.length}]")
    return axes


def plot_lines(
    system: System,
    values: Matrix,
    quantity: str,
    interface: str | None,
    times: Vector | None,
    axes: Any = None,
) -> Any:
    """Draw the largest value (n_state, n_point) of each interface, or of one, over the states."""
    names = (
        list(system.interfaces) if interface is None else [_checked_interface(system, interface)]
    )
    units, (meaning, dimension) = units_of(system.units), QUANTITIES[quantity]
    axes = new_axes() if axes is None else axes
    along = np.arange(len(values)) if times is None else times
    slices: Mapping[str, slice] = system.contact.slices
    for name in names:
        axes.plot(along, values[:, slices[name]].max(axis=1, initial=0.0), label=name)
    axes.set_xlabel("case or increment" if times is None else f"time [{units.time}]")
    axes.set_ylabel(f"largest {meaning} [{units.of(dimension)}]")
    axes.legend()
    return axes


def checked_quantity(quantity: str) -> str:
    """Return the name of a quantity to draw; refuse unknown names."""
    check_known(quantity, QUANTITIES, "picture")
    return quantity


def _checked_interface(system: System, interface: str | None) -> str:
    names = list(system.interfaces)
    if not names or (interface is not None and interface not in names):
        subject = "interface to draw" if interface is None else f"interface '{interface}'"
        refuse_model(f"there is no {subject}; the interfaces are {', '.join(names) or 'none'}")
    return names[0] if interface is None else interface
