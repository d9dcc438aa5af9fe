"""Rules between the values of a study file, a function each."""

import tomllib
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise
from pathlib import Path

from faying.exceptions import FormatError
from faying.interface.gap_field import read_gap_table
from faying.model.assembly import Assembly
from faying.reduction.methods import METHODS
from faying.simulation.instants import MOST_TIME_STEPS
from faying.simulation.integrators import DAMPED
from faying.sources import SOURCES, Source
from faying.study.keys.bolt_rules import bolt_problems, margin_problems
from faying.study.keys.errors import Location, Problem, nearest, quoted
from faying.study.keys.frequency_rules import frequency_problems
from faying.study.keys.friction_rules import (
    increment_problems,
    scatter_problems,
    spare_tangential_penalties,
)
from faying.study.keys.lap_joint import lap_joint_problems
from faying.study.keys.load_files import read_history
from faying.study.keys.loadings import loadings, repeated_loads, temperature_problems
from faying.study.keys.measurements import measurement_problems
from faying.study.keys.parameter_tables import Steps, steps_to, value_at
from faying.study.keys.section import LARGEST_COUNT
from faying.study.keys.tables import LoadCaseSection, Study, Timed


def inconsistencies(study: Study) -> list[Problem]:
    """Return all inconsistencies of a study."""
    return [problem for rule in RULES for problem in rule(study)]


def boundary_problems(study: Study, boundaries: Iterable[str]) -> Iterator[Problem]:
    """Yield loads on boundaries that do not exist."""
    names = list(boundaries)
    for location, load in loadings(study):
        name = load.boundary
        if name is not None and name not in names:
            text = f"no boundary '{name}'; {nearest(name, names)}"
            yield study.problem((*location, "boundary"), text)


def deck_load_problems(study: Study, assembly: Assembly) -> Iterator[Problem]:
    """Yield loads of the deck that do not exist."""
    loads = assembly.loads
    for location, load in loadings(study):
        name = load.deck_load
        if name is not None and name not in loads:
            left_out = [note for note in assembly.ignored if note.startswith(f"load set {name} (")]
            reason = f"left out: {left_out[0]}" if left_out else nearest(name, loads)
            deck = study.model.file.name if study.model.file else "the model"
            text = f"{deck} has no load '{name}'; {reason}"
            yield study.problem((*location, "deck_load"), text)


def _load_targets(study: Study) -> Iterator[Problem]:
    for location, load in loadings(study):
        keys = [key for key in ("boundary", "component") if getattr(load, key) is not None]
        whole = [key for key in ("deck_load", "temperature") if getattr(load, key) is not None]
        if not whole and len(keys) < 2:
            missing = "component" if keys == ["boundary"] else "boundary"
            text = f"missing key '{missing}'; add it, or 'deck_load' for a load of the deck"
            yield study.in_table(location, text)


def _source(study: Study) -> Source:
    return SOURCES[study.model.source]


def _unique_names(study: Study) -> Iterator[Problem]:
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
                yield study.problem((table, i, "name"), text)


def _model_files(study: Study) -> Iterator[Problem]:
    source = _source(study)
    if study.model.subcase is not None and not source.is_deck:
        text = f"source '{source.name}' has no subcases; remove it"
        yield study.problem(("model", "subcase"), text)
    if study.model.ignore and not source.is_deck:
        text = f"source '{source.name}' is not a deck, so nothing can be ignored; remove it"
        yield study.problem(("model", "ignore"), text)
    for key in ("parts", "without"):
        if getattr(study.model, key) and not (source.is_deck or source.is_mesh):
            text = f"source '{source.name}' has no parts to choose from; remove it"
            yield study.problem(("model", key), text)
    for key in dict.fromkeys(reader.key for reader in SOURCES.values()):
        stated = key in study.model.model_fields_set
        if key == source.key and not stated and source.needs_key:
            text = f"source '{source.name}' needs '{key}'; add it"
            yield study.in_table(("model",), text)
        if key != source.key and stated:
            text = f"does not belong to source '{source.name}'; remove it or change the source"
            yield study.problem(("model", key), text)


