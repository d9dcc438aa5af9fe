"""What schemes of second order do with the energy of contact: 216 runs of each.

``python benchmarks/transient_energy.py`` prints the table of docs/theory/time_integration.md for
the classic basis, and what the energy guard flags; ``… compliance`` that with exact interface
compliance (six minutes of processor time each). The lap joint of 5 mm bricks: three penalties, with
and without a sticking area, three numbers of normal modes, four loads applied as a step, three time
steps of 10 ms responses.
"""

import logging
import sys
import time
from collections.abc import Iterator

import numpy as np

import faying as fy
from faying.simulation.energy_guard import MOST_GAIN
from faying.simulation.integrators import Integrator

SCHEMES: dict[str, Integrator] = {
    "implicit-euler": fy.ImplicitEuler(),
    "energy-decaying, 0": fy.EnergyDecaying(0.0),
    "energy-decaying, 0.8": fy.EnergyDecaying(0.8),
    "energy-decaying, 1": fy.EnergyDecaying(1.0),
    "generalized-alpha, 0.8": fy.GeneralizedAlpha(0.8),
    "generalized-alpha, 1": fy.GeneralizedAlpha(1.0),
}
PENALTIES = (1e5, 4.2e5, 1e6)
NORMAL_MODES = (5, 20, 40)
STEPS = (5e-6, 1e-5, 2e-5)
DURATION = 1e-2
LOADS = (
    {"tip.Mx": -30e3},
    {"tip.Fz": -500.0, "tip.Mx": 20e3},
    {"tip.Fz": -1500.0},
    {"tip.My": 60e3, "tip.Fx": 3e3},
)


def models(*, compliance: bool) -> Iterator[fy.ReducedModel]:
    """Return the reduced models of all penalties, sticking areas and numbers of modes."""
    for penalty in PENALTIES:
        damping = fy.Rayleigh(alpha=160.0, beta=5e-7)
        model = fy.lap_joint(element_size=5.0, penalty=penalty, damping=damping)
        for sticking in (fy.Sticking(threshold=0.5, stiffness=1e6), None):
            joint = fy.preload(model, {"bolt": 10e3}, sticking=sticking)
            for count in NORMAL_MODES:
                basis = fy.craig_bampton(joint, normal_modes=count)
                yield fy.reduce(joint, basis, compliance=compliance)


def figures(rom: fy.ReducedModel, load: fy.Load, step: float, scheme: Integrator) -> list[float]:
    """Return peak pressure, energy gained, contact systems a step and seconds of one run."""
    begin = time.process_time()
    with np.errstate(all="ignore"):
        motion = fy.solve_transient(rom, load, step=step, duration=DURATION, integrator=scheme)
    seconds = time.process_time() - begin
    systems = float(motion.iterations[1:].mean())
    return [float(motion.max_pressure.max()), motion.energy_gain, systems, seconds]


def runs(rom: fy.ReducedModel) -> list[list[list[float]]]:
    """Return the figures of all schemes, for all loads and steps of one model."""
    return [
        [figures(rom, fy.Load(load), step, scheme) for scheme in SCHEMES.values()]
        for load in LOADS
        for step in STEPS
    ]


def main() -> None:
    """Run all of them and print one line per scheme."""
    logging.getLogger("faying").setLevel(logging.ERROR)
    found = [runs(rom) for rom in models(compliance="compliance" in sys.argv[1:])]
    show(np.concatenate(found))


def show(table: np.ndarray) -> None:
    """Print one line per scheme of runs (n_run, n_scheme, 4)."""
    peaks, gains, systems, seconds = np.moveaxis(table, -1, 0)
    ratios = peaks / peaks[:, :1]
    write = sys.stdout.write
    write("| scheme | peak over 3 times Euler's | peak over 5000 MPa | largest ratio ")
    write("| contact systems a step | time, Euler 1 |\n|---|---|---|---|---|---|\n")
    for k, name in enumerate(SCHEMES):
        write(
            f"| {name} | {np.count_nonzero(ratios[:, k] > 3)} "
            f"| {np.count_nonzero(peaks[:, k] > 5000)} | {ratios[:, k].max():.3g} "
            f"| {systems[:, k].mean():.2f} | {seconds[:, k].sum() / seconds[:, 0].sum():.1f} |\n"
        )
    write("\n| scheme | flagged | largest gain not flagged | largest ratio not flagged |\n")
    write("|---|---|---|---|\n")
    for k, name in enumerate(SCHEMES):
        sound = gains[:, k] <= MOST_GAIN
        most, worst = gains[sound, k].max(initial=0.0), ratios[sound, k].max(initial=0.0)
        write(f"| {name} | {np.count_nonzero(~sound)} | {most:.3f} | {worst:.2f} |\n")


if __name__ == "__main__":
    main()
