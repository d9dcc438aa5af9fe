"""Agreement with two other programs on the same cantilever, mesh, element and quadrature.

``python docs/validation/reference_cantilever.py`` prints the table (10 s). The references and how
they were made are described in tests/data/README.md.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import faying as fy
from faying._typing import Indices, Matrix
from faying.joint.sticking import sticking_stiffness

DATA = Path(__file__).parents[2] / "tests" / "data" / "lap_joint"
RULES = {"gauss": "gauss2", "nodal": "lobatto"}
LC2 = {"tip.Fz": -500.0, "tip.Mx": 20e3}
LOADS = {"P0": {}, "P": {}, "LC1": {"tip.Fz": -500.0}, "LC2": LC2}
AXIAL = 296880.50576423545  # EA/L of the bolt [N/mm], case.json
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


def joint(quadrature: str) -> fy.Model:
    """Build the structure of the reference; pretension is an initial force of 8000 N."""
    model = fy.lap_joint(
        hole_radius=None,
        element="standard",
        washer_radius=4.6,
        shear_flexible=False,
        bolt_mass=False,
        penalty=1e6,
        quadrature=quadrature,
        damping=fy.Rayleigh(alpha=160.0, beta=5e-7),
    )
    return model.with_bolt_forces({"bolt": 8000.0})


def node_map(model: fy.Model, mesh: dict[str, Matrix]) -> Indices:
    """Return our node at each node of the reference; plates share places at the interface."""
    body, nodes = model.assembly.mesh.bodies, model.assembly.mesh.nodes
    found = np.empty(len(mesh["nodes"]), dtype=np.int64)
    for plate in (0, 1):
        ours, theirs = np.flatnonzero(body == plate), np.flatnonzero(mesh["node_sub"] == plate)
        found[theirs] = ours[cKDTree(nodes[ours]).query(mesh["nodes"][theirs])[1]]
    return found


def with_their_sticking(model: fy.Model, mesh: dict[str, Matrix], order: Indices) -> fy.Model:
    """Tie the pairs that the reference ties."""
    interface = model.interfaces["joint"]
    tied = {tuple(row) for row in order[mesh["pairs"][mesh["stick"]]].tolist()}
    pairs = np.array([tuple(row) in tied for row in interface.pairs.tolist()])
    springs = sticking_stiffness(interface, pairs, 1e6)
    return model.with_stiffness(springs, {"joint": pairs})


def at_our_points(mesh: dict[str, Matrix], points: Matrix, pressure: Matrix, rule: str) -> Matrix:
    """Reorder reference pressures to our contact points."""
    faces = mesh["nodes"][mesh["pairs"][mesh["faces"], 0]]
    places = CORNERS if rule == "lobatto" else mesh["quad_gauss2"]
    shape = np.prod(1 + CORNERS[None] * places[:, None], axis=2) / 4
    theirs = np.einsum("qn,fnd->fqd", shape, faces).reshape(-1, 3)
    return pressure[cKDTree(theirs).query(points)[1]]


def static_rows(quadrature: str, mesh: dict[str, Matrix]) -> Iterator[str]:
    """Compare the static cases."""
    loose, rule = joint(quadrature), RULES[quadrature]
    order = node_map(loose, mesh)
    tied = with_their_sticking(loose, mesh, order)
    for case, forces in LOADS.items():
        model = loose if case == "P0" else tied
        ours, theirs = fy.solve_static(model, fy.Load(forces)), np.load(DATA / f"{case}.npz")
        u = theirs[f"u__{rule}"]
        error = np.abs(model.dofs.nodal(ours.states)[order, :3] - u).max() / np.abs(u).max()
        aux = theirs[f"aux__{rule}"]
        bolt = 8000.0 + AXIAL * (aux[0, 2] - aux[2, 2])
        interface = model.interfaces["joint"]
        p = at_our_points(mesh, interface.points, theirs[f"p_quad__{rule}"], rule)
        p_error = np.abs(ours.pressure - p).max() / p.max()
        yield (
            f"| {case}, {quadrature} | {error:.0e} | {abs(ours.bolt_force('bolt') / bolt - 1):.0e} "
            f"| {p_error:.0e} | {p.max():.2f} | {ours.bolt_force('bolt'):.1f} "
            f"| {ours.contact_force():.1f} |\n"
        )


def step_row(mesh: dict[str, Matrix]) -> str:
    """Compare the LC2 step response, implicit Euler, 620 steps of 1e-5 s."""
    loose = joint("gauss")
    model = with_their_sticking(loose, mesh, node_map(loose, mesh))
    theirs = np.load(DATA / "LC2_step_implicit_euler_dt1e-05.npz")
    ours = fy.solve_transient(model, fy.Load(LC2), step=1e-5, duration=6.2e-3)
    tip = (
        np.abs(ours.displacement("tip")[:, :3] - theirs["tip"]).max() / np.abs(theirs["tip"]).max()
    )
    peak = np.abs(ours.max_pressure - theirs["pqmax"]).max() / theirs["pqmax"].max()
    force = np.abs(ours.contact_force() / theirs["Fc"] - 1).max()
    return (
        f"\nLC2 step: tip {tip:.0e} of its largest, peak pressure over time {peak:.0e}, "
        f"contact force {force:.0e}; largest pressure {ours.max_pressure.max():.1f} MPa.\n"
    )


def main() -> None:
    """Print the table."""
    with np.load(DATA / "mesh.npz") as file:
        mesh = dict(file)
    write = sys.stdout.write
    write("| case, rule | displacement | bolt force | point pressure | peak [MPa] | bolt [N] ")
    write("| contact [N] |\n|---|---|---|---|---|---|---|\n")
    for quadrature in RULES:
        for row in static_rows(quadrature, mesh):
            write(row)
    write(step_row(mesh))


if __name__ == "__main__":
    main()
