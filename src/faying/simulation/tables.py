"""Solutions as tables of pandas and labelled arrays of xarray, both optional packages."""

from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import ModelError
from faying.joint.system import System
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.simulation.contact_fields import ContactFields
from faying.units import Units, units_of

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

FIELDS = {
    "pressure": ("contact pressure, compression positive", "force/length²"),
    "gap": ("gap, open where positive", "length"),
    "contact_force": ("normal contact force, pressure times area", "force"),
}
"""Columns of contact points, with their meanings and dimensions."""


def dataframe(solution: ContactFields, system: System, times: Vector | None) -> "DataFrame":
    """Return a row per contact point, and per instant or case where there are several."""
    pandas: Any = _import_optional("pandas")
    units, places = units_of(system.units), _point_columns(system)
    along, values = _leading_axis(solution, times)
    n_point = len(places["point"])
    columns: dict[str, Any] = {}
    if along:
        columns[along] = np.repeat(values, n_point)
    repeats = len(values) if along else 1
    columns |= {name: np.tile(column, repeats) for name, column in places.items()}
    columns |= {name: field.ravel() for name, field in _fields(solution).items()}
    table = pandas.DataFrame(columns)
    table.attrs["units"] = {name: _unit(name, units) for name in columns}
    table.attrs["model"] = system.name
    return table


def dataset(
    solution: ContactFields,
    system: System,
    times: Vector | None,
    motions: Mapping[str, tuple[Indices, Matrix]],
    bolts: Mapping[str, Matrix],
) -> "Dataset":
    """Return labelled arrays over instants or cases, contact points, bolts and components.

    Boundaries have components and their displacements (..., n), bolts their force (...).
    """
    xarray: Any = _import_optional("xarray")
    units, places = units_of(system.units), _point_columns(system)
    along, values = _leading_axis(solution, times)
    leading = (along,) if along else ()
    coordinates: dict[str, Any] = {"point": np.arange(len(places["interface"]))}
    for name in ("interface", "x", "y", "z", "area"):
        coordinates[name] = ("point", places[name], {"units": _unit(name, units)})
    if along:
        coordinates[along] = (along, values, {"units": _unit(along, units)})
    columns_of_table: dict[str, Any] = {
        name: (
            (*leading, "point"),
            field,
            {"long_name": FIELDS[name][0], "units": _unit(name, units)},
        )
        for name, field in _fields(solution).items()
    }
    if bolts:
        coordinates["bolt"] = list(bolts)
        forces = np.stack(list(bolts.values()), axis=-1)
        about = {"long_name": "axial bolt force, tension positive", "units": units.force}
        columns_of_table["bolt_force"] = ((*leading, "bolt"), forces, about)
    for name, (components, motion) in motions.items():
        labels = [DISPLACEMENT_NAMES[component] for component in components]
        coordinates[f"component_{name}"] = labels
        about = {"long_name": f"displacement of {name}", "units": f"{units.length}, rad"}
        columns_of_table[f"displacement_{name}"] = ((*leading, f"component_{name}"), motion, about)
    labelled: Dataset = xarray.Dataset(columns_of_table, coordinates, {"model": system.name})
    return labelled


def _import_optional(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        message = f"this takes {name}, which is not installed; pip install 'faying[tables]'"
        raise ModelError(message) from None


def _leading_axis(solution: ContactFields, times: Vector | None) -> tuple[str, Vector | Indices]:
    """Return name and values of the leading axis; an empty name where there is none."""
    if solution.gap.ndim == 1:
        return "", np.empty(0)
    if times is None:
        return "case", np.arange(len(solution.gap))
    return "time", times


def _point_columns(system: System) -> dict[str, Any]:
    """Return columns of all contact points: interface, number within it, coordinates and area."""
    interfaces = system.interfaces
    counts = [len(interface.weights) for interface in interfaces.values()]
    points = np.concatenate(
        [*(interface.points for interface in interfaces.values()), np.empty((0, 3))]
    )
    names = np.array(list(interfaces), dtype=object)
    return {
        "interface": np.repeat(names, counts),
        "point": np.concatenate([*map(np.arange, counts), np.empty(0, dtype=int)]),
        **dict(zip("xyz", points.T, strict=True)),
        "area": np.concatenate(
            [*(interface.weights for interface in interfaces.values()), np.empty(0)]
        ),
    }


def _fields(solution: ContactFields) -> dict[str, Matrix]:
    return {
        "pressure": solution.pressure,
        "gap": solution.gap,
        "contact_force": solution.contact_forces,
    }


def _unit(name: str, units: Units) -> str:
    if name in FIELDS:
        return units.of(FIELDS[name][1])
    unit_of = {"x": units.length, "y": units.length, "z": units.length, "time": units.time}
    return {**unit_of, "area": units.of("length²")}.get(name, "")
