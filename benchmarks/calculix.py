"""faying and CalculiX on the same cantilever in one run, processor time against processor time.

    python benchmarks/calculix.py                   static (a minute)
    python benchmarks/calculix.py --dynamic 62      and 62 of the 620 increments of LC2's step

CalculiX solves the deck faying writes: preload, then LC2, one increment each. Its step response is
run for some increments only and scaled to all. Everything runs on one thread; times are medians of
the repetitions.
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
from dataclasses import replace
from pathlib import Path

os.environ.update(OMP_NUM_THREADS="1", MKL_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

import numpy as np

import faying as fy
from faying.io.abaqus.writer import write_deck
from faying.joint.build import build_model
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import NodalLoads

PRELOAD, PENALTY = 8000.0, 1e6
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
    if options.dynamic:
        dynamic(description, options.repeat, options.dynamic)
    write(f"\nload average {load_before:.1f} before, {os.getloadavg()[0]:.1f} after\n")


def static(description, repeat: int) -> None:
    """Compare LC2 on top of the preload with one warm case, and with a thousand from scratch."""
    theirs, one, thousand = [], [], []
    for _ in range(repeat):
        theirs.append(calculix(description))
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


def dynamic(description, repeat: int, increments: int) -> None:
    """Compare LC2 as a step, 620 increments of 1e-5 s."""
    both = calculix(description, increments) - calculix(description)
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


def calculix(description, increments: int = 0) -> float:
    """Return CalculiX's processor time for preload and LC2, or dynamic increments of it."""
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
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


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
