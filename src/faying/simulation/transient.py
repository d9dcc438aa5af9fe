"""Transient contact solutions of full and reduced models, Eqs. (15.13) and (15.16)."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from faying._typing import Mask, Vector
from faying.contact.condensed import CondensedContact, relative_compliance
from faying.exceptions import ModelError
from faying.linalg.factorization import Factorization, factorize
from faying.linalg.threads import threads_for
from faying.model.system import System, input_forces
from faying.simulation.integrators import ImplicitEuler, Integrator, Motion
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.static import relative_forces, solve_static

INITIAL_FRACTION = 1e-3
"""Part of a step over which the initial acceleration is averaged.

It bounds the acceleration of massless degrees of freedom; modes the step resolves see a relative
error of its square.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class Restart:
    """Where a transient stands.

    Attributes
    ----------
    done
        Steps behind it.
    motion
        Displacement, velocity, acceleration and force there.
    active : (n_point,)
        Points in contact.
    """

    done: int
    motion: Motion
    active: Mask


def solve_transient(
    system: System,
    load: Load,
    *,
    step: float,
    duration: float,
    integrator: Integrator | None = None,
    initial: Solution | None = None,
    progress: Callable[[int], object] | None = None,
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
        :class:`ImplicitEuler` unless given.
    initial
        Static solution to start from; by default the joint under its bolts alone.
    progress
        Called with 1 after every step.

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
    One factorization of the effective matrix, then per step two back-substitutions and a warm
    contact problem. Contact is implicit: the forces at the end of a step obey Eq. (15.7) or
    (15.12) there.
    """
    _check_times(step, duration)
    solver = transient_solver(system, step=step, integrator=integrator)
    return solver.solve(load, duration=duration, initial=initial, progress=progress)


def transient_pieces(
    system: System,
    load: Load,
    *,
    step: float,
    duration: float,
    length: int | None,
    integrator: Integrator | None = None,
    initial: Solution | None = None,
    restart: Restart | None = None,
    progress: Callable[[int], object] | None = None,
) -> Iterator[tuple[Solution, Restart]]:
    """Integrate as :func:`solve_transient`, a piece of the instants at a time.

    Parameters
    ----------
    length
        Steps of a piece; None is all at once. Memory is that of one piece.
    restart
        Where an earlier run ended, to go on from there.

    Yields
    ------
    Solution
        Consecutive instants: the first piece begins with ``initial``, every later one with the
        instant after the piece before.
    Restart
        Where the piece ended.

    Raises
    ------
    ModelError
        As :func:`solve_transient`.
    """
    _check_times(step, duration)
    solver = transient_solver(system, step=step, integrator=integrator)
    yield from solver.pieces(
        load,
        duration=duration,
        length=length,
        initial=initial,
        restart=restart,
        progress=progress,
    )


def transient_solver(
    system: System, *, step: float, integrator: Integrator | None = None
) -> "TransientSolver":
    """Factorize what all transients of a system with one time step share.

    Parameters
    ----------
    step : [time]
    integrator
        :class:`ImplicitEuler` unless given.

    Raises
    ------
    ModelError
        If the step is not positive.

    Notes
    -----
    One factorization and the compliance of a step; :meth:`TransientSolver.solve` then has only the
    steps left to do.
    """
    _check_times(step, step)
    scheme = ImplicitEuler() if integrator is None else integrator
    effective = factorize(scheme.effective_matrix(system, step))
    return TransientSolver(
        system=system,
        scheme=scheme,
        step=step,
        effective=effective,
        condensed=_condense_step(system, scheme, effective),
    )


def _check_times(step: float, duration: float) -> None:
    if not 0 < step <= duration:
        message = (
            f"the time step is {step:g} and the duration {duration:g}; "
            "the step must be positive and no longer than the duration"
        )
        raise ModelError(message)


@dataclass(frozen=True, eq=False, kw_only=True)
class TransientSolver:
    """What all transients of a system with one time step have in common.

    Attributes
    ----------
    system
        Full or reduced model.
    scheme
        Integrator.
    step : [time]
    effective
        Factorization of its effective matrix.
    condensed
        Contact problem of one step.
    """

    system: System
    scheme: Integrator
    step: float
    effective: Factorization
    condensed: CondensedContact

    def solve(
        self,
        load: Load,
        *,
        duration: float,
        initial: Solution | None = None,
        progress: Callable[[int], object] | None = None,
    ) -> Solution:
        """Integrate one response; see :func:`solve_transient`."""
        pieces = self.pieces(
            load, duration=duration, length=None, initial=initial, progress=progress
        )
        return next(pieces)[0]

    def pieces(
        self,
        load: Load,
        *,
        duration: float,
        length: int | None,
        initial: Solution | None = None,
        restart: Restart | None = None,
        progress: Callable[[int], object] | None = None,
    ) -> Iterator[tuple[Solution, Restart]]:
        """Integrate a piece of the instants at a time; see :func:`transient_pieces`."""
        _check_times(self.step, duration)
        system, step = self.system, self.step
        last = round(duration / step)
        here = restart
        if here is None:
            start = solve_static(system) if initial is None else initial
            external = input_forces(system, load.inputs(system, np.zeros(1)))[0]
            motion = _initial_motion(system, self.scheme, start, external, step)
            here = Restart(done=0, motion=motion, active=start.contact_forces > 0)
        else:
            start = None
        size = max(last - here.done, 1) if length is None else length
        while here.done < last:
            end = min(here.done + size, last)
            times = step * np.arange(here.done + 1, end + 1, dtype=np.float64)
            piece, here = self._advanced(here, load, times, start, progress)
            start = None
            yield piece, here

    def _advanced(
        self,
        here: Restart,
        load: Load,
        times: Vector,
        start: Solution | None,
        progress: Callable[[int], object] | None,
    ) -> tuple[Solution, Restart]:
        """Return the instants ``times``, after the start where there is one, and their end."""
        system, scheme, step = self.system, self.scheme, self.step
        inputs = load.inputs(system, times)
        external = input_forces(system, inputs)
        motion, active = here.motion, here.active
        n_time, first = len(times) + (start is not None), int(start is not None)
        states, velocities, accelerations = (np.zeros((n_time, len(motion.u))) for _ in range(3))
        forces = np.zeros((n_time, system.contact.n_points))
        gaps, iterations = np.zeros_like(forces), np.zeros(n_time, dtype=np.int64)
        errors = np.zeros(n_time)
        if start is not None:
            states[0], accelerations[0] = motion.u, motion.a
            forces[0], gaps[0] = start.contact_forces, start.gap
            inputs = np.concatenate([start.inputs[None], inputs])
            times = np.concatenate([[0.0], times])
        with threads_for(system.contact.n_points):
            for n, loads in enumerate(external, start=first):
                right = scheme.right_hand_side(system, motion, step) + scheme.force_weight * loads
                free = system.contact.relative_operator @ self.effective.solve(right)
                contact = self.condensed.solve(free, active)
                from_contact = relative_forces(system, contact.forces)
                u = self.effective.solve(right + scheme.force_weight * from_contact)
                motion = scheme.advance(motion, u, loads + from_contact, step)
                states[n], velocities[n], accelerations[n] = motion.u, motion.v, motion.a
                forces[n], gaps[n] = contact.forces, self.condensed.gap(contact)
                iterations[n], active = contact.iterations, contact.active
                errors[n] = contact.error
                if progress is not None:
                    progress(1)
        piece = Solution(
            name=load.name,
            system=system,
            states=states,
            contact_forces=forces,
            gap=gaps,
            inputs=inputs,
            iterations=iterations,
            contact_error=errors,
            times=times,
            velocities=velocities,
            accelerations=accelerations,
        )
        return piece, Restart(done=here.done + len(external), motion=motion, active=active)


def _condense_step(
    system: System, scheme: Integrator, effective: Factorization
) -> CondensedContact:
    """Compliance of one time step, P A⁻¹ Pᵀ times the weight of the new forces."""
    return CondensedContact(
        contact=system.contact,
        compliance=relative_compliance(system.contact, effective, scheme.force_weight),
    )


def _initial_motion(
    system: System, scheme: Integrator, start: Solution, external: Vector, step: float
) -> Motion:
    """Return the state at rest, with the acceleration the suddenly applied load causes."""
    force = external + relative_forces(system, start.contact_forces)
    rest = np.zeros_like(start.states)
    if not scheme.needs_acceleration:
        return Motion(start.states, rest, rest, force)
    unbalanced = force - system.K @ start.states
    averaging = system.M + (INITIAL_FRACTION * step) ** 2 * system.K
    return Motion(start.states, rest, factorize(averaging).solve(unbalanced), force)
