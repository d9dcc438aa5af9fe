"""How often increments with friction are solved, and in how many Newton steps.

    python benchmarks/friction_robustness.py [PATHS [FIRST [compiled]]]

Paths of five increments, numbered: PATHS of them from number FIRST on, so that a long run can be
done in pieces. Half are of a coarse lap joint, half of a few points with any compliance, normals
and gaps; μ up to 1, c_n from 1e4 to 1e9 N/mm³ or hard. Prints a table of Newton steps, what was
refused and why, and the worst natural residual, computed by the law written out again; of
compiled increments also how many were left to the solver in Python.
"""

import sys
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from random_friction import Joints, outcomes

BOUNDS = (5, 10, 20, 40, 80, 160)
"""Upper ends of the classes of Newton steps."""


def main() -> None:
    """Solve the paths asked for and print what became of them."""
    paths = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    joints = Joints()
    compiled = "compiled" in sys.argv
    numbers = range(first, first + paths)
    found = [one for index in numbers for one in outcomes(index, joints, compiled=compiled)]
    solved = [one for one in found if not one.refused]
    lines = [f"{len(found)} increments of paths {first} to {first + paths - 1}\n"]
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
    if compiled:
        left = Counter(one.kind for one in solved if one.left)
        lines.append(f"left to Python: {dict(left)}")
    reasons = Counter((one.kind, one.refused[:160]) for one in found if one.refused)
    lines += [f"{count} × {kind}: {reason}" for (kind, reason), count in reasons.most_common(8)]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