def _interfaces(study: Study) -> Iterator[Problem]:
    for i, interface in enumerate(study.interfaces):
        if (interface.minus == "auto") != (interface.plus == "auto"):
            text = 'only one of minus and plus is "auto"; name both sides, or neither'
            yield study.in_table(("interface", i), text)
        if isinstance(interface.initial_gap, Path):
            try:
                read_gap_table(interface.initial_gap)
            except FormatError as error:
                yield study.problem(("interface", i, "initial_gap"), str(error))


def _boundaries(study: Study) -> Iterator[Problem]:
    for i, boundary in enumerate(study.boundaries):
        neither = boundary.set is None and boundary.node is None
        if neither and not _source(study).has_boundaries:
            text = f"boundary '{boundary.name}' needs either 'set' or 'node'; add one"
            yield study.in_table(("boundary", i), text)
    if study.boundaries and not _source(study).has_boundaries:
        yield from boundary_problems(study, [boundary.name for boundary in study.boundaries])


def _coupled(study: Study) -> Iterator[Problem]:
    for i, boundary in enumerate(study.boundaries):
        if boundary.coupling is not None and boundary.set is None:
            text = "a coupling needs 'set', the nodes that follow; add it"
            yield study.in_table(("boundary", i), text)
        if boundary.at is not None and boundary.coupling is None:
            text = '\'at\' places the node of a coupling; add coupling = "rbe2" or "rbe3"'
            yield study.in_table(("boundary", i), text)


def _mesh_materials(study: Study) -> Iterator[Problem]:
    """Yield incomplete materials of a mesh, which has none itself."""
    if study.model.separate and not _source(study).is_mesh:
        text = 'only source "mesh" has groups to separate; remove it'
        yield study.problem(("model", "separate"), text)
    if not _source(study).is_mesh:
        return
    for name, material in study.materials.items():
        missing = [key for key in ("E", "nu", "rho") if getattr(material, key) is None]
        if missing:
            text = f"a mesh has no material, so {quoted(missing)} must be given; add it"
            yield study.in_table(("material", name), text)


def _reduction(study: Study) -> Iterator[Problem]:
    reduction, training = study.reduction, study.reduction.training
    modes = reduction.joint_modes
    if reduction.normal_modes is None and not any(case.transient for case in study.load_cases):
        text = (
            "'auto' needs load cases over time, and the study has none; give a number, or "
            'add a [[load_case]] of kind = "step" or "history"'
        )
        yield study.problem(("reduction", "normal_modes"), text)
    without_basis = [name for name in reduction.methods if METHODS[name].forces is not None]
    if not modes and without_basis:
        text = f"'auto' is not possible for method '{without_basis[0]}'; give a list of numbers"
        yield study.problem(("reduction", "joint_modes"), text)
    if not modes and not training.box:
        text = "joint_modes = 'auto' needs the loads of a box in [reduction.training]; add a box"
        yield study.problem(("reduction", "joint_modes"), text)
    if any(later <= earlier for earlier, later in pairwise(modes)):
        modes_text = ", ".join(map(str, modes))
        text = f"found {modes_text}; the numbers of modes must increase, sort them"
        yield study.problem(("reduction", "joint_modes"), text)
    if len(set(reduction.methods)) < len(reduction.methods):
        text = "a method is named twice; keep one"
        yield study.problem(("reduction", "methods"), text)
    learning = [name for name in reduction.methods if METHODS[name].trained]
    if not training.box and learning:
        text = (
            f"method '{learning[0]}' needs training loads, and there are none; add "
            "[reduction.training] with box = [{ boundary, component, min, max }], or use methods "
            'without training, as in methods = ["craig-bampton", "compliance"]'
        )
        yield study.in_table(("reduction",), text)
    yield from repeated_loads(study, ("reduction", "training", "box"), training.box)
    yield from _number_of_loads(study)
    for i, side in enumerate(training.box):
        if not side.min < side.max:
            location = ("reduction", "training", "box", i, "min")
            text = f"min {side.min:g} is not below max {side.max:g}; exchange or change them"
            yield study.problem(location, text)
    yield from _number_of_steps(study, ("reduction", "training"), training)


def _number_of_loads(study: Study) -> Iterator[Problem]:
    training, sides = study.reduction.training, len(study.reduction.training.box)
    combined = training.levels**sides * len(training.preload_factors)
    steps = 3**sides - 1 if training.dynamics else 0
    for count, what in ((combined, "levels"), (steps, "dynamics")):
        if count > LARGEST_COUNT:
            text = (
                f"the combinations of {sides} sides are {count:.4g} loads, expected at most "
                f"{LARGEST_COUNT}; lower 'levels', shorten the box, or set dynamics = false"
            )
            yield study.problem(("reduction", "training", what), text)


