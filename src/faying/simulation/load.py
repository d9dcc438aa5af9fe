"""Loads: at boundaries or in patterns, constant after a step or as a history; and bolt forces."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from faying._typing import ComplexVector, Matrix, Vector, frozen
from faying.exceptions import ModelError, check_known, naming, refuse_model
from faying.joint.system import Joint, System, boundary_slices, initial_bolt_forces


@dataclass(frozen=True, eq=False)
class History:
    """A force known at some instants and linear in between; constant outside them.

    Attributes
    ----------
    times : (n,) [time]
        Increasing.
    values : (n,) [force] or [force·length]

    Examples
    --------
    >>> import faying as fy
    >>> import numpy as np
    >>> ramp = fy.History(times=np.array([0.0, 1e-3]), values=np.array([0.0, 500.0]))
    >>> ramp.at(np.array([5e-4, 2e-3]))
    array([250., 500.])
    """

    times: Vector
    values: Vector

    def __post_init__(self) -> None:
        object.__setattr__(self, "times", frozen(self.times))
        object.__setattr__(self, "values", frozen(self.values))
        if self.times.shape != self.values.shape or len(self.times) == 0:
            refuse_model(
                f"a history needs one value per time; found {len(self.times)} times and "
                f"{len(self.values)} values"
            )
        if not (np.diff(self.times) > 0).all():
            row = int(np.argmin(np.diff(self.times) > 0)) + 1
            message = f"the times of a history must increase; sample {row} is not after the last"
            raise ModelError(message)

    def at(self, times: Vector) -> Vector:
        """Values at the given instants."""
        return np.interp(times, self.times, self.values)


class StaticLoad(Protocol):
    """A load at one instant."""

    def inputs(self, system: Joint, times: Vector) -> Matrix:
        """Return the inputs (n_time, n_input) of a system."""


class NamedLoad(StaticLoad, Protocol):
    """A static load with a name."""

    @property
    def name(self) -> str:
        """Name of the load case."""


@dataclass(frozen=True, eq=False, kw_only=True)
class InputRow:
    """A static load given as a row of inputs.

    Attributes
    ----------
    name
        Name of the load case.
    row : (n_input,)
    factor
        Factor of all inputs but the initial forces of the bolts.
    """

    name: str
    row: Vector
    factor: float = 1.0

    def inputs(self, system: Joint, times: Vector) -> Matrix:
        """Return the row repeated for all times (n_time, n_input)."""
        row, bolts = self.factor * self.row, system.port_compliance.bolts
        row[bolts] = self.row[bolts]
        return np.tile(row, (len(times), 1))

    def scaled(self, factor: float) -> "InputRow":
        """Return the load times a factor; bolts keep their forces."""
        return InputRow(name=self.name, row=self.row, factor=factor * self.factor)


@dataclass(frozen=True, eq=False)
class Load:
    """A load case.

    Attributes
    ----------
    forces
        ``"boundary.component"`` to a total force or moment (applied at once and held), or to a
        :class:`History`; e.g. ``{"tip.Fz": -500.0, "tip.Mx": 20e3}``. The name of a load pattern
        of the model stands for its amplitude: ``{"12": 1.0}`` is load set 12 of the deck, after
        :meth:`faying.Model.with_deck_loads`.
    name
        Name in reports.
    bolt_forces
        Initial forces N₀ of bolts where they differ from those the model is locked at.

    Examples
    --------
    >>> load = Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
    >>> load.name
    'LC2'
    """

    forces: Mapping[str, float | History] = field(default_factory=dict)
    name: str = "load"
    bolt_forces: Mapping[str, float] = field(default_factory=dict)

    def inputs(self, system: Joint, times: Vector) -> Matrix:
        """Boundary forces, initial bolt forces and amplitudes of patterns at the given instants.

        Parameters
        ----------
        times : (n_time,)

        Returns
        -------
        ndarray (n_time, n_input)

        Raises
        ------
        ModelError
            If a boundary, one of its components, a load pattern or a bolt does not exist.
        """
        times = np.asarray(times, dtype=float)
        places = boundary_slices(system.boundaries)
        n_boundary = sum(len(boundary.dofs) for boundary in system.boundaries.values())
        bolts = list(system.bolts)
        patterns, first = list(system.load_patterns), n_boundary + len(bolts)
        inputs = np.zeros((len(times), first + len(patterns)))
        inputs[:, n_boundary:first] = initial_bolt_forces(system)
        for key, value in self.forces.items():
            factor = value.at(times) if isinstance(value, History) else np.full(len(times), value)
            if key in system.load_patterns:
                inputs[:, first + patterns.index(key)] = factor
                continue
            boundary, component = _split(key, system, self.name)
            inputs[:, places[boundary]] += np.outer(
                factor, system.boundaries[boundary].pattern(component)
            )
        for name, force in self.bolt_forces.items():
            with naming(f"load '{self.name}'"):
                check_known(name, bolts, "bolt")
            inputs[:, n_boundary + bolts.index(name)] = force
        if not np.isfinite(inputs).all():
            refuse_model(f"load '{self.name}' holds NaN or infinity; give finite forces")
        return inputs

    def scaled(self, factor: float) -> "Load":
        """Return the load with constant forces times a factor; bolts keep their forces.

        Raises
        ------
        ModelError
            If a force is a history.
        """
        forces: dict[str, float | History] = {}
        for key, value in self.forces.items():
            if isinstance(value, History):
                refuse_model(f"load '{self.name}': {key} is a history; give a constant force")
            forces[key] = factor * value
        return Load(forces, name=self.name, bolt_forces=self.bolt_forces)


def _split(key: str, system: Joint, load: str) -> tuple[str, str]:
    boundary, _, component = key.rpartition(".")
    if boundary not in system.boundaries:
        what = f"boundary '{boundary}' (in '{key}')" if boundary else f"boundary load '{key}'"
        refuse_model(
            f"load '{load}': there is no {what} and no load pattern of that name; "
            f"the boundaries are {', '.join(system.boundaries) or 'none'}, "
            f"the load patterns {', '.join(system.load_patterns) or 'none'}"
        )
    return boundary, component


def harmonic_inputs(system: System, load: Mapping[str, complex]) -> ComplexVector:
    """Return the complex amplitudes F of inputs (n_input,), f(t) = Re(F exp(iωt)).

    ``load`` maps ``"boundary.component"`` or the name of a load pattern to a complex amplitude.
    """
    if not any(load.values()):
        refuse_model("the harmonic load is zero; give an amplitude, as {'tip.Fz': 1.0}")
    start = np.zeros(1)
    still = Load().inputs(system, start)[0]

    def part(values: Mapping[str, float]) -> ComplexVector:
        moved = Load(values, name="harmonic load").inputs(system, start)[0] - still
        return np.asarray(moved, dtype=complex)

    real = part({name: float(np.real(value)) for name, value in load.items()})
    return real + 1j * part({name: float(np.imag(value)) for name, value in load.items()})
