"""The mode that a harmonic load brings to resonance, and its backbone up to the load's amplitude.

Amplitudes double from that of the static response to the smallest level, until the mode resists the
largest one: at resonance the work of the load p equals the dissipation, p = 2 ζ α of (F5).
Transients to the steady state under the load are a check.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import ComplexVector, Vector
from faying.assessment.backbone_response import LinearResponse
from faying.assessment.modal_analysis import ModalAnalysis, modal_analysis
from faying.assessment.modal_cycles import ModalCycle, StillModeError
from faying.assessment.response_curve import boundary_components, rows_of
from faying.assessment.stuck_modes import stuck_modes
from faying.joint.system import System
from faying.simulation.integrators import GeneralizedAlpha
from faying.simulation.load import History, Load, harmonic_inputs
from faying.simulation.solution import Solution
from faying.simulation.stepping import transient_solver
from faying.simulation.transient_windows import transient_windows

MOST_AMPLITUDES = 24
"""Most amplitudes, each twice the one before: seven decades."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Resonance:
    """A mode and the load on it.

    Attributes
    ----------
    analysis
        Analysis of the mode, at doubling amplitudes.
    force
        |φᵀ F| of the largest level.
    linear : [1]
        Damping ratio of the damping matrix.
    """

    analysis: ModalAnalysis
    force: float
    linear: float

    def resists(self, cycle: ModalCycle) -> bool:
        """Return whether damping at an amplitude balances the largest level of the load."""
        energy = cycle.energy if cycle.stationary else cycle.loop
        damping = self.linear + energy / (2 * np.pi * cycle.load * cycle.modal)
        return 2 * damping * cycle.load >= self.force


def resonance(
    system: System,
    load: Mapping[str, complex],
    frequencies: tuple[float, float],
    levels: Sequence[float] | Vector,
    component: str,
    state: Solution,
) -> Resonance | None:
    """Return the mode between two frequencies that moves a component, as ``"tip.uz"``, most.

    None without friction, or without a mode that the load excites.
    """
    if not system.contact.rubbing_interfaces:
        return None
    low, high = frequencies
    modes = stuck_modes(system, state, high)
    linear = LinearResponse.of(system, modes, harmonic_inputs(system, load))
    shapes = linear.moved[linear.components.index(component)]
    moved = np.abs(linear.forced * shapes) / linear.circular**2
    moved[(modes.frequencies < low) | (modes.frequencies > high)] = 0.0
    number = int(np.argmax(moved))
    if not moved[number] > 0:
        return None
    force, circular = float(np.abs(linear.forced[number])), float(linear.circular[number])
    alpha = float(np.min(levels)) * force * 2.0 ** np.arange(MOST_AMPLITUDES)
    energies: Vector = np.asarray(alpha**2 / (2 * circular**2), dtype=float)
    try:
        analysis = modal_analysis(
            system, number + 1, energies, over="energy", at=component, initial=state
        )
    except StillModeError:
        return None
    return Resonance(
        analysis=analysis,
        force=float(np.max(levels)) * force,
        linear=float(linear.damping[number]) / (2 * circular),
    )


STEPS = 400
"""Time steps of a period: twice as many changed amplitudes by 0.08 % and phases by 0.1°."""

RISE, PIECE, MOST = 20, 10, 600
"""Periods over which the load rises, between two checks of the motion, and at most."""

SETTLED = 2e-3
"""Relative change still to come at which a motion is steady."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SteadyState:
    """The last period of a transient.

    Attributes
    ----------
    components : (n_boundary,)
        Names of the displacements, as ``"tip.uz"``.
    fundamental : (n_boundary,) [length]
        Complex amplitude, relative to the load.
    periods
        Number of computed periods.
    to_come : [1]
        Relative change of the amplitude still to come, extrapolated from the last changes.
    """

    components: tuple[str, ...]
    fundamental: ComplexVector
    periods: int
    to_come: float


def steady_state(
    system: System,
    load: Mapping[str, complex],
    level: float,
    frequency: float,
    initial: Solution | None = None,
    progress: Callable[[int], object] | None = None,
) -> SteadyState:
    """Integrate the motion under a harmonic load, from a state at rest, until it repeats.

    Parameters
    ----------
    progress
        Is told how many periods were computed since it was called last.

    Notes
    -----
    Generalized-α with a spectral radius of 0.8 and 400 steps a period, which makes periods 2e-5 too
    long. The load rises over 20 periods.
    """
    period = 1 / frequency
    times: Vector = np.asarray(np.arange(MOST * STEPS + 1) * (period / STEPS), dtype=float)
    rising: Vector = np.asarray(level * np.minimum(times / (RISE * period), 1.0), dtype=float)
    turn = 2 * np.pi * frequency * times
    forces = {
        name: History(times, np.asarray(rising * np.real(value * np.exp(1j * turn)), dtype=float))
        for name, value in load.items()
    }
    wave = 2 / STEPS * np.exp(-1j * turn[1 : STEPS + 1])
    solver = transient_solver(system, step=period / STEPS, integrator=GeneralizedAlpha())
    parts = transient_windows(
        solver,
        [Load(forces, name="harmonic load")],
        duration=float(times[-1]),
        length=PIECE * STEPS,
        initial=None if initial is None else [initial],
    )
    fundamentals: list[ComplexVector] = []
    to_come, periods = np.inf, 0
    for (part,), _ in parts:
        periods += PIECE
        if progress is not None:
            progress(PIECE)
        last = rows_of(part.states[-STEPS:].T, system)
        fundamentals.append(last @ wave)
        if periods > RISE + 2 * PIECE:
            size = float(np.linalg.norm(fundamentals[-1]))
            steps = np.diff(np.array(fundamentals[-3:]), axis=0)
            early, late = np.linalg.norm(steps, axis=1).tolist()
            # Changes shrink like a geometric series; otherwise there is no extrapolation yet.
            left = late * late / (early - late) if early > late else np.inf
            to_come = max(left, late) / size
            if to_come <= SETTLED:
                break
    return SteadyState(
        components=boundary_components(system),
        fundamental=fundamentals[-1],
        periods=periods,
        to_come=to_come,
    )
