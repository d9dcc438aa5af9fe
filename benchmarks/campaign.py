"""How much two workers on two cores gain: a campaign of transient runs of the full model.

``python benchmarks/campaign.py`` prints the table of docs/how-to/run_on_a_cluster.md (about five
minutes on two cores): wall times of the same runs with one and with two Dask workers, in turns, and
their ratio. A worker has one thread. What a worker does once is done before the clock starts, for
it is the same for campaigns of any length; the last column has it in.
"""

import os
import sys
import time
from functools import partial
from statistics import median

import faying as fy
from faying.execution import DaskExecutor, Executor, transient_campaign

ELEMENT_SIZE = 2.0
STEPS = 60
RUNS = 8
REPEATS = 3
LOADS = {
    f"{run}": fy.Load({"tip.Fz": -500.0 + 100.0 * run, "tip.Mx": 20e3}, name=f"{run}")
    for run in range(RUNS)
}


def joint(element_size: float) -> fy.Model:
    """Build the default cantilever, preloaded, with its sticking area."""
    model = fy.lap_joint(element_size=element_size, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


def seconds(executor: Executor, period: float, loads: dict[str, fy.Load]) -> float:
    """Return the wall time of a campaign."""
    start = time.perf_counter()
    transient_campaign(
        partial(joint, ELEMENT_SIZE),
        loads,
        executor,
        step=period / 100,
        duration=period / 100 * STEPS,
    )
    return time.perf_counter() - start


def main() -> None:
    """Print one line per repetition, then the medians."""
    model = joint(ELEMENT_SIZE)
    period = 1.0 / float(fy.preloaded_frequencies(model, 1)[0])
    write = sys.stdout.write
    write(f"{model.structure.n_dof} dofs, {model.contact.n_points} contact points, ")
    write(f"{RUNS} runs of {STEPS} steps; {os.cpu_count()} cores\n\n")
    write("| workers | repetition | wall time [s] | per run [s] | load average before |\n")
    write("|---|---|---|---|---|\n")
    times: dict[int, list[float]] = {1: [], 2: []}
    whole: dict[int, float] = {}
    with DaskExecutor.local(1) as one, DaskExecutor.local(2) as two:
        executors = {1: one, 2: two}
        for workers, executor in executors.items():
            whole[workers] = seconds(executor, period, LOADS)  # prepares
        for repeat in range(REPEATS):
            for workers, executor in executors.items():
                load = os.getloadavg()[0]
                taken = seconds(executor, period, LOADS)
                times[workers].append(taken)
                row = (workers, repeat + 1, f"{taken:.1f}", f"{taken / RUNS:.2f}", f"{load:.1f}")
                write(f"| {' | '.join(map(str, row))} |\n")
                sys.stdout.flush()
    ratio = median(times[1]) / median(times[2])
    paired = median(a / b for a, b in zip(times[1], times[2], strict=True))
    write(f"\nmedian {median(times[1]):.1f} s and {median(times[2]):.1f} s: ratio {ratio:.2f}")
    write(f" (median of ratios {paired:.2f}); with preparation {whole[1] / whole[2]:.2f}\n")


if __name__ == "__main__":
    main()
