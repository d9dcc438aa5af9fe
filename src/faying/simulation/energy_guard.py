"""Energy balance of transients, checked for spurious gains."""

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
"""Largest spurious energy gain of a sound transient, as a share of the energy in motion.

A tenth of the energy is five hundredths of the amplitude. Of 216 runs of generalized-α on poor
bases 158 gained less than 0.03 of the largest work and 45 more than 0.9; for schemes that cannot
gain energy it is 0.02 at most, from the summation (``benchmarks/transient_energy.py``).
"""

AT_ONCE = 25
"""Instants whose energies are computed together; more would be no faster and take more memory."""

FELT_ENERGY_SHARE = 1e-3
"""Motions with less than this share of the preload's energy change pressures by 3 % at most."""

_log = logging.getLogger("faying")


@dataclass(frozen=True, kw_only=True)
class EnergyLedger:
    """Energy balance of a transient so far.

    Attributes
    ----------
    stored
        Kinetic, strain and contact energy at the start [force·length].
    work, spent
        Work of all loads since; energy dissipated by friction and, at least, by damping.
    moved
        Largest sum so far of kinetic energy and the magnitude of the work.
    gain
        Largest excess of energy over the supplied energy, as a share of ``moved``.
    """

    stored: float
    work: float = 0.0
    spent: float = 0.0
    moved: float = 0.0
    gain: float = 0.0

    @property
    def sound(self) -> bool:
        """Whether the spurious gain of energy is within that of a sound integration."""
        return self.gain <= MOST_GAIN


ABSURD = float(np.sqrt(np.finfo(float).max))
"""Loads above which energies overflow with any integrator."""


@dataclass(frozen=True, eq=False, kw_only=True)
class EnergyGuard:
    """Energy balances of transients side by side, over a section of their instants.

    Attributes
    ----------
    system, step
    force_weight
        Weight of the forces at the end of a step in the work of the integrator.
    loads
        Names.
    starts, ledgers
        Motion of each transient at the start of the section, and its ledger; None at the beginning.
    inputs : (n_case, 1 + n_time, n_input)
        At the instant before the section and at those of the section.
    history
        Arrays of the section, to be written.
    """

    system: System
    step: float
    force_weight: float
    loads: Sequence[str]
    starts: Sequence[Motion]
    ledgers: Sequence[EnergyLedger | None]
    inputs: Matrix
    history: Instants

    def audit(self) -> list[EnergyLedger]:
        """Return the ledgers at the end of the section."""
        n_time = self.inputs.shape[1] - 1
        return [self._continued_ledger(case, n_time) for case in range(len(self.loads))]

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Report motions that grow until numbers overflow.

        Raises
        ------
        ConvergenceError
            In place of the error that the overflow caused.
        """
        try:
            # An overflow is refused where the next gaps are checked.
            with np.errstate(over="ignore", invalid="ignore"):
                yield
        except (ModelError, ConvergenceError):
            if not np.abs(self.inputs).max(initial=0.0) < ABSURD:
                raise
            for case, name in enumerate(self.loads):
                done = int(np.count_nonzero(self.history.iterations[case]))
                ledger = self._continued_ledger(case, done) if done else None
                if ledger is not None and not ledger.sound:
                    message = f"{name}: {gain_message(ledger.gain)}"
                    raise ConvergenceError(message) from None
            raise

    def _continued_ledger(self, case: int, n_time: int) -> EnergyLedger:
        """Return the ledger of one transient after some instants of the section.

        Notes
        -----
        In exact time integration kinetic, strain and contact energy change by the work of the loads
        less the dissipation by damping and friction. In a step damping dissipates at least
        ΔuᵀC Δu/h, which is used here.
        """
        system, weight, start = self.system, self.force_weight, self.starts[case]
        ledger, inputs = self.ledgers[case], self.inputs[case, : n_time + 1]
        history, u = self.history.of_case(case).instants(0, n_time), start.u
        if ledger is None:
            normal, shear = system.contact.parts(start.contact[None])
            _, energy = _stored_energy(system, start.u[None], start.v[None], normal, shear)
            ledger = EnergyLedger(stored=float(energy[0]))
        with np.errstate(over="ignore", invalid="ignore"):
            for first in range(0, n_time, AT_ONCE):
                chunk = slice(first, first + AT_ONCE)
                states, velocities = history.states[0, chunk], history.velocities[0, chunk]
                moves = np.diff(np.vstack([u, states]), axis=0)
                means = weight * inputs[1:][chunk] + (1 - weight) * inputs[:-1][chunk]
                done = (means * input_displacements(system, moves)).sum(axis=1)
                work = ledger.work + np.cumsum(done)
                lost = 2 * half_form(system.C, moves) / self.step + history.dissipation[0, chunk]
                spent = ledger.spent + np.cumsum(lost)
                shear, forces = history.shear[0, chunk], history.forces[0, chunk]
                kinetic, energy = _stored_energy(system, states, velocities, forces, shear)
                moved = np.maximum(np.maximum.accumulate(np.abs(work) + kinetic), ledger.moved)
                gain = energy - ledger.stored - (work - spent)
                shares = gain / (moved + FELT_ENERGY_SHARE * ledger.stored + np.finfo(float).tiny)
                ledger = EnergyLedger(
                    stored=ledger.stored,
                    work=float(work[-1]),
                    spent=float(spent[-1]),
                    moved=float(moved[-1]),
                    gain=float(np.max(np.nan_to_num(shares, nan=np.inf), initial=ledger.gain)),
                )
                u = states[-1]
        return ledger


def warn_of_gain(name: str, earlier: EnergyLedger | None, later: EnergyLedger | None) -> None:
    """Log a warning when a ledger first stops being sound."""
    if later is not None and not later.sound and (earlier is None or earlier.sound):
        _log.warning("%s: %s", name, gain_message(later.gain))


def gain_message(gain: float) -> str:
    """Return a message that explains a gain of energy and names remedies."""
    share = f"{gain:.0%} of" if np.isfinite(gain) else "many times"
    return (
        f"the time integration gained {share} the energy in motion from nothing, so its "
        "pressures mean nothing; take ImplicitEuler, or without residual compliance EnergyDecaying "
        '(in a study integrator = "energy-decaying"), which cannot, or a smaller step'
    )


def _stored_energy(
    system: System, states: Matrix, velocities: Matrix, forces: Matrix, shear: Matrix
) -> tuple[Vector, Vector]:
    """Return kinetic energy, and the sum of kinetic, strain and contact energy (n_time,)."""
    moving = velocities.any()
    kinetic = half_form(system.M, velocities) if moving else np.zeros(len(velocities))
    strain = half_form(system.K, states)
    return kinetic, kinetic + strain + contact_energy(system.contact, forces, shear)
