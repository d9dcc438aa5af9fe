"""What recovery from the history of another program leaves."""

from collections.abc import Mapping
from dataclasses import dataclass

from faying._typing import Indices, Matrix, Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class RecoveredRecord:
    """Pressures recovered from an imported history.

    Attributes
    ----------
    title
        Title of the study.
    units
        Consistent unit set, length-mass-time.
    history
        Name of the file the pressures were recovered from.
    route
        What they were recovered from: modal coordinates or boundary loads.
    method
        Reduced model whose coordinates these are, or that was simulated.
    joint_modes : [1]
        Its joint modes.
    derivatives
        Where velocities and accelerations come from.
    loads : (n_load,)
        Boundary forces and load patterns that the history has; all others are zero.
    times : (n_time,) [time]
        Instants.
    pressure : (n_time, n_point) [force/length²]
        Contact pressure, compression positive.
    gap : (n_time, n_point) [length]
        Gap, open positive.
    displacements : (n_time, n) [length]
        By boundary: translations [length] and rotations [rad].
    contact_force : (n_time,) [force]
        Total normal force by interface.
    bolt_force : (n_time,) [force]
        Axial force by bolt, tension positive.
    max_pressure : (n_time,) [force/length²]
        Largest over all contact points.
    iterations : (n_time,) [1]
        Linear systems of the contact problem.
    traction : (n_time, n_point, 3) [force/length²]
        With friction, on the plus side.
    slip : (n_time, n_point, 3) [length]
        With friction, of the plus side over the minus side.
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
    traction: Matrix | None = None
    slip: Matrix | None = None
