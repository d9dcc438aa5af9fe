"""Reached pressure error of divided steps against the tolerance that was asked for.

``python benchmarks/divided_steps.py [JOINT…]`` prints the table of docs/theory/time_integration.md:
method ``compliance`` with 20 normal modes, instants a hundredth of the longest period apart over a
quarter of it (the flange: a tenth), against the same model in 128 steps an instant (the flange:
64). Needs gmsh for the pipe flange.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from method_ranges import STEPS, joints, rising

import faying as fy
from faying.reduction.projection import projected

SCHEMES = {"implicit Euler": fy.ImplicitEuler(), "energy-decaying": fy.EnergyDecaying()}
LOADS = {"jump": 0.0, "rise over T/10": 0.1, "rise over T/4": 0.25}
TOLERANCES = (0.1, 0.03)


def main(chosen: set[str]) -> None:
    """Print a row for each joint, load, scheme and tolerance."""
    write = sys.stdout.write
    write("| joint | load, scheme | one step | tolerance | reached | said | steps | a step |\n")
    write(f"{'|---' * 8}|\n")
    with tempfile.TemporaryDirectory() as folder:
        for joint in joints(Path(folder)):
            if chosen and joint.name not in chosen:
                continue
            model, large = joint.model, joint.name == "pipe flange"
            rom = projected(model, fy.craig_bampton(model, normal_modes=20), compliance=True)
            period = 1.0 / fy.preloaded_frequencies(model, 1)[0]
            parts = 64 if large else 128
            for label, part in LOADS.items():
                load = rising(joint.bending, period, part) if part else fy.Load(joint.bending)
                for scheme, integrator in SCHEMES.items():
                    options = {
                        "duration": period / (10 if large else 4),
                        "integrator": integrator,
                    }
                    step = period / STEPS
                    exact = fy.solve_transient(rom, load, step=step / parts, **options)
                    truth = exact.pressure[::parts]
                    one = off(fy.solve_transient(rom, load, step=step, **options), truth)
                    for tolerance in TOLERANCES[1:2] if large else TOLERANCES:
                        begin = time.process_time()
                        found = fy.solve_transient(
                            rom, load, step=step, tolerance=tolerance, **options
                        )
                        spent = time.process_time() - begin
                        taken = int(found.substeps.sum())
                        write(
                            f"| {joint.name} | {label}, {scheme} | {one:.2%} | {tolerance:.0%} | "
                            f"{off(found, truth):.2%} | {found.step_error.sum():.2%} | {taken} | "
                            f"{1e3 * spent / taken:.2g} ms |\n"
                        )
                        sys.stdout.flush()


def off(found: fy.Solution, truth: np.ndarray) -> float:
    """Return the largest pressure error over points and instants, over the largest pressure."""
    return float(np.abs(found.pressure - truth).max() / truth.max())


if __name__ == "__main__":
    main(set(sys.argv[1:]))
