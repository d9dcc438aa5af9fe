"""What solving many load cases leaves: fields of chosen cases, and envelopes of all."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from faying._typing import Matrix
from faying.assessment.envelope import Envelope
from faying.files.described import Format, Meaning, Table, new_file, write_members
from faying.interface.surface import ContactSurface
from faying.reduction.model_fields import GEOMETRY, SURFACE
from faying.reduction.reduced_model import ReducedModel
from faying.units import units_of

SOLVED = Format(
    name="solved load cases",
    version=1,
    wanted="the fields.h5 that faying solve wrote",
    remedy="solve the cases again",
    description=(
        "Contact pressures of chosen load cases or instants of a reduced model, and envelopes over "
        "all of them. Pressure is positive in compression, gap where open."
    ),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class SolvedFields:
    """Fields of chosen cases of a set of static cases, or of chosen instants of a transient.

    Attributes
    ----------
    names
        Of the cases; of an instant its time.
    reasons
        Why each was chosen.
    pressure, gap : (n_chosen, n_point)
    envelope
        Over all cases or instants.
    """

    names: tuple[str, ...]
    reasons: tuple[str, ...]
    pressure: Matrix
    gap: Matrix
    envelope: Envelope


_PRESSURE, _LENGTH = "force/length²", "length"
_NUMBER = Meaning("number of the case or instant it is from, from 0", "1", "(n_point,)")

TABLES: dict[type, Table] = {
    **GEOMETRY,
    ContactSurface: SURFACE,
    Envelope: {
        "max_pressure": Meaning("largest pressure of each contact point", _PRESSURE, "(n_point,)"),
        "max_pressure_case": _NUMBER,
        "min_pressure": Meaning("smallest pressure of each contact point", _PRESSURE, "(n_point,)"),
        "min_pressure_case": _NUMBER,
        "max_gap": Meaning("largest gap of each contact point", _LENGTH, "(n_point,)"),
        "max_gap_case": _NUMBER,
    },
    SolvedFields: {
        "names": Meaning("case, or instant of a transient", "", "(n_chosen,)"),
        "reasons": Meaning("why each was chosen", "", "(n_chosen,)"),
        "pressure": Meaning("contact pressure", _PRESSURE, "(n_chosen, n_point)"),
        "gap": Meaning("gap", _LENGTH, "(n_chosen, n_point)"),
        "envelope": Meaning("extremes over all cases or instants"),
    },
}

ROOT: Table = {
    "name": Meaning("name of the model"),
    "method": Meaning("name of its reduction"),
    "units": Meaning("consistent unit set, length-mass-time"),
    "nodes": Meaning("coordinates in the basic frame", _LENGTH, "(n_node, 3)"),
    "interfaces": Meaning("contact interfaces by name"),
    "static": Meaning("static load cases; absent without any"),
    "transients": Meaning("loads over time by name; absent without any"),
}


def write_solved(
    rom: ReducedModel,
    static: SolvedFields | None,
    transients: Mapping[str, SolvedFields],
    path: Path,
) -> None:
    """Write fields and envelopes to an HDF5 file, atomically.

    Raises
    ------
    FormatError
        If it cannot be written.
    """
    members = {
        "name": rom.name,
        "method": rom.method,
        "units": rom.units,
        "nodes": rom.mesh.nodes,
        "interfaces": rom.interfaces,
        "static": static,
        "transients": transients or None,
    }
    units = units_of(rom.units)
    with new_file(path, SOLVED, {"title": rom.name, "units": rom.units}, units) as file:
        write_members(file, members, ROOT, units, TABLES)
