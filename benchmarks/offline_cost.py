"""What the offline part of methods A and B costs beyond factorization and back-substitutions.

``python benchmarks/offline_cost.py [ELEMENT_SIZE]`` (1.35 mm: about 50 000 dofs) prints, for each
method, the wall time of everything from the assembled matrices to the basis, the part of it that
sparse factorizations and back-substitutions take, and the ratio of the two. Issue 2 allows 3.
"""

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import faying as fy
from faying.linalg import factorization
from faying.model.structure import Structure

BOX = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)})


class Meter:
    """Wall time and right-hand sides of sparse factorizations."""

    def __init__(self) -> None:
        self.seconds, self.columns, self.factorizations = 0.0, 0, 0

    def timed(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``factorize`` of sparse matrices and the solve of what it returns."""

        def factorize(matrix: Any) -> Any:
            start = time.perf_counter()
            factor = function(matrix)
            self.seconds += time.perf_counter() - start
            self.factorizations += 1
            return Solved(factor, self)

        return factorize


class Solved:
    """A factorization whose back-substitutions are timed."""

    def __init__(self, factor: Any, meter: Meter) -> None:
        self._factor, self._meter = factor, meter
        self.backend = factor.backend

    def solve(self, right_hand_side: Any) -> Any:
        """Solve, timed."""
        start = time.perf_counter()
        solution = self._factor.solve(right_hand_side)
        self._meter.seconds += time.perf_counter() - start
        self._meter.columns += 1 if right_hand_side.ndim == 1 else right_hand_side.shape[1]
        return solution


def fresh(model: fy.Model) -> fy.Model:
    """Return the model with nothing factorized."""
    from dataclasses import fields, replace

    old = model.structure
    values = {field.name: getattr(old, field.name) for field in fields(old) if field.init}
    return replace(model, structure=Structure(**values))


def offline_a(model: fy.Model) -> None:
    """Build method A from the matrices."""
    fy.jim_a(model, normal_modes=20, joint_modes=40)


def offline_b(model: fy.Model) -> None:
    """Build method B from the matrices: 75 static loads, 8 step responses of one period."""
    step = 1.0 / fy.preloaded_frequencies(model, 1)[0] / 100
    statics = fy.static_snapshots(model, BOX.static_loads(model))
    steps = fy.step_snapshots(model, BOX.step_loads(), step=step, duration=100 * step)
    fy.jim_b(model, np.hstack([statics, steps]), normal_modes=20, joint_modes=40)


def main() -> None:
    """Print one line per method."""
    size = float(sys.argv[1]) if len(sys.argv) > 1 else 1.35
    model = fy.preload(fy.lap_joint(element_size=size), {"bolt": 10e3}, sticking=fy.Sticking())
    points = sum(face.n_points for face in model.interfaces.values())
    write = sys.stdout.write
    write(f"{model.structure.n_dof} dofs, {points} contact points\n")
    write(
        "| method | offline [s] | sparse solver [s] | factorizations | right-hand sides | ratio |\n"
    )
    write("|---|---|---|---|---|---|\n")
    original = factorization._factorize_sparse
    for name, offline in (("jim-a", offline_a), ("jim-b", offline_b)):
        meter = Meter()
        factorization._factorize_sparse = meter.timed(original)
        start = time.perf_counter()
        offline(fresh(model))
        seconds = time.perf_counter() - start
        factorization._factorize_sparse = original
        write(
            f"| {name} | {seconds:.1f} | {meter.seconds:.1f} | {meter.factorizations} "
            f"| {meter.columns} | {seconds / meter.seconds:.2f} |\n"
        )


if __name__ == "__main__":
    main()
