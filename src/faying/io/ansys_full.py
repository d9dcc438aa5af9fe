"""Ansys ``.full``: assembled mass and stiffness, read by ansys-mapdl-reader."""

from pathlib import Path

import numpy as np
import scipy.sparse as sp

from faying.exceptions import refuse
from faying.io.isolated import read_isolated
from faying.io.matrix_labels import LabelledMatrix

MATRICES = {"K": "k", "M": "m"}
_SCRIPT = """
import sys, warnings
warnings.simplefilter("ignore")
import numpy as np
try:
    from ansys.mapdl import reader
except ImportError:
    sys.exit(3)
full = reader.read_binary(sys.argv[1])
dofs, k, m = full.load_km(sort=True)
parts = {"dofs": dofs, "held": np.asarray(full.const).reshape(-1, 2)}
for name, matrix in (("k", k), ("m", m)):
    if matrix is not None:
        coo = matrix.tocoo()
        parts |= {name + "_row": coo.row, name + "_col": coo.col, name + "_data": coo.data}
np.savez(sys.argv[2], **parts)
"""


def read_full(path: Path, name: str) -> LabelledMatrix:
    """Read K or M of an Ansys ``.full`` file, with node and component of rows.

    Degrees of freedom that Ansys held are left out, so that they count as held.
    """
    if name not in MATRICES:
        refuse(f"matrix {name}: an Ansys .full file has only K and M; leave {name} out")
    parts = read_isolated(_SCRIPT, path, f"matrix {name}", "ansys")
    letter, dofs = MATRICES[name], parts["dofs"].astype(np.int64)
    if f"{letter}_data" not in parts:
        refuse(f"matrix {name}: '{path}' does not hold it; write the file with a modal analysis")
    if len(dofs) and not ((dofs[:, 1] >= 0) & (dofs[:, 1] < 6)).all():
        refuse(
            f"matrix {name}: '{path}' has degrees of freedom other than displacements and "
            "rotations (temperature, pressure, warping); write it for a structural model"
        )
    half = sp.coo_array(
        (parts[f"{letter}_data"], (parts[f"{letter}_row"], parts[f"{letter}_col"])),
        shape=(len(dofs), len(dofs)),
    ).tocsr()
    # Ansys stores one triangle.
    whole = (half + half.T - sp.diags_array(half.diagonal())).tocsr()
    fixed = {tuple(pair) for pair in parts["held"].tolist()}
    free = np.array([tuple(pair) not in fixed for pair in dofs.tolist()], dtype=bool)
    matrix = whole[free][:, free]
    return LabelledMatrix(matrix=matrix, dofs=dofs[free] + np.array([0, 1]))
