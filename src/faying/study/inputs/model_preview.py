"""What can be said of a study that is not ready to run: its model, and what a run would need."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from faying.exceptions import ModelError
from faying.interface.mortar import find_couplings
from faying.interface.pairing import find_interfaces
from faying.joint.build import structure_model
from faying.joint.diagnosis import FreeParts, free_parts
from faying.joint.model import Model
from faying.model.assembly import Assembly
from faying.model.specs import InterfaceSpec
from faying.study.inputs.load_model import LoadedModel, build_loaded
from faying.study.inputs.loads import missing_mass
from faying.study.keys.tables import Study

CANDIDATES: tuple[tuple[InterfaceSpec, Callable[[Assembly, InterfaceSpec], object]], ...] = (
    (InterfaceSpec(name="joint"), find_interfaces),
    (InterfaceSpec(name="joint", meshes="non-matching"), find_couplings),
)
"""Where a model without interfaces may have some, the first that is found."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelPreview:
    """A model and what is missing from it.

    Attributes
    ----------
    candidate
        The interface that was found where none is declared, which the model then has.
    free
        What can move in it.
    needs
        What a run would still need, in sentences.
    """

    model: Model
    candidate: InterfaceSpec | None
    free: FreeParts
    needs: tuple[str, ...]


def model_preview(study: Study, loaded: LoadedModel, *, bare: bool) -> ModelPreview:
    """Build the model as far as it can be built.

    The faults of a bare deck, without a study, are needs of a run.
    """
    problem = ""
    unknown = not loaded.interfaces and not loaded.source.has_joined_faces
    candidate = _candidate(loaded.assembly) if unknown else None
    try:
        specs = loaded.interfaces if candidate is None else (candidate,)
        model = build_loaded(replace(loaded, interfaces=specs)) if specs else _structure(loaded)
    except ModelError as error:
        if not bare and loaded.interfaces:
            raise
        model, problem = _without_joint(loaded), str(error)
    free = free_parts(model)
    needs = tuple(_needs(study, loaded, model, free, problem, candidate))
    return ModelPreview(model=model, candidate=candidate, free=free, needs=needs)


def _candidate(assembly: Assembly) -> InterfaceSpec | None:
    """Return the contact of all bodies that touch, whether their meshes match or not."""
    for spec, find in CANDIDATES:
        try:
            find(assembly, spec)
        except ModelError:
            continue
        return spec
    return None


def _without_joint(loaded: LoadedModel) -> Model:
    """Return the model without contact, and without bolts if these are what cannot be built."""
    try:
        return _structure(loaded)
    except ModelError:
        return _structure(replace(loaded, bolts=()))


def _structure(loaded: LoadedModel) -> Model:
    return structure_model(
        loaded.assembly,
        bolts=loaded.bolts,
        boundaries=loaded.boundaries,
        damping=loaded.damping,
        units=loaded.study.units,
    )


def _needs(
    study: Study,
    loaded: LoadedModel,
    model: Model,
    free: FreeParts,
    problem: str,
    candidate: InterfaceSpec | None,
) -> Iterator[str]:
    if problem:
        yield f"contact and bolts that can be built: {problem}"
    if not loaded.interfaces and candidate is None:
        why = "faces found would be those of ties and of cuts through bolts too"
        why = why if loaded.source.has_joined_faces else "no bodies touch"
        yield (
            f"an interface: none is declared, and {why}; name both sides of one, for models "
            "without contact are read and not computed"
        )
    elif not loaded.interfaces and not problem:
        yield "an interface in the study; those found are above, with what to paste below"
    if free.count:
        springs = (
            "; where contact holds it, weak springs let statics run "
            '(weak_springs = "auto" under [model])'
        )
        yield (
            "supports: something can move, as the rigid-body modes say"
            f"{springs if study.model.weak_springs is None else ''}"
        )
    elif free.whole and not study.load_cases and not study.frequencies:
        yield "supports, unless the joint is meant to move as a whole, as it can"
    for spec in loaded.bolts:
        if spec.name not in loaded.preloads and spec.name not in loaded.initial_forces:
            yield f"the preload of bolt '{spec.name}'"
    if missing := missing_mass(study, model):
        yield f"densities: {missing}"
    if not study.load_cases and not study.frequencies:
        yield "a [[load_case]] or [[frequency]]"
