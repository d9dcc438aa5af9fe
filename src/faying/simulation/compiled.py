"""Preparation of the compiled time steps of reduced models."""

import logging
import time
import warnings
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from typing import Any, cast

import numpy as np

from faying._typing import Mask, Matrix, Vector
from faying.contact.condensed import CondensedContact
from faying.contact.glued_pairs import GluedPairs
from faying.contact.point_springs import padded_rows
from faying.contact.state import ContactState
from faying.contact.yielding import YieldingContact
from faying.iterations import RETRIES
from faying.joint.system import System
from faying.linalg.budget import pairs_fit
from faying.linalg.interface import Factorization
from faying.simulation.instants import Instants
from faying.simulation.integrators import Integrator, Motion
from faying.simulation.step_contact import EndContact

MOST_CHANGED, NEAR = 0.5, 0.3
"""Largest number of changed points over pairs for a given E, in a step and at its start.

A new E takes n³ operations for n pairs, k changed points k³. Among 0.35 to 0.65, steps of 798 pairs
were fastest with 0.5, of 442 with 0.35 (15 % less); of 148 there was no difference.
"""

MOST_SETS = 4
"""Number of stored E, for the sets of points in transients from one state."""

LOOP = "faying.simulation.compiled_steps"

_log = logging.getLogger("faying")


def warn_of_compiled(compiled: bool | None) -> None:
    """Warn that the argument ``compiled`` is deprecated."""
    if compiled is not None:
        message = (
            "'compiled' has no effect any more and will go: steps of reduced models are compiled "
            "where numba is installed (pip install 'faying[compiled]')"
        )
        warnings.warn(message, DeprecationWarning, stacklevel=3)


@cache
def import_loop() -> Any | None:
    """Return the module of compiled steps; None, with a log entry, where it cannot be compiled."""
    begin = time.perf_counter()
    _log.info("compiling the time steps of reduced models, once per installation")
    try:
        loop: Any = import_module(LOOP)
        loop.compile_steps()
    # No numba, an unsupported NumPy, no space for its cache: steps in Python do as well.
    except Exception as error:
        _log.info("time steps are not compiled: %s", error)
        return None
    _log.info("time steps compiled, or read from the cache, in %.1f s", time.perf_counter() - begin)
    return loop


@dataclass(frozen=True, eq=False, kw_only=True)
class CompiledSteps:
    """Data of the compiled loop, shared by transients of a reduced model with one time step.

    Attributes
    ----------
    model
        Arrays of the loop before those of the pairs, by name.
    solver
        Solver of the contact problems of these steps.
    supported
        Latest matrices E, by their sets of points.
    """

    model: dict[str, Matrix]
    solver: YieldingContact
    supported: dict[bytes, Matrix] = field(default_factory=dict)

    def advance(
        self,
        motion: Vector,
        state: ContactState,
        applied: Matrix,
        history: Instants,
        first: int,
    ) -> tuple[int, ContactState]:
        """Advance one case until a step does not converge.

        Returns the number of steps done and the contact state after them. ``motion`` u, v, a and f
        (4 n,) is updated in place under external forces (n_step, n); the history of this case is
        written from the instant ``first`` on.
        """
        loop: Any = import_loop()
        guess, closed = state.active.copy(), state.supported
        done, renewals = 0, 0
        while done < len(applied) and renewals <= RETRIES:
            if done or closed is None or not self._is_near(closed, guess):
                closed = guess.copy()
            instants = slice(first + done, first + len(applied))
            steps = loop.advance(
                loop.Model(**self.model),
                loop.Held(self._compliance_on_springs(closed), closed),
                applied[done:],
                int(MOST_CHANGED * len(self.model["to_pairs"])),
                motion,
                guess,
                loop.Histories(
                    history.states[0, instants],
                    history.velocities[0, instants],
                    history.accelerations[0, instants],
                    history.forces[0, instants],
                    history.gaps[0, instants],
                    history.iterations[0, instants],
                ),
            )
            done += steps
            renewals = 0 if steps else renewals + 1
            if not steps and self._is_near(closed, guess):
                break
        forces = np.zeros((3, len(guess))) if state.forces is None else state.forces.copy()
        if done:
            forces[0] = history.forces[0, first + done - 1]
        return done, ContactState(active=guess, supported=closed, forces=forces)

    def _is_near(self, closed: Mask, guess: Mask) -> bool:
        """Return whether few enough points have changed sides to use E of a closed set."""
        return bool(np.count_nonzero(guess ^ closed) <= NEAR * len(self.solver.S))

    def _compliance_on_springs(self, closed: Mask) -> Matrix:
        """Return E, the compliance of the pairs on the springs of the closed points."""
        key = closed.tobytes()
        if key not in self.supported:
            solver = self.solver
            if len(self.supported) == MOST_SETS:
                del self.supported[next(iter(self.supported))]
            E = (
                cast("GluedPairs", solver.pairs)
                .glued_by(solver.laws.springs * closed)
                .glued.compliance
            )
            Y = solver.shapes
            self.supported[key] = E.copy() if Y is None else np.ascontiguousarray(Y @ E @ Y.T)
        return self.supported[key]


def compiled_steps(
    system: System,
    scheme: Integrator,
    step: float,
    effective: Factorization,
    condensed: CondensedContact,
) -> CompiledSteps | None:
    """Return the data of the compiled loop; None where the loop does not apply.

    It does not without numba, for full models, for mean contact forces, with friction, for curves,
    where contact is hard, and where dense matrices between pairs exceed the dense budget.

    Notes
    -----
    To compile takes 15 s once per installation, to load 0.4 s per process. That pays after 3000
    steps of the cantilever and 30 of a flange of 3972 points.
    """
    P, contact = system.contact.relative_operator, system.contact
    if not isinstance(P, np.ndarray) or not contact.unilateral:
        return None
    if not pairs_fit(len(P), contact.dense_budget):
        return None
    solver = condensed.increments
    if not isinstance(solver, YieldingContact):
        return None
    if not isinstance(scheme.step_contact(condensed), EndContact) or import_loop() is None:
        return None
    n, (columns, values) = P.shape[1], padded_rows(contact.interpolation)
    inverse = effective.solve(np.eye(n))
    right = scheme.right_hand_side(system, unstacked(np.eye(4 * n)), step)
    arrays = {
        "start": effective.solve(right),
        "applied_to_free": scheme.force_weight * inverse,
        "to_pairs": P,
        "from_pairs": scheme.force_weight * inverse @ P.T,
        "pairs_to_states": P.T,
        "newmark": _newmark(scheme, step),
        "S": solver.S,
        "columns": columns,
        "values": values,
        "springs": solver.laws.springs[0],
        "initial_gap": contact.initial_gap,
    }
    # Compiled loops take writeable arrays only, even those that they only read.
    model = {name: np.array(array, order="C") for name, array in arrays.items()}
    return CompiledSteps(model=model, solver=solver)


def _newmark(scheme: Integrator, step: float) -> Matrix:
    """Return velocity and acceleration (2, 6) per u₀, v₀, a₀, f₀, u₁ and f₁.

    The coefficients are the same for all degrees of freedom.
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
    """Return the motion of several cases from stacked u, v, a and f, one case a column."""
    u, v, a, force = np.split(vectors, 4)
    return Motion(u, v, a, force, lagging=np.zeros_like(u), contact=np.zeros((0, u.shape[1])))
