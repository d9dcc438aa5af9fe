"""Compiled time steps: when they pay, and what the loop without friction is given."""

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import find_spec

import numpy as np
import scipy.linalg as la

from faying._typing import Matrix, Vector
from faying.contact.condensed import CondensedContact
from faying.contact.state import ContactState
from faying.contact.supported_pairs import (
    MOST_CHANGED,
    MOST_RENEWALS,
    SupportedPairs,
)
from faying.exceptions import ModelError
from faying.joint.system import System
from faying.linalg.factorization import Factorization
from faying.simulation.instants import Instants
from faying.simulation.integrators import Integrator, Motion
from faying.simulation.step_contact import EndContact

PAYING_STEPS = 20_000
"""Steps from which the loop is compiled unasked.

It takes 15 s once per installation and half a second per process; a step of a small interface is
0.1 ms faster, of a large one several times that. With friction it takes 35 s, and a step is 5 ms
faster.
"""

MOST_FAILURES = 3
"""Steps in a row that the loop could not do, after which it is not tried again."""

LOOP = "faying.simulation.compiled_steps"

_log = logging.getLogger("faying")


def check_compiler() -> None:
    """Refuse to compile time steps where numba is missing.

    Raises
    ------
    ModelError
    """
    if find_spec("numba") is None:
        message = "compiled time steps need numba; pip install 'faying[compiled]'"
        raise ModelError(message)


@cache
def import_loop() -> Callable[..., int]:
    """Return the compiled loop, announcing that it may have to be compiled."""
    begin = time.perf_counter()
    _log.info("compiling the time steps of reduced models, once per installation")
    loop: Callable[..., int] = import_module(LOOP).advance
    _log.info("time steps compiled, or read from the cache, in %.1f s", time.perf_counter() - begin)
    return loop


def worth_compiling(n_step: int) -> bool:
    """Say whether compiling pays for so many steps."""
    return n_step >= PAYING_STEPS and find_spec("numba") is not None


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
    pairs: SupportedPairs
    initial_gap: Vector

    def advance(
        self,
        motion: Vector,
        state: ContactState,
        trend: Vector,
        applied: Matrix,
        history: Instants,
        first: int,
    ) -> tuple[int, ContactState]:
        """Advance one case until a step does not settle.

        Parameters
        ----------
        motion : (4 n,)
            u, v, a and f; moved on.
        state
            Where contact stands.
        trend : (n_point,)
            Moved on.
        applied : (n_step, n)
            External forces.
        history
            Of this case; written from the instant ``first`` on.

        Returns
        -------
        int
            Steps done.
        ContactState
            Where contact stands after them.
        """
        loop, guess = import_loop(), state.active.copy()
        support = self.pairs.at_hand(state)
        done, renewals = 0, 0
        while done < len(applied) and renewals <= MOST_RENEWALS:
            if done or support is None or not self.pairs.near(support.closed, guess):
                try:
                    support = self.pairs.supported(guess)
                except la.LinAlgError:
                    break
            instants = slice(first + done, first + len(applied))
            steps = loop(
                **self.model,
                **self.pairs.arrays(support),
                initial_gap=self.initial_gap,
                applied=applied[done:],
                most_changed=int(MOST_CHANGED * len(self.model["to_pairs"])),
                motion=motion,
                guess=guess,
                trend=trend,
                states=history.states[0, instants],
                velocities=history.velocities[0, instants],
                accelerations=history.accelerations[0, instants],
                contact_forces=history.forces[0, instants],
                slacks=history.gaps[0, instants],
                systems=history.iterations[0, instants],
            )
            done += steps
            renewals = 0 if steps else renewals + 1
            if not steps and self.pairs.near(support.closed, guess):
                break
        closed = None if support is None else support.closed
        return done, ContactState(active=guess, supported=closed, steady=True, factor=support)


def compiled_steps(
    system: System,
    scheme: Integrator,
    step: float,
    effective: Factorization,
    condensed: CondensedContact,
) -> CompiledSteps | None:
    """Return what the loop needs; None where it has nothing to offer.

    It has not for full models, for mean contact forces, where contact is hard, where the
    compliance between pairs is compressed, and where points are fewer than relative displacements.
    """
    P, contact = system.contact.relative_operator, system.contact
    if not isinstance(P, np.ndarray):
        return None
    if not isinstance(scheme.step_contact(condensed), EndContact):
        return None
    pairs = condensed.supported_pairs
    if pairs is None or pairs.S.shape[0] != P.shape[0]:
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
