"""Contact laws: one frozen value each, the same for full and reduced models."""

from faying.contact.laws.coulomb import Coulomb
from faying.contact.laws.hard import Hard
from faying.contact.laws.law import Law
from faying.contact.laws.penalty import Penalty

__all__ = ["Coulomb", "Hard", "Law", "Penalty", "normal_law"]


def normal_law(penalty: float) -> Hard | Penalty:
    """Return the frictionless law of a contact stiffness [force/length³]; ``inf`` is hard.

    Raises
    ------
    ModelError
        If it is not positive.
    """
    return Hard() if penalty == float("inf") else Penalty(float(penalty))
