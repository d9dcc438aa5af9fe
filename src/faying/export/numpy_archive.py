"""A contact-capable hand-over as one .npz file, for any program that has NumPy."""

from pathlib import Path

import numpy as np

from faying.export.arrays import numpy_variables
from faying.reduction.reduced_model import ReducedModel
from faying.study.results.values import Results


def write(rom: ReducedModel, path: Path, _: Results | None = None) -> tuple[Path, ...]:
    """Write the variables of :mod:`faying.export.arrays` to a compressed archive.

    N and T are kept as three arrays each, such as ``N_rows``, ``N_columns`` and ``N_values``;
    nothing is pickled.
    """
    with path.open("wb") as file:
        np.savez_compressed(file, **numpy_variables(rom))
    return (path,)
