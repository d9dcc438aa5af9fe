"""What increments, cycles and steps with friction cost, on lap joints of several sizes.

    python benchmarks/friction.py [SIZE …]

SIZE is an element size in mm: 2.5 (default) is the default cantilever. Prints processor time, the
least of several runs, because other work on the machine can only add to it: of a warm increment
of a path, of cycles of 50 increments in three modes, of a search for the slip reserve, and of a
step of the reduced model, with the Newton steps of each.
"""

import os
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import faying as fy

LOADS = {
    "pull": fy.Load({"tip.Fx": 3000.0}),
    "bend and twist": fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}),
}
AMPLITUDES = {1: 0.05, 2: 0.03, 3: 0.01}
"""Of the first three modes: a quarter to a half of the closed area slips [mm]."""

RUNS, STEPS = 3, 100


def main() -> None:
    """Measure every size given."""
    lines = ["| element size | points | pairs | what | ms | Newton steps |", "|---" * 6 + "|"]
    for size in map(float, sys.argv[1:] or ("2.5",)):
        model = fy.lap_joint(element_size=size, penalty=1e6).with_bolt_forces({"bolt": 10e3})
        rubbing = model.with_friction(0.2)
        n_pair = rubbing.port_compliance.n_relative // 3
        head = f"| {size:g} | {rubbing.contact.n_points} | {n_pair} |"
        lines += [f"{head} {what} | {ms:.2f} | {steps} |" for what, ms, steps in rows(rubbing)]
    lines.append(f"\nload average {os.getloadavg()[0]:.1f}")
    sys.stdout.write("\n".join(lines) + "\n")


def rows(model: fy.Model) -> list[tuple[str, float, str]]:
    """Return what was measured, milliseconds, and Newton steps in the mean."""
    tight = fy.solve_path(model, [fy.Load()])
    down = 1 - np.arange(1, 21) / 10
    factors = np.concatenate([np.arange(1, 11) / 10, down])
    found = []
    for name, load in LOADS.items():
        loads = [load.scaled(float(factor)) for factor in factors]
        ms, path = least(lambda loads=loads: fy.solve_path(model, loads, initial=tight))
        found.append((f"increment, {name}", ms / len(loads), f"{path.iterations.mean():.1f}"))
    for mode, amplitude in AMPLITUDES.items():
        # What modes and the first loading take is taken off: a second amplitude does them once.
        once, _ = least(lambda mode=mode: fy.backbone(model, mode, [1e-6], initial=tight))
        ms, curve = least(
            lambda mode=mode, amplitude=amplitude: fy.backbone(
                model, mode, [1e-6, amplitude], initial=tight
            )
        )
        cycles = float(curve.cycles[1]) + 0.25
        found.append((f"cycle of 50, mode {mode}", (ms - once) / cycles, f"{cycles:g} cycles"))
    ms, _ = least(lambda: fy.slip_reserve(model, LOADS["pull"], tight), 1)
    found.append(("slip reserve, pull", ms, ""))
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=20), compliance=True)
    both = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3, "tip.Fx": 3000.0})
    start = fy.solve_path(rom, [fy.Load()])
    fy.solve_transient(rom, both, step=1e-5, duration=2e-5, initial=start)
    once, _ = least(lambda: fy.solve_transient(rom, both, step=1e-5, duration=1e-5, initial=start))
    ms, motion = least(
        lambda: fy.solve_transient(rom, both, step=1e-5, duration=STEPS * 1e-5, initial=start)
    )
    steps = f"{motion.iterations[1:].mean():.1f}"
    found.append(("reduced step", (ms - once) / (STEPS - 1), steps))
    return found


def least(function: Callable[[], Any], runs: int = RUNS) -> tuple[float, Any]:
    """Return the least processor time of a call [ms], and what it gave."""
    times, result = [], None
    for _ in range(runs):
        start = time.process_time()
        result = function()
        times.append(time.process_time() - start)
    return 1e3 * min(times), result


if __name__ == "__main__":
    main()
