"""What increments, cycles and steps with friction cost, on lap joints of several sizes.

    python benchmarks/friction.py [SIZE …]

SIZE is an element size in mm: 2.5 (default) is the default cantilever. Prints processor time, the
least of several runs, because other work on the machine can only add to it: of a warm increment
of a path, of cycles of 50 increments in three modes, of their backbones at 20 amplitudes, of a
search for the slip reserve, and of a step of the reduced model, with the Newton steps of each;
and of the same static loads and steps without friction. Of joints of more than a thousand points
one cycle of 20 increments is measured, no backbone and no slip reserve, and everything once.
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

BACKBONES = {1: (0.003, 0.5), 2: (0.001, 0.1), 3: (0.0005, 0.02)}
"""Ranges of amplitudes, from where next to nothing slips to where most does [mm]."""

RUNS, STEPS = 3, 100

LARGE, LARGE_STEPS = 1000, 20
"""Contact points from which less is measured."""


def main() -> None:
    """Measure every size given."""
    lines = ["| element size | points | pairs | what | ms | Newton steps |", "|---" * 6 + "|"]
    for size in map(float, sys.argv[1:] or ("2.5",)):
        model = fy.lap_joint(element_size=size, penalty=1e6).with_bolt_forces({"bolt": 10e3})
        rubbing = model.with_friction(0.2)
        large = rubbing.contact.n_points > LARGE
        n_pair = rubbing.port_compliance.n_relative // 3
        head = f"| {size:g} | {rubbing.contact.n_points} | {n_pair} |"
        found = rows(rubbing, model, 1 if large else RUNS, LARGE_STEPS if large else STEPS)
        found += large_cycle(rubbing) if large else cycles(rubbing)
        lines += [f"{head} {what} | {ms:.2f} | {steps} |" for what, ms, steps in found]
    lines.append(f"\nload average {os.getloadavg()[0]:.1f}")
    sys.stdout.write("\n".join(lines) + "\n")


def rows(model: fy.Model, smooth: fy.Model, runs: int, steps: int) -> list[tuple[str, float, str]]:
    """Return what is measured with friction and without, milliseconds, and Newton steps."""
    down = 1 - np.arange(1, 21) / 10
    factors = np.concatenate([np.arange(1, 11) / 10, down])
    both = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3, "tip.Fx": 3000.0})
    found = []
    for joint, which in ((model, ""), (smooth, " without friction")):
        tight = fy.solve_path(joint, [fy.Load()])
        for name, load in LOADS.items():
            loads = [load.scaled(float(factor)) for factor in factors]

            def walk(
                loads: list[fy.Load] = loads, joint: fy.Model = joint, tight: Any = tight
            ) -> Any:
                return fy.solve_path(joint, loads, initial=tight)

            ms, path = least(walk, runs)
            steps_each = f"{path.iterations.mean():.1f}"
            found.append((f"increment, {name}{which}", ms / len(loads), steps_each))
        rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=20), compliance=True)
        start = fy.solve_path(rom, [fy.Load()])

        def steps_of(number: int, rom: fy.ReducedModel = rom, start: Any = start) -> Any:
            return fy.solve_transient(rom, both, step=1e-5, duration=number * 1e-5, initial=start)

        steps_of(2)
        once, _ = least(lambda steps_of=steps_of: steps_of(1), runs)
        ms, motion = least(lambda steps_of=steps_of: steps_of(steps), runs)
        taken = f"{motion.iterations[1:].mean():.1f}"
        found.append((f"reduced step{which}", (ms - once) / (steps - 1), taken))
    return found


def large_cycle(model: fy.Model) -> list[tuple[str, float, str]]:
    """Return what cycles of mode 1 of a large joint cost."""
    tight = fy.solve_path(model, [fy.Load()])

    def curve(levels: Any) -> Any:
        return fy.backbone(model, 1, levels, initial=tight, increments=20)

    once, _ = least(lambda: curve([BACKBONES[1][0]]), 1)
    ms, swung = least(lambda: curve([BACKBONES[1][0], AMPLITUDES[1]]), 1)
    walked = float(swung.cycles[1]) + 0.25
    return [("cycle of 20, mode 1", (ms - once) / walked, f"{walked:g} cycles")]


def cycles(model: fy.Model) -> list[tuple[str, float, str]]:
    """Return what cycles, backbones and a search for the slip reserve cost, and the cycles."""
    tight, found = fy.solve_path(model, [fy.Load()]), []

    def curve(mode: int, levels: Any) -> Any:
        return fy.backbone(model, mode, levels, initial=tight)

    for mode, amplitude in AMPLITUDES.items():
        # What modes and the first loading take is taken off: a second amplitude does them once.
        small = BACKBONES[mode][0]
        once, _ = least(lambda m=mode, s=small: curve(m, [s]))
        ms, swung = least(lambda m=mode, b=(small, amplitude): curve(m, b))
        walked = float(swung.cycles[1]) + 0.25
        found.append((f"cycle of 50, mode {mode}", (ms - once) / walked, f"{walked:g} cycles"))
    for mode, ends in BACKBONES.items():
        ms, swung = least(lambda m=mode, e=ends: curve(m, np.geomspace(*e, 20)), 1)
        found.append((f"backbone of 20, mode {mode}", ms, f"{swung.cycles.sum()} cycles"))
    ms, _ = least(lambda: fy.slip_reserve(model, LOADS["pull"], tight), 1)
    found.append(("slip reserve, pull", ms, ""))
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
