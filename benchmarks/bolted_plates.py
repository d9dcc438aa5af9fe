"""faying and CalculiX on four solid bolts in lapped plates with friction, from one deck.

    python benchmarks/bolted_plates.py              41 335 degrees of freedom (ten minutes)
    python benchmarks/bolted_plates.py --around 2   half as many

Bricks of 20 nodes; heads and nuts share nodes with the plates, shanks are free in their holes. Each
bolt is tightened to 12 kN at its pre-tension section, then the plates are pulled and bent in ten
increments, until more than three quarters of what is closed slips. Both contacts are surface to
surface, with 1e6 N/mm³ in normal direction, 5e5 along it, and a coefficient of 0.15. Integration
points differ, so the tip agrees to 0.3 %. Processor times of one thread each.
"""

import argparse
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

import faying as fy
from faying.assessment.slip import slip_states
from faying.linalg.factorization import factorize
from faying.study.inputs.load_model import build_loaded, load_model
from faying.study.inputs.loads import case_load
from faying.study.keys.schema import read_study

SHANK, HOLE, HEAD, CELL = 4.0, 4.5, 6.5, 30.0
"""Radii of an M8, its hole and its head, and the distance of the bolts [mm]."""

THICKNESS, HEAD_HEIGHT, NUT_HEIGHT, OVERHANG = 10.0, 5.0, 6.0, 40.0
LAYERS = 2
RINGS = 4
"""Layers of a plate; rings of bricks from the head to the edge of the cell of a bolt."""

PRELOAD, PULL, BEND = 12e3, 4000.0, -400.0
INCREMENTS = 10
BOLTS = [(-15.0, -15.0), (15.0, -15.0), (-15.0, 15.0), (15.0, 15.0)]

PLATE = "plate"
STEEL = ["*ELASTIC", "210000., 0.3", "*DENSITY", "7.85e-9"]
CONTACT = [
    "*SURFACE INTERACTION, NAME=FACES",
    "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
    "1.E6, 1.",
    "*FRICTION",
    "0.15, 5.E5",
    "*CONTACT PAIR, INTERACTION=FACES, TYPE=SURFACE TO SURFACE",
    "LOWER_FACE, UPPER_FACE",
]
STUDY = f"""
units = "mm-t-s"
[model]
source = "abaqus"
file = "plates.inp"
[[boundary]]
name = "tip"
set = "TIP"
coupling = "rbe3"
[[load_case]]
name = "pull"
kind = "static"
forces = [
  {{ boundary = "tip", component = "Fx", value = {PULL} }},
  {{ boundary = "tip", component = "Fz", value = {BEND} }},
]
"""


class Bricks:
    """Bricks of 20 nodes, named; nodes at one place are one, except on the faying surface."""

    def __init__(self) -> None:
        self.nodes: dict[tuple[float, ...], int] = {}
        self.elements: dict[str, list[list[int]]] = {}
        self.faces: dict[str, list[tuple[str, int, int]]] = {}

    def add(self, name: str, square: np.ndarray, bottom: float, top: float) -> int:
        """Add a brick over a square (4, 2) and return its place among those of its name."""
        low, high = (np.column_stack([square, np.full(4, z)]) for z in (bottom, top))
        after = [1, 2, 3, 0]
        middles = [(low + low[after]) / 2, (high + high[after]) / 2, (low + high) / 2]
        places = np.round(np.concatenate([low, high, *middles]), 6) + 0.0
        side = 1.0 if name == "UPPER" else 0.0
        brick = [self._node((*place, side * (place[2] == 0.0))) for place in places.tolist()]
        self.elements.setdefault(name, []).append(brick)
        return len(self.elements[name]) - 1

    def _node(self, key: tuple[float, ...]) -> int:
        return self.nodes.setdefault(key, len(self.nodes) + 1)

    def mark(self, surface: str, name: str, place: int, face: int) -> None:
        """Make a face of a brick part of a surface."""
        self.faces.setdefault(surface, []).append((name, place, face))


def circle(radius: float, around: int) -> np.ndarray:
    """Return the corners (4 around + 1, 2) of a ring, the last one the first."""
    angles = -3 * np.pi / 4 + np.pi / 2 * np.arange(4 * around + 1) / around
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def edge(half: float, around: int) -> np.ndarray:
    """Return the same corners on the edge of a square."""
    along = -1 + 2 * np.arange(around) / around
    one = np.ones(around)
    sides = [(along, -one), (one, along), (-along, one), (-one, -along)]
    return half * np.concatenate([*(np.column_stack(side) for side in sides), [[-1.0, -1.0]]])


