"""Recover pressures from the history of another program with what a finished run left behind."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.imported_recovery import (
    backward_differences,
    recover_from_modal,
    simulate_boundary_loads,
)
from faying.assessment.recovery import Recovered, Recovery, recover_reduced
from faying.exceptions import StudyError
from faying.reduction.portable import PortableJoint
from faying.simulation.integrators import Integrator
from faying.simulation.load import History, Load
from faying.study.errors import nearest, quoted
from faying.study.imported_history import ImportedHistory, read_imported_history
from faying.study.interface_surface import nodal_average
from faying.study.portable_records import restored_joint, restored_model, restored_recovery
from faying.study.recovery_results import RecoveredRecord, ReducedRecord
from faying.study.results import Results
from faying.study.store import read_results
from faying.units import units_of

Derivatives = Literal["spline", "backward"]

FEWEST = {"spline": 4, "backward": 2}
"""Instants from which derivatives can be formed."""

MODAL_METHODS = ("craig-bampton", "compliance")
"""Methods of the classic basis, the first choice for coordinates of another program."""


@dataclass(frozen=True, kw_only=True)
class RecoverOptions:
    """How a history is to be taken; None leaves it to :func:`recover`.

    Attributes
    ----------
    method, joint_modes
        Reduced model whose coordinates a modal history has (``craig-bampton``), or that is
        simulated under boundary forces (``compliance``).
    derivatives
        How missing velocities and accelerations are formed: ``"spline"``, or ``"backward"``
        differences as implicit Euler has them.
    step : [time]
        Of a simulation under boundary forces; the smallest interval of the history.
    integrator
        Of that simulation; implicit Euler.
    """

    method: str | None = None
    joint_modes: int | None = None
    derivatives: Derivatives | None = None
    step: float | None = None
    integrator: Integrator | None = None


@dataclass(frozen=True, kw_only=True)
class Peak:
    """The largest pressure on an interface.

    Attributes
    ----------
    point
        Where, (x, y, z).
    time
        When.
    contact_force
        Total normal force of the interface at that instant.
    """

    interface: str
    pressure: float
    point: tuple[float, ...]
    time: float
    contact_force: float


def recover(results: Results, path: Path, options: RecoverOptions) -> RecoveredRecord:
    """Recover pressures from a modal or boundary-force history.

    Without finite elements: all matrices are those that the run kept.

    Parameters
    ----------
    results
        Of a finished run.
    path
        History, see :mod:`faying.study.imported_history`.

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
    joint = restored_joint(results)
    history = read_imported_history(path, joint)
    modal = history.coordinates is not None
    method = options.method or (MODAL_METHODS[0] if modal else "compliance")
    count, record = _chosen(results, method, options.joint_modes)
    if modal:
        ports = results.ports
        recovery = restored_recovery(joint, record, ports.frame_recovery if ports else None)
        recovered, derivatives = _from_modal(recovery, record, history, options, method)
    else:
        recovered, derivatives = _from_loads(joint, record, history, options)
    return RecoveredRecord(
        title=results.title,
        units=results.units,
        history=path.name,
        route="modal" if modal else "boundary loads",
        method=method,
        joint_modes=count,
        derivatives=derivatives,
        loads=tuple(history.loads),
        times=np.asarray(recovered.times),
        pressure=recovered.pressure,
        gap=recovered.gap,
        displacements={name: recovered.displacement(name) for name in joint.boundaries},
        contact_force={name: recovered.contact_force(name) for name in results.interfaces},
        bolt_force={name: recovered.bolt_force(name) for name in joint.bolts},
        max_pressure=recovered.max_pressure,
        iterations=recovered.iterations,
    )


def results_of(folder: Path | str) -> Results:
    """Read the results of a finished run.

    Raises
    ------
    StudyError
        If the folder holds none.
    FormatError
        If they are damaged.
    """
    path = Path(folder) / "results.h5"
    if not path.is_file():
        message = f"{folder} holds no results.h5; name the folder of a finished 'faying run'"
        raise StudyError(message)
    return read_results(path)


def peaks(results: Results, recovered: RecoveredRecord) -> Iterator[Peak]:
    """Find the largest pressure on every interface."""
    for name, interface in results.interfaces.items():
        own = recovered.pressure[:, slice(*interface.slice)]
        row, column = np.unravel_index(int(own.argmax()), own.shape)
        yield Peak(
            interface=name,
            pressure=float(own[row, column]),
            point=tuple(interface.points[column].tolist()),
            time=float(recovered.times[row]),
            contact_force=float(recovered.contact_force[name][row]),
        )


