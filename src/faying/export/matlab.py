"""Export with contact as a .mat file, with functions for MATLAB and Octave beside it."""

from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io

from faying.exceptions import refuse
from faying.export.arrays import sparse_variables, variables
from faying.reduction.reduced_model import ReducedModel
from faying.study.results.values import Results

FUNCTIONS = (
    "faying_contact.m",
    "faying_static.m",
    "faying_rest.m",
    "faying_step.m",
    "faying_recover.m",
    "faying_complementarity.m",
    "faying_friction.m",
    "faying_close.m",
    "faying_unstressed.m",
    "faying_forces.m",
)
"""Files of the folder ``octave``, copied beside the .mat file."""

MOST_BYTES = 2**31
"""Largest size of a variable in version 5 of the format."""


def write(rom: ReducedModel, path: Path, _: Results | None = None) -> tuple[Path, ...]:
    """Write the variables of :mod:`faying.export.arrays` (version 5) and the functions.

    Vectors are columns, indices count from one, lists of names are cell arrays, N and T are sparse.
    """
    members = variables(rom)
    for name, array in members.items():
        if array.nbytes >= MOST_BYTES:
            refuse(
                f"the matrix {name} of shape {array.shape} exceeds the 2 GiB a .mat file can hold; "
                "export to npz, or use a coarser interface"
            )
    content = {name: _matlab_value(array) for name, array in members.items()}
    content |= {name: matrix.tocsc() for name, matrix in sparse_variables(rom).items()}
    scipy.io.savemat(path, content, format="5", do_compression=True, long_field_names=True)
    return (path, *(_copied(name, path.parent) for name in FUNCTIONS))


def _matlab_value(array: Any) -> Any:
    if array.dtype.kind == "U":
        return np.array([*array.tolist()], dtype=object)[:, None] if array.ndim else array.item()
    numbers = array + 1.0 if array.dtype.kind == "i" else array
    return numbers[:, None] if numbers.ndim == 1 else numbers


def _copied(name: str, folder: Path) -> Path:
    target = folder / name
    target.write_text(files("faying.export").joinpath("octave", name).read_text("utf-8"), "utf-8")
    return target
