"""Energy that nothing supplied: the guard of every transient."""

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix, Vector
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.system import System
from faying.simulation.energies import contact_energy, half_form, input_displacements
from faying.simulation.instants import Instants
from faying.simulation.integrators import Motion

MOST_GAIN = 0.1
"""Share of the energy in motion that a sound transient does not gain from nothing.

A tenth of the energy is five hundredths of the amplitude. Of 216 runs of generalized-α on poor
bases 158 gained less than 0.03 of the largest work and 45 more than 0.9; schemes that cannot gain
energy have 0.02 at most, from the way it is summed (``benchmarks/transient_energy.py``).
"""

EVERY = 25
"""Steps between two looks, so that the products with M, K and C are not felt."""

FELT = 1e-3
"""Motion with less than this share of the energy of the preload moves pressures by 3 % at most."""

_log = logging.getLogger("faying")


@dataclass(frozen=True, kw_only=True)
class EnergyLedger:
    """What a transient began with, was given, and has gained so far.

    Attributes
    ----------
    stored
        Kinetic energy, strain energy and that of contact at the start [force·length].
    work, spent
        Work of all loads since; what damping took at least, and friction.
    moved
        Largest kinetic energy and largest magnitude of the work so far, added up.
    gain
        Largest share of ``moved`` that the energy exceeds what was supplied by.
    """

    stored: float
    work: float = 0.0
    spent: float = 0.0
    moved: float = 0.0
    gain: float = 0.0

    @property
    def sound(self) -> bool:
        """Whether no more energy has appeared from nothing than round-off and a fair scheme do."""
        return self.gain <= MOST_GAIN


def opened(system: System, start: Motion) -> EnergyLedger:
    """Begin the ledger of a transient where it stands."""
    normal, shear = system.contact.parts(start.contact[None])
    _, energy = _stored(system, start.u[None], start.v[None], normal, shear)
    return EnergyLedger(stored=float(energy[0]))


def audited(
    ledger: EnergyLedger,
    system: System,
    start: Motion,
    inputs: Matrix,
    history: Instants,
    step: float,
) -> EnergyLedger:
    """Go on with the ledger of one transient over a piece of it.

    Parameters
    ----------
    start
        The instant before the piece.
    inputs : (1 + n_time, n_input)
        At that instant and those of the piece.
    history
        Of this case and of the piece alone.

    Notes
    -----
    In exact time integration kinetic, strain and contact energy change by the work of the loads
    less what damping and friction take. Work and what friction takes are summed over all steps, by
    the trapezoidal rule. Energies are taken every :data:`EVERY` steps, and damping at least
    ∑ ΔuᵀC Δu / Δt between them, a lower bound whatever happened on the way: the gain may be more
    than what is found, but not less.
    """
    n_time = len(inputs) - 1
    at = np.unique(np.append(np.arange(EVERY - 1, n_time, EVERY), n_time - 1))
    states, first = history.states[0], start.u[None]
    with np.errstate(over="ignore", invalid="ignore"):
        path = [input_displacements(system, u) for u in (first, states)]
        means = 0.5 * (inputs[1:] + inputs[:-1])
        steps = (means * np.diff(np.vstack(path), axis=0)).sum(axis=1)
        work = ledger.work + np.cumsum(steps)
        most = np.maximum.accumulate(np.abs(work))[at]
        work = work[at]
        moves = np.diff(np.vstack([first, states[at]]), axis=0)
        lengths = step * np.diff(np.append(-1, at))
        spent = ledger.spent + np.cumsum(2 * half_form(system.C, moves) / lengths)
        spent = spent + np.cumsum(history.dissipation[0])[at]
        shear = None if system.contact.components == 1 else history.shear[0, at]
        kinetic, energy = _stored(
            system, states[at], history.velocities[0, at], history.forces[0, at], shear
        )
        moved = most + np.maximum.accumulate(kinetic)
        moved = np.maximum(moved, ledger.moved)
        gain = energy - ledger.stored - (work - spent)
        shares = gain / (moved + FELT * ledger.stored + np.finfo(float).tiny)
    worst = float(np.max(np.nan_to_num(shares, nan=np.inf), initial=0.0))
    return EnergyLedger(
        stored=ledger.stored,
        work=float(work[-1]),
        spent=float(spent[-1]),
        moved=float(moved[-1]),
        gain=max(ledger.gain, worst),
    )


