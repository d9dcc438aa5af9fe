"""How near the estimate of the transient pressure error is to the true error.

``python benchmarks/transient_estimate.py`` prints the table of docs/theory/transient_accuracy.md:
three joints and one with friction, a quarter of the longest period; with names of joints those
alone, and with a number that part of the longest period (``0.12 "pipe flange"``). Needs gmsh.
"""

import sys
import tempfile
from itertools import chain
from pathlib import Path

from method_ranges import STEPS, joints, rising
from normal_modes import rubbing

import faying as fy

MODES = (20, 80)
SCHEMES = {
    "implicit Euler": fy.ImplicitEuler(),
    "generalized-α 0.8": fy.GeneralizedAlpha(0.8),
    "energy-decaying 0.8": fy.EnergyDecaying(0.8),
}


def main() -> None:
    """Print true and estimated errors, largest and root mean square."""
    write = sys.stdout.write
    span = next((float(one) for one in sys.argv[1:] if one.replace(".", "", 1).isdigit()), 0.25)
    names = [one for one in sys.argv[1:] if not one.replace(".", "", 1).isdigit()]
    write("| joint | load and scheme | 20 modes | estimated | 80 modes | estimated |\n")
    write("|---" * 6 + "|\n")
    with tempfile.TemporaryDirectory() as folder:
        for joint in chain(joints(Path(folder)), [rubbing()]):
            if names and joint.name not in names:
                continue
            models = {
                n: fy.reduce(
                    joint.model, fy.craig_bampton(joint.model, normal_modes=n), compliance=True
                )
                for n in MODES
            }
            period = 1.0 / fy.preloaded_frequencies(joint.model, 1)[0]
            loads = {
                "jump": fy.Load(joint.bending),
                "rise over T/10": rising(joint.bending, period, 0.1),
                "rise over T/4": rising(joint.bending, period, 0.25),
            }
            for label, load in loads.items():
                for scheme, integrator in SCHEMES.items():
                    options = {
                        "step": period / STEPS,
                        "duration": span * period,
                        "integrator": integrator,
                    }
                    full = fy.solve_transient(joint.model, load, **options)
                    cells = [joint.name, f"{label}, {scheme}"]
                    for n in MODES:
                        motion = fy.solve_transient(models[n], load, **options)
                        found = fy.transient_error(joint.model, motion, load, integrator=integrator)
                        cells += [_shown(fy.compare(motion, full)), _shown(found)]
                    write(f"| {' | '.join(cells)} |\n")
                    sys.stdout.flush()


def _shown(error: fy.Accuracy) -> str:
    rubbed = error.max_traction_error
    tractions = "" if rubbed is None else f", tractions {rubbed:.2%}"
    return f"{error.max_relative_error:.2%} / {error.rms_relative_error:.3%}{tractions}"


if __name__ == "__main__":
    main()
