"""What solving many load cases leaves: fields of chosen cases, and envelopes of all."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from faying._typing import Matrix
from faying.assessment.envelope import Envelope
from faying.files.described import Format, new_file, write_members
from faying.files.meanings import Meaning, Table, meanings
from faying.interface.surface import ContactSurface
from faying.reduction.model_fields import GEOMETRY
from faying.reduction.reduced_model import ReducedModel

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
    names : (n_chosen,)
        Names of the cases; of an instant its time.
    reasons : (n_chosen,)
        Why each was chosen.
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


TABLES: dict[type, Table] = {
    **GEOMETRY,
    **{kind: meanings(kind) for kind in (ContactSurface, Envelope, SolvedFields)},
}

ROOT: Table = {
    "name": Meaning("name of the model"),
    "method": Meaning("name of its reduction"),
    "units": Meaning("consistent unit set, length-mass-time"),
    "nodes": Meaning("coordinates in the basic frame", "length", "(n_node, 3)"),
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
    units = rom.unit_set
    with new_file(path, SOLVED, {"title": rom.name, "units": rom.units}, units) as file:
        write_members(file, members, ROOT, units, TABLES)
