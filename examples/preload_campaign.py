"""Bolt preload scatter of transient peaks, shared by the cores of this machine.

Run it with ``python examples/preload_campaign.py [WORKERS]``. Each task tightens the joint to
another preload, which is more than another load: the step response starts from its own preloaded
state. A worker assembles, condenses and reduces the model once, for preloads are forces. (Statics
need no campaign: ``preload_scatter.py`` solves ten thousand in seconds.)
"""

import sys
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

import faying as fy
from faying._typing import Matrix
from faying.execution import Executor, ProcessExecutor, SerialExecutor, run_campaign

NOMINAL, SCATTER = 10e3, 0.10
LOAD = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
STEP, STEPS = 5e-6, 100


def prepare(element_size: float) -> Callable[[float], Mapping[str, Matrix]]:
    """Build the reduced joint on a worker; return the function from preload to results."""
    model = fy.preload(fy.lap_joint(element_size=element_size), {"bolt": NOMINAL})
    basis = fy.craig_bampton(model, normal_modes=20)
    return partial(peak, fy.reduce(model, basis, compliance=True))


def peak(rom: fy.ReducedModel, preload: float) -> dict[str, Matrix]:
    """Tighten to a preload, apply the load as a step, and return what is asked for."""
    locked = rom.with_bolt_forces(fy.tighten(rom, {"bolt": preload}).initial_forces)
    response = fy.solve_transient(locked, LOAD, step=STEP, duration=STEP * STEPS)
    return {
        "peak": response.max_pressure.max(),
        "bolt_force": response.bolt_force("bolt").max(),
        "open": response.open_fraction().max(),
    }


def preloads(count: int, seed: int = 0) -> dict[str, float]:
    """Draw preloads within three standard deviations, by name."""
    draws = np.random.default_rng(seed).normal(1.0, SCATTER, count)
    clipped = NOMINAL * np.clip(draws, 1 - 3 * SCATTER, 1 + 3 * SCATTER)
    return {f"joint {number}": float(value) for number, value in enumerate(clipped)}


def scatter(
    count: int, executor: Executor | None = None, element_size: float = 2.5
) -> dict[str, Matrix]:
    """Return preload, peak, bolt force and open fraction of each joint, each (count,)."""
    tasks = preloads(count)
    found = run_campaign(partial(prepare, element_size), tasks, executor)
    names = ("peak", "bolt_force", "open")
    results = {name: np.array([found[task][name] for task in tasks]) for name in names}
    return {"preload": np.array(list(tasks.values())), **results}


def main() -> None:
    """Print mean, scatter and extremes."""
    workers = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    executor = ProcessExecutor(workers) if workers > 1 else SerialExecutor()
    for name, values in scatter(100, executor).items():
        low, high = values.min(), values.max()
        sys.stdout.write(
            f"{name:12} mean {values.mean():10.4g}  std {values.std():10.3g}"
            f"  from {low:.4g} to {high:.4g}\n"
        )


if __name__ == "__main__":
    main()
