"""Transients whose steps are divided until their pressures hold a tolerance.

Instants stay as far apart as they were asked for; each interval between two of them is done in
1, 2, 4, … steps. Of two solutions of an interval from the same state, one with twice the steps of
the other, the finer is kept, and the largest change of a pressure between them is its error:
``docs/theory/time_integration.md``.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from faying._typing import Indices
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.system import System
from faying.simulation.energy_guard import warn_of_gain
from faying.simulation.instants import require_history_room
from faying.simulation.integrators import ImplicitEuler, Integrator
from faying.simulation.load import Load
from faying.simulation.restart import Restart
from faying.simulation.solution import Solution
from faying.simulation.start import begun, starting_states
from faying.simulation.stepping import TransientSolver, check_times, transient_solver

FINEST = 6
"""Halvings of an interval at most: 64 steps between two instants."""

EASE = 4.0
"""Error over what is allowed below which the next interval takes half as many steps.

Half the steps make the error of a scheme of second order four times as large.
"""


Tried = tuple[Solution, Restart]
"""An interval in some number of steps, and where the motion stands then."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DividedSteps:
    """Transients of a system whose steps are divided as their pressures need it.

    Attributes
    ----------
    system
        Full or reduced model.
    scheme
        Integrator.
    step : [time]
        Between two instants, and the largest.
    tolerance
        Largest sum over the whole duration of the pressure changes that halving the steps of each
        interval makes, over the largest pressure so far.
    compiled
        Whether steps of reduced models are compiled.
    """

    system: System
    scheme: Integrator
    step: float
    tolerance: float
    compiled: bool = False
    _solvers: dict[int, TransientSolver] = field(default_factory=dict)

    def solve(
        self,
        load: Load,
        *,
        duration: float,
        initial: Solution | None = None,
        substeps: Indices | None = None,
        progress: Callable[[int], object] | None = None,
    ) -> Solution:
        """Integrate one response; with given ``substeps`` by these, without a look at errors."""
        pieces = self.pieces(
            load,
            duration=duration,
            length=None,
            initial=initial,
            substeps=substeps,
            progress=progress,
        )
        return next(piece for piece, _ in pieces)

    def pieces(
        self,
        load: Load,
        *,
        duration: float,
        length: int | None,
        initial: Solution | None = None,
        restart: Restart | None = None,
        substeps: Indices | None = None,
        progress: Callable[[int], object] | None = None,
    ) -> Iterator[tuple[Solution, Restart]]:
        """Integrate a piece of the instants at a time, as :meth:`TransientSolver.pieces`."""
        check_times(self.step, duration)
        last = round(duration / self.step)
        require_history_room(1, (last if length is None else min(length, last)) + 1, self.system)
        here, first = restart, None
        if here is None:
            (first,) = starting_states(self.system, [load], None if initial is None else [initial])
            finest = self.step / 2**FINEST
            (here,) = begun(self.system, self.scheme, finest, [load], [first])
            here = replace(here, peak=float(first.pressure.max(initial=0.0)))
        while here.done < last:
            found: list[Solution] = []
            end = last if length is None else min(here.done + length, last)
            while here.done < end:
                done = here.done
                given = None if substeps is None else int(substeps[done + 1]).bit_length() - 1
                one, here = self._interval(load, here, last, given)
                found.append(one)
                if progress is not None:
                    progress(1)
            yield _joined(found, first), here
            first = None

    def _interval(
        self, load: Load, here: Restart, last: int, given: int | None
    ) -> tuple[Solution, Restart]:
        """Return the next instant, and where the motion stands there."""
        if given is not None:
            one, after = self._tried(load, here, given)
            _warn(load, here, after)
            return _ended(one, given, np.nan), replace(after, level=given)
        allowed = self.tolerance / last
        level = max(here.level, 1)
        coarse, fine = (self._offered(load, here, n) for n in (level - 1, level))
        while (error := _change(coarse, fine, here.peak)) > allowed and level < FINEST:
            level, coarse = level + 1, fine
            fine = self._offered(load, here, level)
        one, after = self._tried(load, here, level) if fine is None else fine
        _warn(load, here, after)
        after = replace(after, level=level, peak=_peak(here.peak, one))
        if level > 1 and EASE * error <= allowed:
            after = replace(_renewed(after), level=level - 1)
        return _ended(one, level, error), after

    def _offered(self, load: Load, here: Restart, level: int) -> Tried | None:
        """Integrate over one interval; None where contact is not solved in so few steps."""
        try:
            return self._tried(load, here, level)
        except ConvergenceError:
            return None

    def _tried(self, load: Load, here: Restart, level: int) -> Tried:
        """Integrate over one interval in 2 to the power ``level`` steps."""
        count, solver = 2**level, self._solver(level)
        start = replace(here if here.level == level else _renewed(here), done=here.done * count)
        ((piece, end),) = solver.pieces(
            load, duration=(here.done + 1) * count * solver.step, length=count, restart=start
        )
        return piece, replace(end, done=here.done + 1, peak=here.peak)

    def _solver(self, level: int) -> TransientSolver:
        """Return the solver of a level, factorized once."""
        if level not in self._solvers:
            self._solvers[level] = transient_solver(
                self.system,
                step=self.step / 2**level,
                integrator=self.scheme,
                compiled=self.compiled,
                warn=False,
            )
        return self._solvers[level]


