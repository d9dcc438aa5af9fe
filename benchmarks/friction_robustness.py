"""How often increments with friction are solved, and in how many Newton steps.

    python benchmarks/friction_robustness.py PATHS [--first NUMBER] [--compiled] [--keep FILE]

Paths of five increments, numbered. Half are of a coarse lap joint, half of a few points with any
compliance, normals and gaps; μ up to 1, c_n from 1e4 to 1e9 N/mm³ or hard. Prints a table of
Newton steps, what was refused and why, and the worst natural residual, computed by the law written
out again; of compiled increments also how many were left to the solver in Python.

With a file, what became of each path is kept there, one line each, and the tables are those of all
that it holds: 4000 paths at half a second each are done in pieces, each by the same command with
another number of the first path.
"""

import argparse
import json
import sys
from collections import Counter
from dataclasses import asdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from random_friction import Joints, Outcome, outcomes

BOUNDS = (5, 10, 20, 40, 80, 160)
"""Upper ends of the classes of Newton steps."""


def main() -> None:
    """Solve the paths asked for and print what became of them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("paths", type=int, help="how many")
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--compiled", action="store_true", help="with compiled increments")
    parser.add_argument("--keep", type=Path, help="file to add to, one line a path")
    asked = parser.parse_args()
    joints, found = Joints(), kept(asked.keep)
    for number in range(asked.first, asked.first + asked.paths):
        if number in found:
            continue
        found[number] = list(outcomes(number, joints, compiled=asked.compiled))
        if asked.keep:
            with asked.keep.open("a", encoding="utf-8") as file:
                row = {"path": number, "increments": [asdict(one) for one in found[number]]}
                file.write(json.dumps(row) + "\n")
    sys.stdout.write("\n".join(lines_of(found)) + "\n")


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
    if any(one.left for one in solved):
        left = Counter(one.kind for one in solved if one.left)
        lines.append(f"left to Python: {dict(left)}")
    return lines + [
        f"path {number}, {one.kind}: {one.refused}"
        for number, path in sorted(paths.items())
        for one in path
        if one.refused
    ]


if __name__ == "__main__":
    main()
