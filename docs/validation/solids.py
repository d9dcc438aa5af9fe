"""Patch tests and convergence of the solid elements.

``python docs/validation/solids.py`` prints both tables (20 s).
"""

import sys

import numpy as np
from scipy.sparse.linalg import spsolve

import faying as fy
from faying._typing import Matrix, SparseMatrix, Vector
from faying.model.assembly import Assembly
from faying.model.cells import CellBlock
from faying.model.generate import Cells, brick_grid, shaped
from faying.model.matrices import assemble_matrices
from faying.model.mesh import Mesh

KINDS = (
    ("hex8", "incompatible"),
    ("hex8", "standard"),
    ("hex20", "standard"),
    ("tet4", "standard"),
    ("tet10", "standard"),
    ("wedge6", "standard"),
    ("wedge15", "standard"),
)
STEEL = fy.Material(youngs_modulus=210e3, poissons_ratio=0.29, density=7.82e-9)
SIZE = np.array([3.0, 2.0, 4.0])


def box(kind: str, size: Vector, counts: tuple[int, int, int], distortion: float = 0.0) -> Mesh:
    """Mesh a box; inner corners move randomly by ``distortion`` cells."""
    lines = [np.linspace(0.0, length, n + 1) for length, n in zip(size, counts, strict=True)]
    bricks = brick_grid(*lines)
    inside = np.all((bricks.nodes > 1e-9) & (bricks.nodes < size - 1e-9), axis=1)
    shift = np.random.default_rng(7).uniform(-1, 1, bricks.nodes.shape) * size / counts
    moved = bricks.nodes + distortion * inside[:, None] * shift
    cells = shaped(Cells(kind="hex8", nodes=moved, cells=bricks.cells), kind)
    block = CellBlock(
        kind=kind,
        nodes=cells.cells,
        ids=np.arange(1, len(cells.cells) + 1),
        properties=np.ones(len(cells.cells), dtype=int),
    )
    return Mesh(nodes=cells.nodes, node_ids=np.arange(len(cells.nodes)), blocks=(block,))


def stiffness(mesh: Mesh, element: str, material: fy.Material) -> SparseMatrix:
    """Assemble K of the translations."""
    matrices = assemble_matrices(Assembly(mesh=mesh, materials={1: material}, element=element))
    rows = (6 * np.arange(len(mesh.nodes))[:, None] + np.arange(3)).ravel()
    return matrices.K[rows][:, rows]


def solved(K: SparseMatrix, held: Vector, given: Vector, force: Vector) -> Vector:
    """Solve with given displacements at held rows."""
    u, free = given.copy(), ~held
    right = force[free] - K[free][:, held] @ given[held]
    u[free] = spsolve(K[free][:, free].tocsc(), right)
    return u


def patch_error(kind: str, element: str) -> float:
    """Largest error of a constant strain prescribed on the surface of distorted elements."""
    mesh = box(kind, SIZE, (3, 2, 3), distortion=0.2)
    gradient = 1e-3 * np.random.default_rng(1).standard_normal((3, 3))
    exact = (mesh.nodes @ gradient.T).ravel()
    surface = np.any((mesh.nodes < 1e-9) | (mesh.nodes > SIZE - 1e-9), axis=1)
    K = stiffness(mesh, element, STEEL)
    u = solved(K, np.repeat(surface, 3), exact, np.zeros_like(exact))
    return float(np.abs(u - exact).max() / np.abs(exact).max())


def tip_ratio(kind: str, element: str, layers: int) -> float:
    """Work of the tip load of a 10 × 10 × 100 cantilever (ν = 0) over that of Timoshenko's beam."""
    length, side, modulus = 100.0, 10.0, 1000.0
    material = fy.Material(youngs_modulus=modulus, poissons_ratio=0.0, density=1.0)
    mesh = box(kind, np.array([length, side, side]), (5 * layers, layers, layers))
    held, tip = mesh.nodes[:, 0] < 1e-9, mesh.nodes[:, 0] > length - 1e-9
    force: Matrix = np.zeros((len(mesh.nodes), 3))
    force[tip, 2] = 1.0 / tip.sum()
    K = stiffness(mesh, element, material)
    u = solved(K, np.repeat(held, 3), np.zeros(force.size), force.ravel())
    bending = length**3 / (3 * modulus * side**4 / 12)
    shear = length / (5 / 6 * modulus / 2 * side**2)
    return float(u @ force.ravel() / (bending + shear))


def main() -> None:
    """Print the table."""
    write = sys.stdout.write
    write("| element | patch test | 1 layer | 2 layers | 4 layers |\n|---|---|---|---|---|\n")
    for kind, element in KINDS:
        ratios = " | ".join(f"{tip_ratio(kind, element, layers):.3f}" for layers in (1, 2, 4))
        name = f"{kind}, {element}" if kind == "hex8" else kind
        write(f"| {name} | {patch_error(kind, element):.0e} | {ratios} |\n")


if __name__ == "__main__":
    main()
