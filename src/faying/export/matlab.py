"""A contact-capable hand-over as a .mat file with functions for MATLAB and Octave beside it."""

from importlib.resources import files
from pathlib import Path

import numpy as np
import scipy.io
import scipy.sparse as sp

from faying._typing import Matrix
from faying.exceptions import FormatError
from faying.export.arrays import variables
from faying.export.hand_over import HandOver

FUNCTIONS = (
    "faying_contact.m",
    "faying_static.m",
    "faying_step.m",
    "faying_recover.m",
    "faying_complementarity.m",
    "faying_forces.m",
)
"""Files of the folder ``octave``, copied beside the .mat file."""

MOST_BYTES = 2**31
"""Size of one variable that version 5 of the format can say."""


def write(hand_over: HandOver, path: Path) -> tuple[Path, ...]:
    """Write the variables of :mod:`faying.export.arrays` (version 5) and the functions.

    Vectors are columns, indices count from one, lists of names are cell arrays, N is sparse.

    Raises
    ------
    FormatError
        If a matrix is too large for the format.
    """
    held = variables(hand_over)
    for name, array in held.arrays.items():
        if array.nbytes >= MOST_BYTES:
            message = (
                f"the matrix {name} of shape {array.shape} exceeds the 2 GiB a .mat file can hold; "
                "export to npz, or use a coarser interface"
            )
            raise FormatError(message)
    content = {
        **{name: _column(array) for name, array in held.arrays.items()},
        **{
            name: _column(np.asarray(index + 1, dtype=np.float64))
            for name, index in held.indices.items()
        },
        **{name: np.array([*value], dtype=object)[:, None] for name, value in held.names.items()},
        **held.texts,
        "N": sp.csc_matrix(held.interpolation),
    }
    scipy.io.savemat(path, content, format="5", do_compression=True, long_field_names=True)
    return (path, *(_copied(name, path.parent) for name in FUNCTIONS))


def _column(array: Matrix) -> Matrix:
    return array[:, None] if array.ndim == 1 else array


def _copied(name: str, folder: Path) -> Path:
    target = folder / name
    target.write_text(files("faying.export").joinpath("octave", name).read_text("utf-8"), "utf-8")
    return target
