"""A load of a study: a component at a boundary, a load of the deck, or a temperature."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator

from faying.study.keys.section import Name, Section

ForceComponent = Literal["Fx", "Fy", "Fz", "Mx", "My", "Mz"]


def _load_name(value: Any) -> Any:
    """Return the id of a load set as its name."""
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


LoadName = Annotated[Name, BeforeValidator(_load_name, json_schema_input_type=Name | int)]


class Loading(Section):
    """A component of a boundary's load, a whole load of the deck, or a temperature."""

    alternatives = (
        (("deck_load", "temperature", "boundary"), "the load"),
        (("deck_load", "temperature", "component"), "the load"),
    )
    boundary: Name | None = None
    component: ForceComponent | None = None
    deck_load: LoadName | None = None
    temperature: Name | None = None

    @property
    def target(self) -> str:
        """Key in a :class:`faying.simulation.load.Load`."""
        return self.deck_load or self.temperature or f"{self.boundary}.{self.component}"
