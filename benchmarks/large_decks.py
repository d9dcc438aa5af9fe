"""What ``faying check`` takes of large decks: half a million nodes, and gigabytes that are refused.

    python benchmarks/large_decks.py FOLDER                  # hex8 and tet10, Abaqus and Nastran
    python benchmarks/large_decks.py FOLDER --refused 2e9    # bytes, with cards not supported
    python benchmarks/large_decks.py FOLDER --only hex8.bdf --nodes 2e5

Two blocks on top of each other that overlap by three tenths, the lower one held at its end, the
upper one loaded at its, a declared contact pair where they touch and a tightened bolt through it.
Decks are written to the folder unless they are there. Each check is a process of its own, whose
peak memory counts what this one had before: of decks that it wrote itself, take the second run.
"""

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path
from typing import TextIO

import numpy as np
import numpy.typing as npt

from faying._typing import Indices, Matrix

KINDS = ("hex8.inp", "hex8.bdf", "tet10.inp", "tet10.bdf")
OVERLAP = 0.3
CHUNK = 20_000
BYTES_PER_NODE = 140
UNSUPPORTED = {
    "inp": ("*NGEN\n1, 2\n", "*HYPERELASTIC\n1., 1.\n", "*SUBMODEL\n"),
    "bdf": ("CGAP    77777777\n", "PLSOLID 88888888\n", "CONM1   99999999\n"),
}


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """A block: nodes from an id on, elements, and its face that touches the other."""

    first: int
    nodes: Matrix
    elements: Indices
    facing: Indices
    """Rows of elements with a face in the overlap."""
    face: int
    """Number of that face, from 1, as in Abaqus."""
    corners: tuple[int, int, int]
    """Columns of three of its corners."""


