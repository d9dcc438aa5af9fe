"""Rules between the values of a study file, a function for each kind of table."""

import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

from faying.exceptions import FormatError
from faying.interface.gap_field import read_gap_table
from faying.model.assembly import Assembly
from faying.reduction.methods import METHODS
from faying.simulation.instants import MOST_TIME_STEPS
from faying.simulation.integrators import DAMPED
from faying.sources import SOURCES, Source
from faying.study.keys.bolt_rules import bolt_problems, margin_problems
from faying.study.keys.errors import Location, Mistakes, Problem, located, nearest, quoted
from faying.study.keys.frequency_rules import frequency_problems
from faying.study.keys.frequency_table import FrequencySection
from faying.study.keys.friction_rules import (
    backbone_problems,
    increment_problems,
    scatter_problems,
)
from faying.study.keys.lap_joint import lap_joint_problems
from faying.study.keys.load_files import read_history
from faying.study.keys.loading_table import Loading
from faying.study.keys.loadings import (
    loadings,
    repeated_loads,
    temperature_problems,
    temperature_table_problems,
)
from faying.study.keys.measurements import measurement_problems
from faying.study.keys.model_tables import (
    BoltSection,
    BoundarySection,
    InterfaceSection,
    MaterialSection,
    ModelSection,
    TemperatureSection,
)
from faying.study.keys.parameter_tables import Steps, steps_to, value_at
from faying.study.keys.requirement_tables import MarginsSection
from faying.study.keys.section import LARGEST_COUNT, Section
from faying.study.keys.tables import (
    LoadCaseSection,
    ReductionSection,
    Study,
    Timed,
    TrainingSection,
)

Rule = Callable[[Study, Any], Mistakes]
"""Function of a study and one of its tables that yields what is wrong with this table."""


def inconsistencies(study: Study) -> list[Problem]:
    """Return all inconsistencies of a study."""
    mistakes = (
        located(location, rule(study, table))
        for location, table in _tables(study, ())
        for kind in reversed(type(table).__mro__)
        for rule in RULES.get(kind, ())
    )
    return [*lap_joint_problems(study), *chain.from_iterable(mistakes)]


def _tables(table: Section, location: Location) -> Iterator[tuple[Location, Section]]:
    """Yield a table and all tables within it, with their locations."""
    yield location, table
    for name, field in type(table).model_fields.items():
        value, within = getattr(table, name), (*location, field.alias or name)
        if isinstance(value, Section):
            yield from _tables(value, within)
        elif isinstance(value, (tuple, Mapping)):
            entries = value.items() if isinstance(value, Mapping) else enumerate(value)
            for key, entry in entries:
                if isinstance(entry, Section):
                    yield from _tables(entry, (*within, key))


def boundary_problems(study: Study, boundaries: Iterable[str]) -> Mistakes:
    """Yield loads on boundaries that do not exist."""
    names = list(boundaries)
    for location, load in loadings(study):
        name = load.boundary
        if name is not None and name not in names:
            yield (*location, "boundary"), f"no boundary '{name}'; {nearest(name, names)}"


def deck_load_problems(study: Study, assembly: Assembly) -> Mistakes:
    """Yield loads of the deck that do not exist."""
    loads = assembly.loads
    for location, load in loadings(study):
        name = load.deck_load
        if name is not None and name not in loads:
            left_out = [note for note in assembly.ignored if note.startswith(f"load set {name} (")]
            reason = f"left out: {left_out[0]}" if left_out else nearest(name, loads)
            deck = study.model.file.name if study.model.file else "the model"
            yield (*location, "deck_load"), f"{deck} has no load '{name}'; {reason}"


def _load_target(_: Study, load: Loading) -> Mistakes:
    keys = [key for key in ("boundary", "component") if getattr(load, key) is not None]
    if load.deck_load is None and load.temperature is None and len(keys) < 2:
        missing = "component" if keys == ["boundary"] else "boundary"
        yield "", f"missing key '{missing}'; add it, or 'deck_load' for a load of the deck"


def _source(study: Study) -> Source:
    return SOURCES[study.model.source]


def _names(_: Study, study: Study) -> Mistakes:
    families = {
        "interface": [interface.name for interface in study.interfaces],
        "bolt": [bolt.name for bolt in study.bolts],
        "boundary": [boundary.name for boundary in study.boundaries],
        "load_case": [case.name for case in study.load_cases],
        "frequency": [swept.name for swept in study.frequencies],
    }
    for table, names in families.items():
        for i, name in enumerate(names):
            if name in names[:i]:
                first = names.index(name) + 1
                text = f"'{name}' is already the name of number {first}; names must differ"
                yield (table, i, "name"), text
    if study.boundaries and not _source(study).has_boundaries:
        yield from boundary_problems(study, [boundary.name for boundary in study.boundaries])


