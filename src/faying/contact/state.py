"""The state passed from one contact problem to the next: a warm start, and the slip so far."""

from dataclasses import dataclass

from faying._typing import Mask, Matrix, Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactState:
    """State between two problems of a sequence of contact problems.

    Solvers take a state and return the next one; they keep nothing themselves, so the same problem
    and state give the same digits whatever was solved before.

    Attributes
    ----------
    active : (n_point,)
        Points expected in contact.
    supported : (n_point,) or None
        Points whose springs support the pairs in compiled steps.
    slip : (2, n_point) [length]
        Tangential components of the slip so far.
    forces : (3, n_point) or None [force]
        Contact forces of the increment before, from which the next one starts.
    moved : (n_relative,) or None [length]
        Relative displacements of the increment before.
    """

    active: Mask
    supported: Mask | None = None
    slip: Matrix | float = 0.0
    forces: Matrix | None = None
    moved: Vector | None = None