def divided_steps(
    system: System,
    *,
    step: float,
    tolerance: float,
    integrator: Integrator | None = None,
    compiled: bool | None = None,
) -> DividedSteps:
    """Return what integrates transients of a system within a pressure tolerance.

    Raises
    ------
    ModelError
        If the step or the tolerance is not positive.
    """
    check_times(step, step)
    if not tolerance > 0:
        message = f"the tolerance is {tolerance:g}; give a positive share of the largest pressure"
        raise ModelError(message)
    return DividedSteps(
        system=system,
        scheme=ImplicitEuler() if integrator is None else integrator,
        step=step,
        tolerance=tolerance,
        compiled=bool(compiled),
    )


def _change(coarse: Tried | None, fine: Tried | None, peak: float) -> float:
    """Return the largest change of a pressure at the end, over the largest pressure so far."""
    if coarse is None or fine is None:
        return np.inf
    one, other = coarse[0].pressure[-1], fine[0].pressure[-1]
    largest = _peak(peak, fine[0])
    return float(np.abs(one - other).max(initial=0.0)) / largest if largest > 0 else 0.0


def _peak(peak: float, piece: Solution) -> float:
    return max(peak, float(piece.pressure[-1].max(initial=0.0)))


def _renewed(here: Restart) -> Restart:
    """Return a state without what was made for steps of another length."""
    contact = replace(here.contact, supported=None, steady=False, factor=None)
    return replace(here, contact=contact, trend=np.full_like(here.trend, np.nan))


def _warn(load: Load, before: Restart, after: Restart) -> None:
    """Log that energy appeared from nothing; in steps that were rejected it does not matter."""
    if after.ledger is not None:
        warn_of_gain(load.name, before.ledger, after.ledger)


ALONG = (
    "states",
    "contact_forces",
    "gap",
    "inputs",
    "times",
    "velocities",
    "accelerations",
    "shear_forces",
    "shear_slip",
)
"""Fields of a solution that have one entry for each instant."""


def _ended(piece: Solution, level: int, error: float) -> Solution:
    """Return the last instant of an interval, with what its steps took together."""
    known = {name: getattr(piece, name) for name in ALONG}
    ends: dict[str, Any] = {n: None if value is None else value[-1:] for n, value in known.items()}
    return replace(
        piece,
        **ends,
        iterations=piece.iterations.sum(keepdims=True),
        contact_error=np.max(piece.contact_error, keepdims=True),
        dissipation=np.atleast_1d(np.sum(piece.dissipation)),
        substeps=np.array([2**level]),
        step_error=np.array([error]),
    )


def _joined(found: list[Solution], first: Solution | None) -> Solution:
    """Return the instants as one solution, after the start where there is one."""
    whole = found[-1]
    parts = {
        name: [getattr(one, name) for one in found]
        for name in (*ALONG, "iterations", "contact_error", "dissipation", "substeps", "step_error")
        if getattr(whole, name) is not None
    }
    if first is not None:
        n = first.states.shape[-1]
        begin = {
            "states": first.states,
            "contact_forces": first.contact_forces,
            "gap": first.gap,
            "inputs": first.inputs,
            "times": 0.0,
            "velocities": np.zeros(n),
            "accelerations": np.zeros(n),
            "shear_forces": first.shear_forces,
            "shear_slip": first.shear_slip,
            "iterations": 0,
            "contact_error": 0.0,
            "dissipation": 0.0,
            "substeps": 0,
            "step_error": 0.0,
        }
        for name, rows in parts.items():
            rows.insert(0, np.asarray(begin[name])[None])
    joined: dict[str, Any] = {name: np.concatenate(rows) for name, rows in parts.items()}
    return replace(whole, **joined)
