"""How much two workers on two cores gain: a campaign of transient runs of the full model.

``python benchmarks/campaign.py`` prints the table of docs/how-to/run_on_a_cluster.md (about two
minutes on two idle cores): wall times of the same runs with one and with two Dask workers, in
turns, and their ratio. A worker has one thread. What a worker does once is done before the clock
starts, for it is the same for campaigns of any length.

On a machine that does other work the wall times say little. Processor times say what is left then:
those of all runs on one worker over those of the busier of two. They contain how evenly the runs
were shared and how much the workers slow each other down, not the time that Dask takes; the last
column says for what part of the wall time the two workers had a run to work at.
"""

import os
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from statistics import median

import faying as fy
from faying.execution import DaskExecutor, Executor, forgetting, run_campaign
from faying.simulation.transient import TransientSolver, transient_solver

ELEMENT_SIZE = 2.0
STEPS = 60
RUNS = 8
REPEATS = 5
LOADS = {
    f"{run}": fy.Load({"tip.Fz": -500.0 + 100.0 * run, "tip.Mx": 20e3}, name=f"{run}")
    for run in range(RUNS)
}


@dataclass(frozen=True)
class Times:
    """Times of a campaign.

    Attributes
    ----------
    wall : [s]
    busiest
        Largest processor time of a worker [s].
    occupied
        Part of the wall time that its workers had a run to work at.
    """

    wall: float
    busiest: float
    occupied: float


def joint() -> fy.Model:
    """Build the default cantilever, preloaded, with its sticking area."""
    damping = fy.Rayleigh(alpha=160.0, beta=5e-7)
    model = fy.lap_joint(element_size=ELEMENT_SIZE, damping=damping)
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


def prepare(step: float) -> Callable[[fy.Load], Mapping[str, float]]:
    """Build and factorize on a worker."""
    model = joint()
    solver, rest = transient_solver(model, step=step), fy.solve_static(model)
    return partial(run, solver, rest)


def run(solver: TransientSolver, rest: fy.Solution, load: fy.Load) -> dict[str, float]:
    """Integrate one response."""
    start, began = time.process_time(), time.perf_counter()
    response = forgetting(solver).solve(load, duration=STEPS * solver.step, initial=rest)
    return {
        "peak": float(response.max_pressure.max()),
        "worker": os.getpid(),
        "seconds": time.process_time() - start,
        "elapsed": time.perf_counter() - began,
    }


def campaign(executor: Executor, step: float) -> Times:
    """Compute all runs."""
    start = time.perf_counter()
    found = run_campaign(partial(prepare, step), LOADS, executor)
    wall = time.perf_counter() - start
    seconds: Counter[int] = Counter()
    for result in found.values():
        seconds[int(result["worker"])] += float(result["seconds"])
    elapsed = sum(float(result["elapsed"]) for result in found.values())
    return Times(wall, max(seconds.values()), elapsed / (wall * executor.n_workers))


def main() -> None:
    """Print one line per repetition, then the medians."""
    model = joint()
    period = 1.0 / float(fy.preloaded_frequencies(model, 1)[0])
    write = sys.stdout.write
    write(f"{model.structure.n_dof} dofs, {model.contact.n_points} contact points, ")
    write(f"{RUNS} runs of {STEPS} steps; {os.cpu_count()} cores\n\n")
    write("| repetition | load average | one worker [s] | two workers [s] | ratio | ")
    write("processor time: one [s] | busier of two [s] | ratio | occupied |\n")
    write(f"|{'---|' * 9}\n")
    walls, busiest = [], []
    with DaskExecutor.local(1) as one, DaskExecutor.local(2) as two:
        for executor in (one, two):
            campaign(executor, period / 100)  # prepares
        for repeat in range(REPEATS):
            load = os.getloadavg()[0]
            alone, shared = campaign(one, period / 100), campaign(two, period / 100)
            walls.append(alone.wall / shared.wall)
            busiest.append(alone.busiest / shared.busiest)
            write(f"| {repeat + 1} | {load:.1f} | {alone.wall:.1f} | {shared.wall:.1f} ")
            write(f"| {walls[-1]:.2f} | {alone.busiest:.1f} | {shared.busiest:.1f} ")
            write(f"| {busiest[-1]:.2f} | {shared.occupied:.0%} |\n")
            sys.stdout.flush()
    write(f"\nmedian ratio {median(walls):.2f} by wall time, ")
    write(f"{median(busiest):.2f} by processor time\n")


if __name__ == "__main__":
    main()
