"""What the time step does: observed order, and the peak pressure of the LC2 step response.

``python docs/validation/time_step.py`` prints both tables (two minutes).
"""

import sys

import numpy as np

import faying as fy
from faying.simulation.integrators import Integrator

SCHEMES: dict[str, Integrator] = {
    "implicit-euler": fy.ImplicitEuler(),
    "energy-decaying, 0": fy.EnergyDecaying(0.0),
    "energy-decaying, 0.8": fy.EnergyDecaying(0.8),
    "generalized-alpha, 0.8": fy.GeneralizedAlpha(0.8),
}
LC2 = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")


def joint(element_size: float) -> fy.Model:
    """Build the preloaded cantilever with its sticking area."""
    model = fy.lap_joint(element_size=element_size, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking(threshold=0.5, stiffness=1e6))


def order_rows() -> list[str]:
    """Error of the tip at the end of a smooth contact-free excitation, against a fine step."""
    model = joint(5.0)
    gap = np.full(model.contact.n_points, 1.0)  # 1 mm open: nothing touches
    loose = model.with_initial_gap("joint", gap).with_bolt_forces({"bolt": 0.0})
    rom = fy.reduce(loose, fy.craig_bampton(loose, normal_modes=3))
    period = 2e-3
    times = np.linspace(0, 2 * period, 2001)
    load = fy.Load({"tip.Fz": fy.History(times, 10.0 * np.sin(np.pi * times / (2 * period)) ** 2)})
    counts = (400, 800, 1600)

    def tip(scheme: Integrator, steps: int) -> float:
        run = fy.solve_transient(
            rom, load, step=2 * period / steps, duration=2 * period, integrator=scheme
        )
        return float(run.displacement("tip")[-1, 2])

    exact = tip(fy.GeneralizedAlpha(1.0), 40 * counts[-1])
    rows = []
    for name, scheme in SCHEMES.items():
        errors = [abs(tip(scheme, n) / exact - 1) for n in counts]
        order = np.log2(errors[-2] / errors[-1])
        cells = " | ".join(f"{error:.1e}" for error in errors)
        rows.append(f"| {name} | {cells} | {order:.2f} |\n")
    return rows


def peak_rows() -> list[str]:
    """Peak pressure and tip in one period of the LC2 step, full and reduced model."""
    model = joint(2.5)
    period = 1.0 / float(fy.preloaded_frequencies(model, 1)[0])
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=20), compliance=True)
    rows = []
    for name, scheme in SCHEMES.items():
        for steps in (50, 100, 200, 400, 800, 1600):
            full, fast = (
                fy.solve_transient(
                    system, LC2, step=period / steps, duration=period, integrator=scheme
                )
                for system in (model, rom)
            )
            rows.append(
                f"| {name} | {steps} | {full.max_pressure.max():.1f} "
                f"| {fast.max_pressure.max():.1f} | {full.displacement('tip')[:, 2].min():.4f} "
                f"| {fast.displacement('tip')[:, 2].min():.4f} |\n"
            )
    return rows


def main() -> None:
    """Print both tables."""
    write = sys.stdout.write
    write("| scheme | 400 steps | 800 | 1600 | observed order |\n|---|---|---|---|---|\n")
    for row in order_rows():
        write(row)
    write("\n| scheme | steps per period | peak [MPa], full | peak, compliance ")
    write("| lowest tip u_z [mm], full | tip, compliance |\n|---|---|---|---|---|---|\n")
    for row in peak_rows():
        write(row)


if __name__ == "__main__":
    main()
