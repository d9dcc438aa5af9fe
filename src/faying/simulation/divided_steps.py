"""Transients with time steps divided until pressures are within a tolerance.

Instants keep their distance; each interval between two of them is solved in 1, 2, 4, … steps. Of
two solutions of an interval from the same state, one with twice the steps of the other, the finer
is kept. Its error is the largest change of a pressure between them, times :data:`SAFETY` over the
order of the scheme: ``docs/theory/time_integration.md``.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.system import System
from faying.simulation.instants import check_times
from faying.simulation.integrators import ImplicitEuler, Integrator
from faying.simulation.load import Load
from faying.simulation.path_steps import MOST_DIVISIONS
from faying.simulation.restart import Restart
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import joined, some_states
from faying.simulation.start import begun
from faying.simulation.stepping import TransientSolver
from faying.simulation.transient_windows import transient_windows

SAFETY = 5.0
"""Largest error of a first-order transient over the sum of changes by halved steps.

Displacements and velocities carry errors on that pressures of an interval do not show, and neither
step resolves motions faster than both. The error was up to 4.2 times the sum on a hub pressed on a
shaft, and 2.1 on two lap joints and a flange; 1.4 and 1.7 on a tee and a bracket, which were not
used to choose the factor. For schemes of second order, at most 0.7, half the factor is taken.
"""

Tried = tuple[Solution, Restart]
"""Solution of an interval in some number of steps, and the restart after it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DividedSteps:
    """Solver of transients with adaptive division of time steps.

    Attributes
    ----------
    system
        Full or reduced model.
    scheme
        Integrator.
    step : [time]
        Between two instants, and the largest.
    tolerance
        Largest sum over the whole duration of the errors of its intervals, over the largest
        pressure so far.
    lengths
        Solvers of intervals in 1, 2, 4, … steps; each is factorized at its first use.
    given : (n_time,) or None
        Steps that lead to each instant; by default chosen by error.
    """

    system: System
    scheme: Integrator
    step: float
    tolerance: float
    lengths: tuple[TransientSolver, ...]
    given: Indices | None = None

    def solve(
        self,
        load: Load,
        *,
        duration: float,
        initial: Solution | None = None,
        substeps: Indices | None = None,
        progress: Callable[[int], object] | None = None,
    ) -> Solution:
        """Integrate one response; with given ``substeps`` without error control."""
        parts = transient_windows(
            replace(self, given=substeps),
            [load],
            duration=duration,
            length=None,
            initial=None if initial is None else [initial],
            progress=progress,
        )
        return next(part for (part,), _ in parts)

    def begun(self, loads: Sequence[Load], starts: Sequence[Solution]) -> list[Restart]:
        """Return the restarts of responses that begin at static solutions."""
        finest = self.step / 2**MOST_DIVISIONS
        return [
            replace(restart, peak=float(start.pressure.max(initial=0.0)))
            for restart, start in zip(
                begun(self.system, self.scheme, finest, loads, starts), starts, strict=True
            )
        ]

    def advanced(
        self,
        here: Sequence[Restart],
        loads: Sequence[Load],
        starts: Sequence[Solution],
        *,
        end: int,
        last: int,
        progress: Callable[[int], object] | None,
    ) -> tuple[list[Solution], list[Restart]]:
        """Integrate each response up to instant ``end``, with time steps of its own."""
        histories = [[_first_instant(start)] for start in starts] or [[] for _ in loads]
        walked = [
            self._continue_response(one, load, history, end, last, progress)
            for one, load, history in zip(here, loads, histories, strict=True)
        ]
        return [solution for solution, _ in walked], [after for _, after in walked]

    def _continue_response(
        self,
        restart: Restart,
        load: Load,
        solutions: list[Solution],
        end: int,
        last: int,
        progress: Callable[[int], object] | None,
    ) -> tuple[Solution, Restart]:
        """Return one response up to instant ``end``, after its earlier parts ``solutions``."""
        while restart.done < end:
            level = (
                None if self.given is None else int(self.given[restart.done + 1]).bit_length() - 1
            )
            interval, restart = self._interval(load, restart, last, level)
            solutions.append(interval)
            if progress is not None:
                progress(1)
        return joined(solutions), restart

    def _interval(
        self, load: Load, restart: Restart, last: int, fixed_level: int | None
    ) -> tuple[Solution, Restart]:
        """Return the solution at the next instant, and the restart there."""
        if fixed_level is not None:
            interval, end = self._solve_interval(load, restart, fixed_level)
            return _interval_end(interval, fixed_level, np.nan), replace(end, level=fixed_level)
        allowed = self.tolerance / last
        level = max(restart.level, 1)
        tried = {n: self._try_interval(load, restart, n) for n in (level - 1, level)}
        while (
            error := self._error(tried, level, restart.peak)
        ) > allowed and level < MOST_DIVISIONS:
            level += 1
            tried[level] = self._try_interval(load, restart, level)
        interval, end = tried[level] or self._solve_interval(load, restart, level)
        eased = level > 1 and 2**self.scheme.order * error <= allowed
        level_after = level - 1 if eased else level
        ended = replace(end, level=level_after, peak=_peak(restart.peak, interval))
        return _interval_end(interval, level, error), ended

    def _error(self, tried: Mapping[int, Tried | None], level: int, peak: float) -> float:
        """Return the error of the finer solution at the end, over the largest pressure so far."""
        coarse, fine = tried[level - 1], tried[level]
        if coarse is None or fine is None:
            return np.inf
        coarse_pressure, fine_pressure = coarse[0].pressure[-1], fine[0].pressure[-1]
        largest = _peak(peak, fine[0])
        change = float(np.abs(coarse_pressure - fine_pressure).max(initial=0.0))
        return SAFETY / self.scheme.order * change / largest if largest > 0 else 0.0

    def _try_interval(self, load: Load, restart: Restart, level: int) -> Tried | None:
        """Integrate over one interval; None where contact does not converge."""
        try:
            return self._solve_interval(load, restart, level)
        except ConvergenceError:
            return None

    def _solve_interval(self, load: Load, restart: Restart, level: int) -> Tried:
        """Integrate over one interval in 2 to the power ``level`` steps."""
        count, solver = 2**level, self.lengths[level]
        start = replace(restart, done=restart.done * count)
        first = start.done
        (part,), (end,) = solver.advanced(
            [start], [load], [], end=first + count, last=first + count, progress=None
        )
        return part, replace(end, done=restart.done + 1, peak=restart.peak)


