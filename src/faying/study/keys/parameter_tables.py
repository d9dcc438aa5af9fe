"""[[parameter]] and [band]: numbers of a joint that are known only by their ranges."""

from typing import Annotated, Any, Literal

from pydantic import Field

from faying.study.keys.errors import nearest
from faying.study.keys.section import Count, Name, Number, Section

VARIABLE = {
    "interface": ("friction", "tangential_penalty", "penalty", "closure", "initial_gap", "crown"),
    "bolt": ("preload",),
    "damping": ("alpha", "beta"),
}
"""Keys that may vary because they do not change the structure and its compliance."""

Steps = tuple[str | int, ...]
"""Keys and indices from the top of a study file to a number."""


class ParameterSection(Section):
    """[[parameter]]: a number of the study that is known only by its range."""

    name: Name
    keys: Annotated[tuple[Name, ...], Field(min_length=1)]
    range: tuple[Number, Number]


class BandSection(Section):
    """[band]: the design of parameter values for a band."""

    design: Literal["corners", "quasi-random"] = "corners"
    samples: Count = 32


def steps_to(key: str, tables: Any) -> Steps:
    """Return the steps to a key such as ``"interface.joint.crown.1.height"``.

    ``tables`` is the parsed TOML of a study file.
    """
    table, _, inner = key.partition(".")
    if table not in VARIABLE:
        message = (
            f"'{table}' changes the structure or does not exist; parameters are numbers of "
            f"{', '.join(VARIABLE)}"
        )
        raise LookupError(message)
    where: Steps = (table,)
    entries = tables.get(table, [])
    if isinstance(entries, list):
        # Names may contain dots, so the longest fitting one is taken.
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
        message = f"key '{path[0]}' of {table} cannot vary; {nearest(path[0], VARIABLE[table])}"
        raise LookupError(message)
    return (*where, *(int(step) - 1 if step.isdecimal() else step for step in path))


def value_at(steps: Steps, tables: Any) -> Any:
    """Return the value at some steps in the tables; None where it is missing."""
    for step in steps:
        try:
            tables = tables[step]
        except (KeyError, IndexError, TypeError):
            return None
    return tables
