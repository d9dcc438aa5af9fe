"""Intel's Math Kernel Library, where pip has installed it: PARDISO through ctypes.

Only the functions that :mod:`faying.linalg.pardiso` calls are bound. Parameters are those of the
Developer Reference of oneMKL, "oneMKL PARDISO Parameters in Tabular Form" and "pardiso iparm
Parameter".
"""

import ctypes
import importlib.metadata
import os
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from faying._typing import Matrix
from faying.linalg.blocks import Integers
from faying.linalg.singular import NotDefiniteError

POSITIVE_DEFINITE, INDEFINITE = 2, -2
ANALYSE, FACTORIZE, SOLVE, RELEASE = 11, 22, 33, -1
NOT_ENOUGH_MEMORY = -2

REPRODUCIBLE = 2
"""Conditional numerical reproducibility, MKL_CBWR_AUTO: the same digits for equal thread numbers.

Otherwise sums of several threads are added in the order in which these end, which on a busy machine
differs from call to call.
"""


class MklError(RuntimeError):
    """PARDISO failed for a reason that the caller cannot remove."""


@cache
def load_mkl() -> Any:
    """Return MKL as a ctypes library, or None where it is not installed.

    Results have the same digits in every call with the same number of threads, unless the
    environment variable ``MKL_CBWR`` is set.
    """
    for path in _library_paths():
        try:
            if sys.platform == "win32":
                _preload(path.parent)
            library = ctypes.CDLL(str(path))
        except OSError:
            continue
        if "MKL_CBWR" not in os.environ:
            library.MKL_CBWR_Set(ctypes.c_int(REPRODUCIBLE))
        return library
    return None


def _library_paths() -> list[Path]:
    """Return paths of the run-time library, from the ``mkl`` wheel, then from conda."""
    try:
        files = importlib.metadata.files("mkl") or []
    except importlib.metadata.PackageNotFoundError:
        files = []
    libraries = [Path(str(file.locate())) for file in files if "mkl_rt" in file.name]
    folder = ("Library", "bin") if sys.platform == "win32" else ("lib",)
    libraries += sorted(Path(sys.prefix, *folder).glob("*mkl_rt*"))
    return [path for path in libraries if path.suffix != ".lib" and path.is_file()]


def _preload(folder: Path) -> None:
    """Load the libraries that mkl_rt.dll expects on the PATH, where ``folder`` is not."""
    os.add_dll_directory(str(folder))  # type: ignore[attr-defined, unused-ignore]
    for pattern in ("libiomp5md.dll", "mkl_core.*.dll", "mkl_intel_thread.*.dll"):
        for path in folder.glob(pattern):
            ctypes.CDLL(str(path))


