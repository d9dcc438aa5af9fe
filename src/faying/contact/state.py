"""What one contact problem hands to the next: a warm start, and what has slipped."""

from dataclasses import dataclass

from faying._typing import Mask, Matrix, Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactState:
    """Where a sequence of contact problems stands.

    Solvers take a state and return the next one; they remember nothing themselves, so the same
    problem and state give the same digits whatever was solved before.

    Attributes
    ----------
    active : (n_point,)
        Points expected in contact.
    supported : (n_point,) or None
        Points on whose springs compiled steps have their pairs.
    slip : (2, n_point) [length]
        Tangential components of what has slipped so far.
    forces : (3, n_point) or None [force]
        Of the increment before, from which the next one starts there.
    moved : (n_relative,) or None [length]
        Relative displacements of the increment before.
    """

    active: Mask
    supported: Mask | None = None
    slip: Matrix | float = 0.0
    forces: Matrix | None = None
    moved: Vector | None = None
