"""What the names of methods mean, for readers who see them for the first time."""

from faying.reduction.methods import METHODS
from faying.study.results.values import Results


def meanings(results: Results) -> dict[str, str]:
    """Return what each method of a run is, in the order in which the study names them."""
    names = dict.fromkeys(name for case in results.cases.values() for name in case.methods)
    return {name: METHODS[name].meaning for name in names if name in METHODS}
