"""[[parameter]] and [band]: what of a joint is known by its range alone."""

from typing import Annotated, Any, Literal

from pydantic import Field

from faying.study.keys.errors import nearest
from faying.study.keys.section import Count, Name, Number, Section

VARIABLE = {
    "interface": ("friction", "tangential_penalty", "penalty", "closure", "initial_gap", "crown"),
    "bolt": ("preload",),
    "damping": ("alpha", "beta"),
}
"""Keys of tables that leave the structure and its compliance as they are."""

Steps = tuple[str | int, ...]
"""Where a number stands in the tables of a study file."""


class ParameterSection(Section):
    """[[parameter]]: a number of the study that is known by its range alone."""

    name: Name
    keys: Annotated[tuple[Name, ...], Field(min_length=1)]
    range: tuple[Number, Number]


class BandSection(Section):
    """[band]: at which values of the parameters a band is computed."""

    design: Literal["corners", "quasi-random"] = "corners"
    samples: Count = 32


def steps_to(key: str, tables: Any) -> Steps:
    """Return where a key such as ``"interface.joint.crown.1.height"`` stands.

    The tables are those of a study file, as TOML gives them.
    """
    table, _, inner = key.partition(".")
    if table not in VARIABLE:
        message = (
            f"'{table}' changes the structure or is no table; parameters are numbers of "
            f"{', '.join(VARIABLE)}"
        )
        raise LookupError(message)
    where: Steps = (table,)
    entries = tables.get(table, [])
    if isinstance(entries, list):
        # Names may have dots themselves, so the longest that fits is meant.
        names = [entry["name"] for entry in entries]
        fitting = [name for name in names if inner.startswith(f"{name}.")]
        if not fitting:
            name = inner.partition(".")[0]
            message = f"the study has no [[{table}]] '{name}'; {nearest(name, names)}"
            raise LookupError(message)
        name = max(fitting, key=len)
        where, inner = (table, names.index(name)), inner.removeprefix(f"{name}.")
    path = inner.split(".")
    if path[0] not in VARIABLE[table]:
        message = (
            f"'{path[0]}' is no key of {table} that may vary; {nearest(path[0], VARIABLE[table])}"
        )
        raise LookupError(message)
    return (*where, *(int(step) - 1 if step.isdecimal() else step for step in path))


def value_at(steps: Steps, tables: Any) -> Any:
    """Return what stands somewhere in the tables; None where nothing does."""
    for step in steps:
        try:
            tables = tables[step]
        except (KeyError, IndexError, TypeError):
            return None
    return tables
