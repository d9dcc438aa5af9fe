"""Rules for harmonic loads of a study, and their needs of the model."""

from faying.assessment.forced_joint import FEWEST
from faying.assessment.response_curve import boundary_components
from faying.exceptions import FayingError
from faying.joint.model import Model
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES
from faying.simulation.load import harmonic_inputs
from faying.study.keys.errors import Mistakes, nearest
from faying.study.keys.frequency_table import FrequencySection
from faying.study.keys.loadings import repeated_loads
from faying.study.keys.tables import Study


def frequency_problems(_: Study, swept: FrequencySection) -> Mistakes:
    """Yield invalid ranges, levels and forces of a harmonic load."""
    yield from repeated_loads("forces", swept.forces)
    if not any(force.value for force in swept.forces):
        yield "forces", "all forces are zero; give one an amplitude"
    for j, force in enumerate(swept.forces):
        if force.temperature is not None:
            text = "a temperature cannot be harmonic; load a boundary, or give a deck_load"
            yield ("forces", j, "temperature"), text
    if not swept.lowest < swept.highest:
        text = f"found {swept.lowest:g}, which is not below 'to' = {swept.highest:g}"
        yield "from", f"{text}; exchange or change them"
    if len(set(swept.levels)) < len(swept.levels):
        yield "levels", "a level occurs twice; keep one"
    fewest = 4 * (swept.harmonics or FEWEST)
    if swept.samples is not None and swept.samples < fewest:
        yield "samples", f"found {swept.samples}, expected at least four per harmonic, {fewest}"


def frequencies_of(study: Study, model: Model) -> Mistakes:
    """Yield harmonic loads and response components that a model does not have."""
    for i, swept in enumerate(study.frequencies):
        hard = [name for name, interface in model.interfaces.items() if not interface.law.yields]
        if hard:
            text = f"interface '{hard[0]}' is hard, so small vibrations have no contact stiffness"
            yield ("frequency", i), f'{text}; give it a penalty, as penalty = "auto"'
        try:
            harmonic_inputs(model, swept.load)
        except FayingError as error:
            yield ("frequency", i, "forces"), str(error)
            continue
        components = boundary_components(model)
        if shown_place(swept, components) not in components:
            text = "no component of its loads" if swept.at is None else swept.at
            advice = nearest(swept.at or "", components) if components else "there is none"
            yield ("frequency", i, "at"), f"found {text}, expected a component; {advice}"


def shown_place(swept: FrequencySection, components: tuple[str, ...]) -> str:
    """Return the boundary component whose response is shown: ``at``, or the first loaded component.

    With loads of the deck alone it is the first component of all. It may not exist.
    """
    if swept.at is not None:
        return swept.at
    moved = dict(zip(FORCE_NAMES, DISPLACEMENT_NAMES, strict=True))
    for force in swept.forces:
        if force.boundary is not None and force.component is not None:
            component = f"{force.boundary}.{moved[force.component]}"
            if component in components:
                return component
            ends = [
                candidate for candidate in components if candidate.startswith(f"{force.boundary}[")
            ]
            return next(
                (candidate for candidate in ends if candidate.endswith(component[-3:])), component
            )
    return components[0] if components else ""
