"""What a run keeps of friction: tractions, slip and states of the points, energy it took."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.assessment.slip import point_states, slip_history
from faying.simulation.solution import Solution


@dataclass(frozen=True, eq=False, kw_only=True)
class SlipRecord:
    """What friction does in the increments of a path or the instants of a motion.

    Attributes
    ----------
    traction : (n_increment, n_point, 3) [force/length²]
        Tangential traction on the plus side.
    slip : (n_increment, n_point, 3) [length]
        Slip of the plus side since the joint was unstressed.
    status : (n_increment, n_point) [1]
        0 open, 1 stick, 2 slip.
    open_share : (n_increment,) [1]
        Open area over that of all interfaces with friction.
    stick_share : (n_increment,) [1]
        Sticking area over the same.
    slip_share : (n_increment,) [1]
        Slipping area over the same.
    macroslip : (n_increment,) [1]
        Whether all that is closed slips, on some interface.
    dissipation : (n_increment,) [force·length]
        Energy that friction took.
    """

    traction: Matrix
    slip: Matrix
    status: Indices
    open_share: Vector
    stick_share: Vector
    slip_share: Vector
    macroslip: Mask
    dissipation: Vector

    @property
    def most_slip(self) -> int:
        """The increment in which most of the area slips; the last of several."""
        return len(self.slip_share) - 1 - int(self.slip_share[::-1].argmax())

    @property
    def max_traction(self) -> float:
        """Largest traction over points and increments."""
        return float(np.linalg.norm(self.traction, axis=-1).max(initial=0.0))


def slip_fields(solution: Solution, start: Solution | None) -> dict[str, Any]:
    """Return the members of a record of a path or a motion.

    Parameters
    ----------
    start
        State a path went on from; a motion has it as its first instant, where nothing slips yet.
    """
    slip = slip_history(solution, start)
    if start is None:
        slip = np.concatenate([slip[1:2], slip[1:]])
    states = point_states(
        solution.system.contact, solution.contact_forces, solution.shear_forces, slip
    )
    return {
        "traction": solution.traction,
        "slip": solution.slip,
        "status": states.status,
        "open_share": states.open_share,
        "stick_share": states.stick_share,
        "slip_share": states.slip_share,
        "macroslip": states.macroslip,
        "dissipation": np.broadcast_to(solution.dissipation, len(solution.gap)),
    }
