"""All loads of a study, and its temperatures."""

from collections.abc import Iterator, Sequence

from faying.model.assembly import Assembly
from faying.model.temperature import Temperature
from faying.sources import SOURCES
from faying.study.keys.errors import Location, Problem, nearest
from faying.study.keys.loading_table import Loading
from faying.study.keys.tables import Study


def loadings(study: Study) -> Iterator[tuple[Location, Loading]]:
    """Yield loadings: forces of load cases and frequencies, and sides of the training box."""
    for i, case in enumerate(study.load_cases):
        for j, force in enumerate(case.forces):
            yield ("load_case", i, "forces", j), force
    for i, swept in enumerate(study.frequencies):
        for j, harmonic in enumerate(swept.forces):
            yield ("frequency", i, "forces", j), harmonic
    for i, side in enumerate(study.reduction.training.box):
        yield ("reduction", "training", "box", i), side


def repeated_loads(study: Study, location: Location, loads: Sequence[Loading]) -> Iterator[Problem]:
    """Yield loads that occur twice."""
    targets = [load.target for load in loads]
    for i, target in enumerate(targets):
        if target in targets[:i]:
            text = f"{target} is loaded by number {targets.index(target) + 1} already; merge them"
            where: Location = (*location, i)
            yield study.in_table(where, text)


def temperature_problems(study: Study) -> Iterator[Problem]:
    """Yield temperatures that are empty, unused or undefined, or that matrices cannot have."""
    loads = [(key, load) for key, load in loadings(study) if load.temperature is not None]
    for location, load in loads:
        if load.temperature not in study.temperatures:
            remedy = nearest(str(load.temperature), study.temperatures)
            key: Location = (*location, "temperature")
            text = f"no [temperature.{load.temperature}]; {remedy}"
            yield study.problem(key, text)
    scattered = () if study.preload_scatter is None else study.preload_scatter.temperatures
    for name in scattered:
        if name not in study.temperatures:
            key = ("preload_scatter", "temperatures")
            text = f"no [temperature.{name}]; {nearest(name, study.temperatures)}"
            yield study.problem(key, text)
    used = {load.temperature for _, load in loads} | {*scattered}
    for name, section in study.temperatures.items():
        table: Location = ("temperature", name)
        text = ""
        if not SOURCES[study.model.source].has_elements:
            text = "matrices contain no thermal expansion; remove [temperature], or use a mesh"
        elif section.uniform is None and not section.parts:
            text = "nothing has a temperature; give 'uniform' or 'parts'"
        elif name not in used:
            text = f'no load uses it; add {{ temperature = "{name}", value = 1 }} to forces'
        if text:
            yield study.in_table(table, text)


def temperature_name_problems(study: Study, assembly: Assembly) -> Iterator[Problem]:
    """Yield temperatures with the name of a load of the deck."""
    for name in study.temperatures:
        if name in assembly.loads:
            table: Location = ("temperature", name)
            text = f"the deck has a load '{name}' too; give the temperature another name"
            yield study.in_table(table, text)


def temperatures_of(study: Study, assembly: Assembly) -> dict[str, Temperature]:
    """Return the temperatures by name; parts named by numbers are property ids."""
    return {
        name: Temperature(
            reference=section.reference,
            uniform=section.uniform,
            parts={
                int(part)
                if part.isdecimal() and part not in assembly.mesh.element_sets
                else part: temperature
                for part, temperature in section.parts.items()
            },
        )
        for name, section in study.temperatures.items()
    }
