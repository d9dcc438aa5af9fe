"""What compiled increments do point by point, and LAPACK for compiled code.

numba keeps what it compiled of a file as long as that file does not change:
:mod:`.compiled_increments`, which takes these functions in, must change with this one.
"""

from typing import Any, cast

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from faying._typing import Indices, Matrix, Vector


def _called(typing_context: Any, address: Any, arguments: Any) -> Any:  # noqa: ARG001
    """Call a Fortran routine at an address with the addresses of its arguments."""
    n, unpacked = arguments.count, cast("Any", cgutils).unpack_tuple

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        kind = ir.FunctionType(ir.VoidType(), [ir.IntType(64)] * n)
        routine = builder.inttoptr(values[0], kind.as_pointer())
        builder.call(routine, unpacked(builder, values[1], n))
        return context.get_dummy_value()

    return types.void(types.uint64, arguments), generate


call: Any = intrinsic(_called)


@numba.njit(cache=True)
def factorize(getrf: int, matrix: Matrix, pivots: Any) -> bool:
    """Factorize a matrix in place, its transpose for LAPACK; say whether it is regular."""
    sizes = np.array([len(matrix), 0], dtype=np.int32)
    size = sizes.ctypes.data
    call(
        getrf,
        (size, size, matrix.ctypes.data, size, pivots.ctypes.data, sizes[1:].ctypes.data),
    )
    return bool(sizes[1] == 0)


@numba.njit(cache=True)
def substitute(getrs: int, transposed: Matrix, matrix: Matrix, pivots: Any, right: Matrix) -> None:
    """Solve in place for each row of right sides."""
    sizes = np.array([len(matrix), len(right), 0], dtype=np.int32)
    size = sizes.ctypes.data
    call(
        getrs,
        (
            transposed.ctypes.data,
            size,
            sizes[1:].ctypes.data,
            matrix.ctypes.data,
            size,
            pivots.ctypes.data,
            right.ctypes.data,
            size,
            sizes[2:].ctypes.data,
        ),
    )


@numba.njit(cache=True)
def slopes(trial: Matrix, friction: Vector, slope: Matrix) -> None:
    """Write the derivative (n_point, 9) of what is admissible."""
    slope[:] = 0.0
    for p in range(trial.shape[1]):
        normal = trial[0, p]
        if not normal > 0.0:
            continue
        size, limit = np.hypot(trial[1, p], trial[2, p]), friction[p] * normal
        slope[p, 0] = 1.0
        if size <= limit and limit > 0.0:
            slope[p, 4] = 1.0
            slope[p, 8] = 1.0
        elif size > 0.0:
            a, b, held = trial[1, p] / size, trial[2, p] / size, limit / size
            slope[p, 3], slope[p, 6] = friction[p] * a, friction[p] * b
            slope[p, 4], slope[p, 8] = held * (1.0 - a * a), held * (1.0 - b * b)
            slope[p, 5] = slope[p, 7] = -held * a * b


@numba.njit(cache=True)
def residual(trial: Matrix, x: Matrix, friction: Vector, wrong: Matrix) -> tuple[float, float]:
    """Write F of (F1); return its norm, and the largest of it over the largest force."""
    total, most, strongest = 0.0, 0.0, 0.0
    for p in range(x.shape[1]):
        normal = max(trial[0, p], 0.0)
        size, limit = np.hypot(trial[1, p], trial[2, p]), friction[p] * normal
        cut = limit / size if size > limit else 1.0
        wrong[0, p] = x[0, p] - normal
        wrong[1, p] = x[1, p] - (cut * trial[1, p] if normal > 0.0 else 0.0)
        wrong[2, p] = x[2, p] - (cut * trial[2, p] if normal > 0.0 else 0.0)
        for a in range(3):
            total += wrong[a, p] * wrong[a, p]
            most = max(most, abs(wrong[a, p]))
            strongest = max(strongest, abs(x[a, p]))
    if not total < np.inf:
        return np.inf, np.inf
    return np.sqrt(total), most / max(strongest, most) if most > 0.0 else 0.0


@numba.njit(cache=True, error_model="numpy")
def local(slope: Vector, p: int, r: Matrix, c: Matrix, inverse: Vector, K: Vector) -> None:
    """Write A⁻¹ and K = A⁻¹ J r of a point."""
    A = np.empty(9)
    for i in range(3):
        for j in range(3):
            A[3 * i + j] = slope[3 * i + j] * (r[j, p] * c[j, p] - 1.0) + (1.0 if i == j else 0.0)
    inverse[0] = A[4] * A[8] - A[5] * A[7]
    inverse[1] = A[2] * A[7] - A[1] * A[8]
    inverse[2] = A[1] * A[5] - A[2] * A[4]
    inverse[3] = A[5] * A[6] - A[3] * A[8]
    inverse[4] = A[0] * A[8] - A[2] * A[6]
    inverse[5] = A[2] * A[3] - A[0] * A[5]
    inverse[6] = A[3] * A[7] - A[4] * A[6]
    inverse[7] = A[1] * A[6] - A[0] * A[7]
    inverse[8] = A[0] * A[4] - A[1] * A[3]
    size = A[0] * inverse[0] + A[1] * inverse[3] + A[2] * inverse[6]
    for i in range(9):
        inverse[i] /= size
    for i in range(3):
        for j in range(3):
            total = 0.0
            for k in range(3):
                total += inverse[3 * i + k] * slope[3 * k + j]
            K[3 * i + j] = total * r[j, p]


@numba.njit(cache=True)
def interpolate(columns: Indices, values: Matrix, pairs: Vector, points: Matrix) -> None:
    """Write G u (3, n_point)."""
    n = points.shape[1]
    for a in range(3):
        for p in range(n):
            total = 0.0
            for j in range(columns.shape[1]):
                total += values[a * n + p, j] * pairs[columns[a * n + p, j]]
            points[a, p] = total


@numba.njit(cache=True)
def share_out(columns: Indices, values: Matrix, points: Matrix, pairs: Vector) -> None:
    """Write Gᵀ x (n_relative,)."""
    n = points.shape[1]
    pairs[:] = 0.0
    for a in range(3):
        for p in range(n):
            force = points[a, p]
            if force != 0.0:
                for j in range(columns.shape[1]):
                    pairs[columns[a * n + p, j]] += values[a * n + p, j] * force


@numba.njit(cache=True)
def blockwise(blocks: Matrix, vectors: Matrix, factor: float, result: Matrix) -> None:
    """Add blocks (n_point, 9) times vectors (3, n_point) times a factor."""
    for p in range(len(blocks)):
        for a in range(3):
            total = 0.0
            for b in range(3):
                total += blocks[p, 3 * a + b] * vectors[b, p]
            result[a, p] += factor * total