def divided_steps(
    system: System,
    *,
    step: float,
    tolerance: float,
    integrator: Integrator | None = None,
) -> DividedSteps:
    """Return the solver of transients of a system within a pressure tolerance."""
    check_times(step, step)
    if not tolerance > 0:
        message = f"the tolerance is {tolerance:g}; give a positive share of the largest pressure"
        raise ModelError(message)
    scheme = ImplicitEuler() if integrator is None else integrator
    lengths = (
        TransientSolver(system=system, scheme=scheme, step=step / 2**level)
        for level in range(MOST_DIVISIONS + 1)
    )
    return DividedSteps(
        system=system, scheme=scheme, step=step, tolerance=tolerance, lengths=tuple(lengths)
    )


def _peak(peak: float, solution: Solution) -> float:
    return max(peak, float(solution.pressure[-1].max(initial=0.0)))


def _interval_end(solution: Solution, level: int, error: float) -> Solution:
    """Return the last instant of an interval, with the totals of its steps."""
    return replace(
        some_states(solution, np.array([-1])),
        iterations=solution.iterations.sum(keepdims=True),
        dissipation=np.atleast_1d(np.sum(solution.dissipation)),
        substeps=np.array([2**level]),
        step_error=np.array([error]),
    )


def _first_instant(first: Solution) -> Solution:
    """Return the static solution at the start of a transient as its first instant."""
    nothing = np.zeros(1)
    return replace(
        first,
        states=first.states[None],
        contact_forces=first.contact_forces[None],
        gap=first.gap[None],
        inputs=first.inputs[None],
        times=nothing,
        velocities=np.zeros((1, len(first.states))),
        accelerations=np.zeros((1, len(first.states))),
        shear_forces=first.shear_forces[None],
        shear_slip=first.shear_slip[None],
        iterations=np.zeros(1, dtype=np.int64),
        dissipation=nothing,
        substeps=np.zeros(1, dtype=np.int64),
        step_error=nothing,
    )
