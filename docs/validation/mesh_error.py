"""How near the estimate of the mesh's error comes to what a finer mesh shows.

``python docs/validation/mesh_error.py`` prints the table (two minutes). With a folder as argument
it adds two pipe flanges, meshed there by gmsh (``pip install gmsh``; five more minutes):

    python docs/validation/mesh_error.py FOLDER
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

import faying as fy
from faying.assessment.mesh_error import MeshError
from faying.interface.interface import Interface

ROOT = Path(__file__).parents[2]
sys.path += [str(ROOT / "tests" / "verification"), str(ROOT / "benchmarks")]

import test_hertz  # noqa: E402
import test_hertz_sphere  # noqa: E402

LOADS = {
    "preload": fy.Load({}),
    "LC1": fy.Load({"tip.Fz": -500.0}),
    "LC2": fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}),
}
FLANGE = {
    "preload": fy.Load({}),
    "bending": fy.Load({"end.My": 3e6}),
}


def against(
    estimate: MeshError, interface: Interface, pressure: np.ndarray, finer: np.ndarray
) -> str:
    """Return estimates, truths and their ratios as cells.

    Parameters
    ----------
    finer : (n_point,)
        Pressures of the finer mesh, or exact ones, at the points of the coarse one.
    """
    largest, weights = pressure.max(), interface.weights
    error = np.abs(pressure - finer) / largest
    field = np.sqrt(weights @ error**2 / weights[pressure > 0].sum())
    true, said = (field, error.max()), (estimate.field, estimate.largest)
    cells = [
        f"{100 * s:.2g} / {100 * t:.2g} = {s / t:.2g}" for s, t in zip(said, true, strict=True)
    ]
    return f"{largest:.1f} | {' | '.join(cells)}"


def at(points: np.ndarray, pressure: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Interpolate a field of the finer mesh, linear between its points in their plane."""
    centre = points.mean(axis=0)
    plane = np.linalg.svd(points - centre, full_matrices=False)[2][:2].T
    known, wanted = (points - centre) @ plane, (places - centre) @ plane
    values = LinearNDInterpolator(known, pressure)(wanted)
    outside = np.isnan(values)
    values[outside] = NearestNDInterpolator(known, pressure)(wanted[outside])
    return values


def refined(
    name: str, coarse: fy.Model, fine: fy.Model, loads: dict[str, fy.Load]
) -> Iterator[str]:
    """Yield a row for every load of a joint on two meshes."""
    own, other = coarse.interfaces["joint"], fine.interfaces["joint"]
    for case, load in loads.items():
        solution = fy.solve_static(coarse, load)
        better = fy.solve_static(fine, load)
        finer = at(other.points, better.pressure, own.points)
        estimate = fy.mesh_error(coarse, solution)["joint"]
        cells = against(estimate, own, solution.pressure, finer)
        yield f"| {name}, {case} | {cells} |"


def lap_joints() -> Iterator[str]:
    """Yield the rows of the cantilever without a hole, whose finer meshes are the same body."""
    for name, coarse, fine, options in (
        ("hex8, 5 to 1.25 mm", 5.0, 1.25, {}),
        ("hex8, 2.5 to 1.25 mm", 2.5, 1.25, {}),
        ("tet10, 10 to 2.5 mm", 10.0, 2.5, {"shape": "tet10"}),
        ("tet10, 5 to 2.5 mm", 5.0, 2.5, {"shape": "tet10"}),
        ("hex20, 5 to 2.5 mm", 5.0, 2.5, {"shape": "hex20"}),
        ("tet4, 5 to 2.5 mm", 5.0, 2.5, {"shape": "tet4"}),
        ("hex8, hard, nodal, 5 to 1.25 mm", 5.0, 1.25, {"penalty": "hard"}),
        ("hex8, arch, 5 to 1.25 mm", 5.0, 1.25, {"curvature": 0.004}),
    ):
        models = [
            fy.preload(
                fy.lap_joint(**{"penalty": 8.4e5, **options, "element_size": h}, hole_radius=None),
                {"bolt": 10e3},
            )
            for h in (coarse, fine)
        ]
        yield from refined(f"cantilever, {name}", *models, LOADS)


def hertz() -> Iterator[str]:
    """Yield the rows of smooth curved contact, against the closed forms."""
    for penalty, rule in (("auto", "penalty, gauss"), ("hard", "hard, nodal")):
        for per_width in (4, 16):
            place, _, solution = test_hertz.solve(1 / per_width, penalty)
            exact = test_hertz.HERTZ
            yield _closed(
                f"Hertz, line, {rule}, {per_width} per half width",
                solution, exact.pressure(place),
            )  # fmt: skip
        blocks, solution = test_hertz_sphere.solve(1 / 4, penalty)
        radius = np.hypot(*blocks.joint.points[:, :2].T)
        exact = test_hertz_sphere.HERTZ
        yield _closed(
            f"Hertz, sphere, {rule}, 4 per radius",
            solution, exact.pressure(radius),
        )  # fmt: skip


def _closed(name: str, solution: fy.Solution, exact: np.ndarray) -> str:
    model = solution.system
    estimate = fy.mesh_error(model, solution)["joint"]
    cells = against(estimate, model.interfaces["joint"], solution.pressure, exact)
    return f"| {name} | {cells} |"


def flanges(folder: Path) -> Iterator[str]:
    """Yield the rows of unstructured tet10 on a ring under six bolts."""
    from pipe_flange import pipe_flange

    models = [
        fy.preload(joint.with_penalty(1e6), dict.fromkeys(joint.bolts, 40000.0))
        for joint in (pipe_flange(folder / f"flange{h:g}.msh", h) for h in (20.0, 10.0))
    ]
    yield from refined("pipe flange, tet10, 20 to 10 mm", *models, FLANGE)


def main() -> None:
    """Print the table: estimate / truth = ratio, errors in percent of the peak."""
    write = sys.stdout.write
    write("| joint | peak [MPa] | field [%] | largest [%] |\n|---|---|---|---|\n")
    folders = [Path(given) for given in sys.argv[1:]]
    for rows in (lap_joints(), hertz(), *map(flanges, folders)):
        for row in rows:
            write(row + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
