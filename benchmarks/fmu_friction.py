"""What a step of an FMU with friction costs, and how far it is from our own integrators.

    python benchmarks/fmu_friction.py [ELEMENT_SIZE]

Step response of the default cantilever, 20 normal modes, steps of 10 µs, in fmpy and in Python:
milliseconds of processor time a step, and the largest difference of tractions over their peak.
"""

import sys
import tempfile
import time
from pathlib import Path

import fmpy
import numpy as np

import faying as fy
from faying.export.formats import export

STEP, COUNT = 1e-5, 100
LOAD = {"tip.Fx": 3000.0, "tip.Fz": -500.0, "tip.Mx": 20e3}
INTEGRATORS = (fy.ImplicitEuler(), fy.GeneralizedAlpha(0.8), fy.EnergyDecaying(0.8))


def main() -> None:
    """Print a table."""
    size = float(sys.argv[1]) if len(sys.argv) > 1 else 2.5
    smooth = fy.lap_joint(
        element_size=size, penalty=1e6, damping=fy.Rayleigh(alpha=160.0, beta=5e-7)
    )
    model = smooth.with_bolt_forces({"bolt": 10e3}).with_friction(0.2, tangential_penalty=8e5)
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=20), compliance=True)
    bolt = rom.bolts["bolt"].initial_force
    names = ("time", *LOAD, "bolt.initial_force")
    table = np.array([(0.0, *LOAD.values(), bolt)], dtype=[(name, float) for name in names])
    with tempfile.TemporaryDirectory() as folder:
        files = export(rom, "fmu", out=Path(folder) / "joint.fmu")
        sys.stdout.write(f"{rom.contact.n_points} points, {files[0].stat().st_size / 1e6:.1f} MB\n")
        place = fmpy.extract(str(files[1]), unzipdir=str(Path(folder) / "joint"))
        for number, integrator in enumerate(INTEGRATORS):
            begin = time.process_time()
            ours = fy.solve_transient(
                rom, fy.Load(LOAD), step=STEP, duration=COUNT * STEP, integrator=integrator
            )
            middle = time.process_time()
            start = {"step_size": STEP, "start_loaded": False, "integrator": number}
            theirs = fmpy.simulate_fmu(
                place,
                stop_time=COUNT * STEP,
                output_interval=STEP,
                input=table,
                start_values=start,
                output=["joint.traction"],
            )
            end = time.process_time()
            traction = np.linalg.norm(ours.traction, axis=-1)
            apart = np.abs(theirs["joint.traction"] - traction).max() / traction.max()
            sys.stdout.write(
                f"{type(integrator).__name__}: FMU {1e3 * (end - middle) / COUNT:.2f} ms, "
                f"Python {1e3 * (middle - begin) / COUNT:.2f} ms, apart by {apart:.1e}\n"
            )


if __name__ == "__main__":
    main()
