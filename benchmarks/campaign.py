"""What a campaign of transients of the full model gains side by side, and by a second worker.

``python benchmarks/campaign.py`` prints the tables of docs/how-to/run_on_a_cluster.md (about two
minutes on two idle cores): the same runs through ``transient_campaign`` as it comes, in groups
side by side, and one by one, each with one and with two Dask workers, in turns. A worker has one
thread. What a worker does once is done before the clock starts, for it is the same for campaigns of
any length.

On a machine that does other work the wall times say little. Processor times say what is left then:
those of all runs on one worker over those of the busier of two. They contain how evenly the runs
were shared and how much the workers slow each other down, not the time that Dask takes.
"""

import os
import sys
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import median

import numpy as np

import faying as fy
from faying.execution import DaskExecutor, Executor, grouped, responses, transient_campaign
from faying.execution.checkpoint import Arrays

ELEMENT_SIZE = 2.0
STEPS = 15
RUNS = 64
REPEATS = 5
LOADS = {
    f"{run}": fy.Load({"tip.Fz": -500.0 + 15.0 * run, "tip.Mx": 20e3}, name=f"{run}")
    for run in range(RUNS)
}
SOME = dict(list(LOADS.items())[::4])
"""Loads of what takes longer; all times are per run."""

WAYS: Mapping[str, tuple[Mapping[str, fy.Load], int | None]] = {
    "one by one": (SOME, 1),
    "side by side": (LOADS, None),
}
"""Loads and how many at a time; None is what a campaign does unless told."""


@dataclass(frozen=True)
class Times:
    """Times of a campaign, per response.

    Attributes
    ----------
    wall : [s]
    processor : [s]
        Of all workers.
    busiest : [s]
        Of the worker with the largest processor time.
    """

    wall: float
    processor: float
    busiest: float


def joint() -> fy.Model:
    """Build the default cantilever, preloaded, with its sticking area."""
    damping = fy.Rayleigh(alpha=160.0, beta=5e-7)
    model = fy.lap_joint(element_size=ELEMENT_SIZE, damping=damping)
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


def noted(solution: fy.Solution) -> Arrays:
    """Take what a campaign keeps, and note who has it and the processor time until then."""
    clock = np.asarray(time.process_time())
    return {**responses(solution), "worker": np.asarray(os.getpid()), "clock": clock}


class Workers:
    """An executor, and what the clocks of its processes were."""

    def __init__(self, executor: Executor) -> None:
        self.executor = executor
        self.clocks: Counter[int] = Counter()

    def campaign(
        self, step: float, loads: Mapping[str, fy.Load], side_by_side: int | None
    ) -> Times:
        """Compute the runs of some loads."""
        start = time.perf_counter()
        found = transient_campaign(
            joint,
            loads,
            self.executor,
            step=step,
            duration=STEPS * step,
            take=noted,
            side_by_side=side_by_side,
        )
        wall = time.perf_counter() - start
        clocks: Counter[int] = Counter()
        for result in found.values():
            worker = int(result["worker"])
            clocks[worker] = max(clocks[worker], float(result["clock"]))
        used = [clock - self.clocks[worker] for worker, clock in clocks.items()]
        self.clocks |= clocks
        return Times(wall / len(loads), sum(used) / len(loads), max(used) / len(loads))


def main() -> None:
    """Print a line per repetition and way, then what is gained."""
    model = joint()
    step = 1e-2 / float(fy.preloaded_frequencies(model, 1)[0])
    write = sys.stdout.write
    write(f"{model.structure.n_dof} dofs, {model.contact.n_points} contact points, runs of ")
    write(f"{STEPS} steps: {len(SOME)} one by one, {RUNS} side by side, ")
    write(f"{len(grouped(LOADS)[0])} at a time; {os.cpu_count()} cores\n\n")
    write("| repetition | load average | | wall time per run: one worker [s] | two [s] | ratio | ")
    write("processor time per run: one [s] | two [s] | busier of two [s] | ratio |\n")
    write(f"|{'---|' * 10}\n")
    taken: dict[str, list[tuple[Times, Times]]] = {way: [] for way in WAYS}
    with DaskExecutor.local(1) as first, DaskExecutor.local(2) as second:
        one, two = Workers(first), Workers(second)
        for workers in (one, two):
            workers.campaign(step, SOME, len(SOME) // 2)  # prepares, both workers
        for repeat in range(REPEATS):
            for way, (loads, size) in WAYS.items():
                load = os.getloadavg()[0]
                alone, shared = (w.campaign(step, loads, size) for w in (one, two))
                taken[way].append((alone, shared))
                write(f"| {repeat + 1} | {load:.1f} | {way} ")
                write(f"| {alone.wall:.3f} | {shared.wall:.3f} | {alone.wall / shared.wall:.2f} ")
                write(f"| {alone.processor:.3f} | {shared.processor:.3f} | {shared.busiest:.3f} ")
                write(f"| {alone.busiest / shared.busiest:.2f} |\n")
                sys.stdout.flush()
    write("\nmedians (range):\n")
    for way, times in taken.items():
        wall = [alone.wall / shared.wall for alone, shared in times]
        processor = [alone.busiest / shared.busiest for alone, shared in times]
        write(f"{way}, two workers for one: {spread(wall)} by wall time, ")
        write(f"{spread(processor)} by processor time\n")
    pairs = list(zip(taken["one by one"], taken["side by side"], strict=True))
    for number, workers_text in enumerate(("one worker", "two workers")):
        wall = [single[number].wall / several[number].wall for single, several in pairs]
        used = [single[number].processor / several[number].processor for single, several in pairs]
        write(f"side by side for one by one, {workers_text}: {spread(wall)} by wall time, ")
        write(f"{spread(used)} by processor time\n")
    both = [single[0].wall / several[1].wall for single, several in pairs]
    write(f"two workers side by side for one of one by one: {spread(both)} by wall time\n")


def spread(values: list[float]) -> str:
    """Return median and range."""
    return f"{median(values):.2f} ({min(values):.2f} to {max(values):.2f})"


if __name__ == "__main__":
    main()
