"""Fields from recovery and from many solved load cases, with envelopes."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.assessment.envelope import Envelope
from faying.files.described import Format, new_file, write_members
from faying.files.meanings import tables_within
from faying.reduction.reduced_model import ReducedModel
from faying.reduction.stored_model import StoredJoint


@dataclass(frozen=True, eq=False, kw_only=True)
class RecoveredRecord:
    """Pressures recovered from an imported history.

    Attributes
    ----------
    title
        Title of the study.
    units
        Consistent unit set, length-mass-time.
    history
        Name of the file the pressures were recovered from.
    route
        Source of the pressures: modal coordinates or boundary loads.
    method
        Reduced model of the coordinates, or of the simulation.
    joint_modes : [1]
        Number of joint modes of the reduced model.
    derivatives
        Source of velocities and accelerations.
    loads : (n_load,)
        Boundary forces and load patterns in the history; all others are zero.
    times : (n_time,) [time]
        Instants.
    pressure : (n_time, n_point) [force/length²]
        Contact pressure, compression positive.
    gap : (n_time, n_point) [length]
        Gap, open positive.
    displacements : (n_time, n) [length]
        By boundary: translations [length] and rotations [rad].
    contact_force : (n_time,) [force]
        Total normal force by interface.
    bolt_force : (n_time,) [force]
        Axial force by bolt, tension positive.
    max_pressure : (n_time,) [force/length²]
        Largest over all contact points.
    iterations : (n_time,) [1]
        Number of linear systems of the contact problem.
    traction : (n_time, n_point, 3) [force/length²]
        Tangential traction on the plus side, with friction.
    slip : (n_time, n_point, 3) [length]
        Slip of the plus side over the minus side, with friction.
    """

    title: str
    units: str
    history: str
    route: str
    method: str
    joint_modes: int
    derivatives: str
    loads: tuple[str, ...]
    times: Vector
    pressure: Matrix
    gap: Matrix
    displacements: Mapping[str, Matrix]
    contact_force: Mapping[str, Matrix]
    bolt_force: Mapping[str, Matrix]
    max_pressure: Vector
    iterations: Indices
    traction: Matrix | None = None
    slip: Matrix | None = None

    @property
    def tractions(self) -> dict[str, Matrix]:
        """Magnitudes of tractions (n_time, n_point) [force/length²]; empty without friction."""
        if self.traction is None:
            return {}
        return {"traction": np.linalg.norm(self.traction, axis=-1)}


SOLVED = Format(
    name="solved load cases",
    version=1,
    wanted="the fields.h5 of faying solve",
    remedy="solve the cases again",
    description=(
        "Contact pressures of chosen load cases or instants of a reduced model, and envelopes over "
        "all of them. Pressure is positive in compression, gap where open."
    ),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class SolvedFields:
    """Fields of chosen static cases, or of chosen instants of a transient.

    Attributes
    ----------
    names : (n_chosen,)
        Names of the cases, or times of the instants.
    reasons : (n_chosen,)
        Reasons of the choice.
    pressure : (n_chosen, n_point) [force/length²]
        Contact pressure.
    gap : (n_chosen, n_point) [length]
        Gap.
    envelope
        Extremes over all cases or instants.
    """

    names: tuple[str, ...]
    reasons: tuple[str, ...]
    pressure: Matrix
    gap: Matrix
    envelope: Envelope


@dataclass(frozen=True, eq=False, kw_only=True)
class SolvedFile(StoredJoint):
    """Fields of solved load cases, in a file of their own.

    Attributes
    ----------
    static
        Static load cases; absent without any.
    transients
        Loads over time by name; absent without any.
    """

    static: SolvedFields | None
    transients: Mapping[str, SolvedFields] | None


TABLES = tables_within(SolvedFile)
"""Meanings of the members of such a file."""


def write_solved(
    rom: ReducedModel,
    static: SolvedFields | None,
    transients: Mapping[str, SolvedFields],
    path: Path,
) -> None:
    """Write fields and envelopes to an HDF5 file, atomically."""
    solved = SolvedFile(
        name=rom.name,
        method=rom.method,
        units=rom.units,
        nodes=rom.mesh.nodes,
        interfaces=rom.interfaces,
        static=static,
        transients=transients or None,
    )
    units = rom.unit_set
    with new_file(path, SOLVED, {"title": rom.name, "units": rom.units}, units) as file:
        write_members(file, solved, units, TABLES)
