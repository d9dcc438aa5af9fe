"""Stored results of friction: states of contact points, paths, cycles and fretting."""

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
    """Friction in the increments of a path or the instants of a transient.

    Attributes
    ----------
    traction : (n_increment, n_point, 3) [force/length²]
        Tangential traction on the plus side.
    slip : (n_increment, n_point, 3) [length]
        Slip of the plus side since the joint was unstressed.
    status : (n_increment, n_point) [1]
        0 open, 1 stick, 2 slip.
    open_share : (n_increment,) [1]
        Open area over the area of all interfaces with friction.
    stick_share : (n_increment,) [1]
        Sticking area over the area of all interfaces with friction.
    slip_share : (n_increment,) [1]
        Slipping area over the area of all interfaces with friction.
    macroslip : (n_increment,) [1]
        Whether all closed points of an interface slip.
    dissipation : (n_increment,) [force·length]
        Energy dissipated by friction.
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
        """Return the number of increments or instants; zero without friction."""
        return len(self.dissipation)

    @property
    def most_slip(self) -> int:
        """The increment with the largest slipping area; the last of several."""
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
"""The record without friction over time."""


def slip_over_time(solution: Solution) -> SlipRecord:
    """Return the slip record of a transient."""
    rubs = solution.times is not None and solution.shear_slip.size
    return SlipRecord(**slip_fields(solution, None)) if rubs else NO_SLIP


def slip_fields(solution: Solution, start: Solution | None) -> dict[str, Any]:
    """Return the members of a slip record of a path or a transient.

    A path continues from ``start``. A transient has its start, without slip, as first instant.
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
        Loads that the columns of ``factors`` multiply.
    factors : (n_increment, n_load) [1]
        Load factors.
    pressure : (n_increment, n_point) [force/length²]
        Contact pressure, compression positive.
    load_work : (n_increment,) [force·length]
        Load at factor one times its displacement.
    iterations : (n_increment,) [1]
        Newton steps.
    bolt_moments : (n_increment, 2, 2) [force·length]
        Bending moments by bolt with beams: end, and component across the axis.
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
    """Cycles of a load between plus and minus an amplitude.

    Attributes
    ----------
    amplitude : [1]
        Load factor at the reversals.
    energies : (n_cycle,) [force·length]
        Energy dissipated by friction in each cycle.
    stationary
        Whether the last cycle repeats: its energy is that of the cycle before, or its loop closes.
    loop_area : [force·length]
        Area of the last loop of load factor over displacement of the load.
    slip_range : (n_point,) [length]
        Largest distance between two slip positions of a point in the last cycle.
    fretting : (n_point,) [force/length]
        Slip range times largest traction (Ruiz, Boddington & Chen 1984).
    slip_work : (n_point,) [force/length]
        Energy per area dissipated in the last cycle; of halved increments, by their
        ends.
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
    """Return the record of a path.

    The path continues from ``start``; ``load`` is at factor one. Names and factors
    (n_increment, n_load) are columns of load factors.
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
    """Return the record of cycles."""
    path, joint = cycles.cycle, cycles.cycle.system
    traction = np.linalg.norm(path.traction, axis=-1)
    # Motion of open points causes no wear.
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
    """Return the largest distance (n_point,) between two slips (n_increment, 2, n_point)."""
    largest: Vector = np.zeros(slip.shape[-1])
    for position in slip:
        apart = np.hypot(*np.moveaxis(slip - position, 1, 0))
        largest = np.maximum(largest, apart.max(axis=0))
    return largest
