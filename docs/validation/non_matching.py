"""LC2 on lap joints whose plates match and on some whose plates do not.

Prints a table of joints whose meshes do not match.

    OMP_NUM_THREADS=1 python docs/validation/non_matching.py
"""

import sys
from typing import Any

import faying as fy

LOAD = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
CASES: tuple[dict[str, Any], ...] = (
    {"element_size": 5.0},
    {"element_size": 5.0, "meshes": "non-matching"},
    {"element_size": 5.0, "upper_element_size": 4.0},
    {"element_size": 5.0, "upper_element_size": 2.5},
    {"element_size": 2.5, "upper_element_size": 5.0},
    {"element_size": 2.5},
    {"element_size": 2.5, "upper_element_size": 10 / 3},
    {"element_size": 2.5, "upper_element_size": 2.0},
    {"element_size": 2.0, "upper_element_size": 2.5},
    {"element_size": 2.0},
)


def row(options: dict[str, Any]) -> str:
    """Solve one joint and describe it in a line of a table."""
    model = fy.lap_joint(penalty=1e5, hole_radius=None, **options)
    tight = fy.preload(model, {"bolt": 10e3})
    solution = fy.solve_static(tight, LOAD)
    joint = model.interfaces["joint"]
    lower = options["element_size"]
    upper = options.get("upper_element_size", lower)
    how = "mortar" if joint.coupling is not None else "matching"
    return (
        f"| {lower:g} / {upper:.3g} | {how} | {joint.n_points} | {solution.contact_force():.1f} | "
        f"{float(solution.bolt_force('bolt')):.1f} | {solution.displacement('tip')[2]:.5f} | "
        f"{joint.nodal_average(solution.pressure).max():.2f} |"
    )


def main() -> None:
    """Print the table."""
    lines = [
        "| elements below / above [mm] | | points | contact force [N] | bolt [N] | tip u_z [mm] | "
        "peak of nodal averages [MPa] |",
        "|---|---|---|---|---|---|---|",
        *map(row, CASES),
    ]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
