"""What inertia at the interface does to transients of the compliance method, and what it costs.

``python benchmarks/transient_attachment.py [JOINT…] [LOAD…]`` prints the table of
docs/theory/transient_accuracy.md, all of it or some joints and loads: a quarter of the longest
period at 100 steps per period. Needs gmsh for the pipe flange.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from method_ranges import STEPS, joints, rising

import faying as fy
from faying.reduction.projection import projected

SCHEMES = {
    "implicit Euler": fy.ImplicitEuler(),
    "generalized-α 0.8": fy.GeneralizedAlpha(0.8),
    "energy-decaying 0.8": fy.EnergyDecaying(0.8),
}
LOADS = {"jump": 0.0, "rise over T/10": 0.1, "rise over T/4": 0.25}
"""Part of the period within which the load rises."""
REPEATED = 3
"""Runs of which the median time is taken."""


def main(chosen: set[str]) -> None:
    """Print largest and root mean square errors, and processor time of a step."""
    write = sys.stdout.write
    columns = ("compliance", "compliance+inertia", "the same, 300 modes", "a step", "full model")
    write(f"| joint | load and scheme | {' | '.join(columns)} |\n{'|---' * 7}|\n")
    with tempfile.TemporaryDirectory() as folder:
        for joint in joints(Path(folder)):
            if chosen and joint.name not in chosen and chosen - set(LOADS):
                continue
            models, offline = reduced(joint.model)
            sys.stderr.write(f"{joint.name}: {offline}\n")
            period = 1.0 / fy.preloaded_frequencies(joint.model, 1)[0]
            loads = {
                label: rising(joint.bending, period, part) if part else fy.Load(joint.bending)
                for label, part in LOADS.items()
            }
            for label, load in loads.items():
                if chosen & set(LOADS) and label not in chosen:
                    continue
                for scheme, integrator in SCHEMES.items():
                    options = {
                        "step": period / STEPS,
                        "duration": period / 4,
                        "integrator": integrator,
                    }
                    begin = time.process_time()
                    full = fy.solve_transient(joint.model, load, **options)
                    whole = time.process_time() - begin
                    cells, spent = [joint.name, f"{label}, {scheme}"], []
                    for rom in models.values():
                        motion, seconds = timed(rom, load, options)
                        cells.append(shown(fy.compare(motion, full)))
                        spent.append(seconds)
                    cells.append(" / ".join(f"{1e3 * t / (STEPS / 4):.2g}" for t in spent) + " ms")
                    cells.append(f"{1e3 * whole / (STEPS / 4):.2g} ms")
                    write(f"| {' | '.join(cells)} |\n")
                    sys.stdout.flush()


def reduced(model: fy.Model) -> tuple[dict[str, fy.ReducedModel], str]:
    """Reduce without inertia at the interface, with it, and with more normal modes."""
    begin = time.process_time()
    _ = model.structure.held_compliance
    held = time.process_time() - begin
    models, sizes = {}, []
    for modes, inertia in ((20, False), (20, True), (300, True)):
        begin = time.process_time()
        basis = fy.craig_bampton(model, normal_modes=modes)
        if inertia:
            basis = fy.attachment_modes(model, classic=basis)
        name = f"{modes}{' with inertia' if inertia else ''}"
        models[name] = projected(model, basis, compliance=not inertia)
        spent = time.process_time() - begin + (0 if inertia else held)
        sizes.append(f"{name}: {len(basis)} vectors, {spent:.3g} s")
    return models, "; ".join(sizes)


def timed(rom: fy.ReducedModel, load: fy.Load, options: dict) -> tuple[fy.Solution, float]:
    """Return a transient and the median processor time of it."""
    spent = []
    for _ in range(REPEATED):
        begin = time.process_time()
        motion = fy.solve_transient(rom, load, **options)
        spent.append(time.process_time() - begin)
    return motion, float(np.median(spent))


def shown(error: fy.Accuracy) -> str:
    """Return largest and root mean square error."""
    return f"{error.max_relative_error:.2%} / {error.rms_relative_error:.3%}"


if __name__ == "__main__":
    main(set(sys.argv[1:]))
