"""What a run keeps of load cases that are paths: every increment, cycles and their fretting."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.assessment.slip import slip_history
from faying.joint.system import Joint
from faying.simulation.cycles import Cycles, load_work, loop_area
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.study.results.slip_record import SlipRecord, slip_fields


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
        Whether the last two cycles agree.
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

    Parameters
    ----------
    start
        State the path went on from.
    load
        At factor one.
    names, factors
        Columns of load factors and their values (n_increment, n_load).
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
    )


def cycle_record(cycles: Cycles, load: Load) -> CycleRecord:
    """Take from cycles what a run keeps of them."""
    path, joint = cycles.cycle, cycles.cycle.system
    traction = np.linalg.norm(path.traction, axis=-1)
    # An open point moves freely, which wears nothing.
    moves = np.diff(slip_history(path, cycles.start), axis=0) * (path.contact_forces > 0)[:, None]
    reach = _range(np.cumsum(np.concatenate([np.zeros_like(moves[:1]), moves]), axis=0))
    return CycleRecord(
        amplitude=cycles.amplitude,
        energies=cycles.energies,
        stationary=cycles.stationary,
        loop_area=loop_area(cycles, load),
        slip_range=reach,
        fretting=reach * traction.max(axis=0, initial=0.0),
        slip_work=_slip_work(path, cycles.start, joint),
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


def _slip_work(path: Solution, start: Solution, joint: Joint) -> Vector:
    """Return the energy per area (n_point,) that friction took: traction times change of slip."""
    if path.shear_forces is None:
        return np.zeros(joint.contact.n_points)
    change = np.diff(slip_history(path, start), axis=0)
    work: Vector = -(path.shear_forces * change).sum(axis=(0, 1)) / joint.contact.weights
    return work
