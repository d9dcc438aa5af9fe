"""Reduced models against the full one in a step response with friction, and what a step costs.

``python benchmarks/transient_friction.py`` prints the table behind docs/theory/friction.md: the
reference cantilever of tests/data/README.md (c_n 1e6, c_t 8e5 N/mm³, μ = 0.2, 8 kN locked) under
Fz −500 N, Mx 20 Nm and Fx 3 kN at once, 200 steps of implicit Euler of 1.55e-5 s. A minute.
"""

import sys
import time

import numpy as np

import faying as fy
from faying._typing import Matrix
from faying.reduction.projection import projected

LOAD = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3, "tip.Fx": 3000.0})
STEP, STEPS, LATER = 1.55e-5, 200, 5


def joint() -> fy.Model:
    """Return the reference cantilever."""
    damping = fy.Rayleigh(alpha=160.0, beta=5e-7)
    model = fy.lap_joint(
        hole_radius=None,
        element="standard",
        washer_radius=4.6,
        shear_flexible=False,
        bolt_mass=False,
        penalty=1e6,
        damping=damping,
    )
    model = model.with_bolt_forces({"bolt": 8e3})
    return model.with_friction(0.2, tangential_penalty=8e5)


def reduced(model: fy.Model) -> dict[str, fy.ReducedModel]:
    """Return the models of the table, by name."""
    models = {}
    for modes in (10, 20, 40, 80):
        basis = fy.craig_bampton(model, normal_modes=modes)
        models[f"compliance, {modes} normal modes"] = projected(model, basis, compliance=True)
        if modes in (20, 80):
            basis = fy.attachment_modes(model, classic=basis)
            name = f"compliance+inertia, {modes} normal modes"
            models[name] = projected(model, basis, compliance=False)
    return models


def sizes(found: Matrix, exact: Matrix) -> tuple[Matrix, float]:
    """Return deviations (n_time, n_point) over the largest size, vectors by their lengths."""
    wrong, size = np.abs(found - exact), np.abs(exact)
    if exact.ndim == 3:
        wrong, size = np.linalg.norm(found - exact, axis=2), np.linalg.norm(exact, axis=2)
    return wrong / size.max(), float(size.max())


def main() -> None:
    """Print errors and processor time."""
    model, write = joint(), sys.stdout.write
    options = {"step": STEP, "duration": STEPS * STEP}
    begin = time.process_time()
    full = fy.solve_transient(model, LOAD, **options)
    spent = 1e3 * (time.process_time() - begin) / STEPS
    sys.stderr.write(f"full model: {spent:.3g} ms a step\n")
    write(
        "| model | pressure, largest | from step 5 on | rms | traction, largest | from step 5 on "
        "| rms | tip | a step |\n|---|---|---|---|---|---|---|---|---|\n"
    )
    for name, rom in reduced(model).items():
        begin = time.process_time()
        fast = fy.solve_transient(rom, LOAD, **options)
        spent = 1e3 * (time.process_time() - begin) / STEPS
        cells = [name]
        for field in ("pressure", "traction"):
            wrong, _ = sizes(getattr(fast, field), getattr(full, field))
            root = np.sqrt((wrong**2).mean())
            cells += [f"{100 * one:.2g} %" for one in (wrong.max(), wrong[LATER:].max(), root)]
        tips = [one.displacement("tip")[:, :3] for one in (fast, full)]
        cells += [
            f"{np.abs(tips[0] - tips[1]).max() / np.abs(tips[1]).max():.1e}",
            f"{spent:.2g} ms",
        ]
        write(f"| {' | '.join(cells)} |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
