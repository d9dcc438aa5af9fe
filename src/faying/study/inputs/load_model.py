"""From a study to the arguments of :func:`faying.joint.build.build_model`, and to the model."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from faying.exceptions import naming, refuse_study
from faying.interface.gap_field import read_gap_field, with_gap_offset
from faying.interface.interface import Interface
from faying.joint.build import build_model
from faying.joint.diagnosis import REMEDY, REMEDY_BESIDE_SPRINGS, check_held
from faying.joint.model import Model
from faying.joint.temperature import with_temperature
from faying.joint.weak_springs import with_weak_springs
from faying.model.assembly import Assembly, Material
from faying.model.deck_bolt import with_unlocked_bolts
from faying.model.description import JointDescription, check_surfaces
from faying.model.material import overridden
from faying.model.parts import part_of
from faying.model.specs import BoltSpec, BoundarySpec, InterfaceSpec, Rayleigh
from faying.sources import SOURCES, SourceKeys
from faying.study.inputs.bolts import (
    bolt_entries,
    check_distinct_bolts,
    check_no_second_preload,
    initial_forces,
    preloads,
    unlocked,
)
from faying.study.inputs.loads import check_loads
from faying.study.inputs.sets import with_study_masses, with_study_sets, with_study_supports
from faying.study.keys.consistency import boundary_problems, deck_load_problems
from faying.study.keys.errors import Mistake, Mistakes, located, nearest, reject
from faying.study.keys.lap_joint import lap_joint_keywords
from faying.study.keys.loadings import loadings, temperature_name_problems, temperatures_of
from faying.study.keys.section import stated
from faying.study.keys.tables import Study
from faying.study.keys.topographies import (
    with_crowns,
    with_topographies,
)

Spec = TypeVar("Spec", InterfaceSpec, BoltSpec, BoundarySpec)


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadedModel:
    """A study and its source, merged into the description of a model.

    Attributes
    ----------
    study
    source
        Model description of the source alone.
    assembly, interfaces, bolts, boundaries
        Parts of the model, with the overrides of the study.
    preloads : [force]
        Final force by bolt name.
    initial_forces : [force]
        Initial force, at which a bolt is locked, by bolt name; for bolts without a final force.
    """

    study: Study
    source: JointDescription
    assembly: Assembly
    interfaces: tuple[InterfaceSpec, ...]
    bolts: tuple[BoltSpec, ...]
    boundaries: tuple[BoundarySpec, ...]
    preloads: Mapping[str, float]
    initial_forces: Mapping[str, float]

    @property
    def damping(self) -> Rayleigh:
        """Rayleigh damping of the structure."""
        return Rayleigh(**self.study.damping.model_dump())

    @property
    def remedy(self) -> str:
        """Advice about bodies without support."""
        springs = self.study.model.weak_springs
        return REMEDY if springs is None else REMEDY_BESIDE_SPRINGS


def load_model(study: Study, source: JointDescription | None = None) -> LoadedModel:
    """Read or generate the structure of a study, with the overrides of the study.

    Parameters
    ----------
    source
        Result of :func:`read_source` for a study of the same structure; read unless given.

    Raises
    ------
    StudyError
        If the study names an entity that the source does not have.
    FormatError, ModelError
        If the source cannot be read or its model cannot be built.
    """
    described = read_source(study) if source is None else source
    assembly = with_study_supports(with_study_sets(described.assembly, study), study)
    assembly = with_study_masses(assembly, study)
    bolts = _merged(study, "bolt", described.bolts, bolt_entries(study, assembly))
    check_distinct_bolts(study, bolts)
    entries = [stated(boundary, BoundarySpec) for boundary in study.boundaries]
    boundaries = _merged(study, "boundary", described.boundaries, entries)
    # Gaps of the study are added later, at the contact points, in place of those of the source.
    parted = {i.name for i in study.interfaces if i.initial_gap is not None}
    defaults = tuple(
        replace(spec, gap=replace(spec.gap, value=None, offset=0.0))
        if spec.gap is not None and spec.name in parted
        else spec
        for spec in described.interfaces
    )
    entries = [stated(interface, InterfaceSpec) for interface in study.interfaces]
    interfaces = _merged(study, "interface", defaults, entries)
    names = [spec.name for spec in boundaries]
    mistakes = [*boundary_problems(study, names), *deck_load_problems(study, assembly)]
    shared = temperature_name_problems(study, assembly)
    reject(study.source, [*located((), mistakes), *shared])
    forces = preloads(study, described, bolts)
    locked = initial_forces(study, described)
    check_no_second_preload(study, assembly, bolts, {**forces, **locked})
    return LoadedModel(
        study=study,
        source=described,
        assembly=with_unlocked_bolts(assembly, unlocked(study, described, bolts)),
        interfaces=interfaces,
        bolts=bolts,
        boundaries=boundaries,
        preloads=forces,
        initial_forces=locked,
    )


def build_loaded(loaded: LoadedModel) -> Model:
    """Build the model of a loaded study, with initial gaps and loads of the deck."""
    study = loaded.study
    model = build_model(
        loaded.assembly,
        interfaces=loaded.interfaces,
        bolts=loaded.bolts,
        boundaries=loaded.boundaries,
        damping=loaded.damping,
        units=study.units,
    )
    if study.model.dense_budget is not None:
        model = model.with_dense_budget(int(study.model.dense_budget))
    if study.model.weak_springs is not None:
        model = with_weak_springs(model, study.model.weak_springs)
    gaps = {i.name: i.initial_gap for i in study.interfaces if i.initial_gap is not None}
    parted = {name: _with_gap(model, name, gap) for name, gap in gaps.items()}
    scans = {i.name: i.topography for i in study.interfaces if i.topography}
    crowns = {i.name: i.crown for i in study.interfaces if i.crown}
    model = with_crowns(with_topographies(model.with_interfaces(parted), scans), crowns)
    return with_loads(model, study)


def with_loads(model: Model, study: Study) -> Model:
    """Return the model with the deck's loads that a study applies, and with its temperatures."""
    applied = [load.deck_load for _, load in loadings(study) if load.deck_load is not None]
    model = model.with_deck_loads(*dict.fromkeys(applied))
    for name, temperature in temperatures_of(study, model.assembly).items():
        with naming(f"temperature '{name}'"):
            model = with_temperature(model, name, temperature)
    return model


