"""How often increments with friction are solved, and in how many Newton steps.

    python benchmarks/friction_robustness.py PATHS [--first NUMBER] [--keep FILE]
    python benchmarks/friction_robustness.py --why NUMBER...

Paths of five increments, numbered. Half are of a coarse lap joint, half of a few points with any
compliance, normals and gaps; μ up to 1, c_n from 1e4 to 1e9 N/mm³ or hard. Prints a table of
Newton steps, what was refused and why, and the worst natural residual, computed by the law written
out again.

With a file, what became of each path is kept there, one line each, and the tables are those of all
that it holds: 4000 paths at half a second each are done in pieces, each by the same command with
another number of the first path.

With ``--why``, whether refused increments of hard contact have a solution: the largest share of the
largest gap by which some displacement opens all gaps at once, negative where none keeps them from
closing, and the largest force with penalties instead, of 1e8 to 1e12 N/mm³. Where it rises with the
penalty in proportion, no solution of hard contact is the limit.
"""

import argparse
import json
import sys
from collections import Counter
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
from scipy.optimize import linprog

from faying.assessment.natural_map import NaturalMap
from faying.contact.augmented import AugmentedContact
from faying.contact.between_pairs import ByCompliance
from faying.contact.laws import Coulomb, Penalty
from faying.exceptions import ConvergenceError

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from random_friction import Joints, Outcome, outcomes, small_path, solver_of, walked

BOUNDS = (5, 10, 20, 40, 80, 160)
"""Upper ends of the classes of Newton steps."""


def main() -> None:
    """Solve the paths asked for and print what became of them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("paths", type=int, nargs="?", default=0, help="how many")
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--keep", type=Path, help="file to add to, one line a path")
    parser.add_argument("--why", type=int, nargs="+", help="paths that were refused")
    asked = parser.parse_args()
    if asked.why:
        for number in asked.why:
            sys.stdout.write(reason(number) + "\n")
        return
    joints, found = Joints(), kept(asked.keep)
    for number in range(asked.first, asked.first + asked.paths):
        if number in found:
            continue
        found[number] = list(outcomes(number, joints))
        if asked.keep:
            with asked.keep.open("a", encoding="utf-8") as file:
                row = {"path": number, "increments": [asdict(one) for one in found[number]]}
                file.write(json.dumps(row) + "\n")
    sys.stdout.write("\n".join(lines_of(found)) + "\n")


def reason(number: int) -> str:
    """Return what is known of solutions of the increment of a path of few points refused."""
    rng = np.random.default_rng(number)
    if rng.random() < 0.5:
        return f"path {number} is one of the lap joint"
    _, plain, relatives = small_path(rng)
    contact, S = plain.contact, plain.S
    (law,), slip, done = contact.laws.values(), np.zeros((2, contact.n_points)), 0
    try:
        for here, _ in walked(solver_of(plain), relatives):
            slip, done = here.slip, done + 1
    except ConvergenceError:
        pass
    else:
        return f"path {number} is solved"
    forces = []
    for penalty in 10.0 ** np.arange(8, 13):
        laws = {"joint": Coulomb(Penalty(penalty), law.friction, penalty)}
        soft = AugmentedContact(contact=replace(contact, laws=laws), between=ByCompliance(S))
        try:
            found = soft.solve(relatives[done], contact.offset(slip))
        except ConvergenceError:
            forces.append("refused")
        else:
            forces.append(f"{np.abs(found.forces).max():.1e}")
    gap = contact.free_slack(relatives[done], slip)[0]
    return f"path {number}: room {room(plain, gap):.2g}, forces {', '.join(forces)}"


def room(solver: NaturalMap, gap: np.ndarray) -> float:
    """Return by how much of the largest gap all of them can be open, at most one."""
    sizes, shapes = np.linalg.eigh(solver.S)
    moved = (solver.G @ shapes[:, sizes > 1e-13 * sizes.max()])[: len(gap)]
    n = moved.shape[1]
    found = linprog(
        np.append(np.zeros(n), -1.0),
        A_ub=np.column_stack([-moved, np.ones(len(gap))]),
        b_ub=gap / np.abs(gap).max(),
        bounds=[(None, None)] * n + [(None, 1.0)],
    )
    return float(-found.fun)


def kept(file: Path | None) -> dict[int, list[Outcome]]:
    """Return what became of the paths in a file."""
    if file is None or not file.exists():
        return {}
    rows = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    return {row["path"]: [Outcome(**one) for one in row["increments"]] for row in rows}


def lines_of(paths: dict[int, list[Outcome]]) -> list[str]:
    """Return tables and reasons."""
    found = [one for path in paths.values() for one in path]
    solved = [one for one in found if not one.refused]
    lines = [f"{len(found)} increments of {len(paths)} paths up to number {max(paths)}\n"]
    lines.append("| Newton steps | " + " | ".join(f"≤ {b}" for b in BOUNDS) + " | more |")
    lines.append("|---" * (len(BOUNDS) + 2) + "|")
    for kind in ("lap joint", "few points"):
        steps = [one.iterations for one in solved if one.kind == kind]
        classes = Counter(sum(step > bound for bound in BOUNDS) for step in steps)
        counts = " | ".join(str(classes[i]) for i in range(len(BOUNDS) + 1))
        lines.append(f"| {kind} | {counts} |")
    halved = sum(one.parts for one in solved)
    worst = max((one.residual for one in solved), default=0.0)
    lines.append(f"\nhalved: {halved}; refused: {len(found) - len(solved)}; residual {worst:.1e}")
    return lines + [
        f"path {number}, {one.kind}: {one.refused}"
        for number, path in sorted(paths.items())
        for one in path
        if one.refused
    ]


if __name__ == "__main__":
    main()
