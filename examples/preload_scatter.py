"""Monte Carlo of bolt preloads: how tightening scatter reaches the contact pressure.

Run it with ``python examples/preload_scatter.py [FIGURE.png]``. Ten thousand joints are tightened
to preloads scattered by ±30 % (a tightening factor F_max/F_min of 1.3/0.7 ≈ 1.9) and loaded with
LC2, on the reduced model with residual compliance, whose static pressures are exact. The first
order of the scatter follows from one derivative, printed beside it.
"""

import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

import faying as fy
from faying._typing import Vector
from faying.assessment.sensitivity import sensitivity
from faying.simulation.static import solve_static_inputs

PRELOAD = 10e3
LOAD = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
CASES = 10_000
SCATTER = 0.10
"""Standard deviation of the preload over its nominal value; ±30 % are three of them."""

GRID = 41
"""Preloads at which the bolt is really tightened; between them N₀(F) is linear without error worth
mentioning, for without load and initial gap it is proportional."""


@dataclass(frozen=True, kw_only=True)
class Scatter:
    """What ten thousand joints do.

    Attributes
    ----------
    preloads, peaks, contact_forces, bolt_forces : (n_case,)
        Final preload, largest pressure, total contact force and bolt force under load.
    linear_peak : (n_case,)
        Largest pressure by the derivative at the nominal preload.
    seconds
        Times of the offline part, the tightening and the cases.
    """

    preloads: Vector
    peaks: Vector
    contact_forces: Vector
    bolt_forces: Vector
    linear_peak: Vector
    seconds: Mapping[str, float]


def joint(element_size: float = 2.5) -> fy.Model:
    """Build the default cantilever at its nominal preload."""
    model = fy.lap_joint(element_size=element_size)
    return fy.preload(model, {"bolt": PRELOAD}, sticking=fy.Sticking())


def initial_forces(system: fy.ReducedModel, preloads: Vector) -> Vector:
    """Return the initial bolt forces N₀ that end at the given final preloads."""
    grid = np.linspace(preloads.min(), preloads.max(), GRID)
    locked = [fy.tighten(system, {"bolt": f}).initial_forces["bolt"] for f in grid]
    return np.interp(preloads, grid, locked)


def scatter(model: fy.Model, cases: int = CASES, seed: int = 0) -> Scatter:
    """Solve the load case for many preloads on the compliance reduced model."""
    start = time.perf_counter()
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=20), compliance=True)
    nominal = fy.solve_static(rom, LOAD)
    slope = sensitivity(rom, nominal).final_preloads
    offline = time.perf_counter()

    draws = np.random.default_rng(seed).normal(1.0, SCATTER, cases)
    preloads = PRELOAD * np.clip(draws, 1 - 3 * SCATTER, 1 + 3 * SCATTER)
    inputs = np.tile(nominal.inputs, (cases, 1))
    inputs[:, -1] = initial_forces(rom, preloads)
    tightened = time.perf_counter()

    solution = solve_static_inputs(rom, inputs, "preload scatter")
    done = time.perf_counter()
    point = int(nominal.pressure.argmax())
    return Scatter(
        preloads=preloads,
        peaks=solution.max_pressure,
        contact_forces=solution.contact_force("joint"),
        bolt_forces=solution.bolt_force("bolt"),
        linear_peak=nominal.pressure[point] + slope.pressure[point, 0] * (preloads - PRELOAD),
        seconds={
            "offline": offline - start,
            "tightening": tightened - offline,
            "cases": done - tightened,
        },
    )


def summary(result: Scatter) -> str:
    """Say in a few lines what the scatter does."""
    quantities = {
        "preload [N]": result.preloads,
        "bolt force under load [N]": result.bolt_forces,
        "contact force [N]": result.contact_forces,
        "peak pressure [MPa]": result.peaks,
        "peak pressure, first order": result.linear_peak,
    }
    lines = [f"{'':28}{'mean':>10}{'std':>10}{'std/mean':>10}{'0.1 %':>10}{'99.9 %':>10}"]
    for name, values in quantities.items():
        mean, std = values.mean(), values.std()
        low, high = np.percentile(values, [0.1, 99.9])
        lines.append(f"{name:28}{mean:10.4g}{std:10.3g}{std / mean:10.2%}{low:10.4g}{high:10.4g}")
    times = ", ".join(f"{name} {value:.1f} s" for name, value in result.seconds.items())
    lines.append(f"{len(result.preloads)} preloads: {times}")
    return "\n".join(lines)


def main() -> None:
    """Print the summary and draw the figure if a file is named."""
    result = scatter(joint())
    sys.stdout.write(summary(result) + "\n")
    if len(sys.argv) > 1:
        draw(result, sys.argv[1])


def draw(result: Scatter, path: str) -> None:
    """Draw peak pressure over preload, with its first order, and its histogram."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    order = np.argsort(result.preloads)
    left.plot(result.preloads, result.peaks, ".", markersize=1.5, label="exact")
    left.plot(result.preloads[order], result.linear_peak[order], label="first order")
    left.set(xlabel="final preload [N]", ylabel="peak pressure [MPa]")
    left.legend()
    right.hist(result.peaks, bins=60)
    right.set(xlabel="peak pressure [MPa]", ylabel="joints")
    figure.savefig(path, dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    main()
