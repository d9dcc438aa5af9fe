"""An interface of 20 000 contact points: time and memory, offline, one static case, 100 steps.

Prints the table behind docs/performance.md. With --budget BYTES the dense matrices may
take no more, so a small number compares sparse factors with dense matrices.

    python benchmarks/large_interface.py --save dense.npz
    python benchmarks/large_interface.py --budget 5e8 --save sparse.npz --reference dense.npz
"""

import argparse
import os
import resource
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

import faying as fy

BOLTS = tuple((x, y) for y in (-13.0, 13.0) for x in (-34.0, 0.0, 34.0))
LOAD = fy.Load({"tip.Fz": -20.0, "tip.Mx": 2000.0}, name="LC2")


@contextmanager
def stage(name: str) -> Iterator[None]:
    """Print the wall time of a stage and the peak memory of the process so far."""
    start = time.perf_counter()
    yield
    seconds = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    sys.stdout.write(f"| {name} | {seconds:.1f} | {peak:.2f} |\n")
    sys.stdout.flush()


def main() -> None:
    """Run all stages and print one line each."""
    options = parse()
    sys.stdout.write(f"load average at start {os.getloadavg()[0]:.1f}\n\n")
    sys.stdout.write("| stage | wall time s | peak memory GiB |\n|---|---|---|\n")
    with stage("mesh and assembly"):
        model = fy.lap_joint(
            element_size=options.element_size,
            length=140.0,
            width=52.0,
            overlap=105.0,
            thickness=2.0,
            bolt_positions=BOLTS,
            damping=fy.Rayleigh(alpha=160.0, beta=5e-7),
        )
        if options.budget:
            model = model.with_dense_budget(int(options.budget))
        _ = model.K
    with stage("factorization"):
        _ = model.structure.boundary_factor
    with stage("compliance between pairs"):
        _ = model.structure.held_compliance
    with stage("port compliance"):
        _ = model.static_contact.increments
    with stage("tightening"):
        model = fy.preload(model, dict.fromkeys(model.bolts, 2000.0))
    with stage("20 normal modes"):
        basis = fy.craig_bampton(model, normal_modes=20)
    with stage("reduced model"):
        rom = fy.reduce(model, basis, compliance=True)
        _ = rom.static_contact.increments
    with stage("one static case, full model"):
        static = fy.solve_static(model, LOAD)
    with stage("one static case, reduced model"):
        reduced = fy.solve_static(rom, LOAD)
    with stage("period of the preloaded joint"):
        period = 1.0 / float(fy.preloaded_frequencies(model, 1)[0])
    with stage("100 steps, reduced model"):
        steps = fy.solve_transient(rom, LOAD, step=period / 100, duration=period)
    summarize(model, rom, static, reduced, steps)
    if options.save:
        np.savez(options.save, static=static.pressure, steps=steps.pressure)
    if options.reference:
        compare(options.reference, static, steps)


def parse() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--element-size", type=float, default=1.0)
    parser.add_argument("--budget", type=float, help="dense budget [bytes]")
    parser.add_argument("--save", type=Path, help="file for the pressures")
    parser.add_argument("--reference", type=Path, help="saved pressures to compare with")
    return parser.parse_args()


def summarize(
    model: fy.Model,
    rom: fy.ReducedModel,
    static: fy.Solution,
    reduced: fy.Solution,
    steps: fy.Solution,
) -> None:
    """Print sizes and how well the solutions agree."""
    pairs = type(model.static_contact.increments.pairs).__name__
    error = fy.compare(reduced, static).max_relative_error
    sys.stdout.write(
        f"\n{model.contact.n_points} contact points, {model.structure.relative_operator.shape[0]} "
        f"pairs, {model.structure.n_dof} degrees of freedom; solved by {pairs} (reduced: "
        f"{type(rom.static_contact.increments.pairs).__name__})\n"
        f"static: {int(static.iterations)} iterations, max pressure {static.max_pressure:.4g}, "
        f"in contact {1 - static.open_fraction():.1%}; reduced against full {error:.1e}\n"
        f"transient: {int(steps.iterations.sum())} iterations, {len(steps.iterations) - 1} steps\n"
    )


def compare(path: Path, static: fy.Solution, steps: fy.Solution) -> None:
    """Print the largest relative deviation from saved pressures."""
    with np.load(path) as saved:
        for name, solution in (("static", static), ("steps", steps)):
            error = np.abs(fy.relative_error(solution.pressure, saved[name])).max()
            sys.stdout.write(f"{name}: max relative deviation from the reference {error:.1e}\n")


if __name__ == "__main__":
    main()
