"""Measured frequency responses, each at one amplitude: csv, or UFF 58 through pyuff."""

from pathlib import Path
from typing import Literal

import numpy as np

from faying._typing import ComplexVector, Vector
from faying.exceptions import FormatError
from faying.files.number_table import read_number_table

Kind = Literal["displacement", "velocity", "acceleration"]

COLUMNS = (("frequency", "real", "imag"), ("frequency", "magnitude", "phase"))
"""What a csv file has; phases in radians, positive where the response leads."""

ORDERS = {"displacement": 0, "velocity": 1, "acceleration": 2}
"""How many times a response is differentiated by time."""

UFF_KINDS: dict[int, Kind] = {8: "displacement", 11: "velocity", 12: "acceleration"}
"""Ordinates of data set 58."""


def read_response(path: Path, kind: Kind) -> tuple[Vector, ComplexVector]:
    """Return frequencies (n,), rising, and displacement per force (n,).

    The kind says what responds, where the file does not.
    """
    if path.suffix.lower() in (".uff", ".unv"):
        frequency, response, kind = _uff(path, kind)
    else:
        table = read_number_table(path, COLUMNS, "the measured response")
        columns = dict(zip(table.names, table.values.T, strict=True))
        frequency = columns["frequency"]
        if "real" in columns:
            response = columns["real"] + 1j * columns["imag"]
        else:
            response = columns["magnitude"] * np.exp(1j * columns["phase"])
    if not (frequency > 0).all():
        message = f"{path}: frequencies must be positive"
        raise FormatError(message)
    order = np.argsort(frequency, kind="stable")
    circular = 2 * np.pi * frequency[order]
    return frequency[order], response[order] / (1j * circular) ** ORDERS[kind]


def _uff(path: Path, kind: Kind) -> tuple[Vector, ComplexVector, Kind]:
    try:
        import pyuff
    except ImportError:
        message = f"{path}: UFF files need pyuff; pip install pyuff, or give csv"
        raise FormatError(message) from None
    try:
        sets = pyuff.UFF(str(path)).read_sets()
    except Exception as error:  # whatever a damaged file meets
        message = f"{path}: cannot be read as UFF ({error})"
        raise FormatError(message) from None
    sets = sets if isinstance(sets, list) else [sets]
    responses = [entry for entry in sets if entry.get("type") == 58]
    if len(responses) != 1:
        message = f"{path}: found {len(responses)} functions (data set 58), expected one; split it"
        raise FormatError(message)
    (function,) = responses
    kind_known = UFF_KINDS.get(int(function.get("ordinate_spec_data_type", 0)), kind)
    return np.asarray(function["x"]), np.asarray(function["data"], dtype=complex), kind_known