def peak_fields(results: Results, recovered: RecoveredRecord, interface: str) -> dict[str, Matrix]:
    """Return nodal averages at the instant of the largest pressure, for pictures."""
    units, record = units_of(results.units), results.interfaces[interface]
    instant = int(recovered.max_pressure.argmax())
    # Averages are largest where values are, but not always at the same instant.
    averages = nodal_average(record, recovered.pressure)
    return {
        f"pressure [{units.pressure}]": averages[instant],
        f"gap [{units.length}]": nodal_average(record, recovered.gap[instant]),
        f"largest pressure over time [{units.pressure}]": averages.max(axis=0),
    }


def _chosen(results: Results, method: str, joint_modes: int | None) -> tuple[int, ReducedRecord]:
    """Find a reduced model by method and number of joint modes."""
    if method not in results.reduced:
        message = (
            f"the run kept no reduced model of method '{method}'; "
            f"{nearest(method, results.reduced)} (kept are {quoted(results.reduced)})"
        )
        raise StudyError(message)
    sizes = results.reduced[method]
    if joint_modes is None and len(sizes) == 1:
        return next(iter(sizes.items()))
    if joint_modes is None or joint_modes not in sizes:
        asked = "say with" if joint_modes is None else f"not {joint_modes}: change"
        message = (
            f"method '{method}' was run with {', '.join(map(str, sizes))} joint modes; {asked} "
            "--joint-modes"
        )
        raise StudyError(message)
    return joint_modes, sizes[joint_modes]


def _from_modal(
    recovery: Recovery,
    record: ReducedRecord,
    history: ImportedHistory,
    options: RecoverOptions,
    method: str,
) -> tuple[Recovered, str]:
    """Recover from coordinates; also say where derivatives come from."""
    for name in ("step", "integrator"):
        if getattr(options, name) is not None:
            message = f"{history.path} is a modal history and is not simulated; remove --{name}"
            raise StudyError(message)
    q = np.asarray(history.coordinates)
    if q.shape[1] != len(record.kinds):
        kinds = ", ".join(f"{record.kinds.count(k)} {k}" for k in dict.fromkeys(record.kinds))
        message = (
            f"{history.path} has {q.shape[1]} coordinates, but the basis of '{method}' has "
            f"{len(record.kinds)} ({kinds}); give all in this order, or name another --method"
        )
        raise StudyError(message)
    v, a, derivatives = _derivatives(history, q, options)
    recovered = recover_from_modal(
        recovery,
        history.times,
        q,
        Load(_histories(history), name=history.path.name),
        velocities=v,
        accelerations=a,
        frame_motion=history.frame,
    )
    return recovered, derivatives


def _derivatives(
    history: ImportedHistory, q: Matrix, options: RecoverOptions
) -> tuple[Matrix | None, Matrix | None, str]:
    """Velocities and accelerations as given or by differences; None is left to a spline."""
    given = {"velocities": history.velocities, "accelerations": history.accelerations}
    missing = [name for name, values in given.items() if values is None]
    if not missing:
        return history.velocities, history.accelerations, "both from the history"
    way = options.derivatives or "spline"
    if len(q) < FEWEST[way]:
        message = (
            f"{history.path} has {len(q)} instants, too few to derive {' and '.join(missing)}; "
            f"give {FEWEST[way]} or more instants, or the derivatives"
        )
        raise StudyError(message)
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
    joint: PortableJoint,
    record: ReducedRecord,
    history: ImportedHistory,
    options: RecoverOptions,
) -> tuple[Recovered, str]:
    """Simulate under boundary forces, then recover."""
    if options.derivatives is not None:
        message = f"{history.path} has boundary forces only; remove --derivatives"
        raise StudyError(message)
    if history.frame is not None:
        message = (
            f"{history.path} has supports that move but no coordinates; give q1, q2, … too, for "
            "only supports at rest are simulated here"
        )
        raise StudyError(message)
    if len(history.times) < 2 or history.times[0] != 0:
        message = (
            f"{history.path}: boundary forces need two or more instants, the first at time 0, "
            "when the joint rests under its bolts; add one"
        )
        raise StudyError(message)
    solution = simulate_boundary_loads(
        restored_model(joint, record),
        history.times,
        history.loads,
        step=options.step,
        integrator=options.integrator,
        name=history.path.name,
    )
    recovered = recover_reduced(restored_recovery(joint, record), solution)
    return recovered, "simulated"


def _histories(history: ImportedHistory) -> Mapping[str, History]:
    times: Vector = history.times
    return {name: History(times, values) for name, values in history.loads.items()}
