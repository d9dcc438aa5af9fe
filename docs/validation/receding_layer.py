"""Two elastic layers pressed together by strip loads against a semi-analytic solution.

``python docs/validation/receding_layer.py`` prints the table (20 s). Mesh, loads and the
semi-analytic pressures are those of tests/data/receding_layer (see tests/data/README.md).
"""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import faying as fy
from faying._typing import Matrix, Vector
from faying.model.assembly import Assembly, Spring, Support
from faying.model.cells import CellBlock
from faying.model.mesh import Mesh

DATA = Path(__file__).parents[2] / "tests" / "data" / "receding_layer"
GROUND = 1.0  # [N/mm]; holds the upper layer, and carries nothing as the load is balanced


def layers(element: str) -> Assembly:
    """Describe the mesh and its supports."""
    with np.load(DATA / "mesh.npz") as file:
        data = dict(file)
    cells, fixed = data["elems"], data["fixed_dofs0"]
    block = CellBlock(
        kind="hex8",
        nodes=cells,
        ids=np.arange(1, len(cells) + 1),
        properties=1 + data["node_sub"][cells[:, 0]],
    )
    mesh = Mesh(nodes=data["nodes"], node_ids=np.arange(1, len(data["nodes"]) + 1), blocks=(block,))
    steel = fy.Material(youngs_modulus=210e3, poissons_ratio=0.29, density=7.82e-9)
    top = int(np.argmax(data["nodes"][:, 2] - data["nodes"][:, 0]))
    return Assembly(
        mesh=mesh,
        materials={1: steel, 2: steel},
        element=element,
        supports=tuple(
            Support(id=1 + c, nodes=fixed[fixed % 3 == c] // 3, components=(c,)) for c in range(3)
        ),
        springs=(Spring(id=10_000, ends=((top, 2),), stiffness=GROUND),),
    )


def loads(model: fy.Model) -> Vector:
    """Return the strip loads at the free degrees of freedom."""
    with np.load(DATA / "mesh.npz") as file:
        nodal = np.hstack([file["load"], np.zeros_like(file["load"])])
    force: Vector = model.dofs.transformation.T @ nodal.ravel()
    return force


def pressures(element: str, quadrature: str, penalty: float) -> tuple[Matrix, Vector]:
    """Return contact points and pressures from the bare contact problem."""
    spec = fy.InterfaceSpec(name="layers", penalty=1e6, quadrature=quadrature)
    model = fy.build_model(layers(element), interfaces=(spec,))
    model = replace(model, interfaces={"layers": model.interfaces["layers"].with_penalty(penalty)})
    factor = fy.factorize(model.K)
    contact = model.contact
    H = fy.interface_compliance(model, factor) + np.diag(contact.flexibility)
    g_free = contact.initial_gap + contact.gap_operator @ factor.solve(loads(model))
    solved = fy.contact_problem(H, g_free).solve()
    return model.interfaces["layers"].points, solved.forces / contact.weights


def contact_length(x: Vector, pressure: Vector) -> float:
    """Interpolate linearly between the last closed point and where pressure would vanish."""
    order = np.argsort(x)
    x, pressure = x[order], pressure[order]
    last = int(np.flatnonzero(pressure > 0)[-1])
    before = int(np.flatnonzero(x < x[last] - 1e-9)[-1])
    slope = (pressure[before] - pressure[last]) / (x[last] - x[before])
    return float(x[last] + pressure[last] / slope)


def main() -> None:
    """Print the table."""
    exact = json.loads((DATA / "case.json").read_text())
    write = sys.stdout.write
    write(
        "| element, rule, law | peak [MPa] | exact | half length [mm] | exact | rms over peak |\n"
    )
    write("|---|---|---|---|---|---|\n")
    with np.load(DATA / "result.npz") as file:
        profiles = dict(file)
    for element in ("incompatible", "standard"):
        for quadrature, penalty, law in (
            ("gauss", 1e6, "semi"),
            ("nodal", 1e6, "semi"),
            ("nodal", np.inf, "rigid"),
        ):
            points, pressure = pressures(element, quadrature, penalty)
            x = points[:, 0]
            reference = np.interp(x, profiles[f"x_{law}"], profiles[f"p_{law}"], right=0.0)
            rms = np.sqrt(((pressure - reference) ** 2).mean()) / reference.max()
            label = "hard" if law == "rigid" else "c_n = 1e6"
            write(
                f"| {element}, {quadrature}, {label} | {pressure.max():.2f} "
                f"| {exact[f'p0_{law}']:.2f} | {contact_length(x, pressure):.2f} "
                f"| {exact[f'a_{law}']:.2f} | {rms:.2%} |\n"
            )


if __name__ == "__main__":
    main()
