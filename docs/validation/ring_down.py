"""Damping of a decay against that of cycles, with the inertia of other modes and without it.

``python docs/validation/ring_down.py`` prints the table of docs/theory/friction.md. A reduced model
of 5 mm bricks (20 normal modes, interface compliance) is loaded by α M φ and let go. Modes lose
their inertia where their share of the mass matrix is divided by a thousand: what is left of them
follows quasi-statically, as cycles take it to do.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg as la

import faying as fy
from faying._typing import Matrix, Vector
from faying.assessment.ring_down import Decay
from faying.assessment.stuck_modes import stuck_stiffness
from faying.joint.load_pattern import LoadPattern

CASES = ((1, (0.1, 0.25, 0.5), 3), (2, (0.015, 0.03, 0.05), 5), (3, (0.003, 0.01, 0.02), 6))
"""Mode, amplitudes of the tip [mm], and the mode that it excites."""
LEFT = 1e-3
STEPS, PERIODS = 100, 4


@dataclass(frozen=True, eq=False)
class Joint:
    """A reduced joint at rest, and its modes with every closed point stuck."""

    system: fy.ReducedModel
    rest: fy.Solution
    squares: Vector
    shapes: Matrix

    def force(self, mode: int, amplitude: float) -> float:
        """Return the load α under which the tip would move so far if nothing slipped."""
        tip = self.shapes[self.system.boundaries["tip"].dofs[:3], mode - 1]
        return float(self.squares[mode - 1] * amplitude / np.abs(tip).max())

    def pushed(self, mode: int) -> fy.ReducedModel:
        """Return the joint with the load M φ."""
        pattern = LoadPattern(name="mode", forces=self.system.M @ self.shapes[:, mode - 1])
        return replace(self.system, load_patterns={"mode": pattern})

    def modal(self, mode: int, states: Matrix) -> Vector:
        """Return φᵀ M (u − u₀)."""
        weighted = self.system.M @ self.shapes[:, mode - 1]
        return np.asarray((states - self.rest.states[-1]) @ weighted)

    def mass_without(self, modes: Sequence[int]) -> Matrix:
        """Return M less all but a thousandth of what modes have of it."""
        weighted = self.system.M @ self.shapes[:, np.array(modes, dtype=int) - 1]
        return np.asarray(self.system.M - (1 - LEFT) * weighted @ weighted.T)


def rubbing_joint() -> Joint:
    """Return the joint of the table."""
    model = fy.lap_joint(element_size=5.0, penalty=1e6).with_bolt_forces({"bolt": 8e3})
    model = model.with_friction(0.2)
    system = fy.reduce(model, fy.craig_bampton(model, normal_modes=20), compliance=True)
    rest = fy.solve_path(system, [fy.Load()])
    squares, shapes = la.eigh(np.asarray(stuck_stiffness(system, rest)), np.asarray(system.M))
    return Joint(system, rest, squares, shapes)


def cycles(joint: Joint, mode: int, amplitude: float) -> tuple[Vector, Vector]:
    """Return modal amplitudes and damping ratios of first cycles up to an amplitude."""
    shares = np.concatenate([np.arange(1, 21), np.arange(19, -21, -1), np.arange(-19, 21)]) / 20
    found = []
    for part in np.linspace(0.5, 1.0, 6):
        force = part * joint.force(mode, amplitude)
        loads = [fy.Load(), *(fy.Load({"mode": force * share}) for share in shares)]
        path = fy.solve_path(joint.pushed(mode), loads)
        size = np.ptp(joint.modal(mode, path.states[-81:])) / 2
        found.append((size, path.dissipation[-80:].sum() / (2 * np.pi * force * size)))
    sizes, ratios = np.array(found).T
    return sizes, ratios


def decay(joint: Joint, mode: int, amplitude: float, still: Sequence[int] = ()) -> Decay:
    """Let the joint go at an amplitude; modes ``still`` without their inertia."""
    pushed, force = joint.pushed(mode), joint.force(mode, amplitude)
    loads = [fy.Load(), *(fy.Load({"mode": force * n / 20}) for n in range(1, 21))]
    start, period = fy.solve_path(pushed, loads), 2 * np.pi / np.sqrt(joint.squares[mode - 1])
    motion = fy.solve_transient(
        replace(pushed, M=joint.mass_without(still)),
        fy.Load(),
        initial=start,
        step=period / STEPS,
        duration=PERIODS * period,
        integrator=fy.EnergyDecaying(0.8),
    )
    return fy.free_decay(motion.times, joint.modal(mode, motion.states))


def over_cycles(found: Decay, sizes: Vector, ratios: Vector) -> Vector:
    """Return damping of a decay over that of cycles at the same amplitudes."""
    at = np.log(found.amplitude)
    return np.asarray(found.damping_ratio / np.exp(np.interp(at, np.log(sizes), np.log(ratios))))


def span(values: Vector) -> str:
    """Return the least and the largest value as text."""
    low, high = f"{values.min():.2f}", f"{values.max():.2f}"
    return low if low == high else f"{low} to {high}"


def main() -> None:
    """Print the table."""
    joint = rubbing_joint()
    head = (
        "| mode | amplitude [mm] | ζ of a cycle [%] | decay over it | without inertia of one mode "
        "| of all others |\n|---|---|---|---|---|---|\n"
    )
    sys.stdout.write(head)
    for mode, amplitudes, other in CASES:
        others = [one for one in range(1, len(joint.squares) + 1) if one != mode]
        for amplitude in amplitudes:
            known = cycles(joint, mode, amplitude)
            all_of_them, one, none = (
                span(over_cycles(decay(joint, mode, amplitude, still), *known))
                for still in ((), [other], others)
            )
            damping = f"{100 * known[1][-1]:.3g}"
            cells = (mode, amplitude, damping, all_of_them, f"{one} (mode {other})", none)
            sys.stdout.write("| " + " | ".join(map(str, cells)) + " |\n")


if __name__ == "__main__":
    main()
