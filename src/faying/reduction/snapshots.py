"""Contact-force snapshots for method B (§15.3.4): static and step load combinations."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from faying._typing import Matrix
from faying.exceptions import refuse_model
from faying.joint.system import System
from faying.simulation.instants import runs_at_once
from faying.simulation.integrators import Integrator
from faying.simulation.load import Load
from faying.simulation.static import solve_static_cases
from faying.simulation.stepping import transient_solver


@dataclass(frozen=True, kw_only=True)
class LoadBox:
    """The range of loads that a reduced model is trained for.

    Attributes
    ----------
    ranges
        ``"boundary.component"`` to its smallest and largest value, [force] or [force·length].
    levels
        Values per component in the static combinations, from smallest to largest.
    preload_factors
        Multiples of the locked bolt forces in the static combinations.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> box = fy.LoadBox(ranges={"tip.Fz": (-500.0, 500.0), "tip.Mx": (0.0, 20e3)}, levels=3)
    >>> len(box.static_loads(joint)), len(box.step_loads())         # 3 × 3 × 3 preloads; 3² − 1
    (27, 8)
    """

    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    levels: int = 5
    preload_factors: tuple[float, ...] = (0.5, 1.0, 1.5)

    def __post_init__(self) -> None:
        if not self.ranges or self.levels < 1 or not self.preload_factors:
            refuse_model(
                "a training box needs at least one load range, one level and one preload factor; "
                "name them under [reduction.training]"
            )

    def static_loads(self, system: System) -> list[Load]:
        """Return all combinations of load levels and preload factors (15.3.4.1)."""
        grids = [np.linspace(*bounds, self.levels) for bounds in self.ranges.values()]
        return [
            Load(
                dict(zip(self.ranges, values, strict=True)),
                name="training",
                bolt_forces={
                    name: factor * bolt.initial_force for name, bolt in system.bolts.items()
                },
            )
            for factor in self.preload_factors
            for values in product(*grids)
        ]

    def step_loads(self) -> list[Load]:
        """Return all combinations of smallest, middle and largest values except the middle itself.

        Two ranges that are symmetric about zero give the eight directions of Eq. (15.28).
        """
        grids = [(low, (low + high) / 2, high) for low, high in self.ranges.values()]
        middle = tuple(grid[1] for grid in grids)
        return [
            Load(dict(zip(self.ranges, values, strict=True)), name="training")
            for values in product(*grids)
            if values != middle
        ]

    def random_loads(self, system: System, count: int, seed: int) -> list[Load]:
        """Return loads drawn uniformly from the box, preload factors included."""
        rng = np.random.default_rng(seed)
        lows, highs = np.array(list(self.ranges.values())).T
        factors = rng.uniform(min(self.preload_factors), max(self.preload_factors), count)
        values = rng.uniform(lows, highs, (count, len(lows)))
        return [
            Load(
                dict(zip(self.ranges, row.tolist(), strict=True)),
                name=f"random-{case}",
                bolt_forces={
                    name: factor * bolt.initial_force for name, bolt in system.bolts.items()
                },
            )
            for case, (row, factor) in enumerate(zip(values, factors.tolist(), strict=True))
        ]


def static_snapshots(system: System, loads: Sequence[Load]) -> Matrix:
    """Return contact forces λ (n_point, n_load) [force] of static loads, Eqs. (15.25), (15.26).

    Parameters
    ----------
    system
        A preloaded model, full or reduced.
    loads
        Loads, each for one column of the result.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> fy.static_snapshots(joint, [fy.Load({"tip.Fz": -500.0}), fy.Load()]).shape
    (112, 2)
    """
    return solve_static_cases(system, loads).contact_forces.T


def step_snapshots(
    system: System,
    loads: Sequence[Load],
    *,
    step: float,
    duration: float,
    integrator: Integrator | None = None,
    progress: Callable[[int], object] | None = None,
) -> Matrix:
    """Return contact forces λ (n_point, n_load · n_time) [force], Eqs. (15.27) to (15.29).

    Each load acts suddenly on the joint at rest.

    Parameters
    ----------
    system
        The full model, or a reduced one to lower the cost as §15.3.4.2 recommends.
    step, duration : [time]
        At least one period of the dominant vibration.

    Notes
    -----
    As many responses side by side as fit into memory; a step then reads the factorization once
    for all of them.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    >>> fy.step_snapshots(rom, [fy.Load({"tip.Fz": -50.0})], step=1e-5, duration=1e-4).shape
    (112, 11)
    """
    solver = transient_solver(system, step=step, integrator=integrator)
    together = runs_at_once(system, round(duration / step) + 1)
    solutions = [
        run.contact_forces
        for first in range(0, len(loads), together)
        for run in solver.solve_cases(
            loads[first : first + together], duration=duration, progress=progress
        )
    ]
    return np.concatenate(solutions).T
