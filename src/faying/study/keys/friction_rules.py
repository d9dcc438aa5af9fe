"""Rules for load cases in increments, for backbones, and for joints with friction."""

from typing import Literal

from faying.assessment.modal_cycles import boundary_and_component
from faying.exceptions import FormatError, ModelError, refuse_model
from faying.iterations import MOST_SOLVED
from faying.joint.model import Model
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.reduction.methods import METHODS
from faying.study.keys.errors import Location, Mistakes, located, nearest, quoted, reject
from faying.study.keys.frequency_rules import frequencies_of
from faying.study.keys.load_files import ALL, read_load_factors
from faying.study.keys.section import MOST_PRELOAD_FACTOR
from faying.study.keys.tables import LoadCaseSection, Study
from faying.study.keys.threads import thread_of

MOST_MAPS = 6
"""Largest number of maps side by side."""


def backbone_problems(_: Study, case: LoadCaseSection) -> Mistakes:
    """Yield missing and superfluous keys of backbones, and missing loads of other cases."""
    if case.kind != "backbone":
        if not case.forces:
            yield "", "'forces' is missing or empty; add one or more loads"
        return
    if case.forces:
        yield "forces", "a backbone is loaded only by the inertia of its modes; remove it"
    if not case.modes:
        yield "", "kind = \"backbone\" needs 'modes', as modes = [1, 2]; add it"
    if len(set(case.modes)) < len(case.modes):
        yield "modes", "a mode occurs twice; keep one"
    if bool(case.amplitudes) == (case.amplitude_range is not None):
        text = (
            "kind = \"backbone\" takes either 'amplitudes' [length] or 'amplitude_range' = "
            "[smallest, largest, how many]; give one of them"
        )
        yield "", text
    levels = case.levels
    outside = [level for level in case.maps if not levels or not levels[0] <= level <= levels[-1]]
    if len(case.maps) > MOST_MAPS or (outside and levels):
        text = f"give at most {MOST_MAPS}, from the smallest to the largest amplitude of the case"
        yield "maps", text
    if case.amplitude_range is not None:
        low, high, count = case.amplitude_range
        if not low < high or not 2 <= count <= MOST_SOLVED:
            text = (
                f"found {low:g} to {high:g} in {count}; give the smaller amplitude first, and 2 "
                f"to {MOST_SOLVED} of them"
            )
            yield "amplitude_range", text


def backbones_of(study: Study, model: Model) -> Mistakes:
    """Yield backbones without friction, and with modes or boundaries that do not exist."""
    for i, case in enumerate(study.load_cases):
        if case.kind != "backbone":
            continue
        if not model.contact.rubbing_interfaces:
            text = "no interface has friction, so nothing is damped; add 'friction'"
            yield ("load_case", i, "kind"), text
        count = model.K.shape[0] - 1
        if any(mode > count for mode in case.modes):
            yield ("load_case", i, "modes"), f"the model has {count} modes; give smaller numbers"
        try:
            _check_place(case.at, list(model.boundaries))
        except ModelError as error:
            yield ("load_case", i, "at"), str(error)


def has_reserve(case: LoadCaseSection, model: Model) -> bool:
    """Return whether a load case has a slip reserve: a static load or cycle, and friction."""
    return case.kind in ("static", "cycle") and bool(model.contact.rubbing_interfaces)


def _check_place(boundary: str | None, boundaries: list[str]) -> None:
    if boundary is None:
        return
    _, name, component = boundary_and_component(boundary)
    if name not in boundaries:
        refuse_model(f"there is no boundary '{name}'; {nearest(name, boundaries)}")
    if component and component not in DISPLACEMENT_NAMES:
        refuse_model(f"'{component}' is not one of the components {quoted(DISPLACEMENT_NAMES)}")


KINDS = {
    "factors": ("path",),
    "amplitudes": ("cycle", "backbone"),
    "amplitude_range": ("backbone",),
    "over": ("backbone",),
    "maps": ("backbone",),
    "masing": ("backbone",),
    "modes": ("backbone",),
    "at": ("backbone",),
    "increments": ("static", "cycle", "backbone"),
    "slip_share": ("static", "cycle"),
    "rise_time": ("step",),
}
"""Kinds of load cases that may have a key."""


def increment_problems(_: Study, case: LoadCaseSection) -> Mistakes:
    """Yield keys that a kind of load case does not have, and paths without a valid file."""
    for key in sorted(case.model_fields_set.intersection(KINDS)):
        if case.kind not in KINDS[key]:
            having = " or ".join(f'"{kind}"' for kind in KINDS[key])
            yield key, f"only kind = {having} has it; remove it or change the kind"
    if case.kind == "path" and case.factors is None:
        yield "", "kind = \"path\" needs 'factors', a csv with a column for each load; add it"
    if case.kind == "path" and case.factors is not None:
        try:
            read_load_factors(case.factors, [force.target for force in case.forces])
        except FormatError as error:
            yield "factors", str(error)
    if len(set(case.amplitudes)) < len(case.amplitudes):
        yield "amplitudes", "an amplitude occurs twice; keep one"


def scatter_problems(study: Study, _table: Study) -> Mistakes:
    """Yield inconsistent preload scatter, and scatter that needs missing data of bolts."""
    section = study.preload_scatter
    if section is None:
        return
    try:
        _ = section.spread
    except ModelError as error:
        yield "preload_scatter", str(error)
    for i, bolt in enumerate(study.bolts if section.thread_friction is not None else ()):
        thread = thread_of(bolt, study.units)
        if thread is None or thread.head_diameter is None:
            text = (
                f"scatter of friction in thread and head needs the size and grade of bolt "
                f'\'{bolt.name}\'; add size = "M8" and grade = "8.8"'
            )
            yield ("bolt", i), text


