"""Every stage by size, in time and memory, beside the naive way, the seed's way and the bounds.

    python benchmarks/stages.py                       all rows (an hour)
    python benchmarks/stages.py --quick               10 k and 50 k dofs (two minutes)
    python benchmarks/stages.py --keep rows.json      the same, and goes on where it was stopped

Prints the tables behind docs/performance.md and draws its figures. Every row is a process
of its own (``stage_row.py``) on one thread, the largest on two; repeated rows give medians.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).parent
IMAGES = HERE.parent / "docs" / "images"

Result = dict[str, Any]

write = sys.stdout.write


@dataclass(frozen=True, kw_only=True)
class Case:
    """A lap joint of about so many degrees of freedom and contact points."""

    dofs: int
    points: int
    element_size: float
    overlap: float
    order: int
    extras: tuple[str, ...] = ()
    repeat: int = 1
    threads: int = 1

    def options(self, quick: bool) -> str:
        """Return what ``stage_row.py`` is given."""
        names = ("element_size", "overlap", "order", "extras")
        return json.dumps({name: getattr(self, name) for name in names} | {"quick": quick})

    @property
    def name(self) -> str:
        """Return what the row is called."""
        return f"{self.dofs // 1000} k, {self.points}"


CASES = (
    Case(
        dofs=10_000,
        points=400,
        element_size=2.5,
        overlap=40,
        order=2,
        extras=("naive", "seed", "scikit-fem"),
        repeat=3,
    ),
    Case(dofs=10_000, points=1500, element_size=2.3, overlap=50, order=3, repeat=3),
    Case(dofs=50_000, points=400, element_size=1.3, overlap=40, order=1, repeat=3),
    Case(
        dofs=50_000,
        points=1500,
        element_size=1.3,
        overlap=36,
        order=2,
        extras=("naive", "seed"),
        repeat=3,
    ),
    Case(dofs=50_000, points=3000, element_size=1.36, overlap=68, order=2, repeat=3),
    Case(dofs=150_000, points=400, element_size=0.82, overlap=18, order=1),
    Case(dofs=150_000, points=1500, element_size=0.83, overlap=18, order=2),
    Case(
        dofs=150_000,
        points=3000,
        element_size=0.86,
        overlap=32,
        order=2,
        extras=("scikit-fem",),
    ),
    Case(dofs=500_000, points=3000, element_size=0.56, overlap=48, order=1, threads=2),
)
"""10 k dofs have some 200 facets, too few for 3000 points; 500 k have more than 400 and 1500 under
the washers alone."""

QUICK = tuple(case for case in CASES if case.name in ("10 k, 400", "50 k, 1500"))

STAGES = (
    "assembly",
    "factorization",
    "constraint modes",
    "compliance",
    "preload",
    "normal modes (20)",
    "jim-a (40)",
    "jim-b, 75 static",
    "jim-b, effective matrix",
    "jim-b, 800 steps (scaled)",
    "jim-b, modes (40)",
    "reduce",
)
ONLINE = (
    "static case",
    "reduced step",
    "reduced step, long run",
    "reduced step, in Python",
    "full step",
)
REDUCED = 200
"""Steps of a reduced run."""

OFFLINE = ("assembly", "factorization", "constraint modes", "compliance", "preload",
           "normal modes (20)", "reduce")  # fmt: skip
"""What a user of the method ``compliance`` waits for."""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--keep", type=Path, help="file of rows already measured, and to come")
    parser.add_argument("--repeat", type=int, default=99, help="runs of a row at most")
    parser.add_argument("--only", nargs="+", help="names of rows, like '50 k, 1500'")
    options = parser.parse_args()
    most = 1 if options.quick else options.repeat
    kept = json.loads(options.keep.read_text()) if options.keep and options.keep.exists() else {}
    write(f"{os.cpu_count()} cores, load average at the start {os.getloadavg()[0]:.1f}\n")
    if "bandwidth" not in kept:
        kept["bandwidth"] = process("bandwidth", 1)
    rows = {}
    for case in chosen(options.quick, options.only):
        runs = kept.setdefault(case.name, [])
        while len(runs) < min(most, case.repeat):
            runs.append(measure(case, options.quick))
            if options.keep:
                options.keep.write_text(json.dumps(kept, indent=1))
        rows[case.name] = median_of(runs)
    if "commands" not in kept:
        kept["commands"] = commands()
        if options.keep:
            options.keep.write_text(json.dumps(kept, indent=1))
    tables(rows, kept["bandwidth"])
    growth(rows)
    targets(rows, kept["bandwidth"], kept["commands"])
    if not options.quick and len(rows) > 2:
        draw(rows)
    write(f"\nload average at the end {os.getloadavg()[0]:.1f}\n")


def chosen(quick: bool, only: list[str] | None) -> tuple[Case, ...]:
    """Return the rows asked for."""
    cases = QUICK if quick else CASES
    return tuple(case for case in cases if only is None or case.name in only)


# Measuring


def measure(case: Case, quick: bool) -> Result:
    """Run one row in a process of its own."""
    sys.stderr.write(f"{case.name}\n")
    return process(case.options(quick), case.threads)


def process(argument: str, threads: int) -> Result:
    """Run ``stage_row.py``; a process inherits its parent's peak memory: keep it small."""
    names = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")
    done = subprocess.run(
        [sys.executable, str(HERE / "stage_row.py"), argument],
        env=os.environ | dict.fromkeys(names, str(threads)),
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    if done.returncode:
        sys.exit(f"{argument} ended with status {done.returncode}")
    result: Result = json.loads(done.stdout)
    return result


def median_of(runs: list[Result]) -> Result:
    """Return one row with the medians of times and of peaks."""
    middle = dict(runs[-1])
    for group in ("s", "wall", "peak_gib"):
        middle[group] = {
            key: statistics.median(run[group][key] for run in runs) for key in runs[-1][group]
        }
    middle["load_average"] = [run["load_average"][0] for run in runs]
    middle["runs"] = len(runs)
    return middle


def commands() -> dict[str, float]:
    """Median wall and processor times of two commands [s]."""
    program = Path(sys.executable).with_name("faying")
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "study.toml"
        demo = (HERE.parent / "src/faying/study/demo.toml").read_text()
        study.write_text(demo.replace("element_size = 2.5", "element_size = 1.3"))
        for name, call in {"help": ["--help"], "check": ["check", str(study)]}.items():
            runs = [taken([str(program), *call], folder) for _ in range(5)]
            wall, processor = zip(*runs, strict=True)
            found[name] = statistics.median(wall)
            found[f"{name}, processor"] = statistics.median(processor)
    return found


def taken(command: list[str], folder: str) -> tuple[float, float]:
    """Wall and processor time of a command that must succeed."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, check=True)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


# Tables


def tables(rows: dict[str, Result], speed: dict[str, float]) -> None:
    """Print sizes, times, memory and what is beside them."""
    names = list(rows)
    write(
        f"\nmemory bandwidth: copy {speed['copy'] / 1e9:.1f}, dot {speed['dot'] / 1e9:.1f} GB/s\n"
    )
    write("\n| | " + " | ".join(names) + " |\n|---|" + "---|" * len(names) + "\n")
    for label, key in (("dofs", "dofs"), ("contact points", "points"), ("pairs", "pairs")):
        line(label, [str(row[key]) for row in rows.values()])
    line("threads", [row["threads"] for row in rows.values()])
    loads = (" ".join(f"{load:.1f}" for load in row["load_average"]) for row in rows.values())
    line("load average before each run", loads)
    for stage in STAGES:
        line(f"{stage} [s]", [shown(row["s"].get(stage)) for row in rows.values()])
    line("offline of `compliance` [s]", [shown(offline(row)) for row in rows.values()])
    line("… wall time [s]", [shown(offline(row, "wall")) for row in rows.values()])
    line("factors [GiB]", [shown(row["factor_gib"]) for row in rows.values()])
    for stage in ("assembly", "factorization", "compliance", "jim-b, effective matrix"):
        line(f"peak after {stage} [GiB]", [shown(row["peak_gib"][stage]) for row in rows.values()])
    line("peak of all [GiB]", [shown(max(row["peak_gib"].values())) for row in rows.values()])
    for stage in ONLINE:
        line(f"{stage} [ms]", [shown(1e3 * row["s"][stage]) for row in rows.values()])
    line("bytes a reduced step must read [MB]", [shown(touched(r) / 1e6) for r in rows.values()])
    bound = [1e3 * touched(row) / max(speed.values()) for row in rows.values()]
    line("its time at the bandwidth [ms]", [shown(value) for value in bound])
    bound = [1e3 * 4 * row["factor_gib"] * 2**30 / max(speed.values()) for row in rows.values()]
    line("full step: factors read 4 times [ms]", [shown(value) for value in bound])
    beside(rows)


def line(label: str, cells: Any) -> None:
    """Print one line of a table."""
    write(f"| {label} | " + " | ".join(cells) + " |\n")


def shown(value: float | None) -> str:
    """Three digits."""
    if value is None:
        return ""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def offline(row: Result, clock: str = "s") -> float:
    """Seconds from nothing to a reduced model with its compliance."""
    return sum(row[clock][stage] for stage in OFFLINE)


def touched(row: Result) -> int:
    """Bytes one reduced step reads at least once."""
    return int(sum(row["step_bytes"].values()))


def beside(rows: dict[str, Result]) -> None:
    """Print the naive way and the seed's way."""
    write("\n| | dofs, points | theirs [s] | faying [s] | ratio |\n|---|---|---|---|---|\n")
    for name, row in rows.items():
        s = row["s"]
        pairs = [
            ("SuperLU as SciPy sets it (COLAMD)", "naive: SuperLU, COLAMD", "factorization"),
            (
                "SuperLU, MMD, symmetric mode",
                "naive: SuperLU, MMD_AT_PLUS_A",
                "factorization",
            ),
            ("a back-solve per point, COLAMD", "naive: back-solves, COLAMD (scaled)", "compliance"),
            (
                "a back-solve per point, MMD",
                "naive: back-solves, MMD_AT_PLUS_A (scaled)",
                "compliance",
            ),
            ("static case, full Newton, faying's factorization", "Newton case", "static case"),
            (
                "static case, full Newton, COLAMD (scaled)",
                "naive: Newton case, COLAMD (scaled)",
                "static case",
            ),
            ("step of the full model, Newton", "Newton step", "full step"),
            ("jim-b training, Newton (scaled)", "seed: training (scaled)", "jim-b training"),
            ("K and M by scikit-fem", "scikit-fem, K and M", "assembly of K and M"),
        ]
        for label, theirs, ours in pairs:
            if theirs in s:
                ratio = s[theirs] / s[ours]
                cells = [name, shown(s[theirs]), shown(s[ours]), shown(ratio)]
                line(label, cells)


def growth(rows: dict[str, Result]) -> None:
    """Print the exponents of power laws fitted over dofs and over points."""
    by_points: dict[int, list[Result]] = {}
    by_dofs: dict[int, list[Result]] = {}
    for case in CASES:
        if case.name in rows:
            by_points.setdefault(case.points, []).append(rows[case.name])
            by_dofs.setdefault(case.dofs, []).append(rows[case.name])
    groups = [(f"dofs, {n} points", "dofs", found) for n, found in by_points.items()]
    groups += [(f"points, {n // 1000} k dofs", "points", found) for n, found in by_dofs.items()]
    groups = [group for group in groups if len(group[2]) > 1]
    if not groups:
        return
    write("\n| exponent over | ")
    write(" | ".join(group[0] for group in groups) + " |\n|---|" + "---|" * len(groups) + "\n")
    for stage in (*STAGES, *ONLINE):
        line(stage, [f"{exponent(found, key, stage):.2f}" for _, key, found in groups])
    line("peak memory", [f"{exponent(found, key, None):.2f}" for _, key, found in groups])


def exponent(rows: list[Result], key: str, stage: str | None) -> float:
    """Slope of log time, or of log peak memory, over log size."""
    sizes = [row[key] for row in rows]
    values = [max(row["peak_gib"].values()) if stage is None else row["s"][stage] for row in rows]
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])


