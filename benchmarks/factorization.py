"""Sparse backends side by side, and what the offline part costs beyond them.

    python benchmarks/factorization.py                 the backends, 8 k to 150 k dofs (10 minutes)
    python benchmarks/factorization.py --offline       jim-a and jim-b at 50 k dofs (5 minutes)
    python benchmarks/factorization.py --joints        what compliances take (5 minutes)
    python benchmarks/factorization.py --joints 576k   of one joint, here of 576 k dofs (8 minutes)

Prints the tables behind docs/performance.md: medians of interleaved repetitions and their
ratios in one run; with --joints processor times, each joint in a process of its own, whose peak of
memory is told.
"""

import argparse
import os
import resource
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any

import numpy as np

import faying as fy
from faying.joint.structure import Structure
from faying.linalg import factorization, superlu
from faying.linalg.backends import available_backends
from faying.linalg.factorization import factorize
from faying.linalg.partial import port_compliance
from faying.linalg.superlu import nested_dissection, pymetis

SIZES = (2.5, 1.3, 0.88)
"""Element sizes of the default cantilever [mm]: 8 k, 49 k and 143 k degrees of freedom."""

SLOWEST = 60_000
"""Degrees of freedom above which SuperLU in minimum-degree order is not waited for."""

JOINTS = {
    "50k": {"element_size": 1.3},
    "150k": {"element_size": 0.88},
    "50k-nodal": {"element_size": 2.5, "width": 100.0, "overlap": 90.0, "quadrature": "nodal"},
    "150k-nodal": {
        "element_size": 2.5,
        "length": 145.0,
        "width": 140.0,
        "thickness": 17.5,
        "overlap": 130.0,
        "quadrature": "nodal",
    },
    "576k": {"element_size": 0.56, "overlap": 48.0, "order": 1},
}
"""Nodal points are as many as pairs; with Gauss points there are four a facet."""

BOX = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)})

write = sys.stdout.write