def _with_gap(model: Model, name: str, offset: float | Path) -> Interface:
    """Return an interface of the model with an offset added to its gap."""
    interface = model.interfaces[name]
    if isinstance(offset, Path):
        values = read_gap_field(offset, interface, model.assembly.mesh.node_ids)
        return with_gap_offset(interface, values)
    return with_gap_offset(interface, np.asarray(offset))


def check_interfaces(study: Study, loaded: LoadedModel) -> None:
    """Refuse a model without contact interfaces."""
    if not loaded.interfaces:
        refuse_study(
            f"{study.path.name}: neither the study nor its source has a contact interface; add "
            '[[interface]] with a name, minus = "auto" and plus = "auto"'
        )


def build(study: Study) -> Model:
    """Build the model of a study, and check its supports and loads.

    Raises
    ------
    FayingError
        As :func:`load_model`, :func:`build_loaded`,
        :func:`faying.study.inputs.loads.check_loads` and
        :func:`faying.joint.diagnosis.check_held`.
    """
    loaded = load_model(study)
    check_interfaces(study, loaded)
    model = build_loaded(loaded)
    check_loads(study, model)
    check_held(model, loaded.remedy)
    return model


def read_source(study: Study) -> JointDescription:
    """Read the source of a study, with the materials and brick formulation of the study."""
    source, model = SOURCES[study.model.source], study.model
    described = source.read(
        SourceKeys(
            file=model.file or Path(),
            files=dict(model.files or {}),
            subcase=model.subcase,
            ignore=model.ignore,
            element=model.element,
            separate=model.separate,
            lap_joint=lap_joint_keywords(study) if model.lap_joint else {},
            materials=study.materials,
        )
    )
    if source.is_deck:
        check_surfaces(described, model.file or Path())
    described = part_of(described, model.parts, model.without)
    return _with_overrides(described, study) if source.is_deck else described