# Targets


def targets(rows: dict[str, Result], speed: dict[str, float], calls: dict[str, float]) -> None:
    """Print the targets these rows can judge: ratios within one row."""
    write("\n| target | at most (or at least) | measured | |\n|---|---|---|---|\n")
    for name, limit in (("50 k, 1500", 2.0), ("150 k, 3000", 3.0)):
        if name in rows:
            s = rows[name]["s"]
            ratio = s["compliance"] / s["factorization"]
            target(f"compliance over factorization, {name}", limit, ratio)
    for name, row in rows.items():
        if "scikit-fem, K and M" in row["s"]:
            ratio = row["s"]["assembly of K and M"] / row["s"]["scikit-fem, K and M"]
            equal = f"matrices equal to {row['assembly_difference']:.0e}"
            target(f"assembly over scikit-fem's, {name} ({equal})", 0.5, ratio)
    if "500 k, 3000" in rows:
        row = rows["500 k, 3000"]
        target("500 k, 3000: offline, wall time [min]", 10, offline(row, "wall") / 60)
        target("500 k, 3000: peak memory [GiB]", 20, max(row["peak_gib"].values()))
    for name, row in rows.items():
        s = row["s"]
        if name == "10 k, 400":
            reading = touched(row) / max(speed.values())
            place = "default cantilever, over the time to read its data"
            target(f"reduced step, {place}", 2, s["reduced step, long run"] / reading)
            target(f"the same from the jump on, {REDUCED} steps", 2, s["reduced step"] / reading)
            seconds = REDUCED * s["reduced step"]
            target(f"{REDUCED} steps of LC2, default cantilever [s]", 0.1, seconds)
        if name.startswith("50 k"):
            target(f"full over reduced step, {name}", -100, s["full step"] / s["reduced step"])
        if name.startswith("50 k") and "seed: training (scaled)" in s:
            ratio = s["seed: training (scaled)"] / s["jim-b training"]
            target(f"jim-b training, full Newton over faying, {name}", -50, ratio)
    for name, call, limit in (
        ("`faying --help`", "help", 0.3),
        ("`faying check`, 50 k dofs", "check", 5),
    ):
        target(f"{name}, wall [s]", limit, calls[call])
        target(f"{name}, processor [s]", limit, calls[f"{call}, processor"])


