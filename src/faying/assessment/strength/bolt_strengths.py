"""What the strength of bolts is judged by, whatever says it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from faying.assessment.strength.thread import Thread
from faying.assessment.strength.tightening import PreloadRange
from faying.contact.contact import Contact
from faying.simulation.load import StaticLoad


@dataclass(frozen=True, kw_only=True)
class BoltStrengths:
    """What the strength of bolts is judged by.

    Attributes
    ----------
    threads
        Of the bolts whose size and grade are known.
    ranges
        Of the preloads.
    tightened : [force]
        Bolt to the force it was tightened to.
    temperatures
        Name to what every static load case may have beside its loads.
    smallest_friction
        Coefficient of the interfaces with friction, where it scatters.
    """

    threads: Mapping[str, Thread] = field(default_factory=dict)
    ranges: Mapping[str, PreloadRange] = field(default_factory=dict)
    tightened: Mapping[str, float] = field(default_factory=dict)
    temperatures: Mapping[str, StaticLoad] = field(default_factory=dict)
    smallest_friction: float | None = None

    def rubbing(self, contact: Contact) -> dict[str, float]:
        """Return the coefficients of the interfaces that have friction, of a range the smallest."""
        lowest = self.smallest_friction
        return {
            name: contact.laws[name].friction if lowest is None else lowest
            for name in contact.rubbing_interfaces
        }