def main() -> None:
    """Print the tables asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=float, nargs="+", default=SIZES, help="element sizes [mm]")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--offline", action="store_true")
    parser.add_argument("--joints", nargs="*", choices=list(JOINTS))
    parser.add_argument("--friction", type=float, help="one row of --joints, in this process")
    options = parser.parse_args()
    if options.friction is not None:
        joint(options.joints[0], options.friction, options.repeat)
        return
    threads = os.environ.get("OMP_NUM_THREADS", "unset")
    write(f"cores {os.cpu_count()}, OMP_NUM_THREADS {threads}, load average {load()}\n\n")
    if options.offline:
        offline(repeat=options.repeat)
    elif options.joints is not None:
        joints(options.joints or [name for name in JOINTS if name != "576k"], options.repeat)
    else:
        for size in options.sizes:
            compare(fy.lap_joint(element_size=size), options.repeat)
    write(f"\nload average at the end {load()}\n")


def load() -> str:
    """Return the load averages of the last 1, 5 and 15 minutes."""
    return ", ".join(f"{value:.1f}" for value in os.getloadavg())


# Backends side by side


@dataclass(frozen=True)
class Way:
    """One way to factorize and to form the compliance."""

    backend: str
    order: Callable[[Any], Any] = nested_dissection


def ways(n_dof: int) -> dict[str, Way]:
    """Return what is compared, the default first."""
    found = {}
    if "pardiso" in available_backends():
        found["pardiso"] = Way("pardiso")
    if pymetis is not None:
        found["superlu+metis"] = Way("superlu")
    if n_dof < SLOWEST:
        found["superlu"] = Way("superlu", order=lambda _: None)
    return found


def compare(model: fy.Model, repeat: int) -> None:
    """Print one row per way."""
    structure = model.structure
    inner = structure.interior
    K = structure.K[inner][:, inner].tocsr()
    ports = structure.relative_operator[:, inner].tocsr()
    right = np.random.default_rng(0).standard_normal((K.shape[0], 200))
    compared = ways(K.shape[0])
    times = {name: defaultdict(list) for name in compared}
    memory = {}
    for _ in range(repeat if K.shape[0] < SLOWEST else min(repeat, 3)):
        for name, way in compared.items():
            superlu.nested_dissection = way.order
            clock = Clock(times[name])
            factor = factorize(K, backend=way.backend)
            clock.lap("factorization")
            factor.solve(right)
            clock.lap("200")
            for _ in range(5):
                factor.solve(right[:, 0])
            clock.lap("five")
            port_compliance(ports, factor)
            clock.lap("compliance")
            memory[name] = factor.memory
    superlu.nested_dissection = nested_dissection
    report(K.shape[0], model.contact.n_points, ports.shape[0], times, memory)


class Clock:
    """Collects the times between its laps."""

    def __init__(self, times: dict[str, list[float]]) -> None:
        self.times, self.last = times, time.perf_counter()

    def lap(self, name: str) -> None:
        """Add the time since the last lap."""
        now = time.perf_counter()
        self.times[name].append(now - self.last)
        self.last = now


def report(
    n_dof: int, n_point: int, n_port: int, times: dict[str, Any], memory: dict[str, int]
) -> None:
    """Print a table of medians; ratios are those of the sums within a repetition."""
    write(f"\n{n_dof} dofs, {n_point} contact points, {n_port} ports\n\n")
    write("| backend | factorization s | 200 back-solves s | one back-solve ms | compliance s ")
    write("| factors MB | factorization + 200, ratio | factorization + compliance, ratio |\n")
    write("|---|---|---|---|---|---|---|---|\n")
    plain = "pardiso" if "pardiso" in times else next(iter(times))
    for name, laps in times.items():
        median = {lap: np.median(values) for lap, values in laps.items()}
        solving, forming = (
            np.median(total(laps, second) / total(times[plain], second))
            for second in ("200", "compliance")
        )
        write(
            f"| {name} | {median['factorization']:.2f} | {median['200']:.2f} "
            f"| {median['five'] / 5 * 1e3:.1f} | {median['compliance']:.2f} "
            f"| {memory[name] / 1e6:.0f} | {solving:.2f} | {forming:.2f} |\n"
        )
    sys.stdout.flush()


def total(laps: dict[str, list[float]], second: str) -> Any:
    """Return factorization plus a second stage, repetition by repetition."""
    return np.array(laps["factorization"]) + np.array(laps[second])


# What ports cost


def joints(names: list[str], repeat: int) -> None:
    """Print what the compliance of joints takes, one component of pairs and three."""
    write("| dofs | points | ports | factorization s | compliance s | over it ")
    write("| S MB | peak GB |\n" + "|---" * 8 + "|\n")
    for name in names:
        for friction in ("0", "0.2")[: 1 if name == "576k" else 2]:
            sys.stdout.flush()
            arguments = ["--joints", name, "--friction", friction, "--repeat", str(repeat)]
            subprocess.run([sys.executable, __file__, *arguments], check=True)


def joint(name: str, friction: float, repeat: int) -> None:
    """Print one row: medians of processor time."""
    model = fy.lap_joint(penalty=1e6, **JOINTS[name])
    if friction:
        model = model.with_friction(friction)
    structure, points = model.structure, model.contact.n_points
    inner = structure.interior
    ports = structure.relative_operator[:, inner].tocsr()
    K = structure.K[inner][:, inner].tocsr()
    del model, structure
    rows = []
    for _ in range(repeat if K.shape[0] < SLOWEST else 1):
        start = time.process_time()
        factor = factorize(K)
        plain = time.process_time() - start
        compliance = port_compliance(ports, factor)
        formed = time.process_time() - start - plain
        rows.append((plain, formed, formed / plain))
        size = compliance.nbytes / 1e6
        del factor, compliance
    plain, formed, ratio = np.median(rows, axis=0)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    write(f"| {K.shape[0]} | {points} | {ports.shape[0]} | {plain:.2f} | {formed:.2f} ")
    write(f"| {ratio:.1f} × | {size:.0f} | {peak:.1f} |\n")


# The offline part


class Metered:
    """A factorization whose use is timed."""

    def __init__(self, factor: Any, spent: dict[str, float]) -> None:
        self._factor, self._spent = factor, spent
        self.backend, self.memory = factor.backend, factor.memory

    def solve(self, right_hand_side: Any) -> Any:
        """Solve, timed."""
        columns = 1 if np.ndim(right_hand_side) == 1 else np.shape(right_hand_side)[1]
        self._spent["columns"] += columns
        return timed(self._spent, "back-solves", self._factor.solve, right_hand_side)

    def gram(self, columns: Any) -> Any:
        """Form a compliance, timed."""
        return timed(self._spent, "compliance", self._factor.gram, columns)


def timed(spent: dict[str, float], name: str, function: Callable[..., Any], *given: Any) -> Any:
    """Call a function and book its time."""
    start = time.perf_counter()
    result = function(*given)
    spent[name] += time.perf_counter() - start
    return result


def metered(function: Any, spent: dict[str, float], A: Any) -> Metered:
    """Factorize, timed."""
    spent["factorizations"] += 1
    return Metered(timed(spent, "factorization", function, A), spent)


def fresh(model: fy.Model) -> fy.Model:
    """Return the model with nothing factorized."""
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


def offline(repeat: int) -> None:
    """Print how the offline part compares with the factorizations and back-solves in it."""
    model = fy.lap_joint(element_size=1.3, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    model = fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())
    write(f"{model.K.shape[0]} dofs, {model.contact.n_points} contact points\n\n")
    write("| method | all s | factorizations | s | columns | s | compliance s | rest s | ratio |\n")
    write("|---|---|---|---|---|---|---|---|---|\n")
    backends = dict(factorization.BACKENDS)
    for name, build in {"jim-a": offline_a, "jim-b": offline_b}.items():
        rows = []
        for _ in range(repeat):
            spent: dict[str, float] = defaultdict(float)
            for backend, function in backends.items():
                timed = partial(metered, function.factorize, spent)
                factorization.BACKENDS[backend] = function._replace(factorize=timed)
            start = time.perf_counter()
            build(fresh(model))
            spent["all"] = time.perf_counter() - start
            needed = sum(spent[part] for part in ("factorization", "back-solves", "compliance"))
            rows.append(spent | {"rest": spent["all"] - needed, "ratio": spent["all"] / needed})
        m = {key: np.median([row.get(key, 0) for row in rows]) for key in rows[0]}
        m = defaultdict(float, m)
        write(
            f"| {name} | {m['all']:.1f} | {m['factorizations']:.0f} | {m['factorization']:.1f} "
            f"| {m['columns']:.0f} | {m['back-solves']:.1f} | {m['compliance']:.1f} "
            f"| {m['rest']:.1f} | {m['ratio']:.2f} |\n"
        )
        sys.stdout.flush()


if __name__ == "__main__":
    main()
