"""[[measurement]]: measured curves beside computed ones, from csv, or UFF 58 through pyuff."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np

from faying._typing import ComplexVector, Vector
from faying.assessment.backbone import Backbone
from faying.assessment.measured_curve import MeasuredCurve, deviations
from faying.assessment.response_curve import ResponseCurve
from faying.assessment.single_mode import single_mode
from faying.exceptions import FormatError, ModelError, naming, refuse
from faying.files.number_table import read_number_table
from faying.study.keys.errors import Mistakes, nearest
from faying.study.keys.frequency_table import FrequencySection
from faying.study.keys.tables import MeasurementSection, Study

Kind = Literal["displacement", "velocity", "acceleration"]

RESPONSE_COLUMNS = (("frequency", "real", "imag"), ("frequency", "magnitude", "phase"))
"""Columns of a csv file; phases in radians, positive where the response leads."""

ORDERS = {"displacement": 0, "velocity": 1, "acceleration": 2}
"""Number of time derivatives of a response."""

UFF_KINDS: dict[int, Kind] = {8: "displacement", 11: "velocity", 12: "acceleration"}
"""Kind of response by the ordinate type of data set 58."""


def read_response(path: Path, kind: Kind) -> tuple[Vector, ComplexVector]:
    """Return increasing frequencies (n,), and displacement per force (n,).

    ``kind`` applies where the file does not state the kind of response.
    """
    if path.suffix.lower() in (".uff", ".unv"):
        frequency, response, kind = _uff(path, kind)
    else:
        table = read_number_table(path, RESPONSE_COLUMNS, "the measured response")
        columns = dict(zip(table.names, table.values.T, strict=True))
        frequency = columns["frequency"]
        if "real" in columns:
            response = columns["real"] + 1j * columns["imag"]
        else:
            response = columns["magnitude"] * np.exp(1j * columns["phase"])
    if not (frequency > 0).all():
        refuse(f"{path}: frequencies must be positive")
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
        refuse(f"{path}: found {len(responses)} functions (data set 58), expected one; split it")
    (function,) = responses
    kind_known = UFF_KINDS.get(int(function.get("ordinate_spec_data_type", 0)), kind)
    return np.asarray(function["x"]), np.asarray(function["data"], dtype=complex), kind_known


COLUMNS = (
    ("amplitude", "frequency", "damping"),
    ("amplitude", "frequency"),
    ("amplitude", "damping"),
)
"""Sets of columns that a file may have."""


def measured_curves(study: Study) -> tuple[MeasuredCurve, ...]:
    """Read the measured curves of a study.

    Raises
    ------
    FormatError
        If a file cannot be read, or holds a number that is not positive.
    """
    return tuple(_curve(section) for section in study.measurements if section.frequency is None)


def measured_responses(
    study: Study, swept: FrequencySection, component: str = ""
) -> dict[str, ResponseCurve]:
    """Read the measured responses of a component to a harmonic load with one force, by name."""
    curves = {}
    for section in study.measurements:
        for response in section.response if section.frequency == swept.name else ():
            level, (force,) = response.level or 1.0, swept.load.values()
            frequency, values = read_response(response.file, response.of)
            moved = response.factor * level * force * values
            curves[f"{section.name}, level {level:g}"] = ResponseCurve(
                level=level,
                components=(component,),
                frequency=frequency,
                harmonics=np.stack([np.zeros_like(moved), moved], axis=1)[:, :, None],
            )
    return curves


def _curve(section: MeasurementSection) -> MeasuredCurve:
    columns = _columns(section)
    order = np.argsort(columns["amplitude"], kind="stable")
    columns = {name: values[order] for name, values in columns.items()}
    return MeasuredCurve(
        name=section.name,
        case=section.load_case or "",
        mode=section.mode or 1,
        amplitude=columns["amplitude"],
        frequency=columns.get("frequency"),
        damping_ratio=columns.get("damping"),
        frequency_scatter=section.frequency_scatter,
        damping_scatter=section.damping_scatter,
    )


def _columns(section: MeasurementSection) -> dict[str, Vector]:
    """Return the columns of a curve, from its file or from a response at each amplitude."""
    if section.file is None:
        rows = []
        for response in section.response:
            with naming(str(response.file)):
                mode = single_mode(*read_response(response.file, response.of))
            rows.append([response.amplitude or 0.0, mode.frequency, mode.damping_ratio])
        return dict(zip(COLUMNS[0], np.array(rows).T, strict=True))
    table = read_number_table(section.file, COLUMNS, "the measured curve")
    if (table.values <= 0).any():
        refuse(f"{section.file}: amplitudes, frequencies and damping ratios must be positive")
    return dict(zip(table.names, table.values.T, strict=True))


def measurement_problems(_: Study, study: Study) -> Mistakes:
    """Yield measured curves without a computed one, and files that cannot be read."""
    names = [section.name for section in study.measurements]
    for number, section in enumerate(study.measurements):
        wrong: dict[str, str] = {}
        if section.name in names[:number]:
            wrong["name"] = f"two measurements are called '{section.name}'; names must differ"
        missing = next(_incomplete(section), None)
        if missing is not None:
            yield ("measurement", number), missing
        elif section.frequency is None:
            wrong |= _beside_a_backbone(study, section)
        else:
            wrong |= _beside_a_sweep(study, section)
        yield from ((("measurement", number, key), text) for key, text in wrong.items())


def _incomplete(section: MeasurementSection) -> Iterator[str]:
    """Yield missing and contradictory keys of a table."""
    if section.frequency is None and (section.load_case is None or section.mode is None):
        yield "no computed curve is named; give 'load_case' and 'mode', or 'frequency'"
    elif section.frequency is not None and (section.load_case, section.mode) != (None, None):
        yield "a backbone and a [[frequency]] are named; remove one of them"
    if section.file is None and not section.response:
        yield "no response is given; add a table [[measurement.response]] for each"
    key = "amplitude" if section.frequency is None else "level"
    if any(getattr(response, key) is None for response in section.response):
        yield f"each [[measurement.response]] needs '{key}'; add it"
    if section.frequency is not None and section.file is not None:
        yield "curves over frequency are given as tables [[measurement.response]]"


def _beside_a_backbone(study: Study, section: MeasurementSection) -> dict[str, str]:
    """Return the problems of a curve over amplitude, by key."""
    backbones = {case.name: case for case in study.load_cases if case.kind == "backbone"}
    case, wrong = backbones.get(section.load_case or ""), dict[str, str]()
    if case is None:
        advice = nearest(section.load_case or "", backbones) if backbones else "there is none"
        wrong["load_case"] = f"there is no backbone '{section.load_case}'; {advice}"
    elif section.mode not in case.modes:
        modes = ", ".join(map(str, case.modes))
        wrong["mode"] = f"load case '{case.name}' computes modes {modes}; name one of them"
    elif case.over != "amplitude":
        wrong["load_case"] = f"'{case.name}' is over energy, and measured curves over amplitude"
    try:
        _curve(section)
    except (FormatError, ModelError) as error:
        wrong["file" if section.file else "response"] = str(error)
    return wrong


def _beside_a_sweep(study: Study, section: MeasurementSection) -> dict[str, str]:
    """Return the problems of curves over frequency, by key."""
    sweeps = {swept.name: swept for swept in study.frequencies}
    swept = sweeps.get(section.frequency or "")
    if swept is None:
        advice = nearest(section.frequency or "", sweeps) if sweeps else "there is none"
        return {"frequency": f"there is no [[frequency]] '{section.frequency}'; {advice}"}
    if len(swept.load) > 1:
        return {"frequency": f"'{swept.name}' has several forces, and responses are per force"}
    strange = [test.level for test in section.response if test.level not in swept.levels]
    if strange:
        levels = ", ".join(f"{level:g}" for level in swept.levels)
        text = f"'{swept.name}' has no level {strange[0]:g}; its levels are {levels}"
        return {"response": text}
    try:
        measured_responses(study, swept)
    except FormatError as error:
        return {"response": str(error)}
    return {}


def compared(curve: MeasuredCurve, backbones: Mapping[str, Backbone]) -> dict[str, Any]:
    """Return a measured curve and its deviations for ``summary.json``.

    Values are None where the backbone does not reach an amplitude, or were not measured.
    """
    figures: dict[str, Any] = {
        "load_case": curve.case,
        "mode": curve.mode,
        "amplitude": curve.amplitude.tolist(),
        "frequency": None if curve.frequency is None else curve.frequency.tolist(),
        "damping_ratio": None if curve.damping_ratio is None else curve.damping_ratio.tolist(),
    }
    computed = backbones.get(str(curve.mode))
    if computed is None:
        return figures
    differences = deviations(curve, computed)
    for name in ("frequency", "damping_ratio", "frequency_error", "damping_error"):
        key = name if name.endswith("error") else f"computed_{name}"
        values = getattr(differences, name).tolist()
        figures[key] = [value if np.isfinite(value) else None for value in values]
    return figures


def sentence(curve: MeasuredCurve, backbones: Mapping[str, Backbone]) -> str:
    """Return a sentence about the deviations of frequencies and damping ratios."""
    computed = backbones.get(str(curve.mode))
    if computed is None:
        return f"'{curve.name}' has no computed curve"
    differences = deviations(curve, computed)
    count, said = int(np.count_nonzero(np.isfinite(differences.frequency))), []
    if not count:
        return f"'{curve.name}' was measured at amplitudes that mode {curve.mode} does not reach"
    for what, errors in (
        ("frequencies", differences.frequency_error),
        ("damping ratios", differences.damping_error),
    ):
        off = 100 * errors[np.isfinite(errors)]
        if len(off):
            said.append(f"{what} {off.min():+.2g} to {off.max():+.2g} %".replace("-", "−"))
    return (
        f"mode {curve.mode} is off '{curve.name}' (triangles) by {', '.join(said)} at {count} of "
        f"{len(differences.frequency)} measured amplitudes"
    )
