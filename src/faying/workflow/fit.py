"""Parameters of a study fitted to measured curves, and bands of backbones over their ranges."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from faying import __version__
from faying.assessment.backbone import Backbone
from faying.assessment.backbone_band import BackboneBand, backbone_band
from faying.assessment.identification import Identification, identify
from faying.assessment.measured_curve import MeasuredCurve
from faying.assessment.parameter import Parameter, design
from faying.exceptions import refuse_study
from faying.execution.campaign import run_campaign
from faying.execution.checkpoint import Checkpoint
from faying.execution.executor import Executor
from faying.files.atomic import held, write_text
from faying.files.csv_rows import write_rows
from faying.files.names import file_names
from faying.report.figures.backbone import draw_band, draw_fit
from faying.study.judgement.summary import plain
from faying.study.keys.measurements import compared, measured_curves
from faying.study.keys.parameter_tables import steps_to, value_at
from faying.study.keys.tables import Study
from faying.study.stages.books import Books, ProgressBar
from faying.study.stages.varied import Curves, prepare_curves, unpacked_curves


@contextmanager
def _curve_folder(out: Path) -> Iterator[Path]:
    """Lock a results folder, and yield its folder for computed curves, removed at the end."""
    out.mkdir(parents=True, exist_ok=True)
    with held(out):
        yield out / "unfinished"
        Checkpoint(out / "unfinished").discard()


def fit_study(
    study: Study,
    out: Path,
    *,
    progress: ProgressBar | None = None,
    executor: Executor | None = None,
) -> Identification:
    """Return the parameters of a study whose backbones fit its measured curves best.

    Parameters
    ----------
    out
        Receives ``fit.json``, and for each measured curve ``fit_CURVE.csv`` and ``.png``. An
        interrupted fit of the same study continues from its computed curves.
    executor
        Computes the trials of a step side by side.
    """
    parameters, measured = _parameters(study), measured_curves(study)
    books = Books(progress)
    with _curve_folder(out) as folder, books.stage("trials") as advance:

        def compute(trials: Sequence[Mapping[str, float]]) -> list[dict[str, Backbone]]:
            computed = _curves(study, trials, folder, executor, advance)
            return [
                {test.name: curves[test.case, test.mode] for test in measured}
                for curves in computed
            ]

        result = identify(compute, parameters, measured)
        stems = file_names([test.name for test in measured])
        for test in measured:
            curve, stem = result.curves[test.name], stems[test.name]
            _write(out / f"fit_{stem}.csv", _compared_columns(test, curve))
            draw_fit(curve, test).savefig(out / f"fit_{stem}.png")
        write_text(out / "fit.json", json.dumps(plain(_summary(result, measured)), indent=2) + "\n")
    return result


def band_of_study(
    study: Study,
    out: Path,
    *,
    progress: ProgressBar | None = None,
    executor: Executor | None = None,
) -> Mapping[str, BackboneBand]:
    """Compute backbones of a study at the design points of its ``[band]``, and return their bands.

    Parameters
    ----------
    out
        Receives ``band.json`` with the design, and ``band_CASE-mode-N.csv`` and ``.png`` of
        each load case and mode. An interrupted call with the same study continues from its
        computed curves.
    executor
        Computes samples side by side.

    Returns
    -------
    Mapping
        Bands by ``"CASE, mode N"``.
    """
    trials = design(_parameters(study), study.band.design, study.band.samples)
    if not any(case.kind == "backbone" for case in study.load_cases):
        refuse_study(f'{study.path.name} has no [[load_case]] of kind = "backbone"; add one')
    measured, books = measured_curves(study), Books(progress)
    with _curve_folder(out) as folder:
        with books.stage("samples", len(trials)) as advance:
            samples = _curves(study, trials, folder, executor, advance)
        bands = {
            f"{case}, mode {mode}": backbone_band([curves[case, mode] for curves in samples])
            for case, mode in samples[0]
        }
        for name, stem in file_names(bands).items():
            _write(out / f"band_{stem}.csv", _columns(bands[name]))
            tests = [test for test in measured if f"{test.case}, mode {test.mode}" == name]
            draw_band(bands[name], tests).savefig(out / f"band_{stem}.png")
        summary = {
            "faying": __version__,
            "design": study.band.design,
            "samples": trials,
            "bands": {name: _columns(band) for name, band in bands.items()},
        }
        write_text(out / "band.json", json.dumps(plain(summary), indent=2) + "\n")
    return bands


def _parameters(study: Study) -> list[Parameter]:
    """Return the parameters of a study; the fit starts at the values of the study file."""
    if not study.parameters:
        refuse_study(f"{study.path.name} has no [[parameter]]; add one with its keys and range")
    from tomllib import loads

    tables, parameters = loads(study.text), []
    for section in study.parameters:
        low, high = section.range
        value = value_at(steps_to(section.keys[0], tables), tables)
        inside = isinstance(value, (int, float)) and low <= value <= high
        start = float(value) if inside else None
        parameters.append(Parameter(name=section.name, low=low, high=high, start=start))
    return parameters


def _curves(
    study: Study,
    trials: Sequence[Mapping[str, float]],
    folder: Path,
    executor: Executor | None,
    advance: Callable[[int], object],
) -> list[Curves]:
    """Return the backbones of trials, computed or read from the folder."""
    prepare = partial(prepare_curves, study.source.text, study.source.path)
    tasks = {
        ", ".join(f"{name} = {value!r}" for name, value in trial.items()): dict(trial)
        for trial in trials
    }
    computed = run_campaign(
        prepare,
        tasks,
        executor,
        keep=folder,
        progress=lambda _: advance(1),
    )
    return [unpacked_curves(arrays) for arrays in computed.values()]


def _compared_columns(measured: MeasuredCurve, computed: Backbone) -> dict[str, Any]:
    """Return columns with a measured curve, the computed curve and their deviations."""
    figures = compared(measured, {str(measured.mode): computed})
    return {name: column for name, column in figures.items() if isinstance(column, list)}


def _columns(band: BackboneBand) -> dict[str, list[float]]:
    return {
        name: getattr(band, name).tolist()
        for name in (
            "amplitude",
            "frequency_low",
            "frequency_high",
            "damping_low",
            "damping_high",
            "samples",
        )
    }


def _write(path: Path, columns: Mapping[str, Sequence[Any]]) -> None:
    """Write columns as csv; None gives an empty cell."""
    write_rows(path, (columns, *zip(*columns.values(), strict=True)), "%s")


def _summary(result: Identification, measured: Sequence[MeasuredCurve]) -> dict[str, Any]:
    """Return the contents of ``fit.json``."""
    names = list(result.values)
    return {
        "faying": __version__,
        "parameters": {
            parameter.name: {
                "value": result.values[parameter.name],
                "interval": result.intervals[parameter.name],
                "range": [parameter.low, parameter.high],
            }
            for parameter in result.parameters
        },
        "correlations": [list(row) for row in result.correlations],
        "directions": [
            {"shares": dict(zip(names, row, strict=True)), "spread": spread}
            for row, spread in zip(result.directions, result.spreads, strict=True)
        ],
        "misfit": result.misfit,
        "trials": result.trials,
        "measurements": {
            test.name: compared(test, {str(test.mode): result.curves[test.name]})
            for test in measured
        },
        "remarks": list(result.remarks),
    }
