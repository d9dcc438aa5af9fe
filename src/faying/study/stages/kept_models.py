"""The reduced models of a run, complete: what its load cases solve and its results keep."""

from collections.abc import Mapping
from dataclasses import replace

from faying.joint.model import Model
from faying.joint.system import System
from faying.reduction.basis import Basis
from faying.reduction.projection import completed, projected
from faying.reduction.reduced_model import ReducedModel

Models = Mapping[str, Mapping[int, System]]
Kept = Mapping[str, Mapping[int, ReducedModel]]

ALWAYS = (False, True)
"""Whether a residual compliance is with the classic basis, of the models kept in any case."""


def kept_models(model: Model, models: Models, classic: Basis, title: str) -> Kept:
    """Return the reduced models of a run that have a basis, the classic ones in any case.

    With all that recovery and exports need, computed once for all of them.
    """
    chosen = {
        (name, count): rom
        for name, sizes in models.items()
        for count, rom in sizes.items()
        if isinstance(rom, ReducedModel)
    }
    for compliance in ALWAYS:
        rom = projected(model, classic, compliance=compliance)
        if rom.method not in models:
            chosen[rom.method, 0] = rom
    models_by_method: dict[str, dict[int, ReducedModel]] = {}
    for (name, count), rom in zip(chosen, completed(model, list(chosen.values())), strict=True):
        models_by_method.setdefault(name, {})[count] = replace(rom, name=title)
    return models_by_method


def with_kept(models: Models, recoverable: Kept) -> dict[str, dict[int, System]]:
    """Return the models of a run with those that are kept in place of what they came from."""
    return {
        name: {
            count: recoverable.get(name, {}).get(count, system) for count, system in sizes.items()
        }
        for name, sizes in models.items()
    }
