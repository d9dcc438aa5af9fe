"""What load cases that are backbones must be."""

from collections.abc import Iterator

from faying.assessment.modal_cycles import boundary_and_component
from faying.exceptions import ModelError
from faying.joint.model import Model
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.study.keys.errors import Problem, nearest, quoted
from faying.study.keys.positions import Location
from faying.study.keys.tables import LoadCaseSection, Study

MOST_AMPLITUDES = 1000
"""Amplitudes of a range; more is taken for a slip of the pen."""

MOST_MAPS = 6
"""Maps that stand side by side."""


def backbone_problems(study: Study, location: Location, case: LoadCaseSection) -> Iterator[Problem]:
    """Find what backbones lack or have too much, and loads that other cases lack."""
    if case.kind != "backbone":
        if not case.forces:
            yield study.in_table(location, "'forces' is missing or empty; add one or more loads")
        return
    if case.forces:
        text = "a backbone is loaded by the inertia of its modes alone; remove it"
        yield study.problem((*location, "forces"), text)
    if not case.modes:
        text = "kind = \"backbone\" needs 'modes', as modes = [1, 2]; add it"
        yield study.in_table(location, text)
    if len(set(case.modes)) < len(case.modes):
        text = "a mode is there twice; keep one"
        yield study.problem((*location, "modes"), text)
    if bool(case.amplitudes) == (case.amplitude_range is not None):
        text = (
            "kind = \"backbone\" takes either 'amplitudes' [length] or 'amplitude_range' = "
            "[smallest, largest, how many]; give one of them"
        )
        yield study.in_table(location, text)
    levels = case.levels
    outside = [level for level in case.maps if not levels or not levels[0] <= level <= levels[-1]]
    if len(case.maps) > MOST_MAPS or (outside and levels):
        text = f"give at most {MOST_MAPS}, from the smallest to the largest amplitude of the case"
        yield study.problem((*location, "maps"), text)
    if case.amplitude_range is not None:
        low, high, count = case.amplitude_range
        if not low < high or not 2 <= count <= MOST_AMPLITUDES:
            text = (
                f"found {low:g} to {high:g} in {count}; give the smaller amplitude first, and 2 "
                f"to {MOST_AMPLITUDES} of them"
            )
            yield study.problem((*location, "amplitude_range"), text)


def backbones_of(study: Study, model: Model) -> Iterator[Problem]:
    """Find backbones without friction, of modes or at places that a model does not have."""
    for i, case in enumerate(study.load_cases):
        if case.kind != "backbone":
            continue
        wrong: dict[str, str] = {}
        if not model.contact.rubbing_interfaces:
            wrong["kind"] = "no interface has friction, which makes damping; add 'friction' to one"
        count = model.K.shape[0] - 1
        if any(mode > count for mode in case.modes):
            wrong["modes"] = f"the model has {count} modes; take smaller numbers"
        try:
            _check_place(case.at, list(model.boundaries))
        except ModelError as error:
            wrong["at"] = str(error)
        yield from study.problems(("load_case", i), wrong)


def _check_place(boundary: str | None, boundaries: list[str]) -> None:
    if boundary is None:
        return
    _, name, component = boundary_and_component(boundary)
    if name not in boundaries:
        message = f"there is no boundary '{name}'; {nearest(name, boundaries)}"
        raise ModelError(message)
    if component and component not in DISPLACEMENT_NAMES:
        message = f"'{component}' is no component; they are {quoted(DISPLACEMENT_NAMES)}"
        raise ModelError(message)
