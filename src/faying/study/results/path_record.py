"""What a run keeps of friction: states of the points, paths by increments, cycles and fretting."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.assessment.case_metrics import bent_bolts
from faying.assessment.slip import point_states, slip_history
from faying.simulation.cycles import Cycles, load_work, loop_area
from faying.simulation.load import Load
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

    def __len__(self) -> int:
        """Return the number of increments or instants; none where nothing slips along."""
        return len(self.dissipation)

    @property
    def most_slip(self) -> int:
        """The increment in which most of the area slips; the last of several."""
        return len(self.slip_share) - 1 - int(self.slip_share[::-1].argmax())

    @property
    def max_traction(self) -> float:
        """Largest traction over points and increments."""
        return float(np.linalg.norm(self.traction, axis=-1).max(initial=0.0))


NO_SLIP = SlipRecord(
    traction=np.empty((0, 0, 3)),
    slip=np.empty((0, 0, 3)),
    status=np.empty((0, 0), dtype=np.int64),
    open_share=np.empty(0),
    stick_share=np.empty(0),
    slip_share=np.empty(0),
    macroslip=np.empty(0, dtype=bool),
    dissipation=np.empty(0),
)
"""What stands where nothing slips along surfaces over time."""


def slip_over_time(solution: Solution) -> SlipRecord:
    """Return what friction does at the instants of a motion."""
    rubs = solution.times is not None and solution.shear_slip.size
    return SlipRecord(**slip_fields(solution, None)) if rubs else NO_SLIP


def slip_fields(solution: Solution, start: Solution | None) -> dict[str, Any]:
    """Return the members of a record of a path or a motion.

    A path went on from the start; a motion has it as its first instant, where nothing slips yet.
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


@dataclass(frozen=True, eq=False, kw_only=True)
class PathRecord(SlipRecord):
    """A path of loads, increment by increment.

    Attributes
    ----------
    loads : (n_load,)
        What the columns of ``factors`` multiply.
    factors : (n_increment, n_load) [1]
        Load factors.
    pressure : (n_increment, n_point) [force/length²]
        Contact pressure, compression positive.
    load_work : (n_increment,) [force·length]
        Load at factor one times the displacement it does work on.
    iterations : (n_increment,) [1]
        Newton steps.
    bolt_moments : (n_increment, 2, 2) [force·length]
        Bending moments by bolt with beams: end, and component across its axis.
    displacements : (n_increment, n) [length]
        By boundary: translations [length] and rotations [rad].
    bolt_forces : (n_increment,) [force]
        Axial force by bolt, tension positive.
    """

    loads: tuple[str, ...]
    factors: Matrix
    pressure: Matrix
    load_work: Vector
    iterations: Indices
    bolt_moments: Mapping[str, Matrix]
    displacements: Mapping[str, Matrix] = field(default_factory=dict)
    bolt_forces: Mapping[str, Vector] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class CycleRecord:
    """Cycles of a load between ± an amplitude.

    Attributes
    ----------
    amplitude : [1]
        Load factor at the reversals.
    energies : (n_cycle,) [force·length]
        Energy that friction took in each cycle.
    stationary
        Whether the last cycle repeats: friction took as much as before, or it ends where it began.
    loop_area : [force·length]
        Area of the last loop of load factor over the displacement the load does work on.
    slip_range : (n_point,) [length]
        Largest distance between two places of a point in the last cycle, moved while closed.
    fretting : (n_point,) [force/length]
        Slip range times largest traction (Ruiz, Boddington & Chen 1984).
    slip_work : (n_point,) [force/length]
        Energy per area that friction took in the last cycle, increments that had to be halved by
        their ends.
    start_work : [force·length]
        ``load_work`` at the beginning of the last cycle.
    increments
        The last cycle: down from the amplitude and up again.
    """

    amplitude: float
    energies: Vector
    stationary: bool
    loop_area: float
    slip_range: Vector
    fretting: Vector
    slip_work: Vector
    start_work: float
    increments: PathRecord


def path_record(
    path: Solution,
    start: Solution,
    load: Load,
    names: Sequence[str],
    factors: Matrix,
) -> PathRecord:
    """Take from a path what a run keeps.

    It went on from the start, with the load at factor one. Names and factors (n_increment, n_load)
    are columns of load factors.
    """
    joint = path.system
    return PathRecord(
        **slip_fields(path, start),
        loads=tuple(names),
        factors=np.asarray(factors, dtype=float),
        pressure=path.pressure,
        load_work=load_work(path, load),
        iterations=path.iterations,
        displacements={name: path.displacement(name) for name in joint.boundaries},
        bolt_forces={name: np.asarray(path.bolt_force(name)) for name in joint.bolts},
        bolt_moments={name: path.bolt_bending(name) for name in bent_bolts(joint.bolts)},
    )


def cycle_record(cycles: Cycles, load: Load) -> CycleRecord:
    """Take from cycles what a run keeps of them."""
    path, joint = cycles.cycle, cycles.cycle.system
    traction = np.linalg.norm(path.traction, axis=-1)
    # An open point moves freely, which wears nothing.
    change = np.diff(slip_history(path, cycles.start), axis=0)
    moves = change * (path.contact_forces > 0)[:, None]
    reach = _range(np.cumsum(np.concatenate([np.zeros_like(moves[:1]), moves]), axis=0))
    return CycleRecord(
        amplitude=cycles.amplitude,
        energies=cycles.energies,
        stationary=cycles.stationary,
        loop_area=loop_area(cycles, load),
        slip_range=reach,
        fretting=reach * traction.max(axis=0, initial=0.0),
        slip_work=-(path.shear_forces * change).sum(axis=(0, 1)) / joint.contact.weights,
        start_work=float(load_work(cycles.start, load)[-1]),
        increments=path_record(path, cycles.start, load, ("factor",), cycles.factors[:, None]),
    )


def _range(slip: Matrix) -> Vector:
    """Return the largest distance between two places (n_increment, 2, n_point) of each point."""
    largest: Vector = np.zeros(slip.shape[-1])
    for position in slip:
        apart = np.hypot(*np.moveaxis(slip - position, 1, 0))
        largest = np.maximum(largest, apart.max(axis=0))
    return largest
