"""Matrix Market and MATLAB files, read by SciPy in a process of its own.

SciPy's readers are compiled and trust the file: damaged ones ended the process by writes beyond its
arrays (seen with SciPy 1.17).
"""

from pathlib import Path

import scipy.sparse as sp

from faying._typing import SparseMatrix
from faying.files.contents import check_room, file_size
from faying.io.isolated import read_isolated

_SAVED = """
parts = {}
for name, value in matrices.items():
    entries = sp.coo_array(value)
    parts |= {name + "/row": entries.row, name + "/col": entries.col, name + "/data": entries.data}
    parts[name + "/shape"] = np.array(value.shape)
np.savez(sys.argv[2], **parts)
"""

_MARKET = """
import sys
import numpy as np, scipy.io, scipy.sparse as sp
rows, columns, _, layout, field, symmetry = scipy.io.mminfo(sys.argv[1])
if field not in ("real", "integer", "unsigned-integer"):
    sys.exit(f"it is {field} {symmetry}; expected real or integer, general or symmetric")
if layout == "array":  # of one that is cut off SciPy takes the remainder as zero
    sides = {"general": 2 * columns, "symmetric": rows + 1, "skew-symmetric": rows - 1}
    with open(sys.argv[1]) as file:
        lines = sum(1 for line in file if line.strip() and line[0] != "%") - 1
    if 2 * lines != rows * sides[symmetry]:
        sys.exit(f"it is a {symmetry} matrix {rows} x {columns} and holds {lines} numbers")
matrices = {"": scipy.io.mmread(sys.argv[1])}
"""

_MATLAB = """
import sys
import numpy as np, scipy.io, scipy.sparse as sp
try:
    variables = scipy.io.loadmat(sys.argv[1])
except NotImplementedError:
    sys.exit("it is a MATLAB 7.3 file; save it in MATLAB with save(..., '-v7')")
numbers = {
    name: value
    for name, value in variables.items()
    if name[:2] != "__" and getattr(value, "ndim", 0) == 2 and value.dtype.kind in "fiubc"
}
matrices = {name: value for name, value in numbers.items() if min(value.shape) > 1} or numbers
"""


def read_market_matrix(path: Path, what: str) -> SparseMatrix:
    """Read a real matrix, of coordinates or an array."""
    return _read(_MARKET, path, what)[""]


def read_matlab_matrices(path: Path, what: str) -> dict[str, SparseMatrix]:
    """Read the matrices of a MATLAB file up to version 7; vectors and numbers where it has none.

    Variables of other classes are left out.
    """
    return _read(_MATLAB, path, what)


def _read(script: str, path: Path, what: str) -> dict[str, SparseMatrix]:
    check_room(file_size(path), path)
    parts = read_isolated(script + _SAVED, path, what)
    names = [key.removesuffix("/shape") for key in parts if key.endswith("/shape")]
    return {
        name: sp.coo_array(
            (parts[f"{name}/data"], (parts[f"{name}/row"], parts[f"{name}/col"])),
            shape=tuple(parts[f"{name}/shape"].tolist()),
        )
        for name in names
    }