def squares(around: int) -> list[tuple[str, np.ndarray]]:
    """Return the squares (4, 2) of a bolt and the plates around it, with what they belong to."""
    steps = SHANK / 2 * np.linspace(-1, 1, around + 1)
    core = [
        np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
        for x0, x1 in pairwise(steps)
        for y0, y1 in pairwise(steps)
    ]
    head, outside = circle(HEAD, around), edge(CELL / 2, around)
    plate = [(1 - part) * head + part * outside for part in np.linspace(0, 1, RINGS + 1)]
    hole, shank = circle(HOLE, around), circle(SHANK, around)
    rings = [
        ("shank", edge(SHANK / 2, around), shank),
        ("gap", shank, hole),
        ("collar", hole, head),
    ]
    rings += [(PLATE, inner, outer) for inner, outer in pairwise(plate)]
    return [("shank", square) for square in core] + [
        (part, np.array([inner[k], outer[k], outer[k + 1], inner[k + 1]]))
        for part, inner, outer in rings
        for k in range(4 * around)
    ]


def joint(around: int) -> Bricks:
    """Return the bricks of the joint."""
    bricks = Bricks()
    levels = np.linspace(0, THICKNESS, LAYERS + 1)
    layers = list(pairwise(levels))
    for number, center in enumerate(BOLTS):
        bolt = f"BOLT{number}"
        for part, square in squares(around):
            place = square + center
            for bottom, top in layers:
                if part in ("collar", PLATE):
                    lower = bricks.add("LOWER", place, -top, -bottom)
                    upper = bricks.add("UPPER", place, bottom, top)
                    if bottom == 0:
                        bricks.mark("LOWER_FACE", "LOWER", lower, 2)
                        bricks.mark("UPPER_FACE", "UPPER", upper, 1)
                elif part == "shank":
                    lower = bricks.add(bolt, place, -top, -bottom)
                    bricks.add(bolt, place, bottom, top)
                    if bottom == 0:
                        bricks.mark(f"CUT{number}", bolt, lower, 2)
            if part != PLATE:
                bricks.add(bolt, place, THICKNESS, THICKNESS + HEAD_HEIGHT)
                bricks.add(bolt, place, -THICKNESS - NUT_HEIGHT, -THICKNESS)
    lengths = np.linspace(CELL, CELL + OVERHANG, 5)
    widths = np.linspace(-CELL, CELL, 2 * around + 1)
    for x0, x1 in pairwise(lengths):
        for y0, y1 in pairwise(widths):
            square = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
            for bottom, top in layers:
                bricks.add("UPPER", square, bottom, top)
                bricks.add("LOWER", (square * [-1, 1])[::-1], -top, -bottom)
    return bricks


def rows(numbers: list[int]) -> list[str]:
    """Return numbers as lines of a deck, twelve in each."""
    return [", ".join(map(str, numbers[k : k + 12])) for k in range(0, len(numbers), 12)]


def deck(bricks: Bricks) -> str:
    """Return the deck of both programs: preload in one step, the loads in increments of another."""
    places = np.array(list(bricks.nodes))[:, :3]
    lines = ["*NODE"]
    lines += [f"{n}, {x:.9g}, {y:.9g}, {z:.9g}" for n, (x, y, z) in enumerate(places, 1)]
    first, count = {}, 0
    for name, elements in bricks.elements.items():
        first[name] = count + 1
        lines.append(f"*ELEMENT, TYPE=C3D20, ELSET={name}")
        for brick in elements:
            count += 1
            lines += [", ".join(map(str, [count, *brick[:14]])) + ",", *rows(brick[14:])]
    lines += ["*ELSET, ELSET=ALL", *bricks.elements, "*MATERIAL, NAME=STEEL", *STEEL]
    lines.append("*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL")
    for surface, faces in bricks.faces.items():
        lines.append(f"*SURFACE, NAME={surface}, TYPE=ELEMENT")
        lines += [f"{first[name] + place}, S{face}" for name, place, face in faces]
    controls = [len(places) + 1 + number for number in range(len(BOLTS))]
    for number, node in enumerate(controls):
        lines += [f"*NODE, NSET=CONTROL{number}", f"{node}, 0, 0, 0"]
        lines += [f"*PRE-TENSION SECTION, SURFACE=CUT{number}, NODE={node}", "0, 0, 1"]
    end = CELL + OVERHANG
    clamp, tip = ((np.flatnonzero(places[:, 0] == x) + 1).tolist() for x in (-end, end))
    lines += ["*NSET, NSET=CLAMP", *rows(clamp), "*NSET, NSET=TIP", *rows(tip), *CONTACT]
    lines += ["*BOUNDARY", "CLAMP, 1, 3"]
    lines += ["*STEP, INC=200", "*STATIC", "1., 1.", "*CLOAD"]
    lines += [f"{node}, 1, {PRELOAD}" for node in controls]
    lines += ["*NODE PRINT, NSET=TIP", "U", "*END STEP"]
    lines += ["*STEP, INC=200", "*STATIC, DIRECT", f"{1 / INCREMENTS}, 1.", "*BOUNDARY, FIXED"]
    lines += [f"{node}, 1, 1" for node in controls]
    lines += ["*CLOAD"]
    lines += [f"{n}, {k}, {f / len(tip):.12g}" for n in tip for k, f in ((1, PULL), (3, BEND))]
    lines += ["*NODE PRINT, NSET=TIP", "U", "*END STEP", ""]
    return "\n".join(lines)