def _model(study: Study, model: ModelSection) -> Mistakes:
    source = _source(study)
    if model.subcase is not None and not source.is_deck:
        yield "subcase", f"source '{source.name}' has no subcases; remove it"
    if model.ignore and not source.is_deck:
        text = f"source '{source.name}' is not a deck, so nothing can be ignored; remove it"
        yield "ignore", text
    for key in ("parts", "without"):
        if getattr(model, key) and not (source.is_deck or source.is_mesh):
            yield key, f"source '{source.name}' has no parts to choose from; remove it"
    if model.separate and not source.is_mesh:
        yield "separate", 'only source "mesh" has groups to separate; remove it'
    for key in dict.fromkeys(reader.key for reader in SOURCES.values()):
        stated = key in model.model_fields_set
        if key == source.key and not stated and source.needs_key:
            yield "", f"source '{source.name}' needs '{key}'; add it"
        if key != source.key and stated:
            yield key, f"does not belong to source '{source.name}'; remove it or change the source"


def _interface(study: Study, interface: InterfaceSection) -> Mistakes:
    if (interface.minus == "auto") != (interface.plus == "auto"):
        yield "", 'only one of minus and plus is "auto"; name both sides, or neither'
    if isinstance(interface.initial_gap, Path):
        try:
            read_gap_table(interface.initial_gap)
        except FormatError as error:
            yield "initial_gap", str(error)
    stated = "tangential_penalty" in interface.model_fields_set
    if stated and not interface.friction and not _source(study).is_deck:
        yield "tangential_penalty", "the interface has no friction; add 'friction' or remove it"


def _boundary(study: Study, boundary: BoundarySection) -> Mistakes:
    if boundary.set is None and boundary.node is None and not _source(study).has_boundaries:
        yield "", f"boundary '{boundary.name}' needs either 'set' or 'node'; add one"
    if boundary.coupling is not None and boundary.set is None:
        yield "", "a coupling needs 'set', the nodes that follow; add it"
    if boundary.at is not None and boundary.coupling is None:
        yield "", '\'at\' places the node of a coupling; add coupling = "rbe2" or "rbe3"'


def _material(study: Study, material: MaterialSection) -> Mistakes:
    if not material.model_fields_set:
        yield "", "the table is empty; give 'E', 'nu', 'rho' or 'alpha', or remove it"
    if not _source(study).has_elements:
        yield "", "matrices have no material; remove [material]"
    missing = [key for key in ("E", "nu", "rho") if getattr(material, key) is None]
    if missing and _source(study).is_mesh:
        yield "", f"a mesh has no material, so {quoted(missing)} must be given; add it"


def _reduction(study: Study, reduction: ReductionSection) -> Mistakes:
    modes, training = reduction.joint_modes, reduction.training
    if reduction.normal_modes is None and not any(case.transient for case in study.load_cases):
        text = (
            "'auto' needs load cases over time, and the study has none; give a number, or "
            'add a [[load_case]] of kind = "step" or "history"'
        )
        yield "normal_modes", text
    without_basis = [name for name in reduction.methods if METHODS[name].forces is not None]
    if not modes and without_basis:
        text = f"'auto' is not possible for method '{without_basis[0]}'; give a list of numbers"
        yield "joint_modes", text
    if not modes and not training.box:
        text = "joint_modes = 'auto' needs the loads of a box in [reduction.training]; add a box"
        yield "joint_modes", text
    if any(later <= earlier for earlier, later in pairwise(modes)):
        modes_text = ", ".join(map(str, modes))
        yield "joint_modes", f"found {modes_text}; the numbers of modes must increase, sort them"
    if len(set(reduction.methods)) < len(reduction.methods):
        yield "methods", "a method is named twice; keep one"
    learning = [name for name in reduction.methods if METHODS[name].trained]
    if not training.box and learning:
        text = (
            f"method '{learning[0]}' needs training loads, and there are none; add "
            "[reduction.training] with box = [{ boundary, component, min, max }], or use methods "
            'without training, as in methods = ["craig-bampton", "compliance"]'
        )
        yield "", text


def _training(_: Study, training: TrainingSection) -> Mistakes:
    yield from repeated_loads("box", training.box)
    sides = len(training.box)
    combined = training.levels**sides * len(training.preload_factors)
    steps = 3**sides - 1 if training.dynamics else 0
    for count, what in ((combined, "levels"), (steps, "dynamics")):
        if count > LARGEST_COUNT:
            text = (
                f"the combinations of {sides} sides are {count:.4g} loads, expected at most "
                f"{LARGEST_COUNT}; lower 'levels', shorten the box, or set dynamics = false"
            )
            yield what, text
    for i, side in enumerate(training.box):
        if not side.min < side.max:
            text = f"min {side.min:g} is not below max {side.max:g}; exchange or change them"
            yield ("box", i, "min"), text


