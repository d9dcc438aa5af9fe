"""CalculiX's own regression decks against the figures that CalculiX keeps beside them.

    python benchmarks/calculix_decks.py FOLDER [--limit DOFS] [--all]

Every ``.inp`` of the folder (the decks come with CalculiX's source, in its folder ``test``) that
has a ``.dat.ref`` and that faying reads is solved as faying reads it. Statics of the first step:
largest difference of a displacement over the largest one, of those that are printed, else of those
in a ``.frd.ref``. Frequencies: largest relative difference of those that are printed. The table has
a line for each deck that is compared, the nearest first; below it are counts of what was not, and
why. ``--all`` names those too.
"""

import argparse
import os
import re
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

os.environ.update(OMP_NUM_THREADS="1", MKL_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

import numpy as np
import scipy.sparse.linalg as spla

import faying as fy
from faying._typing import Matrix
from faying.exceptions import FayingError
from faying.io.abaqus.joint import read_joint
from faying.model.constraints import constrain
from faying.model.description import JointDescription
from faying.model.matrices import assemble_matrices, used_components

STEP = re.compile(r"^\s*S T E P\s+(\d+)")
FIELD = re.compile(r"^ (\S.*?) for set \S+ and time\s+(\S+)")
MODE = re.compile(r"^\s+\d+\s+(\S+)\s+(\S+)\s+(\S+)\s+(\S+)\s*$")
MOST_MODES = 10
RIGID = 1e-5
"""Frequencies below this part of the highest printed one are those of rigid motion."""
NEAR, FAR = 1e-5, 1e-2
"""Printed figures have seven digits; above the second a deck is looked at."""


@dataclass(kw_only=True)
class Figures:
    """Displacements by node at the end of the first step, and frequencies [cycles/time]."""

    displacements: dict[int, list[float]] = field(default_factory=dict)
    local: bool = False
    frequencies: list[float] = field(default_factory=list)


def figures(path: Path) -> Figures:
    """Read a ``.dat.ref``: the last displacements of step 1, and the first table of eigenvalues."""
    found = Figures()
    what, when, step, modes = "", -1.0, 1, False
    for line in path.read_text(encoding="latin-1").splitlines():
        if match := STEP.match(line):
            step, what = int(match[1]), ""
        elif "E I G E N V A L U E" in line:
            modes, what = not found.frequencies, ""
        elif match := FIELD.match(line):
            what, time = match[1], float(match[2])
            if what.startswith("displacements") and step == 1 and time > when:
                when, found.displacements, found.local = time, {}, False
        elif (modes and "FACTORS" in line) or "EFFECTIVE" in line:
            modes = False
        elif modes and (match := MODE.match(line)):
            found.frequencies.append(float(match[3]))
        elif what.startswith("displacements") and step == 1 and line.strip():
            texts = line.split()
            if len(texts) >= 4 and texts[0].isdigit():
                found.displacements[int(texts[0])] = [float(text) for text in texts[1:4]]
                found.local |= texts[-1] == "L"
    return found


def plotted(path: Path) -> Figures:
    """Read a ``.frd.ref``: the last displacements of step 1."""
    found = Figures()
    step, inside = 0, False
    for line in path.read_text(encoding="latin-1").splitlines():
        if line.startswith("    1PSTEP"):
            step = int(line.split()[-1])
        elif line.startswith(" -4"):
            inside = line.split()[1] == "DISP" and step <= 1
            if inside:
                found.displacements = {}
        elif line.startswith(" -3"):
            inside = False
        elif inside and line.startswith(" -1"):
            values = [float(line[13 + 12 * i : 25 + 12 * i]) for i in range(3)]
            found.displacements[int(line[3:13])] = values
    return found


def first_step(path: Path) -> str:
    """Return what the first step computes, as its keywords say."""
    text = re.sub(r"(?m)^\*\*.*$", "", path.read_text(encoding="latin-1")).upper()
    steps = re.split(r"(?m)^\*STEP", text)
    if len(steps) < 2:
        return "no step"
    own = steps[1].split("*END STEP")[0]
    for keyword in ("STATIC", "FREQUENCY"):
        if re.search(rf"(?m)^\*{keyword}", own):
            moving = "NLGEOM" in own.split("\n")[0] and "NLGEOM=NO" not in own.split("\n")[0]
            return keyword + (", NLGEOM" if moving else "")
    return "neither statics nor frequencies"


def compared(path: Path, limit: int) -> tuple[str, float]:
    """Return what of a deck was compared, and how far it is off (nan where nothing was)."""
    what = first_step(path)
    if not what.startswith(("STATIC", "FREQUENCY")):
        return what, np.nan
    theirs = figures(path.with_suffix(".dat.ref"))
    statics = what.startswith("STATIC")
    beside = path.with_suffix(".frd.ref")
    if statics and not any(map(any, theirs.displacements.values())) and beside.exists():
        theirs = plotted(beside)
    if statics and not any(map(any, theirs.displacements.values())):
        return "no displacements kept", np.nan
    if statics and theirs.local:
        return "displacements printed in turned axes", np.nan
    if not statics and not theirs.frequencies:
        return "no frequencies printed", np.nan
    described = read_joint(path, step=1)
    if not statics and described.interfaces:
        return "frequencies under contact", np.nan
    if described.bolts and not described.interfaces:
        return "bolts without contact", np.nan
    if statics and not set(theirs.displacements) & set(described.assembly.mesh.node_ids.tolist()):
        return "no displacements kept", np.nan
    if statics:
        found = _statics(path, described, theirs, limit)
    else:
        found = _modes(described, theirs, limit)
    shown = what.capitalize().replace("nlgeom", "NLGEOM")
    return shown + (", contact" if described.interfaces else ""), found


def _statics(path: Path, described: JointDescription, theirs: Figures, limit: int) -> float:
    ids = described.assembly.mesh.node_ids
    known = [n for n in theirs.displacements if n in set(ids.tolist())]
    rows = np.argsort(ids)[np.searchsorted(np.sort(ids), known)]
    wanted = np.array([theirs.displacements[n] for n in known])
    ours = _moved(path, described, limit)[rows, :3]
    largest = np.abs(wanted).max()
    return float(np.abs(ours - wanted).max() / largest)


def _moved(path: Path, described: JointDescription, limit: int) -> Matrix:
    """Return the displacements of all nodes (n_node, 6) under the loads of the first step."""
    name = described.selected_load
    if described.interfaces:
        joint = fy.read_abaqus(path, step=1)
        _check_size(joint.K.shape[0], limit)
        joint = joint.with_deck_loads(name)
        solution = fy.solve_static(joint, fy.Load({name: 1.0}))
        return np.asarray(joint.dofs.nodal(solution.full_displacement()))
    assembly = described.assembly
    dofs = constrain(assembly, used_components(assembly))
    T = dofs.transformation
    _check_size(T.shape[1], limit)
    K = (T.T @ assemble_matrices(assembly).K @ T).tocsc()
    f = np.zeros((len(assembly.mesh.nodes), 6))
    load = assembly.loads[name]
    np.add.at(f, load.nodes, load.forces)
    return np.asarray(T @ spla.spsolve(K, T.T @ f.ravel())).reshape(-1, 6)


def _modes(described: JointDescription, theirs: Figures, limit: int) -> float:
    assembly = described.assembly
    dofs = constrain(assembly, used_components(assembly))
    T = dofs.transformation
    _check_size(T.shape[1], limit)
    matrices = assemble_matrices(assembly)
    K, M = ((T.T @ matrix @ T).tocsc() for matrix in (matrices.K, matrices.M))
    wanted = np.sort(theirs.frequencies)
    wanted = wanted[wanted > RIGID * wanted.max()][:MOST_MODES]
    free = len(theirs.frequencies) - len(wanted) if len(wanted) < MOST_MODES else 6
    shift = -((2 * np.pi * wanted[0]) ** 2) / 10  # below zero: K may be singular
    count = min(len(wanted) + free + 2, K.shape[0] - 2)
    squares = spla.eigsh(K, count, M, sigma=shift, return_eigenvectors=False)
    ours = np.sqrt(np.sort(np.maximum(squares, 0.0))) / (2 * np.pi)
    ours = ours[ours > RIGID * np.max(theirs.frequencies)][: len(wanted)]
    if len(ours) < len(wanted):
        return np.nan
    return float(np.abs(ours / wanted - 1).max())


class TooLargeError(Exception):
    """A deck is beyond the limit of the command line."""


def _check_size(n_dof: int, limit: int) -> None:
    if n_dof > limit:
        raise TooLargeError


def outcomes(folder: Path, limit: int, verbose: bool) -> Iterator[tuple[str, str, float]]:
    """Yield name, what was compared or why not, and the difference."""
    for path in sorted(folder.glob("*.inp")):
        if not path.with_suffix(".dat.ref").exists():
            yield path.name, "no printed figures", np.nan
            continue
        try:
            yield path.name, *compared(path, limit)
        except TooLargeError:
            yield path.name, f"more than {limit} degrees of freedom", np.nan
        except FayingError as error:
            reason = str(error).splitlines()[0].removeprefix(f"{path}:")
            yield path.name, f"refused: {reason}" if verbose else "refused", np.nan
        except Exception as error:  # one deck must not end the table; it is counted and named
            yield path.name, f"{type(error).__name__}: {error}"[:80], np.nan


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--limit", type=int, default=20000, help="largest number of unknowns")
    parser.add_argument("--all", action="store_true", help="name what was not compared too")
    wished = parser.parse_args()
    write = sys.stdout.write
    found = list(outcomes(wished.folder, wished.limit, wished.all))
    table = sorted((off, name, what) for name, what, off in found if np.isfinite(off))
    rest = [(name, what) for name, what, off in found if not np.isfinite(off)]
    for kind in dict.fromkeys(what for _, _, what in table):
        errors = np.array([off for off, _, what in table if what == kind])
        write(
            f"{kind}: {len(errors)} decks, median {np.median(errors):.1e}, below {NEAR:g} "
            f"{(errors < NEAR).sum()}, above {FAR:g} {(errors > FAR).sum()}\n"
        )
    write("\n| deck | compared | difference |\n|---|---|---|\n")
    for off, name, what in table:
        write(f"| {name} | {what} | {off:.1e} |\n")
    write("\n| not compared | decks |\n|---|---|\n")
    for what, count in Counter(what for _, what in rest).most_common():
        write(f"| {what} | {count} |\n")
    if wished.all:
        for name, what in rest:
            write(f"{name}\t{what}\n")


if __name__ == "__main__":
    main()