def calculix(folder: Path) -> tuple[float, int, list[np.ndarray]]:
    """Return processor time [s] and iterations of CalculiX, and the tip (3,) by increments."""
    if shutil.which("ccx") is None:
        sys.exit("CalculiX is not installed: there is no 'ccx' on the path")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        ["ccx", "plates"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"CalculiX failed:\n{done.stdout[-2000:]}")
    blocks = re.split(r"displacements .*\n", (folder / "plates.dat").read_text())[1:]
    tip = [np.loadtxt(block.splitlines(), usecols=(1, 2, 3)).mean(axis=0) for block in blocks]
    iterations = len((folder / "plates.cvg").read_text().splitlines()) - 4
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, iterations, tip


def faying(study: Path) -> tuple[dict[str, float], list[np.ndarray]]:
    """Return faying's processor times [s] and the tip (3,) after each increment."""
    times: dict[str, float] = {}
    description = read_study(study)
    model = build_loaded(load_model(description))
    sys.stdout.write(f"{model}; load average {os.getloadavg()[0]:.1f}\n\n")
    load = case_load(description.load_cases[0])
    start = time.process_time()
    factorize(model.K)
    times["one factorization of K"] = time.process_time() - start
    start = time.process_time()
    _ = model.static_contact.increments
    times["offline"] = time.process_time() - start
    start = time.process_time()
    tightened = fy.tighten(model, dict.fromkeys(model.bolts, PRELOAD), increments=1)
    locked = model.with_bolt_forces(tightened.initial_forces)
    state = fy.solve_path(locked, tightened.loads)
    times["tightening"] = time.process_time() - start
    tip, shares, spent = [state.displacement("tip")[-1, :3]], [], []
    for number in range(1, INCREMENTS + 1):
        start = time.process_time()
        before, state = state, fy.solve_path(locked, [load.scaled(number / INCREMENTS)], state)
        spent.append(time.process_time() - start)
        shares.append(100 * slip_states(state, before).slip_of_closed[-1])
        tip.append(state.displacement("tip")[-1, :3])
    times["ten increments"] = sum(spent)
    sys.stdout.write(f"increments take {min(spent):.2f} to {max(spent):.2f} s, ")
    sys.stdout.write(f"{min(shares):.0f} to {max(shares):.0f} % of what is closed slips\n\n")
    return times, tip


def main() -> None:
    """Print the times of both programs, their ratios, and how far their tips are apart."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--around", type=int, default=4, help="bricks on a quarter of a hole")
    around = options.parse_args().around
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "plates.inp").write_text(deck(joint(around)))
        (folder / "study.toml").write_text(STUDY)
        times, ours = faying(folder / "study.toml")
        for stage, seconds in times.items():
            sys.stdout.write(f"{stage}: {seconds:.2f} s\n")
        theirs, iterations, tip = calculix(folder)
    whole = times["offline"] + times["tightening"] + times["ten increments"]
    sys.stdout.write(f"CalculiX, {iterations} iterations: {theirs:.0f} s, {theirs / whole:.0f} ×\n")
    apart = [np.linalg.norm(a - b) / np.linalg.norm(b) for a, b in zip(ours, tip, strict=True)]
    sys.stdout.write(f"tips are apart by at most {100 * max(apart):.2g} %\n")


if __name__ == "__main__":
    main()
