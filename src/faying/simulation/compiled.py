"""Compiled time steps of reduced models: when they pay, and what the compiled loop is given."""

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import find_spec

import numpy as np
import scipy.linalg as la

from faying._typing import Mask, Matrix, Vector
from faying.contact.condensed import CondensedContact
from faying.contact.sprung_pairs import MOST_CHANGED, MOST_RENEWALS, SprungPairs
from faying.exceptions import ModelError
from faying.joint.system import System
from faying.linalg.factorization import Factorization
from faying.simulation.history import History, Trend
from faying.simulation.integrators import Integrator, Motion
from faying.simulation.step_contact import EndContact

PAYING_STEPS = 20_000
"""Steps from which the loop is compiled unasked.

It takes 15 s once per installation and half a second per process; a step of a small interface is
0.1 ms faster, of a large one several times that.
"""

MANY_PAIRS = 1500
"""Pairs above which only long runs are compiled: a new E of 3000 takes two seconds."""

MOST_FAILURES = 3
"""Steps in a row that the loop could not do, after which it is not tried again."""

LOOP = "faying.simulation.compiled_steps"

_log = logging.getLogger("faying")


def compile_steps() -> None:
    """Compile the time steps of reduced models now, for all transients of this process.

    Without this only runs of 20 000 steps and more are compiled. Results are the same up to
    round-off.

    Raises
    ------
    ModelError
        If numba is not installed.

    Notes
    -----
    Some 15 s the first time after an installation, half a second in later processes.
    """
    if find_spec("numba") is None:
        message = "compiled time steps need numba; pip install 'faying[compiled]'"
        raise ModelError(message)
    import_loop()


@cache
def import_loop() -> Callable[..., int]:
    """Return the compiled loop, announcing that it may have to be compiled."""
    begin = time.perf_counter()
    _log.info("compiling the time steps of reduced models, once per installation")
    loop: Callable[..., int] = import_module(LOOP).advance
    _log.info("time steps compiled, or read from the cache, in %.1f s", time.perf_counter() - begin)
    return loop


def worth_compiling(n_step: int, n_pair: int) -> bool:
    """Say whether the loop pays for so many steps, or is there already and no worse."""
    if n_step >= PAYING_STEPS:
        return find_spec("numba") is not None
    return n_pair <= MANY_PAIRS and import_loop.cache_info().currsize > 0


@dataclass(frozen=True, eq=False, kw_only=True)
class CompiledSteps:
    """What all transients of a reduced model with one time step give to the loop.

    Attributes
    ----------
    model
        Its arrays before those of the pairs, by name.
    pairs
        Pairs on springs.
    initial_gap : (n_point,) [length]
    """

    model: dict[str, Matrix]
    pairs: SprungPairs
    initial_gap: Vector

    def advance(
        self,
        motion: Vector,
        guess: Mask,
        trend: Trend,
        applied: Matrix,
        history: History,
        first: int,
    ) -> int:
        """Advance one case until a step does not settle; return the number of steps done.

        Parameters
        ----------
        motion : (4 n,)
            u, v, a and f; moved on.
        guess : (n_point,)
            Points expected in contact; moved on.
        trend
            Moved on.
        applied : (n_step, n)
            External forces.
        history
            Of this case; written from the instant ``first`` on.
        """
        loop = import_loop()
        last = np.full(len(guess), np.nan) if trend.last is None else trend.last[0].copy()
        done, renewals = 0, 0
        while done < len(applied) and renewals <= MOST_RENEWALS:
            if done or not self.pairs.near(guess):
                try:
                    self.pairs.renew(guess)
                except la.LinAlgError:
                    break
            instants = slice(first + done, first + len(applied))
            steps = loop(
                **self.model,
                **self.pairs.arrays(),
                initial_gap=self.initial_gap,
                applied=applied[done:],
                most_changed=int(MOST_CHANGED * len(self.model["to_pairs"])),
                motion=motion,
                guess=guess,
                trend=last,
                states=history.states[0, instants],
                velocities=history.velocities[0, instants],
                accelerations=history.accelerations[0, instants],
                contact_forces=history.forces[0, instants],
                slacks=history.gaps[0, instants],
                systems=history.iterations[0, instants],
            )
            done += steps
            renewals = 0 if steps else renewals + 1
            if not steps and self.pairs.near(guess):
                break
        if done:
            trend.last = last[None]
        return done


def compiled_steps(
    system: System,
    scheme: Integrator,
    step: float,
    effective: Factorization,
    condensed: CondensedContact,
) -> CompiledSteps | None:
    """Return what the loop needs; None where it has nothing to offer.

    It has not for full models, for mean contact forces, where contact is hard, and where the
    compliance between pairs is compressed or singular.
    """
    P, contact, S = system.contact.relative_operator, system.contact, condensed.total
    if not (isinstance(P, np.ndarray) and isinstance(S, np.ndarray)):
        return None
    if not isinstance(scheme.step_contact(condensed), EndContact):
        return None
    if not (contact.flexibility > 0).all():
        return None
    try:
        pairs = SprungPairs(
            N=contact.interpolation, S=S, D=contact.flexibility, own=condensed.space.diagonal
        )
    except la.LinAlgError:
        return None
    n = P.shape[1]
    inverse = effective.solve(np.eye(n))
    right = scheme.right_hand_side(system, unstacked(np.eye(4 * n)), step)
    arrays = {
        "start": effective.solve(right),
        "applied_to_free": scheme.force_weight * inverse,
        "to_pairs": P,
        "from_pairs": scheme.force_weight * inverse @ P.T,
        "pairs_to_states": P.T,
        "newmark": _newmark(scheme, step),
    }
    return CompiledSteps(
        model={name: np.array(array, order="C") for name, array in arrays.items()},
        pairs=pairs,
        initial_gap=np.array(contact.initial_gap),
    )


def _newmark(scheme: Integrator, step: float) -> Matrix:
    """Return velocity and acceleration (2, 6) per u₀, v₀, a₀, f₀, u₁ and f₁.

    Integrators treat all degrees of freedom alike here.
    """
    u0, v0, a0, f0, u1, f1 = np.eye(6)
    motion = Motion(u0, v0, a0, f0, lagging=np.zeros(6), contact=np.zeros(0))
    end = scheme.advance(motion, u1, f1, step)
    return np.array([end.v, end.a])


def stacked(motion: Motion) -> Vector:
    """Return u, v, a and f of one case as one vector."""
    parts = (motion.u, motion.v, motion.a, motion.force)
    return np.concatenate([np.ravel(part) for part in parts])


def unstacked(vectors: Matrix) -> Motion:
    """Return u, v, a and f, stacked, of several cases, one a column."""
    u, v, a, force = np.split(vectors, 4)
    return Motion(u, v, a, force, lagging=np.zeros_like(u), contact=np.zeros((0, u.shape[1])))
