"""Time to couple two faces of n × n facets that do not match.

Prints the table behind docs/theory/non_matching.md.

    OMP_NUM_THREADS=1 python benchmarks/mortar.py 30 100 180
"""

import resource
import sys
import time

import numpy as np
import scipy.sparse as sp

import faying as fy
from faying.interface.mortar import build_mortar_interface, find_couplings
from faying.model.assembly import Assembly
from faying.model.dofs import DofMap
from faying.model.mesh import Mesh


def face(count: tuple[int, int], angle: float, distort: float, seed: int) -> tuple:
    """Nodes and quad4 facets of a unit square at z = 0, counter-clockwise from above."""
    lines = [np.linspace(-0.5, 0.5, n + 1) for n in count]
    x, y = (grid.ravel() for grid in np.meshgrid(*lines, indexing="ij"))
    inner = (np.abs(x) < 0.499) & (np.abs(y) < 0.499)
    shift = distort * inner * np.random.default_rng(seed).uniform(-1, 1, (2, len(x)))
    x, y = x + shift[0] / count[0], y + shift[1] / count[1]
    number = np.arange(len(x)).reshape(count[0] + 1, count[1] + 1)
    corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    c, s = np.cos(angle), np.sin(angle)
    nodes = np.column_stack([c * x - s * y, s * x + c * y, np.zeros(len(x))])
    return nodes, np.stack(corners, axis=-1).reshape(-1, 4)


def measure(n: int, angle: float, distort: float) -> None:
    """Couple two faces and print one line."""
    below, own = face((n, n), 0.0, distort, 1)
    above, other = face((round(1.1 * n) + 1, round(0.9 * n) + 1), angle, distort, 2)
    nodes = np.vstack([below, above])
    mesh = Mesh(nodes=nodes, node_ids=np.arange(1, len(nodes) + 1))
    sets = {"below": own, "above": len(below) + other[:, ::-1]}
    assembly = Assembly(mesh=mesh, face_sets=sets)
    dofs = DofMap(
        transformation=sp.eye_array(6 * len(nodes), format="csr"), free=np.arange(6 * len(nodes))
    )
    spec = fy.InterfaceSpec(
        name="joint", minus="below", plus="above", meshes="non-matching", tolerance=1e-3 / n
    )
    start = time.perf_counter()
    (coupling,) = find_couplings(assembly, spec).values()
    coupled = time.perf_counter()
    joint = build_mortar_interface(assembly, dofs, spec, coupling, 1e5)
    built = time.perf_counter()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    shape = "distorted" if distort else "regular"
    sys.stdout.write(
        f"| {len(own)} + {len(other)} | {np.degrees(angle):.0f}° {shape} | "
        f"{len(coupling.segments)} | {joint.n_points} | {coupled - start:.2f} | "
        f"{built - coupled:.2f} | {peak:.2f} |\n"
    )


def main() -> None:
    """Measure the sizes given, parallel and turned, regular and distorted."""
    sys.stdout.write(
        "| facets | plus side | triangles | points | coupling s | interface s | peak GiB |\n"
        "|---|---|---|---|---|---|---|\n"
    )
    for n in [int(argument) for argument in sys.argv[1:]] or [30, 100]:
        for angle, distort in ((0.0, 0.0), (0.3, 0.0), (0.3, 0.2)):
            measure(n, angle, distort)


if __name__ == "__main__":
    main()
