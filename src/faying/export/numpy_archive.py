"""A contact-capable hand-over as one .npz file, for any program that has NumPy."""

from pathlib import Path
from typing import Any

import numpy as np

from faying.export.arrays import variables
from faying.export.hand_over import HandOver


def write(hand_over: HandOver, path: Path) -> tuple[Path, ...]:
    """Write the variables of :mod:`faying.export.arrays` to a compressed archive.

    N is kept as three arrays, ``N_rows``, ``N_columns`` and ``N_values``; nothing is pickled.
    """
    held = variables(hand_over)
    sparse = held.interpolation.tocoo()
    rows, columns = (np.asarray(part, dtype=np.int64) for part in (sparse.row, sparse.col))
    names = {key: np.array(value, dtype=np.str_) for key, value in held.names.items()}
    texts = {key: np.array(value) for key, value in held.texts.items()}
    arrays: dict[str, Any] = {
        **held.arrays,
        **held.indices,
        **names,
        **texts,
        "N_rows": rows,
        "N_columns": columns,
        "N_values": np.asarray(sparse.data, dtype=np.float64),
    }
    with path.open("wb") as file:
        np.savez_compressed(file, **arrays)
    return (path,)