def _with_overrides(described: JointDescription, study: Study) -> JointDescription:
    """Replace materials and brick formulation by those of the study."""
    assembly = _with_materials(described.assembly, study)
    if "element" in study.model.model_fields_set:
        blocks = tuple(
            replace(block, formulation="") if block.kind == "hex8" else block
            for block in assembly.mesh.blocks
        )
        assembly = replace(
            assembly, element=study.model.element, mesh=replace(assembly.mesh, blocks=blocks)
        )
    return replace(described, assembly=assembly)


def _with_materials(assembly: Assembly, study: Study) -> Assembly:
    """Replace material constants of solids and beams by material name or property id."""
    solids = {str(number): material for number, material in assembly.materials.items()}
    names = {material.name for material in solids.values()}
    names |= {beam.material.name for beam in assembly.beams}
    for name in study.materials:
        if name not in names and name not in solids:
            targets = sorted(filter(None, names)) or list(solids)
            location = study.source.table(("material", name))
            refuse_study(f"{location}: the deck has no material '{name}'; {nearest(name, targets)}")
        if any(name in section.materials for section in assembly.shell_sections.values()):
            location = study.source.table(("material", name))
            refuse_study(
                f"{location}: shells use material '{name}' too, and their sections keep the "
                "constants of the deck; change them there"
            )

    def chosen(material: Material, number: int) -> Material:
        section = study.materials.get(str(number), study.materials.get(material.name))
        return overridden(material, section) if section else material

    materials = {number: chosen(old, number) for number, old in assembly.materials.items()}
    beams = tuple(
        replace(beam, material=chosen(beam.material, beam.property)) for beam in assembly.beams
    )
    return replace(assembly, materials=materials, beams=beams)


def _merged(
    study: Study, table: str, defaults: tuple[Spec, ...], entries: list[dict[str, Any]]
) -> tuple[Spec, ...]:
    """Return the specs of a source, overridden by entries of the same name, and new entries."""
    specs = {spec.name: spec for spec in defaults}
    new = {"interface": InterfaceSpec, "bolt": BoltSpec, "boundary": BoundarySpec}[table]
    mistakes: list[Mistake] = []
    for number, entry in enumerate(entries):
        name = entry["name"]
        if name in specs:
            mistakes += _refused_overrides(study, table, number, entry)
            specs[name] = replace(specs[name], **_without_replaced(table, entry))
        elif (defaults or table == "bolt") and not PLACES[table].intersection(entry):
            text = f"the model has no {table} '{name}'; {nearest(name, specs)}"
            mistakes.append(((table, number, "name"), text))
        else:
            specs[name] = new(**entry)
    reject(study.source, located((), mistakes))
    return tuple(specs.values())


PLACES = {
    "interface": {"minus", "plus"},
    "bolt": {"elements", "nodes", "axis"},
    "boundary": {"set", "node"},
}
"""Keys that place an entity; an entry without them overrides an entity of the source."""


def _without_replaced(table: str, entry: dict[str, Any]) -> dict[str, Any]:
    """Clear the place of a boundary, or the law of an interface, that an entry replaces."""
    if table == "boundary" and PLACES[table].intersection(entry):
        return {"set": None, "node": None, **entry}
    if table == "interface" and {"penalty", "closure"}.intersection(entry):
        return {"penalty": "auto", "closure": None, **entry}
    return entry


def _refused_overrides(study: Study, table: str, number: int, entry: dict[str, Any]) -> Mistakes:
    """Yield keys that cannot override a bolt of the source."""
    for key in entry if table == "bolt" else ():
        if key != "name":
            text = "the source defines this bolt, so only its preload can be given here; "
            yield (table, number, key), text + SOURCES[study.model.source].remedy
