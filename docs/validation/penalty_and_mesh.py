"""What penalty, quadrature and mesh do to the pressures of the full model.

``python docs/validation/penalty_and_mesh.py`` prints three tables (two minutes).
"""

import sys

import numpy as np

import faying as fy

LC2 = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
PENALTIES = (1e4, 1e5, 8.4e5, 1e7, 1e8, np.inf)


def tightened(model: fy.Model) -> fy.Model:
    """Bring the bolt to its force, without a sticking area that would depend on the pressure."""
    return fy.preload(model, {"bolt": 10e3})


def penalty_rows() -> list[str]:
    """LC2 with nodal quadrature, against hard contact at the same points."""
    base = fy.lap_joint(quadrature="nodal")
    hard = fy.solve_static(tightened(base.with_penalty(np.inf)), LC2)
    rows = []
    for penalty in PENALTIES:
        run = fy.solve_static(tightened(base.with_penalty(penalty)), LC2)
        error = np.abs(fy.relative_error(run.pressure, hard.pressure))
        name = "hard" if np.isinf(penalty) else f"{penalty:.2g}"
        rows.append(
            f"| {name} | {run.max_pressure:.2f} | {error.max():.2%} "
            f"| {run.max_penetration * 1e3:.2g} | {run.open_fraction():.3f} "
            f"| {run.displacement('tip')[2]:.5f} | {run.iterations} |\n"
        )
    return rows


def quadrature_rows() -> list[str]:
    """LC2 at c_n = 10 E/h with several rules."""
    rows = []
    for rule, order in (("nodal", None), ("gauss", 2), ("gauss", 3), ("gauss", 4), ("gauss", 6)):
        model = tightened(fy.lap_joint(quadrature=rule, order=order))
        run = fy.solve_static(model, LC2)
        average = model.interfaces["joint"].nodal_average(run.pressure).max()
        rows.append(
            f"| {rule}{f' {order}' if order else ''} | {model.contact.n_points} "
            f"| {run.max_pressure:.2f} | {average:.2f} | {run.open_fraction():.3f} "
            f"| {run.displacement('tip')[2]:.5f} |\n"
        )
    return rows


def mesh_rows() -> list[str]:
    """LC2 on finer meshes without a hole, one penalty."""
    rows = []
    for size in (5.0, 2.5, 5 / 3, 1.25):
        model = tightened(fy.lap_joint(element_size=size, hole_radius=None, penalty=8.4e5))
        run = fy.solve_static(model, LC2)
        average = model.interfaces["joint"].nodal_average(run.pressure).max()
        rows.append(
            f"| {size:.3g} | {model.K.shape[0]} | {model.contact.n_points} "
            f"| {run.max_pressure:.1f} | {average:.1f} | {run.open_fraction():.3f} "
            f"| {run.displacement('tip')[2]:.4f} |\n"
        )
    return rows


def main() -> None:
    """Print the tables."""
    write = sys.stdout.write
    write("| c_n [N/mm³] | peak [MPa] | largest error to hard | penetration [µm] | open area ")
    write("| tip u_z [mm] | iterations |\n|---|---|---|---|---|---|---|\n")
    write("".join(penalty_rows()))
    write("\n| rule | points | peak at points [MPa] | peak of nodal averages | open area ")
    write("| tip u_z [mm] |\n|---|---|---|---|---|---|\n")
    write("".join(quadrature_rows()))
    write("\n| element [mm] | dofs | points | peak at points [MPa] | peak of nodal averages ")
    write("| open area | tip u_z [mm] |\n|---|---|---|---|---|---|---|\n")
    write("".join(mesh_rows()))


if __name__ == "__main__":
    main()
