"""All places of a study that name a load."""

from collections.abc import Iterator, Sequence

from faying.study.keys.errors import Problem
from faying.study.keys.loading_table import Loading
from faying.study.keys.positions import Location
from faying.study.keys.tables import Study


def loadings(study: Study) -> Iterator[tuple[Location, Loading]]:
    """Yield them: forces of load cases and frequencies, and sides of the training box."""
    for i, case in enumerate(study.load_cases):
        for j, force in enumerate(case.forces):
            yield ("load_case", i, "forces", j), force
    for i, swept in enumerate(study.frequencies):
        for j, harmonic in enumerate(swept.forces):
            yield ("frequency", i, "forces", j), harmonic
    for i, side in enumerate(study.reduction.training.box):
        yield ("reduction", "training", "box", i), side


def repeated_loads(study: Study, location: Location, loads: Sequence[Loading]) -> Iterator[Problem]:
    """Find loads that are there twice."""
    targets = [load.target for load in loads]
    for i, target in enumerate(targets):
        if target in targets[:i]:
            text = f"{target} is loaded by number {targets.index(target) + 1} already; merge them"
            where: Location = (*location, i)
            yield study.in_table(where, text)
