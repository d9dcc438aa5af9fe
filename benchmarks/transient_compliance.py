"""What limits the transient accuracy of the compliance method, and what would halve it.

``python benchmarks/transient_compliance.py`` prints the table of docs/theory/transient_accuracy.md
(about two minutes on two cores): LC2 step and a smooth load of the default cantilever.
"""

import sys

import numpy as np

import faying as fy

LC2 = {"tip.Fz": -500.0, "tip.Mx": 20e3}


def joint() -> fy.Model:
    """Build the default cantilever, preloaded, with its sticking area."""
    model = fy.lap_joint(damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


def smooth(period: float) -> fy.Load:
    """LC2 swelling and fading within two periods."""
    times = np.linspace(0, 2 * period, 801)
    swell = np.sin(np.pi * times / (2 * period)) ** 2
    return fy.Load({name: fy.History(times, value * swell) for name, value in LC2.items()})


def main() -> None:
    """Print one line per variant."""
    model = joint()
    period = 1.0 / fy.preloaded_frequencies(model, 1)[0]
    step_load = fy.Load(LC2)
    variants = [
        ("step, implicit Euler", step_load, fy.ImplicitEuler(), 100),
        ("step, implicit Euler", step_load, fy.ImplicitEuler(), 400),
        ("smooth, generalized-α 0.8", smooth(period), fy.GeneralizedAlpha(0.8), 100),
    ]
    write = sys.stdout.write
    write(
        "| load and scheme | steps per period | basis | max | p99.9 | rms | max after 50 steps |\n"
    )
    write("|---|---|---|---|---|---|---|\n")
    for label, load, scheme, steps in variants:
        options = {"step": period / steps, "duration": 2 * period, "integrator": scheme}
        full = fy.solve_transient(model, load, **options)
        for name, basis in bases(model).items():
            rom = fy.reduce(model, basis, compliance=True)
            fast = fy.solve_transient(rom, load, **options)
            error = np.abs(fy.relative_error(fast.pressure, full.pressure))
            write(
                f"| {label} | {steps} | {name} | {error.max():.2%} "
                f"| {np.percentile(error, 99.9):.2%} | {np.sqrt((error**2).mean()):.3%} "
                f"| {error[51:].max():.2%} |\n"
            )


def bases(model: fy.Model) -> dict[str, fy.Basis]:
    """Return bases that differ in normal modes and joint modes."""
    classic = {f"{n} normal": fy.craig_bampton(model, normal_modes=n) for n in (10, 20, 40, 80)}
    joint_modes = {
        f"20 normal, {n} jim-a": fy.jim_a(model, joint_modes=n, classic=classic["20 normal"])
        for n in (10, 20, 40)
    }
    return {**classic, **joint_modes}


if __name__ == "__main__":
    main()