def _number_of_steps(_: Study, timed: Timed) -> Mistakes:
    pairs = ((timed.duration, 1 / (timed.step or 1e30)), (timed.periods, timed.steps_per_period))
    for length, rate in pairs:
        count = (length or 0.0) * (rate or 0)
        if count > MOST_TIME_STEPS:
            text = (
                f"found {count:.4g} time steps, expected at most {MOST_TIME_STEPS}; "
                "enlarge the step"
            )
            yield "", text


def _load_case(_: Study, case: LoadCaseSection) -> Mistakes:
    if case.rho_infinity is not None and case.integrator not in DAMPED:
        having = " and ".join(f'"{name}"' for name in DAMPED)
        yield "rho_infinity", f"only integrator = {having} have it; remove it or set the integrator"


def _timing(_: Study, case: LoadCaseSection) -> Mistakes:
    if not case.transient:
        keys = [*Timed.model_fields, "integrator", "tolerance"]
        for key in [key for key in keys if getattr(case, key) is not None]:
            yield key, f'kind = "{case.kind}" has no time; remove it or use kind = "step"'
        return
    if case.step is None and case.steps_per_period is None:
        yield "", f"kind = \"{case.kind}\" needs a time step; add 'step' or 'steps_per_period'"
    if case.rise_time is not None and case.rise_time > (case.duration or case.rise_time):
        text = (
            f"found {case.rise_time:g}, longer than the duration {case.duration:g}, so that the "
            "loads are never reached; shorten it or lengthen the duration"
        )
        yield "rise_time", text
    if case.kind == "step" and case.duration is None and case.periods is None:
        yield "", "kind = \"step\" needs a length; add 'duration' or 'periods'"
    if case.step is not None and case.duration is not None and case.duration < case.step:
        text = f"duration {case.duration:g} is shorter than the step {case.step:g}; enlarge it"
        yield "duration", text


def _forces(_: Study, case: LoadCaseSection) -> Mistakes:
    yield from repeated_loads("forces", case.forces)
    for j, force in enumerate(case.forces):
        if force.file is None:
            continue
        if case.kind != "history":
            text = f'kind = "{case.kind}" takes a value; use kind = "history" for a file'
            yield ("forces", j, "file"), text
        try:
            read_history(force.file)
        except FormatError as error:
            yield ("forces", j, "file"), str(error)
    if case.kind == "history" and not any(force.file for force in case.forces):
        yield "", "kind = \"history\" needs a 'file' in at least one of its forces; add it"


def _parameters(_: Study, study: Study) -> Mistakes:
    """Yield parameters that name no number of the study, and invalid ranges."""
    tables = tomllib.loads(study.text)
    used: dict[Steps, str] = {}
    for number, section in enumerate(study.parameters):
        wrong: dict[str, str] = {}
        if not section.range[0] < section.range[1]:
            wrong["range"] = f"found {list(section.range)}, expected the smaller number first"
        if section.name in [earlier.name for earlier in study.parameters[:number]]:
            wrong["name"] = f"two parameters are called '{section.name}'; names must differ"
        for key in section.keys:
            try:
                steps = steps_to(key, tables)
            except LookupError as error:
                wrong["keys"] = str(error)
                continue
            if steps[-1] == "friction" and not section.range[0] > 0:
                wrong["range"] = "without friction a joint has no backbone; start above 0"
            if steps in used:
                wrong["keys"] = f"'{key}' belongs to parameter '{used[steps]}' already; remove it"
            elif isinstance(value_at(steps[:-1], tables), dict):
                used[steps] = section.name
            else:
                wrong["keys"] = f"the study has no table of '{key}'; add it"
        yield from ((("parameter", number, key), text) for key, text in wrong.items())


RULES: Mapping[type[Section], Sequence[Rule]] = {
    Study: (_names, scatter_problems, temperature_problems, measurement_problems, _parameters),
    ModelSection: (_model,),
    MaterialSection: (_material,),
    InterfaceSection: (_interface,),
    BoltSection: (bolt_problems,),
    MarginsSection: (margin_problems,),
    BoundarySection: (_boundary,),
    Loading: (_load_target,),
    TemperatureSection: (temperature_table_problems,),
    ReductionSection: (_reduction,),
    TrainingSection: (_training,),
    Timed: (_number_of_steps,),
    LoadCaseSection: (_timing, _forces, increment_problems, backbone_problems, _load_case),
    FrequencySection: (frequency_problems,),
}
"""Rules by the kind of table."""
