"""Why schemes of second order are some percent off after a jump on a flange, and what would help.

``python benchmarks/flange_after_a_jump.py [MODES] [SCHEME…]`` prints the table of
docs/theory/transient_accuracy.md: method ``compliance+inertia`` against the full model at smaller
steps and other damping, the full model against itself at smaller steps, and how far the schemes are
from one another. A quarter of the longest period, 20 normal modes. Needs gmsh.
"""

import sys
import tempfile
import time
from itertools import combinations
from pathlib import Path

import numpy as np
from method_ranges import STEPS, joints

import faying as fy
from faying.reduction.projection import projected

SCHEMES = {
    "implicit Euler": fy.ImplicitEuler(),
    "generalized-α 0.8": fy.GeneralizedAlpha(0.8),
    "generalized-α 0.4": fy.GeneralizedAlpha(0.4),
    "generalized-α 0": fy.GeneralizedAlpha(0.0),
    "energy-decaying 0.8": fy.EnergyDecaying(0.8),
    "energy-decaying 0": fy.EnergyDecaying(0.0),
}
REFINED = (1, 2, 4)
"""Steps within one of a hundredth of the period."""


def main(modes: int, chosen: set[str]) -> None:
    """Print errors of the reduced model, and how far the full one is from itself."""
    write = sys.stdout.write
    with tempfile.TemporaryDirectory() as folder:
        joint = next(one for one in joints(Path(folder)) if one.name == "pipe flange")
    model, load = joint.model, fy.Load(joint.bending)
    period = 1.0 / fy.preloaded_frequencies(model, 1)[0]
    begin = time.process_time()
    rom = projected(model, fy.attachment_modes(model, normal_modes=modes))
    sys.stderr.write(f"{len(rom.K)} vectors, {time.process_time() - begin:.3g} s\n")
    write("| scheme | steps per period | reduced against full | full against its finest |\n")
    write(f"{'|---' * 4}|\n")
    coarse, finest = {}, {}
    for name, integrator in SCHEMES.items():
        if chosen and name not in chosen:
            continue
        fulls, rows = {}, {}
        for part in REFINED:
            options = {
                "step": period / STEPS / part,
                "duration": period / 4,
                "integrator": integrator,
            }
            full = fy.solve_transient(model, load, **options)
            motion = fy.solve_transient(rom, load, **options)
            fulls[part] = full.pressure[::part]
            rows[part] = fy.compare(motion, full)
        coarse[name], finest[name] = fulls[REFINED[0]], fulls[REFINED[-1]]
        for part, error in rows.items():
            reduced = f"{error.max_relative_error:.2%} / {error.rms_relative_error:.3%}"
            own = apart(fulls[part], finest[name])
            write(f"| {name} | {STEPS * part} | {reduced} | {own} |\n")
            sys.stdout.flush()
    for steps, found in ((STEPS, coarse), (STEPS * REFINED[-1], finest)):
        for one, other in combinations(found, 2):
            sys.stderr.write(f"{steps}: {one}, {other}: {apart(found[one], found[other])}\n")


def apart(one: np.ndarray, other: np.ndarray) -> str:
    """Return the largest and root mean square difference of pressures over the largest."""
    difference = np.abs(one - other) / other.max()
    return f"{difference.max():.1%} / {np.sqrt((difference**2).mean()):.2%}"


if __name__ == "__main__":
    counts = [int(word) for word in sys.argv[1:] if word.isdigit()]
    main(counts[0] if counts else 20, {word for word in sys.argv[1:] if not word.isdigit()})
