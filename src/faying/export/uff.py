"""Frequency responses as data sets 58 of the Universal File Format, written by pyuff."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from faying._typing import Mask
from faying.assessment.response_curve import ResponseCurve
from faying.exceptions import refuse_study
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES
from faying.reduction.reduced_model import ReducedModel
from faying.study.results.frequency_record import FrequencyRecord
from faying.study.results.values import Results

RESPONSE, GENERAL = 4, 0
"""Function types of data set 58: displacement over a force, and displacement alone."""

UNEVEN_COMPLEX = 6
"""Ordinate type: complex numbers in double precision."""


FREQUENCY, DISPLACEMENT, FORCE = 18, 8, 13
"""Specific data types of abscissa and ordinates."""


def write(rom: ReducedModel, path: Path, run: Results | None) -> tuple[Path, ...]:
    """Write the first harmonics of a run; see :mod:`faying.export.formats`.

    Each level and boundary component is a data set over the frequencies of a sweep up, and another
    of a sweep down if it differs. With one load it is displacement over force, else displacement.
    """
    import pyuff

    if run is None or not run.frequencies:
        refuse_study(
            f"'{rom.name}' has no responses to harmonic loads; export the folder of a run whose "
            "study has a [[frequency]]"
        )
    sets = [
        data_set for name, record in run.frequencies.items() for data_set in _sets(name, record)
    ]
    pyuff.UFF(str(path)).write_sets(sets, "overwrite")
    return (path,)


def _sets(name: str, record: FrequencyRecord) -> Iterator[dict[str, Any]]:
    """Yield the data sets of a harmonic load."""
    load = record.response.load
    for curve in record.response.curves:
        sweeps = {"up": curve.swept_up}
        if not np.array_equal(curve.swept_up, curve.swept_down):
            sweeps["down"] = curve.swept_down
        for way, passed in sweeps.items():
            for number, component in enumerate(curve.components):
                yield _set(name, way, load, curve, passed, number, component)


def _set(
    name: str,
    way: str,
    load: Any,
    curve: ResponseCurve,
    passed: Mask,
    number: int,
    component: str,
) -> dict[str, Any]:
    alone = len(load) == 1
    target, size = next(iter(load.items()))
    over = curve.level * size if alone else 1.0
    boundary, _, moved = component.rpartition(".")
    order = np.argsort(curve.frequency[passed])
    pushed = target.rpartition(".")[2]
    return {
        "type": 58,
        "binary": 0,
        "id1": f"{name}, level {curve.level:g}, sweep {way}",
        "id2": component,
        "id3": f"over {target}" if alone else f"under {', '.join(load)}",
        "func_type": RESPONSE if alone else GENERAL,
        "rsp_ent_name": boundary[:10],
        "rsp_node": number + 1,
        "rsp_dir": DISPLACEMENT_NAMES.index(moved) + 1,
        "ref_ent_name": target.rpartition(".")[0][:10] if alone else "NONE",
        "ref_node": 1,
        "ref_dir": FORCE_NAMES.index(pushed) + 1 if alone and pushed in FORCE_NAMES else 0,
        "ord_data_type": UNEVEN_COMPLEX,
        "num_pts": int(passed.sum()),
        "abscissa_spacing": 0,
        "abscissa_min": 0.0,
        "abscissa_inc": 0.0,
        "abscissa_spec_data_type": FREQUENCY,
        "ordinate_spec_data_type": DISPLACEMENT,
        "orddenom_spec_data_type": FORCE if alone else 0,
        "x": curve.frequency[passed][order],
        "data": curve.harmonics[passed, 1, number][order] / over,
    }