ABSURD = 1e100
"""Loads from which numbers overflow whatever integrates them."""


@dataclass(frozen=True, eq=False, kw_only=True)
class EnergyGuard:
    """The ledgers of transients side by side, over a piece of them.

    Attributes
    ----------
    system, step
    loads
        Names.
    starts, ledgers
        Where each stands, and its ledger; None where it begins.
    inputs : (n_case, 1 + n_time, n_input)
        At the instant before the piece and those of the piece.
    history
        Of the piece, to be written.
    warn
        Whether to log what is not sound.
    """

    system: System
    step: float
    loads: Sequence[str]
    starts: Sequence[Motion]
    ledgers: Sequence[EnergyLedger | None]
    inputs: Matrix
    history: Instants
    warn: bool = True

    def audit(self) -> list[EnergyLedger]:
        """Return the ledgers at the end of the piece; log what is not sound any more."""
        n_time = self.inputs.shape[1] - 1
        found = [self._audited(case, n_time) for case in range(len(self.loads))]
        if self.warn:
            for name, before, after in zip(self.loads, self.ledgers, found, strict=True):
                warn_of_gain(name, before, after)
        return found

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Say of a motion that grew until its numbers overflowed that it did.

        Raises
        ------
        ConvergenceError
            In place of the error that the overflow caused.
        """
        try:
            # What overflows is refused where the next gaps are looked at.
            with np.errstate(over="ignore", invalid="ignore"):
                yield
        except ModelError:
            if not np.abs(self.inputs).max(initial=0.0) < ABSURD:
                raise
            for case, name in enumerate(self.loads):
                done = int(np.count_nonzero(self.history.iterations[case]))
                ledger = self._audited(case, done) if done else None
                if ledger is not None and not ledger.sound:
                    message = f"{name}: {gain_message(ledger.gain)}"
                    raise ConvergenceError(message) from None
            raise

    def _audited(self, case: int, n_time: int) -> EnergyLedger:
        start, before = self.starts[case], self.ledgers[case]
        return audited(
            opened(self.system, start) if before is None else before,
            self.system,
            start,
            self.inputs[case, : n_time + 1],
            self.history.of_case(case).instants(0, n_time),
            self.step,
        )


def warn_of_gain(name: str, before: EnergyLedger | None, after: EnergyLedger) -> None:
    """Log that a ledger is not sound any more."""
    if not after.sound and (before is None or before.sound):
        _log.warning("%s: %s", name, gain_message(after.gain))


def gain_message(gain: float) -> str:
    """Say what a gain of energy means and what helps."""
    share = f"{gain:.0%} of" if np.isfinite(gain) else "many times"
    return (
        f"the time integration gained {share} the energy in motion from nothing, so its "
        "pressures mean nothing; take ImplicitEuler, or without residual compliance EnergyDecaying "
        '(in a study integrator = "energy-decaying"), which cannot, or a smaller step'
    )


def _stored(
    system: System, states: Matrix, velocities: Matrix, forces: Matrix, shear: Matrix | None
) -> tuple[Vector, Vector]:
    """Kinetic energy, and that with strain and contact energy, of each instant (n_time,)."""
    moving = velocities.any()
    kinetic = half_form(system.M, velocities) if moving else np.zeros(len(velocities))
    strain = half_form(system.K, states)
    return kinetic, kinetic + strain + contact_energy(system.contact, forces, shear)