def block(kind: str, size: tuple[int, int, int], lower: bool) -> Body:
    """Return a block with cells of edge 1 (hex8) or 2 (tet10)."""
    x, _, z = size
    step = 1 if kind == "hex8" else 2
    grid = np.stack(np.meshgrid(*(np.arange(n * step + 1) for n in size), indexing="ij"), -1)
    number = np.arange(grid[..., 0].size).reshape(grid.shape[:3])
    places = grid.reshape(-1, 3).astype(float)
    reach = round(OVERLAP * x * step)
    if lower:
        places[:, 2] -= z * step
    else:
        places[:, 0] += x * step - reach
    cells = np.stack(np.meshgrid(*(step * np.arange(n) for n in size), indexing="ij"), -1)
    cells = cells.reshape(-1, 3)

    def at(*offsets: npt.ArrayLike) -> Indices:
        return np.stack([number[tuple((cells + o).T)] for o in offsets], axis=1)

    first = 1 if lower else places.shape[0] + 1
    layer = (cells[:, 2] == (z - 1) * step) if lower else (cells[:, 2] == 0)
    near = cells[:, 0] >= x * step - reach if lower else cells[:, 0] < reach
    if kind == "hex8":
        square = [(0, 0), (1, 0), (1, 1), (0, 1)]
        elements = at(*[(a, b, c) for c in (0, 1) for a, b in square])
        facing = np.flatnonzero(layer & near)
        face, corners = (2, (4, 5, 6)) if lower else (1, (0, 2, 1))
        return Body(
            first=first, nodes=places, elements=elements, facing=facing, face=face, corners=corners
        )
    tets, facing = [], []
    for k, order in enumerate(permutations(range(3))):
        unit = np.eye(3, dtype=int)[list(order)]
        path = np.vstack([np.zeros((1, 3), dtype=int), np.cumsum(unit, axis=0)]) * 2
        if round(np.linalg.det(unit)) < 0:
            path[[1, 2]] = path[[2, 1]]
        ends = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
        tets.append(at(*path, *[(path[a] + path[b]) // 2 for a, b in ends]))
        if order[0 if lower else 2] == 2:
            facing.append(k * len(cells) + np.flatnonzero(layer & near))
    return Body(
        first=first,
        nodes=places,
        elements=np.concatenate(tets),
        facing=np.concatenate(facing),
        face=3 if lower else 1,
        corners=(1, 2, 3) if lower else (0, 2, 1),
    )


def size_of(kind: str, n_nodes: float) -> tuple[int, int, int]:
    """Return the cells of a block so that two of them have about so many nodes."""
    edge = (n_nodes / 2 / (0.25 if kind == "hex8" else 2.0)) ** (1 / 3)
    edge = max(round(edge), 10)
    return (edge, edge, max(edge // 4, 2))


def rows(pattern: str, *columns: npt.NDArray[np.generic]) -> Iterator[str]:
    """Yield lines of whole numbers and coordinates, thousands at a time."""
    for start in range(0, len(columns[0]), CHUNK):
        parts = [column[start : start + CHUNK] for column in columns]
        # Objects, so that ids stay whole beside coordinates.
        table = np.column_stack([part.astype(object) for part in parts])
        yield (pattern * len(table)) % tuple(table.ravel().tolist())


def bolt(lower: Body, upper: Body) -> tuple[Matrix, list[Indices]]:
    """Return the ends of a bolt in the middle of the overlap, and ids of the nodes they hold."""
    x = (lower.nodes[:, 0].max() + upper.nodes[:, 0].min()) / 2
    y = lower.nodes[:, 1].max() / 2
    low, high = lower.nodes[:, 2].min(), upper.nodes[:, 2].max()
    ends, held = np.array([[x, y, low], [x, y, high]]), []
    for body, z in ((lower, low), (upper, high)):
        apart = np.hypot(body.nodes[:, 0] - x, body.nodes[:, 1] - y)
        held.append(body.first + np.flatnonzero((body.nodes[:, 2] == z) & (apart < 6)))
    return ends, held


def lines_of(ids: Indices, width: int) -> str:
    """Return ids with commas, so many in a line."""
    parts = [ids[k : k + width].tolist() for k in range(0, len(ids), width)]
    return "".join(", ".join(map(str, part)) + "\n" for part in parts)


def write_inp(file: TextIO, kind: str, bodies: tuple[Body, Body], between: list[str]) -> None:
    """Write an Abaqus deck."""
    name = "C3D8I" if kind == "hex8" else "C3D10"
    element = 1
    lower, upper = bodies
    file.write("*HEADING\nTwo blocks\n" + between[0])
    for label, body in zip(("LOWER", "UPPER"), bodies, strict=True):
        file.write(f"*NODE, NSET=N{label}\n")
        ids = body.first + np.arange(len(body.nodes))
        file.writelines(rows("%8d, %.7e, %.7e, %.7e\n", ids, body.nodes))
        file.write(f"*ELEMENT, TYPE={name}, ELSET={label}\n")
        table = np.column_stack(
            [element + np.arange(len(body.elements)), body.first + body.elements]
        )
        file.writelines(rows(", ".join(["%8d"] * table.shape[1]) + "\n", table))
        file.write(f"*ELSET, ELSET={label}_FACING\n" + lines_of(element + body.facing, 16))
        file.write(f"*SURFACE, NAME={label}_FACE\n{label}_FACING, S{body.face}\n")
        element += len(body.elements)
        if body is lower:
            file.write(between[1])
    ends, held = bolt(*bodies)
    last = upper.first + len(upper.nodes)
    file.write(
        "*NODE\n" + "".join(f"{last + k}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(ends))
    )
    file.write(
        f"{last + 2}, 0., 0., 0.\n*ELEMENT, TYPE=B31, ELSET=BOLT\n{element}, {last}, {last + 1}\n"
    )
    file.write("*BEAM SECTION, ELSET=BOLT, MATERIAL=STEEL, SECTION=CIRC\n3.\n1., 0., 0.\n")
    for k, ids in enumerate(held):
        file.write(f"*NSET, NSET=WASHER{k}\n{lines_of(ids, 16)}")
        file.write(f"*RIGID BODY, NSET=WASHER{k}, REF NODE={last + k}\n")
    file.write(f"*PRE-TENSION SECTION, ELEMENT={element}, NODE={last + 2}\n")
    file.write("*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*DENSITY\n7.85E-9\n")
    file.writelines(
        f"*SOLID SECTION, ELSET={label}, MATERIAL=STEEL\n" for label in ("LOWER", "UPPER")
    )
    file.write("*SURFACE INTERACTION, NAME=J\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n")
    file.write("*CONTACT PAIR, INTERACTION=J, TYPE=SURFACE TO SURFACE\nLOWER_FACE, UPPER_FACE\n")
    fixed, loaded = ends_of(bodies)
    file.write(f"*NSET, NSET=FIXED\n{lines_of(fixed, 16)}*NSET, NSET=TIP\n{lines_of(loaded, 16)}")
    file.write("*BOUNDARY\nFIXED, 1, 3\n" + between[2] + "*STEP\n*STATIC\n*CLOAD\nTIP, 3, -1.\n")
    file.write(f"{last + 2}, 1, 20000.\n*END STEP\n")


def ends_of(bodies: tuple[Body, Body]) -> tuple[Indices, Indices]:
    """Return the ids of the nodes that are held and of those that are loaded."""
    lower, upper = bodies
    far = upper.nodes[:, 0] == upper.nodes[:, 0].max()
    return lower.first + np.flatnonzero(lower.nodes[:, 0] == 0), upper.first + np.flatnonzero(far)


def write_bdf(file: TextIO, kind: str, bodies: tuple[Body, Body], between: list[str]) -> None:
    """Write a Nastran deck of small fields, with Simcenter's cards of contact."""
    name, element = ("CHEXA" if kind == "hex8" else "CTETRA"), 1
    file.write("SOL 101\nCEND\nSPC = 1\nLOAD = 2\nBCSET = 4\nBOLTLD = 3\nBEGIN BULK\n" + between[0])
    file.write("PARAM,COUPMASS,1\n")
    for number, body in enumerate(bodies, start=1):
        ids = body.first + np.arange(len(body.nodes))
        file.writelines(rows("GRID    %8d        %8.2f%8.2f%8.2f\n", ids, body.nodes))
        n_nodes = body.elements.shape[1]
        pattern = (
            f"{name:8}%8d{number:8d}" + "%8d" * 6 + "\n        " + "%8d" * (n_nodes - 6) + "\n"
        )
        table = np.column_stack(
            [element + np.arange(len(body.elements)), body.first + body.elements]
        )
        file.writelines(rows(pattern, table))
        facing = table[body.facing]
        faces = np.column_stack([facing[:, 0], *(facing[:, 1 + c] for c in body.corners)])
        flat = faces.ravel()
        file.write(f"BSURFS  {number:8d}{'':24}" + "".join(f"{n:8d}" for n in flat[:4]) + "\n")
        rest = [flat[k : k + 8].tolist() for k in range(4, len(flat), 8)]
        file.writelines("        " + "".join(f"{n:8d}" for n in part) + "\n" for part in rest)
        element += len(body.elements)
        if number == 1:
            file.write(between[1])
    ends, held = bolt(*bodies)
    last = bodies[1].first + len(bodies[1].nodes)
    file.writelines(f"GRID,{last + k},,{x},{y},{z}\n" for k, (x, y, z) in enumerate(ends))
    file.write(f"CBAR,{element},3,{last},{last + 1},1.,0.,0.\nPBAR,3,9,28.3,63.6,63.6,127.2\n")
    for k, ids in enumerate(held):
        fields = [element + 1 + k, last + k, 123456, *ids.tolist()]
        parts = [fields[j : j + 8] for j in range(0, len(fields), 8)]
        heads = ["RBE2"] + [""] * (len(parts) - 1)
        file.writelines(
            f"{head:8}{''.join(f'{n:8d}' for n in part)}\n"
            for head, part in zip(heads, parts, strict=True)
        )
    file.write(f"BOLT,1,1,{element}\nBOLTFOR,3,20000.,1\nBCTSET,4,1,2,0.\n")
    file.write("PSOLID,1,9\nPSOLID,2,9\nMAT1,9,210000.,,.3,7.85-9\n")
    fixed, loaded = ends_of(bodies)
    file.writelines(f"SPC1    {1:8d}{123:8d}{n:8d}\n" for n in fixed.tolist())
    file.writelines(f"FORCE,2,{n},,1.,0.,0.,-1.\n" for n in loaded.tolist())
    file.write(between[2] + "ENDDATA\n")


def write(path: Path, n_nodes: float, *, refused: bool) -> None:
    """Write a deck, with cards that are not supported at its start, middle and end if wished."""
    kind, suffix = path.name.split(".")
    size = size_of(kind, n_nodes)
    bodies = (block(kind, size, lower=True), block(kind, size, lower=False))
    between = list(UNSUPPORTED[suffix]) if refused else [""] * 3
    with path.open("w") as file:
        (write_inp if suffix == "inp" else write_bdf)(file, kind, bodies, between)


def checked(path: Path) -> tuple[float, float, float, str]:
    """Return wall time, processor time [s], peak memory [GB] of a check, and what it said first."""
    start = time.perf_counter()
    with subprocess.Popen(
        [sys.executable, "-m", "faying", "check", str(path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ) as process:
        output = process.stdout.read() if process.stdout else ""
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    wall = time.perf_counter() - start
    first = (output.splitlines() or [""])[0].removeprefix(f"faying: {path}: ")
    said = "checked" if process.returncode == 0 else first
    return wall, used.ru_utime + used.ru_stime, used.ru_maxrss * 1024 / 1e9, said


def main() -> None:
    """Write decks, check them, print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--nodes", type=float, default=5e5)
    parser.add_argument("--refused", type=float, help="bytes of decks that are refused")
    parser.add_argument("--only", choices=KINDS)
    wished = parser.parse_args()
    folder, n_nodes, kinds = wished.folder, wished.nodes, KINDS
    if wished.refused:
        folder, kinds = folder / "refused", KINDS[:2]
        n_nodes = wished.refused / BYTES_PER_NODE
    folder.mkdir(parents=True, exist_ok=True)
    sys.stdout.write(f"load average at start {os.getloadavg()[0]:.1f}\n\n")
    sys.stdout.write(
        "| deck | MB | wall s | processor s | peak GB | |\n|---|---|---|---|---|---|\n"
    )
    for name in [wished.only] if wished.only else kinds:
        path = folder / name
        if not path.exists():
            write(path, n_nodes, refused=bool(wished.refused))
        wall, processor, peak, said = checked(path)
        figures = f"{path.stat().st_size / 1e6:.0f} | {wall:.1f} | {processor:.1f} | {peak:.2f}"
        sys.stdout.write(f"| {name} | {figures} | {said} |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
