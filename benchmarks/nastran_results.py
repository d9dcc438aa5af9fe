"""Displacements and frequencies of Nastran decks against the results that lie beside them.

    python benchmarks/nastran_results.py FOLDER [--above 0.05] [--limit DOFS]

Every deck below the folder that faying reads, and that has an ``.op2`` (read with pyyeti) or an
``.f06`` of the same name, is solved as faying reads it: the first subcase of statics as the largest
difference of a displacement of grid points over the largest displacement, modes as the largest
difference of the lowest frequencies that are not zero. A line stands for each deck, with what the
reader noted where the difference is larger than ``--above``.
"""

import argparse
import os
import re
import struct
import sys
from dataclasses import dataclass, field
from pathlib import Path

os.environ.update(OMP_NUM_THREADS="1", MKL_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

import numpy as np
import scipy.linalg as la
from pyyeti.nastran import op2

from faying._typing import Matrix, Vector
from faying.exceptions import FayingError
from faying.io.nastran.joint import read_joint
from faying.io.nastran.reader import read_parts
from faying.model.constraints import constrain
from faying.model.matrices import assemble_matrices, used_components

STATICS, MODES = 1, 2
MOST_MODES = 10
_ROW = re.compile(r"^0?\s*(\d+)\s+G\s+(\S.*)$")
_MODE = re.compile(r"^\s*\d+\s+\d+((?:\s+-?\d\.\d+E[+-]\d+){5})\s*$")


@dataclass(kw_only=True)
class Results:
    """What another program found: displacements by grid id, or frequencies [Hz]."""

    subcase: int | None = None
    displacements: dict[int, Vector] = field(default_factory=dict)
    basic: bool = False
    frequencies: list[float] = field(default_factory=list)


def from_op2(path: Path) -> Results | None:
    """Return the first static vector, or the eigenvalues of all real modes."""
    try:
        file = op2.OP2(str(path))
    except (ValueError, RuntimeError, OSError, struct.error, IndexError):
        return None
    found = Results()
    names = ("OUGV1", "OUGV2", "BOUGV1", "OUGV1PAT", "OUG1", "BOPHIG")
    for name in names:
        if name not in file.dbnames:
            continue
        file.set_position(name)
        file.rdop2nt()
        while (ident := file.rdop2record(form="int")) is not None:
            data = file.rdop2record(form="bytes")
            word = np.dtype(f"i{ident.dtype.itemsize}")
            real = np.dtype(f"f{ident.dtype.itemsize}")
            approach, sort, complexity = ident[0] // 10, ident[1] // 1000, ident[8]
            if sort > 1 or complexity != 1 or ident[9] != 8:
                break
            if found.subcase not in (None, int(ident[3])):
                continue
            if approach == MODES:
                found.subcase = int(ident[3])
                value = float(ident[5:6].astype(word).view(real)[0])
                frequency = np.sqrt(max(value, 0.0)) / (2 * np.pi)
                if found.frequencies and frequency < (1 - 1e-3) * found.frequencies[-1]:
                    return found  # modes are written again, as they fly
                found.frequencies.append(frequency)
            elif approach == STATICS and not found.displacements:
                table = np.frombuffer(data, dtype=word).reshape(-1, 8)
                grid = table[:, 1] == 1
                rows = np.ascontiguousarray(table[grid]).view(real)[:, 2:]
                found.displacements = dict(
                    zip((table[grid, 0] // 10).tolist(), rows.astype(float), strict=True)
                )
                found.subcase = int(ident[3])
                found.basic = name.endswith("PAT")
        if found.displacements or found.frequencies:
            return found
    return None


def from_f06(path: Path) -> Results | None:
    """Return the first table of displacements, or the table of real eigenvalues."""
    found = Results()
    inside = ""
    subcase = None
    for line in path.read_text(encoding="latin-1").splitlines():
        if match := re.search(r"SUBCASE\s+(\d+)", line):
            subcase = int(match[1])
        packed = line.replace(" ", "")
        if "DISPLACEMENTVECTOR" in packed:
            inside = "" if "COMPLEX" in packed else "displacements"
        elif "REALEIGENVALUES" in packed:
            inside = "modes"
        elif line.startswith("1") or re.search(r"[A-Z] [A-Z] [A-Z] [A-Z]", line):
            inside = ""
        elif inside == "modes" and (match := _MODE.match(line)):
            frequency = float(match[1].split()[2])
            if found.frequencies and frequency < (1 - 1e-3) * found.frequencies[-1]:
                break  # the table is written again, as it flies
            found.frequencies.append(frequency)
        elif inside == "displacements" and (match := _ROW.match(line)):
            values = [float(text) for text in match[2].split()[:6]]
            if found.subcase in (None, subcase) and len(values) == 6:
                found.subcase = subcase
                found.displacements.setdefault(int(match[1]), np.array(values))
    if found.frequencies and not found.displacements:
        return found
    return found if found.displacements else None


def difference(path: Path, theirs: Results, limit: int) -> tuple[str, float, tuple[str, ...]]:
    """Return what was compared, how far it is off, and the notes of the reader."""
    try:
        described = read_joint(path, subcase=theirs.subcase)
    except FayingError as error:
        if "subcase" not in str(error):
            raise
        described = read_joint(path)
    notes = described.assembly.ignored
    if described.interfaces or described.bolts:
        return "contact or bolts: not compared", np.nan, notes
    dofs = constrain(described.assembly, used_components(described.assembly))
    T = dofs.transformation
    if T.shape[1] > limit:
        return f"{T.shape[1]} degrees of freedom: not compared", np.nan, notes
    matrices = assemble_matrices(described.assembly)
    K, M = ((T.T @ matrix @ T).toarray() for matrix in (matrices.K, matrices.M))
    if theirs.displacements:
        name = described.selected_load
        if name is None:
            return "no load set was read: not compared", np.nan, notes
        load = described.assembly.loads[name]
        f = np.zeros((len(described.assembly.mesh.nodes), 6))
        np.add.at(f, load.nodes, load.forces)
        moved = (T @ (_inverse(K) @ (T.T @ f.ravel()))).reshape(-1, 6)
        return "statics", _statics(path, theirs, moved), notes
    return _modes(theirs, K, M, notes)


def _inverse(K: Matrix) -> Matrix:
    """Pseudo-inverse: what nothing holds stays, as with AUTOSPC."""
    scale = 1 / np.sqrt(np.where(np.diag(K) > 0, np.diag(K), 1.0))
    values, vectors = la.eigh(K * scale[:, None] * scale)
    held = values > 1e-12 * values[-1]
    scaled = scale[:, None] * vectors[:, held]
    return np.asarray(scaled / values[held] @ scaled.T)


def _statics(path: Path, theirs: Results, moved: Matrix) -> float:
    grids = read_parts(path).grids
    ids = [n for n in theirs.displacements if n in set(grids.ids.tolist())]
    index = grids.index(np.array(ids))
    ours = moved[index, :3]
    if not theirs.basic:
        ours = np.einsum("nij,nj->ni", grids.systems.axes_of(index), ours)
    wanted = np.array([theirs.displacements[n][:3] for n in ids])
    largest = float(max(np.abs(wanted).max(), np.abs(ours).max()))
    return float(np.abs(ours - wanted).max() / largest) if largest else 0.0


def _modes(
    theirs: Results, K: Matrix, M: Matrix, notes: tuple[str, ...]
) -> tuple[str, float, tuple[str, ...]]:
    scale = 1 / np.sqrt(np.where(np.diag(K) > 0, np.diag(K), 1.0))
    shift = np.trace(K * scale[:, None] * scale) / max(np.trace(M * scale[:, None] * scale), 1e-300)
    shift *= 1e-9
    shifted = (K + shift * M) * scale[:, None] * scale
    values, vectors = la.eigh(shifted)
    held = values > 1e-14 * values[-1]
    basis = scale[:, None] * vectors[:, held] / np.sqrt(values[held])
    inverse = la.eigh(basis.T @ M @ basis, eigvals_only=True)[::-1]
    squares = 1 / inverse[inverse > 1e-14 * inverse[0]] - shift
    ours = np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)
    wanted = np.array(theirs.frequencies)
    least = 1e-3 * max(ours[: len(wanted)].max(initial=0.0), wanted.max())
    least = max(min(least, 0.5 * float(wanted[wanted > 1e-2].min(initial=np.inf))), 1e-3)
    ours, wanted = ours[ours > least], wanted[wanted > least]
    n = min(len(ours), len(wanted), MOST_MODES)
    if not n:
        return "no elastic modes: not compared", np.nan, notes
    off = np.abs(ours[:n] / wanted[:n] - 1)
    shown = " ".join(f"{a:.4g}/{b:.4g}" for a, b in zip(ours[:n], wanted[:n], strict=True))
    return f"{n} modes ({shown})", float(off.max()), notes


def results_of(path: Path) -> Results | None:
    """Return what lies beside a deck."""
    for suffix, read in ((".op2", from_op2), (".f06", from_f06)):
        for kind in (suffix, suffix.upper()):
            beside = path.with_suffix(kind)
            if beside.exists() and (found := read(beside)) is not None:
                return found
    return None


def main() -> None:
    """Print a line for each deck."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--above", type=float, default=0.05, help="show notes of decks farther off")
    parser.add_argument("--limit", type=int, default=3000, help="largest number of unknowns")
    wished = parser.parse_args()
    suffixes = {".bdf", ".dat", ".nas"}
    for path in sorted(p for p in wished.folder.rglob("*") if p.suffix.lower() in suffixes):
        theirs = results_of(path)
        if theirs is None:
            continue
        name = path.relative_to(wished.folder)
        try:
            what, off, notes = difference(path, theirs, wished.limit)
        except FayingError:
            continue
        sys.stdout.write(f"{off:.1e}\t{name}\t{what}\n")
        if off > wished.above:
            sys.stdout.writelines(f"\t\t{note}\n" for note in notes)
        sys.stdout.flush()


if __name__ == "__main__":
    main()
