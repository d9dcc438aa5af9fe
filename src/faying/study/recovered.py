"""What recovery from the history of another program leaves."""

from collections.abc import Mapping
from dataclasses import dataclass

from faying._typing import Indices, Matrix, Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class RecoveredRecord:
    """Pressures recovered from an imported history.

    Attributes
    ----------
    history
        Name of its file.
    route
        ``"modal"`` or ``"boundary loads"``.
    method, joint_modes
        Reduced model whose coordinates the history has, or that was simulated.
    derivatives
        Where velocities and accelerations come from.
    loads
        Boundary forces and load patterns that the history has; all others are zero.
    times : (n_time,)
    pressure, gap : (n_time, n_point)
    displacements
        Boundary name to (n_time, n).
    contact_force, bolt_force
        Interface or bolt name to (n_time,).
    max_pressure : (n_time,)
    iterations : (n_time,)
    """

    title: str
    units: str
    history: str
    route: str
    method: str
    joint_modes: int
    derivatives: str
    loads: tuple[str, ...]
    times: Vector
    pressure: Matrix
    gap: Matrix
    displacements: Mapping[str, Matrix]
    contact_force: Mapping[str, Matrix]
    bolt_force: Mapping[str, Matrix]
    max_pressure: Vector
    iterations: Indices