def check_friction(study: Study, model: Model) -> None:
    """Refuse keys of a study that joints with friction or gaskets, or without, exclude.

    Raises
    ------
    StudyError
        One message with all refused keys.
    """
    rubbing = model.contact.rubbing_interfaces
    mistakes = [
        *_bolt_columns(study, model),
        *backbones_of(study, model),
        *frequencies_of(study, model),
    ]
    mistakes += _with_friction(study, rubbing[0]) if rubbing else _without(study, model)
    gaskets = [name for name, interface in model.interfaces.items() if interface.law.remembers]
    mistakes += _with_gasket(study, gaskets[0]) if gaskets else []
    reject(study.source, located((), mistakes))


def _bolt_columns(study: Study, model: Model) -> Mistakes:
    """Yield columns of paths that are neither loads nor bolts, and invalid bolt factors."""
    for i, case in enumerate(study.load_cases):
        if case.factors is None:
            continue
        loads = [force.target for force in case.forces]
        columns = [ALL, *loads, *model.bolts]
        factors = read_load_factors(case.factors, loads)
        for name, values in zip(factors.names, factors.values.T, strict=True):
            absurd = (values < 0) | (values > MOST_PRELOAD_FACTOR)
            if name in model.bolts and name not in loads and absurd.any():
                text = (
                    f"{case.factors.name}: column '{name}' has {values[absurd][0]:g}, expected a "
                    f"factor from 0 to {MOST_PRELOAD_FACTOR:g} on the bolt's initial force"
                )
                yield ("load_case", i, "factors"), text
            if name not in columns:
                text = (
                    f"{case.factors.name}: column '{name}' is neither a load of the case nor a "
                    f"bolt; {nearest(name, columns)}"
                )
                yield ("load_case", i, "factors"), text


def _with_gasket(study: Study, interface: str) -> Mistakes:
    """Yield keys that cannot follow the closing history of a gasket."""
    reason = f"interface '{interface}' has the closure 'gasket', which depends on its history"
    for i, case in enumerate(study.load_cases):
        if case.transient:
            text = f"{reason}: give another kind of case, or the closure 'table'"
            yield ("load_case", i, "kind"), text
    for name in study.reduction.methods:
        if METHODS[name].trained:
            text = f"{reason}, and method '{name}' is trained on single states; use other methods"
            yield ("reduction", "methods"), text
    if study.sticking is not None:
        text = f"{reason}, and sticking parts are solved again without it; remove [sticking]"
        yield ("sticking",), text
    if not study.friction_during_preload:
        text = f"{reason}, so tightening is followed with its friction; remove this key"
        yield ("friction_during_preload",), text


def _without(study: Study, model: Model) -> Mistakes:
    """Yield keys that need friction or a gasket."""
    for i, case in enumerate(study.load_cases):
        for key in ("increments", "slip_share")[not model.contact.forgets :]:
            if case.kind == "static" and key in case.model_fields_set:
                text = "no interface has friction, so one solution is enough; remove it"
                yield ("load_case", i, key), text
    if study.preload_scatter is not None and study.preload_scatter.surface_friction is not None:
        text = "no interface has friction that could scatter; add it, or remove surface_friction"
        yield ("preload_scatter", "surface_friction"), text
    if "friction_during_preload" in study.model_fields_set:
        text = "no interface has friction; add it to an [[interface]], or remove this key"
        yield ("friction_during_preload",), text


def _with_friction(study: Study, interface: str) -> Mistakes:
    """Yield keys that exclude friction."""
    reason = f"interface '{interface}' has friction"
    if study.sticking is not None:
        text = f"{reason}, which determines what sticks; remove [sticking], or the friction"
        yield ("sticking",), text
    able = [name for name, method in METHODS.items() if not method.trained]
    for name in study.reduction.methods:
        if METHODS[name].trained:
            text = (
                f"{reason}, and method '{name}' is trained on normal contact forces alone; use "
                f"one of {quoted(able)} (compliance is exact on paths)"
            )
            yield ("reduction", "methods"), text
    places: dict[Location, str] = {}
    if study.reduction.training.box:
        places["reduction", "training", "box"] = "training loads are solved without friction"
    if not study.reduction.joint_modes:
        places["reduction", "joint_modes"] = "'auto' uses certificates, which exclude friction"
    for location, what in places.items():
        yield location, f"{reason}, and {what}; remove it"


FULL_UP_TO = 100_000
"""Free degrees of freedom up to which all load cases are compared with the full model by default.

A step of the full model takes some tenths of a second there, a response of some hundred steps
minutes.
"""

Kind = Literal["full", "worst", "none"]


def reference_kind(study: Study, model: Model) -> tuple[Kind, str]:
    """Return the kind of reference of a study, and the reason where it was chosen."""
    asked, n_dof = study.validation.reference, model.structure.n_dof
    if not model.contact.forgets:
        reason = "with friction or gaskets, all load cases are compared with the full model"
        return "full", "" if asked in (None, "full") else reason
    if asked is not None:
        return asked, ""
    if n_dof <= FULL_UP_TO:
        return "full", ""
    return "worst", (
        f"the model has {n_dof} free degrees of freedom, and only up to {FULL_UP_TO} load cases "
        'are compared with the full model unless [validation] reference = "full" asks for it'
    )
