"""Recovery of pressures from the history of another program with models of a finished run."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from faying._typing import Matrix
from faying.assessment.imported_recovery import (
    backward_differences,
    recover_from_boundary_loads,
    recover_from_modal,
)
from faying.assessment.recovery import Recovered
from faying.display.table import PRESSURE, Column, Table, described
from faying.exceptions import refuse_study
from faying.interface.surface import nodal_average
from faying.reduction.model_writer import MOST_PORTS
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.integrators import Integrator
from faying.simulation.load import History, Load
from faying.study.keys.errors import nearest, quoted
from faying.study.results.solved_fields import RecoveredRecord
from faying.study.results.store import read_results
from faying.study.results.values import Results
from faying.study.stages.imported_history import ImportedHistory, read_imported_history

Derivatives = Literal["spline", "backward"]

FEWEST = {"spline": 4, "backward": 2}
"""Fewest instants for derivatives."""

MODAL_METHODS = ("craig-bampton", "compliance")
"""Methods of the classic basis; the first is the default for modal histories."""


@dataclass(frozen=True, kw_only=True)
class RecoverOptions:
    """Options of :func:`recover`; None is the default.

    Attributes
    ----------
    method, joint_modes
        Reduced model of the coordinates of a modal history (``craig-bampton``), or model that is
        simulated under boundary forces (``compliance``).
    derivatives
        Method for missing velocities and accelerations: ``"spline"``, or ``"backward"``
        differences as in implicit Euler.
    step : [time]
        Time step under boundary forces; by default the smallest interval of the history.
    integrator
        Integrator under boundary forces; by default implicit Euler.
    """

    method: str | None = None
    joint_modes: int | None = None
    derivatives: Derivatives | None = None
    step: float | None = None
    integrator: Integrator | None = None


def recover(results: Results, path: Path, options: RecoverOptions) -> RecoveredRecord:
    """Recover pressures from a modal or boundary-force history.

    The matrices are read from the results; no finite element model is built.

    Parameters
    ----------
    results
        Results of a finished run.
    path
        History, see :mod:`faying.study.stages.imported_history`.

    Returns
    -------
    RecoveredRecord

    Raises
    ------
    StudyError
        If the run has no such method, or the history does not fit it.
    FormatError
        If the history cannot be read.
    """
    history = read_imported_history(path, reduced_model(results, MODAL_METHODS[0]).joint)
    modal = history.coordinates is not None
    method = options.method or (MODAL_METHODS[0] if modal else "compliance")
    rom = reduced_model(results, method, options.joint_modes)
    recovered, derivatives = (_from_modal if modal else _from_loads)(rom, history, options)
    return RecoveredRecord(
        title=results.title,
        units=results.units,
        history=path.name,
        route="modal" if modal else "boundary loads",
        method=method,
        joint_modes=rom.joint_modes,
        derivatives=derivatives,
        loads=tuple(history.loads),
        times=np.asarray(recovered.times),
        pressure=recovered.pressure,
        gap=recovered.gap,
        displacements={name: recovered.displacement(name) for name in rom.boundaries},
        contact_force={name: recovered.contact_force(name) for name in results.interfaces},
        bolt_force={name: recovered.bolt_force(name) for name in rom.bolts},
        max_pressure=recovered.max_pressure,
        iterations=recovered.iterations,
        **recovered.along_surfaces,
    )


def results_of(folder: Path | str) -> Results:
    """Read the results of a finished run.

    Raises
    ------
    StudyError
        If the folder holds no results.
    FormatError
        If the results are damaged.
    """
    path = Path(folder) / "results.h5"
    if not path.is_file():
        refuse_study(f"{folder} holds no results.h5; give the folder of a finished 'faying run'")
    return read_results(path)


def peak_table(results: Results, recovered: RecoveredRecord) -> Table:
    """Return the table of largest pressures and tractions of interfaces, with time and place."""
    units = results.unit_set

    def largest(name: str) -> tuple[int, int]:
        pressure = recovered.pressure[:, slice(*results.interfaces[name].slice)]
        instant, point = np.unravel_index(int(pressure.argmax()), pressure.shape)
        return int(instant), int(point)

    def place(name: str) -> str:
        point = results.interfaces[name].points[peaks[name][1]].tolist()
        return f"({', '.join(f'{value:.4g}' for value in point)})"

    def pressure(name: str) -> float:
        instant, point = peaks[name]
        return float(recovered.pressure[instant, results.interfaces[name].slice[0] + point])

    def largest_of(sizes: Matrix) -> Callable[[str], float]:
        return lambda name: float(sizes[:, slice(*results.interfaces[name].slice)].max())

    peaks = {name: largest(name) for name in results.interfaces}
    columns = (
        Column("pressure", pressure, PRESSURE, 5),
        Column(f"at [{units.length}]", place),
        Column("time", lambda name: recovered.times[peaks[name][0]], "time", 5),
        Column(
            "contact force then",
            lambda name: recovered.contact_force[name][peaks[name][0]],
            "force",
            5,
        ),
        *(
            Column(f"largest {name}", largest_of(sizes), PRESSURE, 5)
            for name, sizes in recovered.tractions.items()
        ),
    )
    return described("interface", [(name, name) for name in peaks], columns, units)


def peak_fields(results: Results, recovered: RecoveredRecord, interface: str) -> dict[str, Matrix]:
    """Return nodal averages at the instant of the largest pressure, by name with unit."""
    units, record = results.unit_set, results.interfaces[interface]
    instant = int(recovered.max_pressure.argmax())
    # Averages are largest where values are, but not always at the same instant.
    averages = nodal_average(record, recovered.pressure)
    fields = {
        f"pressure [{units.pressure}]": averages[instant],
        f"gap [{units.length}]": nodal_average(record, recovered.gap[instant]),
        f"largest pressure over time [{units.pressure}]": averages.max(axis=0),
    }
    for name, sizes in recovered.tractions.items():
        averages = nodal_average(record, sizes)
        fields[f"{name} [{units.pressure}]"] = averages[instant]
        fields[f"largest {name} over time [{units.pressure}]"] = averages.max(axis=0)
    return fields


def reduced_model(results: Results, method: str, joint_modes: int | None = None) -> ReducedModel:
    """Return a reduced model of a run.

    Parameters
    ----------
    joint_modes
        Number of joint modes; may be omitted if the method has one model.
    """
    if not results.reduced:
        pairs = sum(len(record.pairs) for record in results.interfaces.values())
        refuse_study(
            f"the results of '{results.title}' hold no port compliance, as its {pairs} node pairs "
            f"(three ports each with friction) make more than {MOST_PORTS} ports; faying reduce "
            "writes it to a file: fy.read_reduced_model reads that, fy.recover_from_boundary_loads "
            "or fy.recover_from_modal with its 'recovery' computes the pressures"
        )
    if method not in results.reduced:
        refuse_study(
            f"the run has no reduced model '{method}'; "
            f"{nearest(method, results.reduced)} (it has {quoted(results.reduced)})"
        )
    sizes = results.reduced[method]
    if joint_modes is None and len(sizes) == 1:
        return next(iter(sizes.values()))
    counts = ", ".join(map(str, sizes))
    if joint_modes is None:
        refuse_study(f"method '{method}' was run with {counts} joint modes; give --joint-modes")
    if joint_modes not in sizes:
        refuse_study(
            f"the run has no model '{method}' with {joint_modes} joint modes; it was run with "
            f"{counts}, not {joint_modes}: change --joint-modes"
        )
    return sizes[joint_modes]


def _from_modal(
    rom: ReducedModel, history: ImportedHistory, options: RecoverOptions
) -> tuple[Recovered, str]:
    """Recover pressures from coordinates; return them, and the source of derivatives."""
    for name in ("step", "integrator"):
        if getattr(options, name) is not None:
            refuse_study(f"{history.path} is a modal history, so there is no --{name}; remove it")
    q, kinds = np.asarray(history.coordinates), rom.basis.kinds
    if q.shape[1] != len(kinds):
        modes_text = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
        refuse_study(
            f"{history.path} has {q.shape[1]} coordinates, but the basis of '{rom.method}' has "
            f"{len(kinds)} ({modes_text}); give all in this order, or another --method"
        )
    v, a, derivatives = _derivatives(history, q, options)
    recovered = recover_from_modal(
        rom.recovery,
        history.times,
        q,
        Load(
            {name: History(history.times, values) for name, values in history.loads.items()},
            name=history.path.name,
        ),
        velocities=v,
        accelerations=a,
        frame_motion=history.frame,
    )
    return recovered, derivatives


def _derivatives(
    history: ImportedHistory, q: Matrix, options: RecoverOptions
) -> tuple[Matrix | None, Matrix | None, str]:
    """Return velocities and accelerations, None where a spline gives them, and their source."""
    derivatives = {"velocities": history.velocities, "accelerations": history.accelerations}
    missing = [name for name, values in derivatives.items() if values is None]
    if not missing:
        return history.velocities, history.accelerations, "both from the history"
    way = options.derivatives or "spline"
    if len(q) < FEWEST[way]:
        refuse_study(
            f"{history.path} has {len(q)} instants, too few to derive {' and '.join(missing)}; "
            f"give {FEWEST[way]} or more instants, or the derivatives"
        )
    text = f"{' and '.join(missing)} by {'a cubic spline' if way == 'spline' else 'differences'}"
    if way == "spline":
        return history.velocities, history.accelerations, text
    v, a = backward_differences(history.times, q)
    return (
        v if history.velocities is None else history.velocities,
        a if history.accelerations is None else history.accelerations,
        text,
    )


def _from_loads(
    rom: ReducedModel, history: ImportedHistory, options: RecoverOptions
) -> tuple[Recovered, str]:
    """Simulate the response to boundary forces, and recover pressures from it."""
    if options.derivatives is not None:
        refuse_study(f"{history.path} has only boundary forces; remove --derivatives")
    if history.frame is not None:
        refuse_study(
            f"{history.path} has moving supports but no coordinates; give q1, q2, … too, because "
            "only supports at rest are simulated"
        )
    if len(history.times) < 2 or history.times[0] != 0:
        refuse_study(
            f"{history.path}: boundary forces need at least two instants, the first at time 0, "
            "with the joint at rest under its preloads; add one"
        )
    recovered = recover_from_boundary_loads(
        rom,
        history.times,
        history.loads,
        step=options.step,
        integrator=options.integrator,
        name=history.path.name,
    )
    return recovered, "simulated"