class PardisoHandle:
    """One matrix inside PARDISO: square blocks of its upper triangle, by block rows.

    Parameters
    ----------
    data : (n_stored, b, b)
        Factors are of its precision.
    indices, indptr
        Block columns, ascending in each block row, and the beginning of each block row.
    border
        Number of last rows that are not eliminated, for :meth:`schur_complement`. Blocks are then
        single numbers; MKL 2026 crashes in the analysis of larger ones.
    kind
        ``POSITIVE_DEFINITE``: Cholesky; ``INDEFINITE``: L D Lᵀ with pivots of Bunch and Kaufman.

    Notes
    -----
    Not safe to use from two threads at once. :meth:`release` frees the memory of PARDISO.
    """

    def __init__(
        self,
        data: npt.NDArray[Any],
        indices: Integers,
        indptr: Integers,
        border: int = 0,
        kind: int = POSITIVE_DEFINITE,
    ) -> None:
        self._kind = kind
        self._pt = np.zeros(64, dtype=np.int64)
        self._data, self._indices, self._indptr = data, indices, indptr
        self.block = int(data.shape[1])
        self.n = self.block * (len(indptr) - 1)
        self._border = border
        # PARDISO overwrites the marks by its row order, and needs this in later phases.
        self._order = np.zeros(len(indptr) - 1, dtype=np.int32)
        self._order[len(self._order) - border :] = 1
        self._parameters = parameters = np.zeros(64, dtype=np.int32)
        parameters[0] = 1  # take the following, no defaults
        parameters[1] = 2  # METIS
        parameters[9] = 13  # of pivots below 1e-13 of the matrix norm, if indefinite
        parameters[17] = -1  # report the entries of the factor
        parameters[20] = 1  # pivots of one and two rows, if indefinite
        if kind == INDEFINITE:
            parameters[7] = 2  # steps of refinement
            # Scaled and matched, for zeros on the diagonal of constraints; not of blocks.
            parameters[[10, 12]] = int(self.block == 1)
        parameters[27] = int(data.dtype == np.float32)
        # In two levels, because with a marked border the one-level analysis of MKL 2026 reads
        # 4 (n - border) bytes past an array, and crashes at the end of a page.
        parameters[23] = 1 if border else 0
        parameters[34] = 1  # indices from zero
        parameters[35] = 1 if border else 0  # the Schur complement onto the marked rows
        parameters[36] = self.block if self.block > 1 else 0
        self._call(ANALYSE)

    @property
    def precision(self) -> np.dtype[Any]:
        """Precision of the factor, of right-hand sides and of solutions."""
        return self._data.dtype

    @property
    def entries(self) -> int:
        """Number of entries of the factor, from the analysis."""
        return int(self._parameters[17]) * self.block**2

    @property
    def memory(self) -> int:
        """Bytes of the factor and its tables."""
        return 1024 * int(self._parameters[15] + self._parameters[16])

    @property
    def expected_memory(self) -> int:
        """Expected bytes of the factor and its tables, from the analysis."""
        return self.precision.itemsize * self.entries + 1024 * int(self._parameters[15])

    @property
    def peak(self) -> int:
        """Expected peak bytes of the factorization, from the analysis."""
        analysis, permanent, factor = (int(value) for value in self._parameters[14:17])
        return 1024 * max(analysis, permanent + factor)

    @property
    def negative(self) -> int:
        """Number of negative eigenvalues, from an indefinite factorization."""
        return int(self._parameters[22])

    @property
    def perturbed(self) -> int:
        """Number of pivots that were too small and were replaced."""
        return int(self._parameters[13])

    def factorize(self) -> None:
        """Compute the factor.

        Raises
        ------
        NotDefiniteError
            If a pivot is not positive.
        """
        self._call(FACTORIZE)

    def schur_complement(self) -> Matrix:
        """Return the Schur complement (border, border) after elimination of all other rows.

        Raises
        ------
        NotDefiniteError
            If a pivot is not positive.
        """
        complement = np.zeros((self._border, self._border))
        self._call(FACTORIZE, complement, complement)
        return complement

    def solve(self, right: Matrix) -> Matrix:
        """Return A⁻¹ B for B (n_block·b, k) in Fortran order, of the factor's precision."""
        solution = np.zeros_like(right, order="F")
        self._call(SOLVE, right, solution)
        return solution

    def release(self) -> None:
        """Free the factor."""
        self._call(RELEASE)

    def _call(
        self, phase: int, right: Matrix | None = None, solution: Matrix | None = None
    ) -> None:
        error = ctypes.c_int(0)
        load_mkl().pardiso(
            _address(self._pt),
            _integer(1),
            _integer(1),
            _integer(self._kind),
            _integer(phase),
            _integer(len(self._indptr) - 1),
            _address(self._data),
            _address(self._indptr),
            _address(self._indices),
            _address(self._order),
            _integer(1 if right is None else right.shape[1]),
            _address(self._parameters),
            _integer(0),
            _address(right),
            _address(solution),
            ctypes.byref(error),
        )
        if error.value == NOT_ENOUGH_MEMORY:
            message = "PARDISO ran out of memory; use a coarser mesh or a machine with more memory"
            raise MemoryError(message)
        # Documented is -4; MKL 2026 also returns -13 for matrices singular within round-off.
        if error.value and phase == FACTORIZE:
            raise NotDefiniteError
        if error.value:
            message = f"PARDISO failed in phase {phase} with error {error.value}"
            raise MklError(message)


def _address(array: npt.NDArray[Any] | None) -> ctypes.c_void_p:
    return ctypes.c_void_p(None if array is None else array.ctypes.data)


def _integer(value: int) -> Any:
    return ctypes.byref(ctypes.c_int(value))
