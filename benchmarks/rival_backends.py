"""faying's factorization beside the other sparse direct solvers that pip installs as wheels.

    python3 -m venv rivals
    rivals/bin/pip install --only-binary=:all: "numpy<2" scipy python-mumps==0.0.2 cvxopt pypardiso
    python benchmarks/rival_backends.py --python rivals/bin/python

The rivals get an environment of their own, because python-mumps has wheels for NumPy 1 only. Each
factorizes the interior stiffness of the built-in joint and solves for 200 right-hand sides; medians
of interleaved repetitions, ratios over the best in the same run. One thread each.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.update(OMP_NUM_THREADS="1", MKL_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

import numpy as np
import scipy.sparse as sp

SIZES = (1.3, 0.88)
"""Element sizes [mm]: 49 k and 143 k degrees of freedom."""

RIVAL = """
import json, sys, time, warnings
warnings.simplefilter("ignore")
import numpy as np, scipy.sparse as sp
name, path = sys.argv[1:]
A = sp.csc_matrix(sp.load_npz(path))
right = np.random.default_rng(0).standard_normal((A.shape[0], 200))
start = time.perf_counter()
if name == "mumps":
    import mumps
    context = mumps.Context()
    context.set_matrix(sp.triu(A).tocoo(), symmetric=True)
    context.factor(ordering="metis")
    middle = time.perf_counter()
    x = context.solve(right)
elif name == "cvxopt":
    import cvxopt
    from cvxopt import cholmod
    lower = sp.tril(A).tocoo()
    start = time.perf_counter()
    matrix = cvxopt.spmatrix(lower.data, lower.row, lower.col, A.shape)
    cholmod.options["supernodal"] = 2
    factor = cholmod.symbolic(matrix, uplo="L")
    cholmod.numeric(matrix, factor)
    middle = time.perf_counter()
    x = cvxopt.matrix(right)
    cholmod.solve(factor, x)
    x = np.array(x)
else:
    import pypardiso
    solver = pypardiso.PyPardisoSolver(mtype=2)
    upper = sp.csr_matrix(sp.triu(A))
    start = time.perf_counter()
    solver.factorize(upper)
    middle = time.perf_counter()
    x = solver.solve(upper, right)
end = time.perf_counter()
error = float(abs(A @ x - right).max() / abs(right).max())
print(json.dumps([middle - start, end - middle, error]))
"""

write = sys.stdout.write


def main() -> None:
    """Print one table per size."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--python", type=Path, required=True, help="of the rivals' environment")
    parser.add_argument("--sizes", type=float, nargs="+", default=SIZES)
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    for size in options.sizes:
        compare(size, options.python, options.repeat)
    write(f"\nload average {os.getloadavg()[0]:.1f} at the end\n")


def compare(size: float, python: Path, repeat: int) -> None:
    """Time every solver on the matrix of one element size."""
    import faying as fy

    structure = fy.lap_joint(element_size=size).structure
    A = structure.K[structure.interior][:, structure.interior].tocsr()
    times: dict[str, list[list[float]]] = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "matrix.npz"
        sp.save_npz(path, sp.csc_matrix(A))
        for _ in range(repeat):
            for name in ("faying", "mumps", "cvxopt", "pypardiso"):
                found = ours(A) if name == "faying" else rival(python, name, path)
                times.setdefault(name, []).append(found)
    totals = {name: statistics.median(a + b for a, b, _ in runs) for name, runs in times.items()}
    best = min(totals.values())
    write(f"\n{A.shape[0]} degrees of freedom\n\n")
    write("| solver | factorization s | 200 back-solves s | sum over the best | residual |\n")
    write("|---|---|---|---|---|\n")
    for name, runs in times.items():
        factor, solve, error = (statistics.median(values) for values in zip(*runs, strict=True))
        ratio = totals[name] / best
        write(f"| {name} | {factor:.2f} | {solve:.2f} | {ratio:.2f} | {error:.0e} |\n")
    sys.stdout.flush()


def ours(A: sp.csr_array) -> list[float]:
    """Time faying's default backend."""
    from faying.linalg.factorization import factorize

    right = np.random.default_rng(0).standard_normal((A.shape[0], 200))
    start = time.perf_counter()
    factor = factorize(A)
    middle = time.perf_counter()
    x = factor.solve(right)
    end = time.perf_counter()
    return [middle - start, end - middle, float(np.abs(A @ x - right).max() / np.abs(right).max())]


def rival(python: Path, name: str, path: Path) -> list[float]:
    """Time another solver in its own process."""
    done = subprocess.run(
        [str(python), "-c", RIVAL, name, str(path)], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        sys.exit(f"{name} failed:\n{done.stderr[-1000:]}")
    found: list[float] = json.loads(done.stdout)
    return found


if __name__ == "__main__":
    main()
