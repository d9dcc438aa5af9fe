"""Time steps of transients side by side, with one factorization for all cases."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from faying._typing import Matrix, SparseMatrix
from faying.contact.condensed import CondensedContact, structure_between
from faying.contact.state import ContactState
from faying.exceptions import ConvergenceError
from faying.iterations import RETRIES
from faying.joint.system import System, input_forces
from faying.linalg.factorization import factorize
from faying.linalg.interface import Factorization
from faying.linalg.threads import threads_for
from faying.simulation.compiled import CompiledSteps, compiled_steps, stacked, unstacked
from faying.simulation.energy_guard import EnergyGuard
from faying.simulation.instants import Instants, check_times, require_history_room
from faying.simulation.integrators import ImplicitEuler, Integrator, Motion
from faying.simulation.load import Load
from faying.simulation.path_steps import PathStep
from faying.simulation.restart import Restart, each_of, side_by_side
from faying.simulation.solution import Solution
from faying.simulation.start import begun, starting_states
from faying.simulation.static import relative_forces
from faying.simulation.step_contact import StepContact
from faying.simulation.transient_windows import transient_windows

SIDE_BY_SIDE = 16
"""Cases advanced together; more would be no faster and take more memory."""

STEPS_AT_ONCE = 2000
"""Steps between reports of progress, checks for interrupts and writes of a stream: a second of
computing at most, and 15 MB for a thousand contact points."""


def transient_solver(
    system: System,
    *,
    step: float,
    integrator: Integrator | None = None,
) -> "TransientSolver":
    """Return the solver of all transients of a system with one time step.

    Parameters
    ----------
    step : [time]
    integrator
        :class:`ImplicitEuler` by default.

    Raises
    ------
    ModelError
        If the step is not positive, or a law remembers closure.

    Notes
    -----
    One factorization and the compliance of a step, (M7) of ``docs/theory/method.md``;
    :meth:`TransientSolver.solve` then has only the steps left to do.
    """
    scheme = ImplicitEuler() if integrator is None else integrator
    solver = TransientSolver(system=system, scheme=scheme, step=step)
    _ = solver.condensed
    return solver


@dataclass(frozen=True, eq=False, kw_only=True)
class TransientSolver:
    """The solver of all transients of a system with one time step.

    Attributes
    ----------
    system
        Full or reduced model.
    scheme
        Integrator.
    step : [time]
    """

    system: System
    scheme: Integrator
    step: float

    def __post_init__(self) -> None:
        check_times(self.step, self.step)
        self.system.contact.check_forgetful("time steps", "solve_path")

    @cached_property
    def effective(self) -> Factorization:
        """Factorization of the effective matrix."""
        return factorize(self._effective_matrix)

    @cached_property
    def _effective_matrix(self) -> SparseMatrix | Matrix:
        return self.scheme.effective_matrix(self.system, self.step)

    @cached_property
    def condensed(self) -> CondensedContact:
        """Contact problem of one step: compliance P A⁻¹ Pᵀ times the weight of the new forces."""
        contact, weight = self.system.contact, self.scheme.force_weight
        return CondensedContact(
            contact=contact,
            compliance=structure_between(contact, self._effective_matrix, self.effective, weight),
            at_rest=partial(getattr, self.system, "static_contact"),
        )

    def solve(
        self,
        load: Load,
        *,
        duration: float,
        initial: Solution | None = None,
        progress: Callable[[int], object] | None = None,
    ) -> Solution:
        """Integrate one response; see :func:`solve_transient`."""
        starts = None if initial is None else [initial]
        return self.solve_cases([load], duration=duration, initial=starts, progress=progress)[0]

    def solve_cases(
        self,
        loads: Sequence[Load],
        *,
        duration: float,
        initial: Sequence[Solution] | None = None,
        progress: Callable[[int], object] | None = None,
    ) -> list[Solution]:
        """Integrate responses side by side; see :func:`solve_transient_cases`."""
        check_times(self.step, duration)
        require_history_room(len(loads), round(duration / self.step) + 1, self.system)
        starts = starting_states(self.system, loads, initial)
        solutions: list[Solution] = []
        for first in range(0, len(loads), SIDE_BY_SIDE):
            cases = slice(first, first + SIDE_BY_SIDE)
            windows = transient_windows(
                self,
                loads[cases],
                duration=duration,
                length=None,
                initial=starts[cases],
                progress=progress,
            )
            solutions += [solution for window, _ in windows for solution in window]
        return solutions

    def begun(self, loads: Sequence[Load], starts: Sequence[Solution]) -> list[Restart]:
        """Return restarts of responses that begin at static solutions."""
        return begun(self.system, self.scheme, self.step, loads, starts)

    def advanced(
        self,
        here: Sequence[Restart],
        loads: Sequence[Load],
        starts: Sequence[Solution],
        *,
        end: int,
        last: int,  # noqa: ARG002
        progress: Callable[[int], object] | None,
    ) -> tuple[list[Solution], list[Restart]]:
        """Integrate up to instant ``end``; see :class:`~.transient_windows.Steps`."""
        system = self.system
        times = self.step * np.arange(here[0].done + 1, end + 1, dtype=np.float64)
        since = np.append(here[0].done * self.step, times)
        inputs = np.array([load.inputs(system, since) for load in loads])
        first = int(bool(starts))
        history = Instants.empty(len(loads), first + len(times), system)
        guard = EnergyGuard(
            system=system,
            step=self.step,
            force_weight=self.scheme.force_weight,
            loads=[load.name for load in loads],
            starts=[restart.motion for restart in here],
            ledgers=[restart.ledger for restart in here],
            inputs=inputs,
            history=history.instants(first, first + len(times)),
        )
        inputs = inputs[:, 1:]
        external = input_forces(system, inputs)
        if starts:
            history.begin(side_by_side([restart.motion for restart in here]), starts)
            inputs = np.concatenate([[[start.inputs] for start in starts], inputs], axis=1)
            times = np.concatenate([[0.0], times])
        with threads_for(self.condensed.order), guard.watching():
            ends = self._advance(here, external, history, first, progress)
        ledgers = guard.audit()
        history.gaps[:, first:] -= system.contact.closed_by(history.forces[:, first:])
        solutions = [
            Solution(
                name=load.name,
                system=system,
                states=history.states[case],
                contact_forces=history.forces[case],
                gap=history.gaps[case],
                inputs=inputs[case],
                iterations=history.iterations[case],
                times=times,
                velocities=history.velocities[case],
                accelerations=history.accelerations[case],
                energy_gain=ledgers[case].gain,
                shear_forces=history.shear[case],
                shear_slip=history.slip[case],
                dissipation=history.dissipation[case],
            )
            for case, load in enumerate(loads)
        ]
        return solutions, [
            replace(end, ledger=ledger) for end, ledger in zip(ends, ledgers, strict=True)
        ]

    def _advance(
        self,
        here: Sequence[Restart],
        external: Matrix,
        history: Instants,
        first: int,
        progress: Callable[[int], object] | None,
    ) -> list[Restart]:
        """Write the instants from ``first`` on, by the compiled loop or side by side."""
        n_case, n_step = external.shape[:2]
        if self._compiled is not None:
            walk = partial(self._advance_compiled, self._compiled)
            cases = zip(here, external, strict=True)
            return [
                walk(start, applied, history.of_case(case), first, progress)
                for case, (start, applied) in enumerate(cases)
            ]
        motion = side_by_side([restart.motion for restart in here])
        states: Sequence[ContactState] = [restart.contact for restart in here]
        for n in range(n_step):
            with _naming_step(here[0].done + n + 1, self.step):
                motion, states, ends = self._step(motion, states, external[:, n].T)
            history.note(first + n, motion, ends)
            if progress is not None:
                progress(n_case)
        return each_of(here[0].done + n_step, motion, states)

    def _step(
        self, motion: Motion, states: Sequence[ContactState], applied: Matrix
    ) -> tuple[Motion, Sequence[ContactState], Sequence[PathStep]]:
        """Return the motion after a step, its contact states, and the steps of contact.

        Linear operations are done for all cases at once, with one case a column.
        """
        system, scheme = self.system, self.scheme
        right = scheme.right_hand_side(system, motion, self.step) + scheme.force_weight * applied
        free = system.contact.relative_operator @ self.effective.solve(right)
        acting, ends, states_after = self._step_contact.solve(free.T, states, motion.contact.T)
        from_contact = relative_forces(system, *system.contact.parts(acting)).T
        u = self.effective.solve(right + scheme.force_weight * from_contact)
        carried_force = scheme.kept_force(applied, from_contact)
        motion = scheme.advance(motion, u, carried_force, self.step)
        forces = [end.increment.forces[: system.contact.components].ravel() for end in ends]
        return replace(motion, contact=np.array(forces).T), states_after, ends

    @cached_property
    def _step_contact(self) -> StepContact:
        return self.scheme.step_contact(self.condensed)

    @cached_property
    def _compiled(self) -> CompiledSteps | None:
        return compiled_steps(self.system, self.scheme, self.step, self.effective, self.condensed)

    def _advance_compiled(
        self,
        compiled: CompiledSteps,
        here: Restart,
        external: Matrix,
        history: Instants,
        first: int,
        progress: Callable[[int], object] | None,
    ) -> Restart:
        """Write the instants of one case; steps the loop cannot do are done in Python."""
        motion, state = stacked(here.motion), here.contact
        n, failures = 0, 0
        while n < len(external):
            chunk, done = external[n : n + STEPS_AT_ONCE], 0
            if failures < RETRIES:
                done, state = compiled.advance(motion, state, chunk, history, first + n)
            failures = 0 if done else failures + 1
            if done < len(chunk):
                moved, (state_after,), ends = self._step(
                    unstacked(motion[:, None]), [state], chunk[done][:, None]
                )
                state = replace(state_after, supported=state.supported)
                history.note(first + n + done, moved, ends)
                motion, done = stacked(moved), done + 1
            n += done
            if progress is not None:
                progress(done)
        u, v, a, force = np.split(motion, 4)
        end = Motion(u, v, a, force, here.motion.lagging, history.forces[0, first + n - 1])
        return Restart(done=here.done + n, motion=end, contact=state)


@contextmanager
def _naming_step(number: int, step: float) -> Iterator[None]:
    """Add the number and time of the step to errors of contact."""
    try:
        yield
    except ConvergenceError as error:
        message = f"step {number} (t = {number * step:g}): {error}"
        raise ConvergenceError(message) from error