def target(name: str, limit: float, measured: float) -> None:
    """Print one target; a negative limit is the least that is wanted."""
    met = measured >= -limit if limit < 0 else measured <= limit
    bound = f"≥ {-limit:g}" if limit < 0 else f"≤ {limit:g}"
    line(name, [bound, shown(measured), "met" if met else "**missed**"])


# Figures


def draw(rows: dict[str, Result]) -> None:
    """Draw times and memory over dofs, and times over points."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullFormatter

    figure = Figure(figsize=(12, 4.6), layout="constrained")
    axes = figure.subplots(1, 3)
    shown_stages = {
        "factorization": "factorization (bound)",
        "assembly": "assembly",
        "compliance": "compliance",
        "normal modes (20)": "20 normal modes",
        "jim-a (40)": "jim-a",
        "full step": "step, full model",
        "static case": "static case",
        "reduced step": "step, reduced",
    }
    measured = [case for case in CASES if case.name in rows]
    points = statistics.mode(case.points for case in measured)
    dofs = statistics.mode(case.dofs for case in measured)
    over_dofs = [rows[case.name] for case in measured if case.points == points]
    over_points = [rows[case.name] for case in measured if case.dofs == dofs]
    plots = (
        (axes[0], over_dofs, "dofs", f"{points} points"),
        (axes[1], over_points, "points", f"{dofs // 1000} k dofs"),
    )
    for ax, group, key, title in plots:
        for stage, label in shown_stages.items():
            sizes, times = [r[key] for r in group], [r["s"][stage] for r in group]
            ax.loglog(sizes, times, "o-", markersize=4, label=label)
        ax.set(title=title, xlabel=key, ylabel="processor time [s]")
    for points in sorted({case.points for case in measured}):
        group = [rows[case.name] for case in measured if case.points == points]
        peaks = [max(row["peak_gib"].values()) for row in group]
        axes[2].loglog([r["dofs"] for r in group], peaks, "o-", label=f"peak, {points} points")
        factors = [row["factor_gib"] for row in group]
        axes[2].loglog([r["dofs"] for r in group], factors, "x--", label=f"factors, {points}")
    axes[2].set(title="memory", xlabel="dofs", ylabel="GiB")
    for ax in axes:
        ax.grid(which="both", alpha=0.2)
        ax.xaxis.set_minor_formatter(NullFormatter())  # labels of less than a decade collide
    lines, labels = axes[1].get_legend_handles_labels()
    figure.legend(lines, labels, fontsize=8, loc="outside lower center", ncols=8)
    axes[2].legend(fontsize=7)
    figure.savefig(IMAGES / "performance.png", dpi=130)


if __name__ == "__main__":
    main()