def _number_of_steps(study: Study, location: Location, timed: Timed) -> Iterator[Problem]:
    pairs = ((timed.duration, 1 / (timed.step or 1e30)), (timed.periods, timed.steps_per_period))
    for length, rate in pairs:
        count = (length or 0.0) * (rate or 0)
        if count > MOST_TIME_STEPS:
            text = (
                f"found {count:.4g} time steps, expected at most {MOST_TIME_STEPS}; "
                "enlarge the step"
            )
            yield study.in_table(location, text)


def _load_cases(study: Study) -> Iterator[Problem]:
    for i, case in enumerate(study.load_cases):
        location: Location = ("load_case", i)
        yield from _number_of_steps(study, location, case)
        yield from _timing(study, location, case)
        yield from _forces(study, location, case)
        yield from increment_problems(study, location, case)
        if case.rho_infinity is not None and case.integrator not in DAMPED:
            having = " and ".join(f'"{name}"' for name in DAMPED)
            text = f"only integrator = {having} have it; remove it or set the integrator"
            yield study.problem((*location, "rho_infinity"), text)


def _timing(study: Study, location: Location, case: LoadCaseSection) -> Iterator[Problem]:
    if not case.transient:
        keys = [*Timed.model_fields, "integrator", "tolerance"]
        for key in [key for key in keys if getattr(case, key) is not None]:
            text = f'kind = "{case.kind}" has no time; remove it or use kind = "step"'
            yield study.problem((*location, key), text)
        return
    if case.step is None and case.steps_per_period is None:
        text = f"kind = \"{case.kind}\" needs a time step; add 'step' or 'steps_per_period'"
        yield study.in_table(location, text)
    if case.rise_time is not None and case.rise_time > (case.duration or case.rise_time):
        text = (
            f"found {case.rise_time:g}, longer than the duration {case.duration:g}, so that the "
            "loads are never reached; shorten it or lengthen the duration"
        )
        yield study.problem((*location, "rise_time"), text)
    if case.kind == "step" and case.duration is None and case.periods is None:
        text = "kind = \"step\" needs a length; add 'duration' or 'periods'"
        yield study.in_table(location, text)
    if case.step is not None and case.duration is not None and case.duration < case.step:
        text = f"duration {case.duration:g} is shorter than the step {case.step:g}; enlarge it"
        yield study.problem((*location, "duration"), text)


def _forces(study: Study, location: Location, case: LoadCaseSection) -> Iterator[Problem]:
    yield from repeated_loads(study, (*location, "forces"), case.forces)
    for j, force in enumerate(case.forces):
        entry: Location = (*location, "forces", j)
        if force.file is None:
            continue
        if case.kind != "history":
            text = f'kind = "{case.kind}" takes a value; use kind = "history" for a file'
            yield study.problem((*entry, "file"), text)
        try:
            read_history(force.file)
        except FormatError as error:
            yield study.problem((*entry, "file"), str(error))
    if case.kind == "history" and not any(force.file for force in case.forces):
        text = "kind = \"history\" needs a 'file' in at least one of its forces; add it"
        yield study.in_table(location, text)


def _material(study: Study) -> Iterator[Problem]:
    for name, material in study.materials.items():
        if not material.model_fields_set:
            text = "the table is empty; give 'E', 'nu', 'rho' or 'alpha', or remove it"
            yield study.in_table(("material", name), text)
    if study.materials and not _source(study).has_elements:
        text = "matrices have no material; remove [material]"
        yield study.in_table(("material",), text)


def _parameters(study: Study) -> Iterator[Problem]:
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
        yield from study.problems(("parameter", number), wrong)


RULES: tuple[Callable[[Study], Iterable[Problem]], ...] = (
    _unique_names,
    _model_files,
    lap_joint_problems,
    _material,
    _interfaces,
    spare_tangential_penalties,
    scatter_problems,
    bolt_problems,
    margin_problems,
    _boundaries,
    _coupled,
    measurement_problems,
    _parameters,
    _mesh_materials,
    _load_targets,
    temperature_problems,
    _reduction,
    _load_cases,
    frequency_problems,
)
