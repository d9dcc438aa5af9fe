"""Transient contact solutions of full and reduced models, Eqs. (15.13) and (15.16)."""

from collections.abc import Callable, Sequence

from faying.joint.system import System
from faying.simulation.compiled import warn_of_compiled
from faying.simulation.divided_steps import divided_steps
from faying.simulation.instants import check_times
from faying.simulation.integrators import Integrator
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.stepping import transient_solver


def solve_transient(
    system: System,
    load: Load,
    *,
    step: float,
    duration: float,
    integrator: Integrator | None = None,
    initial: Solution | None = None,
    progress: Callable[[int], object] | None = None,
    compiled: bool | None = None,
    tolerance: float | None = None,
) -> Solution:
    """Integrate the response to a load that acts from t = 0+ on a prestressed joint at rest.

    Parameters
    ----------
    system
        Full or reduced model.
    load
        Constant forces act as a step; histories are taken at the end of each step.
    step, duration : [time]
    integrator
        :class:`ImplicitEuler` by default.
    initial
        Static solution to start from; by default the joint under its bolts alone.
    progress
        Called with the number of steps done since the last call: one, or more if compiled.
    compiled
        Deprecated, without effect: steps of a reduced model are compiled where numba is installed
        (extra ``compiled``; 15 s once per installation), the same results up to round-off.
    tolerance
        Largest pressure error of the time steps over the largest pressure. With it each ``step``
        is divided as needed, up to 64 parts: ``substeps`` of the solution holds their number,
        ``step_error`` the estimated errors, whose sum is at most the tolerance unless 64 parts do
        not suffice.

    Returns
    -------
    Solution
        With ``n_time = round(duration / step) + 1`` instants, the first one being ``initial``.

    Raises
    ------
    ModelError
        If the step is not positive or longer than the duration, or the load does not fit.

    Notes
    -----
    One factorization of the effective matrix, then per step two back-substitutions and a contact
    problem with a warm start. Contact is implicit: forces at the end of a step obey Eq. (15.7) or
    (15.12) there.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    >>> moved = fy.solve_transient(rom, fy.Load({"tip.Fz": -50.0}), step=1e-5, duration=1e-3)
    >>> moved.times.shape, moved.pressure.shape
    ((101,), (101, 112))
    """
    warn_of_compiled(compiled)
    check_times(step, duration)
    if tolerance is not None:
        divided = divided_steps(system, step=step, tolerance=tolerance, integrator=integrator)
        return divided.solve(load, duration=duration, initial=initial, progress=progress)
    solver = transient_solver(system, step=step, integrator=integrator)
    return solver.solve(load, duration=duration, initial=initial, progress=progress)


def solve_transient_cases(
    system: System,
    loads: Sequence[Load],
    *,
    step: float,
    duration: float,
    integrator: Integrator | None = None,
    initial: Sequence[Solution] | None = None,
    progress: Callable[[int], object] | None = None,
    compiled: bool | None = None,
) -> list[Solution]:
    """Integrate the responses to many loads side by side.

    Parameters
    ----------
    loads
        Each as in :func:`solve_transient`.
    initial
        Static solutions to start from, one for each load, for instance of several preloads; by
        default the joint under its bolts alone.
    progress
        Called with the number of steps of all loads done since the last call.
    compiled
        As in :func:`solve_transient`.

    Returns
    -------
    list of Solution
        In the order of the loads; equal to separate solutions up to round-off.

    Raises
    ------
    ModelError
        As :func:`solve_transient`, or if loads and initial solutions differ in number.

    Notes
    -----
    The matrix products and back-substitutions of a step are done for all cases at once; contact
    problems are solved case by case. All histories are in memory together: 3 n_dof + 2 n_point
    numbers per case and instant.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    >>> loads = [fy.Load({"tip.Fz": -force}) for force in (20.0, 40.0)]
    >>> first, second = fy.solve_transient_cases(rom, loads, step=1e-5, duration=1e-3)
    >>> bool(abs(second.states).max() > abs(first.states).max())
    True
    """
    warn_of_compiled(compiled)
    check_times(step, duration)
    solver = transient_solver(system, step=step, integrator=integrator)
    return solver.solve_cases(loads, duration=duration, initial=initial, progress=progress)
