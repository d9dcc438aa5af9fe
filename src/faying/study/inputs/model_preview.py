"""Preview of a study that is not ready to run: its model, and the missing parts for a run."""

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
from faying.study.inputs.load_model import LoadedModel, build_loaded, with_loads
from faying.study.inputs.loads import missing_mass
from faying.study.keys.tables import Study

CANDIDATES: tuple[tuple[InterfaceSpec, Callable[[Assembly, InterfaceSpec], object]], ...] = (
    (InterfaceSpec(name="joint"), find_interfaces),
    (InterfaceSpec(name="joint", meshes="non-matching"), find_couplings),
)
"""Interfaces that a model without interfaces may have, in the order in which they are tried."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelPreview:
    """A model and what is missing for a run.

    Attributes
    ----------
    candidate
        Interface that was found where none is declared; the model contains it.
    free
        Rigid-body motions of the model without contact.
    needs
        Phrases that name the missing parts for a run.
    """

    model: Model
    candidate: InterfaceSpec | None
    free: FreeParts
    needs: tuple[str, ...]


def model_preview(study: Study, loaded: LoadedModel, *, bare: bool) -> ModelPreview:
    """Build the model of a study as far as possible.

    Faults of a deck without a study count as needs of a run.
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
    """Return an interface of all bodies that touch, with matching meshes if possible."""
    for spec, find in CANDIDATES:
        try:
            find(assembly, spec)
        except ModelError:
            continue
        return spec
    return None


def _without_joint(loaded: LoadedModel) -> Model:
    """Return the model without contact, and without bolts if they cannot be built."""
    try:
        return _structure(loaded)
    except ModelError:
        return _structure(replace(loaded, bolts=()))


def _structure(loaded: LoadedModel) -> Model:
    model = structure_model(
        loaded.assembly,
        bolts=loaded.bolts,
        boundaries=loaded.boundaries,
        damping=loaded.damping,
        units=loaded.study.units,
    )
    return with_loads(model, loaded.study)


def _needs(
    study: Study,
    loaded: LoadedModel,
    model: Model,
    free: FreeParts,
    problem: str,
    candidate: InterfaceSpec | None,
) -> Iterator[str]:
    if problem:
        yield f"valid contact and bolts: {problem}"
    if not loaded.interfaces and candidate is None:
        why = "faces of ties and cut bolts would be found as well"
        why = why if loaded.source.has_joined_faces else "no bodies touch"
        yield (
            f"an interface: none is declared, and {why}; name both sides of one, because models "
            "without contact are not computed"
        )
    elif not loaded.interfaces and not problem:
        yield "an interface in the study; candidates are listed above, and lines to paste below"
    if free.count:
        springs = (
            "; where contact holds a body, weak springs let static cases run "
            '(weak_springs = "auto" under [model])'
        )
        yield (
            "supports: bodies can move, see the rigid-body modes"
            f"{springs if study.model.weak_springs is None else ''}"
        )
    elif free.whole and not study.load_cases and not study.frequencies:
        yield "supports, unless the joint is meant to move as a whole"
    for spec in loaded.bolts:
        if spec.name not in loaded.preloads and spec.name not in loaded.initial_forces:
            yield f"the preload of bolt '{spec.name}'"
    if missing := missing_mass(study, model):
        yield f"densities: {missing}"
    if not study.load_cases and not study.frequencies:
        yield "a [[load_case]] or [[frequency]]"
