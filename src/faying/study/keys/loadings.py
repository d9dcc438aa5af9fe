"""All loads of a study, and its temperatures."""

from collections.abc import Iterator, Sequence

from faying.model.assembly import Assembly
from faying.model.temperature import Temperature
from faying.sources import SOURCES
from faying.study.keys.errors import Location, Mistakes, Problem, located, nearest
from faying.study.keys.loading_table import Loading
from faying.study.keys.model_tables import TemperatureSection
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


def repeated_loads(key: str, loads: Sequence[Loading]) -> Mistakes:
    """Yield loads that occur twice."""
    targets = [load.target for load in loads]
    for i, target in enumerate(targets):
        if target in targets[:i]:
            first = targets.index(target) + 1
            yield (key, i), f"{target} is loaded by number {first} already; merge them"


def temperature_problems(_: Study, study: Study) -> Mistakes:
    """Yield uses of undefined temperatures."""
    uses: list[tuple[Location, str]] = [
        ((*location, "temperature"), load.temperature)
        for location, load in loadings(study)
        if load.temperature is not None
    ]
    scattered = () if study.preload_scatter is None else study.preload_scatter.temperatures
    uses += [(("preload_scatter", "temperatures"), name) for name in scattered]
    for location, name in uses:
        if name not in study.temperatures:
            yield location, f"no [temperature.{name}]; {nearest(name, study.temperatures)}"


def temperature_table_problems(study: Study, section: TemperatureSection) -> Mistakes:
    """Yield that a temperature is empty or unused, or that matrices cannot have it."""
    scattered = () if study.preload_scatter is None else study.preload_scatter.temperatures
    used = {load.temperature for _, load in loadings(study)} | {*scattered}
    (name,) = (name for name, table in study.temperatures.items() if table is section)
    if not SOURCES[study.model.source].has_elements:
        yield "", "matrices contain no thermal expansion; remove [temperature], or use a mesh"
    elif section.uniform is None and not section.parts:
        yield "", "nothing has a temperature; give 'uniform' or 'parts'"
    elif name not in used:
        yield "", f'no load uses it; add {{ temperature = "{name}", value = 1 }} to forces'


def temperature_name_problems(study: Study, assembly: Assembly) -> Iterator[Problem]:
    """Yield temperatures with the name of a load of the deck."""
    for name in study.temperatures:
        if name in assembly.loads:
            text = f"the deck has a load '{name}' too; give the temperature another name"
            yield from located(("temperature", name), [("", text)])


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
