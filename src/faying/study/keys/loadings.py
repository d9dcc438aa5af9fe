"""All places of a study that name a load."""

from collections.abc import Iterator

from faying.study.keys.positions import Location
from faying.study.keys.tables import Loading, Study


def loadings(study: Study) -> Iterator[tuple[Location, Loading]]:
    """Yield them: forces of load cases, and sides of the training box."""
    for i, case in enumerate(study.load_cases):
        for j, force in enumerate(case.forces):
            yield ("load_case", i, "forces", j), force
    for i, side in enumerate(study.reduction.training.box):
        yield ("reduction", "training", "box", i), side
