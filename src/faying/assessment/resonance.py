"""The mode that a harmonic load brings to resonance, and its backbone as far as the load drives it.

Amplitudes double from that of the static response to the smallest level, until the mode resists the
largest one: at resonance the load p feeds what damping takes, p = 2 ζ α of (F5).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Vector
from faying.assessment.backbone_response import LinearResponse
from faying.assessment.modal_analysis import ModalAnalysis, modal_analysis
from faying.assessment.modal_cycles import ModalCycle, StillModeError
from faying.assessment.stuck_modes import stuck_modes
from faying.joint.system import System
from faying.simulation.harmonic_load import harmonic_inputs
from faying.simulation.solution import Solution

MOST_AMPLITUDES = 24
"""Amplitudes at most, each twice the one before: seven decades."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Resonance:
    """A mode and the load on it.

    Attributes
    ----------
    analysis
        Of the mode, at amplitudes that double.
    force
        |φᵀ F| of the largest level.
    linear : [1]
        Damping ratio of the damping matrix.
    """

    analysis: ModalAnalysis
    force: float
    linear: float

    def resists(self, cycle: ModalCycle) -> bool:
        """Say whether the mode resists the largest level at an amplitude, so that it is enough."""
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
    """Find the mode between two frequencies that moves a place most under a load.

    Parameters
    ----------
    component
        A component of a boundary, as ``"tip.uz"``.
    state
        State to vibrate about.

    Returns
    -------
    Resonance or None
        If nothing rubs, or no mode is there that the load reaches.
    """
    if not len(system.contact.rubbing):
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
