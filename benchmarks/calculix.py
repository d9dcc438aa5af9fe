"""faying and CalculiX on the same cantilever in one run, processor time against processor time.

    python benchmarks/calculix.py                   static, without and with friction (two minutes)
    python benchmarks/calculix.py --dynamic 62      and 62 of the 620 increments of LC2's step

CalculiX solves the deck faying writes: preload, then LC2, one increment each. Its step response is
run for some increments only and scaled to all. Everything runs on one thread; times are medians of
the repetitions.

With friction the deck has ``*FRICTION``, and faying follows the same path: an increment that
tightens, then the load in one increment as CalculiX takes it, and in ten as studies do.
"""

import argparse
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

os.environ.update(OMP_NUM_THREADS="1", MKL_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

import numpy as np

import faying as fy
from faying.io.abaqus.writer import write_deck
from faying.joint.build import build_model
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import NodalLoads
from faying.simulation.tightening import tightened_joint

PRELOAD, PENALTY = 8000.0, 1e6
FRICTION, TANGENTIAL_PENALTY = 0.2, 8e5
FORCES = {"tip.Fz": -500.0, "tip.Mx": 20e3}
STEP, INCREMENTS = 1e-5, 620
DAMPING = fy.Rayleigh(alpha=160.0, beta=5e-7)

write = sys.stdout.write


def main() -> None:
    """Print the tables asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--element-size", type=float, default=2.5)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--dynamic", type=int, default=0, metavar="INCREMENTS")
    options = parser.parse_args()
    if shutil.which("ccx") is None:
        sys.exit("CalculiX is not installed: there is no 'ccx' on the path")
    description = replace(
        lap_joint_assembly(
            element_size=options.element_size, element="standard", bolt_mass=False, penalty=PENALTY
        ),
        preloads={"bolt": PRELOAD},
    )
    load_before = os.getloadavg()[0]
    static(description, options.repeat)
    with_friction(description, options.repeat)
    if options.dynamic:
        dynamic(description, options.repeat, options.dynamic)
    write(f"\nload average {load_before:.1f} before, {os.getloadavg()[0]:.1f} after\n")


def static(description, repeat: int) -> None:
    """Compare LC2 on top of the preload with one warm case, and with a thousand from scratch."""
    theirs, one, thousand = [], [], []
    for _ in range(repeat):
        theirs.append(calculix(description).seconds)
        start = time.process_time()
        model = built(description)
        preloaded = fy.preload(model, {"bolt": PRELOAD})
        rom = fy.reduce(preloaded, fy.craig_bampton(preloaded, normal_modes=20), compliance=True)
        fy.solve_static_cases(rom, cases(1000))
        thousand.append(time.process_time() - start)
        start = time.process_time()
        for load in cases(200):
            fy.solve_static(rom, load)
        one.append((time.process_time() - start) / 200)
    points = preloaded.contact.n_points
    write(f"{model.K.shape[0]} dofs, {points} contact points\n\n")
    write("| | processor time | CalculiX over it |\n|---|---|---|\n")
    write(f"| CalculiX, preload and LC2 | {statistics.median(theirs):.2f} s | 1 |\n")
    row("faying, one six-component load, model at hand", one, theirs)
    row(
        "faying, 1000 loads with assembly, preload and basis, per load",
        [t / 1000 for t in thousand],
        theirs,
    )


def with_friction(description, repeat: int) -> None:
    """Compare LC2 after the preload, both with friction, with further loads and with building."""
    rubbing = replace(
        description,
        interfaces=tuple(
            replace(spec, friction=FRICTION, tangential_penalty=TANGENTIAL_PENALTY)
            for spec in description.interfaces
        ),
    )
    theirs, everything = [], []
    spent = {count: [] for count in (1, 10)}
    for _ in range(repeat):
        theirs.append(calculix(rubbing))
        start = time.process_time()
        model = built(rubbing)
        found = tightened_joint(model, {"bolt": PRELOAD}, increments=1)
        locked = model.with_bolt_forces(found.tightening.initial_forces)
        rom = fy.reduce(locked, fy.craig_bampton(locked, normal_modes=20), compliance=True)
        tight = fy.solve_path(rom, [fy.Load()])
        for load in cases(100):
            fy.solve_path(rom, [load], initial=tight)
        everything.append((time.process_time() - start) / 100)
        for count, times in spent.items():
            start = time.process_time()
            for load in cases(20):
                steps = [load.scaled(k / count) for k in range(1, count + 1)]
                fy.solve_path(rom, steps, initial=tight)
            times.append((time.process_time() - start) / 20)
    write(f"\n| friction {FRICTION} | processor time | CalculiX over it |\n|---|---|---|\n")
    seconds = [run.seconds for run in theirs]
    write(f"| CalculiX, preload and LC2 | {statistics.median(seconds):.2f} s | 1 |\n")
    for count, times in spent.items():
        how = f"{count} increment{'s' * (count > 1)}"
        row(f"faying, one six-component load, model at hand, {how}", times, seconds)
    row("faying, 100 loads with assembly, tightening and basis, per load", everything, seconds)
    solved = fy.solve_path(rom, [fy.Load(FORCES)], initial=tight)
    ours, other = solved.displacement("tip")[-1, :3], theirs[-1].tip
    difference = np.abs(ours - other).max() / np.abs(other).max()
    write(f"\nLC2 in one increment: {int(solved.iterations[0])} Newton steps, {closed(solved)}; ")
    write(f"tip of CalculiX {other}, difference {difference:.0e}\n")


def closed(path) -> str:
    """Say how many points are closed and at their friction bound at the end of a path."""
    traction = np.linalg.norm(path.traction[-1], axis=1)
    pressed = path.pressure[-1] > 0
    bound = traction[pressed] >= (1 - 1e-9) * FRICTION * path.pressure[-1][pressed]
    return f"{np.count_nonzero(pressed)} points closed, {np.count_nonzero(bound)} of them slip"


def dynamic(description, repeat: int, increments: int) -> None:
    """Compare LC2 as a step, 620 increments of 1e-5 s."""
    both = calculix(description, increments).seconds - calculix(description).seconds
    theirs = [both * INCREMENTS / increments]
    stepping, everything = [], []
    for _ in range(repeat):
        start = time.process_time()
        preloaded = fy.preload(built(description), {"bolt": PRELOAD}, sticking=fy.Sticking())
        rom = fy.reduce(preloaded, fy.craig_bampton(preloaded, normal_modes=20), compliance=True)
        load = fy.Load(FORCES)
        fy.solve_transient(rom, load, step=STEP, duration=STEP)
        online = time.process_time()
        fy.solve_transient(rom, load, step=STEP, duration=STEP * INCREMENTS)
        stepping.append(time.process_time() - online)
        everything.append(time.process_time() - start)
    write(f"\n| step response, {INCREMENTS} increments | processor time | CalculiX over it |\n")
    write("|---|---|---|\n")
    write(f"| CalculiX, {increments} increments scaled | {theirs[0]:.0f} s | 1 |\n")
    row("faying, stepping", stepping, theirs)
    row("faying, with assembly, preload and basis", everything, theirs)


def row(name: str, ours: list[float], theirs: list[float]) -> None:
    """Print a median and its ratio."""
    own, other = statistics.median(ours), statistics.median(theirs)
    shown = f"{own * 1e3:.2f} ms" if own < 1 else f"{own:.2f} s"
    write(f"| {name} | {shown} | {other / own:.0f} |\n")


def built(description) -> fy.Model:
    """Build the model anew."""
    return build_model(
        description.assembly,
        interfaces=description.interfaces,
        bolts=description.bolts,
        boundaries=description.boundaries,
        damping=DAMPING,
    )


def cases(count: int) -> list[fy.Load]:
    """Random loads of six components."""
    rng = np.random.default_rng(0)
    sizes = {"Fx": 200.0, "Fy": 200.0, "Fz": 500.0, "Mx": 20e3, "My": 20e3, "Mz": 20e3}
    draws = rng.uniform(-1, 1, (count, len(sizes))) * list(sizes.values())
    return [
        fy.Load({f"tip.{key}": float(value) for key, value in zip(sizes, draw, strict=True)})
        for draw in draws
    ]


@dataclass(frozen=True)
class Run:
    """Processor time of CalculiX [s], and where the tip went last (3,) [mm]."""

    seconds: float
    tip: np.ndarray


def calculix(description, increments: int = 0) -> Run:
    """Let CalculiX solve preload and LC2, or dynamic increments of it."""
    assembly = description.assembly
    tip = assembly.rigid_couplings[0].reference
    loads = {"LC2": NodalLoads(nodes=[tip], forces=[[0, 0, -500.0, 20e3, 0, 0]])}
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder) / "joint.inp"
        write_deck(description, deck, loads=loads)
        if increments:
            deck.write_text(as_dynamic(deck.read_text(), increments))
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = ["ccx", "joint"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode != 0:
            sys.exit(f"CalculiX failed:\n{done.stdout[-2000:]}")
        face = assembly.mesh.node_ids[assembly.rigid_couplings[0].nodes]
        moved = last_displacement(deck.with_suffix(".frd"), set(face.tolist()))
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Run(seconds, moved)


def last_displacement(path: Path, nodes: set[int]) -> np.ndarray:
    """Return the last mean displacement (3,) of nodes in a file of CalculiX's results.

    The mean over the rigid face at the tip is the displacement of the node in its middle.
    """
    inside, found = False, {}
    for line in path.read_text().splitlines():
        if line.startswith(" -4"):
            inside = line.split()[1] == "DISP"
        elif inside and line.startswith(" -1") and int(line[3:13]) in nodes:
            found[line[3:13]] = [float(line[13 + 12 * i : 25 + 12 * i]) for i in range(3)]
    return np.mean(list(found.values()), axis=0)


def as_dynamic(deck: str, increments: int) -> str:
    """Turn the last step of a deck into implicit dynamics of fixed increments, with damping.

    CalculiX wants energies from the first step on and a density for the stiff stub of the bolt.
    """
    deck = deck.replace("*END STEP", "*EL FILE\nENER\n*END STEP")
    deck = re.sub(r"(\*MATERIAL,NAME=CUT\d+\n)", r"\1*DENSITY\n1e-15\n", deck)
    head, _, last = deck.rpartition("*STEP,INC=100")
    timing = f"*DYNAMIC,ALPHA=-0.3\n1e-7,{STEP * increments},1e-12,{STEP}\n"
    last = re.sub(r"\*STATIC[^\n]*\n[^\n*]*\n", timing, last)
    return f"{head}*STEP,INC={10 * increments}{last}"


if __name__ == "__main__":
    main()
