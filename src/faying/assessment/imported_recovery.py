"""Recovery from histories of other programs: modal coordinates, or forces at boundaries."""

from collections.abc import Mapping

import numpy as np
from scipy.interpolate import CubicSpline

from faying._typing import Matrix, Vector
from faying.assessment.recovery import Recovered, recover_pressure, solve_instants
from faying.exceptions import refuse_model
from faying.reduction.recovery import Recovery
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.frame_motion import FrameMotion
from faying.simulation.integrators import Integrator
from faying.simulation.load import History, Load
from faying.simulation.transient import solve_transient


def recover_from_modal(
    operator: Recovery,
    times: Vector,
    coordinates: Matrix,
    load: Load,
    *,
    velocities: Matrix | None = None,
    accelerations: Matrix | None = None,
    frame_motion: FrameMotion | None = None,
) -> Recovered:
    """Recover pressures from a modal history of another program.

    Parameters
    ----------
    operator
        Recovery matrices of the basis: ``rom.recovery``, or :func:`recovery_operator` for moving
        supports.
    times : (n_time,) [time]
        Increasing.
    coordinates : (n_time, n_mode)
        q in the order of the basis; used only where a derivative is missing.
    load
        Boundary forces at those instants, e.g. as :class:`~faying.simulation.load.History`, and
        bolt forces.
    velocities, accelerations : (n_time, n_mode), optional
        Computed by a cubic spline where missing: accelerations from given velocities, otherwise
        from the coordinates. The error falls with the sampling interval, but only to first order
        where contact changes. A spline rings across a jump of the load, and implicit Euler's
        accelerations are not those of a smooth curve: export accelerations there, or use
        :func:`backward_differences`.
    frame_motion
        Motion of the supports, if they move; coordinates are then relative to them.

    Raises
    ------
    ModelError
        If shapes do not fit, times do not increase, or fewer than four instants must be
        differentiated.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> basis = fy.craig_bampton(joint, normal_modes=4)
    >>> rom, push = fy.reduce(joint, basis), fy.Load({"tip.Fz": -100.0})
    >>> moved = fy.solve_transient(rom, push, step=1e-5, duration=1e-4)
    >>> known = fy.recover_from_modal(rom.recovery, moved.times, moved.states, push)
    >>> known.pressure.shape
    (11, 112)
    """
    times = np.asarray(times, dtype=float)
    shape = (len(times), operator.inertia.shape[1])
    histories = {
        "coordinates": coordinates,
        "velocities": velocities,
        "accelerations": accelerations,
    }
    for name, values in histories.items():
        if values is not None and np.shape(values) != shape:
            refuse_model(
                f"the {name} have shape {np.shape(values)}, expected {shape}: "
                "one row per time and one column per trial vector"
            )
    v, a = _derivatives(times, np.asarray(coordinates), velocities, accelerations)
    inputs = load.inputs(operator.joint, times)
    free = operator.free_displacements(inputs, v, a)
    if frame_motion is not None:
        free = free - _frame_displacements(operator, frame_motion, len(times))
    return solve_instants(operator.joint, load.name, inputs, free, times)


def _frame_displacements(operator: Recovery, motion: FrameMotion, n_time: int) -> Matrix:
    """Return Q K⁻¹ M A times the accelerations of the frame (n_time, n_port)."""
    if operator.frame is None:
        refuse_model(
            "the recovery matrices know nothing of supports that move, for the mass of supported "
            "nodes was not kept; run the study again with this version of faying, or take "
            "for_moving_supports(model, rom) of faying.reduction.projection"
        )
    fields = motion.fields()
    if len(fields) != n_time:
        refuse_model(f"the frame's motion has {len(fields)} instants but the history {n_time}")
    return np.asarray(fields @ operator.frame.T)


def backward_differences(times: Vector, coordinates: Matrix) -> tuple[Matrix, Matrix]:
    """Return the velocities and accelerations of implicit Euler, from rest, at equal steps.

    For coordinates (n_time, n_mode) these are (q₁ − q₀)/h and its difference over h; zero at the
    first instant.
    """
    steps = np.diff(np.asarray(times, dtype=float))[:, None]
    velocities, accelerations = np.zeros((2, *np.shape(coordinates)))
    velocities[1:] = np.diff(coordinates, axis=0) / steps
    accelerations[1:] = np.diff(velocities, axis=0) / steps
    return velocities, accelerations


def recover_from_boundary_loads(
    rom: ReducedModel,
    times: Vector,
    forces: Mapping[str, Vector],
    *,
    step: float | None = None,
    integrator: Integrator | None = None,
    name: str = "boundary loads",
) -> Recovered:
    """Simulate a reduced model under imported boundary forces, then recover its pressures.

    The most accurate recovery: with ``compliance=True`` the inertia forces of the reduced model
    are accurate, see ``docs/theory/recovery.md``.

    Parameters
    ----------
    times : (n_time,) [time]
        Starting at zero, with the joint at rest under its bolts.
    forces
        ``"boundary.component"`` to forces or moments (n_time,), linear in between.
    step
        Time step; by default the smallest interval between ``times``.

    Raises
    ------
    ModelError
        If the times do not start at zero and increase, or a boundary does not exist.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> import numpy as np
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    >>> times = np.linspace(0.0, 1e-4, 11)
    >>> ramp = {"tip.Fz": -100.0 * times / times[-1]}
    >>> fy.recover_from_boundary_loads(rom, times, ramp).pressure.shape
    (11, 112)
    """
    times = np.asarray(times, dtype=float)
    if len(times) < 2 or times[0] != 0:
        refuse_model("boundary loads need at least two instants, the first at time zero")
    load = Load({key: History(times, values) for key, values in forces.items()}, name=name)
    interval = float(np.diff(times).min()) if step is None else step
    solution = solve_transient(
        rom, load, step=interval, duration=float(times[-1]), integrator=integrator
    )
    return recover_pressure(rom, solution)


def _derivatives(
    times: Vector, q: Matrix, v: Matrix | None, a: Matrix | None
) -> tuple[Matrix, Matrix]:
    """Return velocities and accelerations, by a cubic spline where they are missing."""
    if v is not None and a is not None:
        return v, a
    if len(times) < 4 or not (np.diff(times) > 0).all():
        refuse_model(
            f"{len(times)} instants are too few, or do not increase, to derive what is missing; "
            "give velocities and accelerations"
        )
    velocity = CubicSpline(times, q).derivative()(times) if v is None else v
    if a is not None:
        return velocity, a
    if v is None:
        return velocity, CubicSpline(times, q).derivative(2)(times)
    return velocity, CubicSpline(times, v).derivative()(times)
