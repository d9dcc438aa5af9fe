"""Print how far certified errors lie above the true ones, on several joints; some minutes.

Run: ``python docs/validation/certificate_sharpness.py``. Random static loads of a box of six
components, 20 normal modes; methods A and B with 20 joint modes.
"""

import sys

import numpy as np

import faying as fy
from faying.assessment.accuracy import relative_error
from faying.assessment.certificate import certifier

LOADS = 60
PEAK = {"tip.Fx": 500.0, "tip.Fy": 500.0, "tip.Fz": 500.0}
PEAK |= {"tip.Mx": 20e3, "tip.My": 20e3, "tip.Mz": 20e3}
BOX = fy.LoadBox(ranges={name: (-value, value) for name, value in PEAK.items()})
TWO_BOLTS = ((-10.0, 0.0), (10.0, 0.0))
JOINTS = {
    "default cantilever": {},
    "tetrahedra (tet10), 5 mm": {"shape": "tet10", "element_size": 5.0},
    "two bolts, 60 mm overlap": {"bolt_positions": TWO_BOLTS, "overlap": 60.0},
    "three plates, two bolts": {"bolt_positions": TWO_BOLTS, "plates": 3},
    "arch, 2.5 mm": {"curvature": 2e-3},
    "meshes of 4 on 5 mm": {"element_size": 5.0, "upper_element_size": 4.0},
}


def main() -> None:
    """Print one row per joint and method."""
    write = sys.stdout.write
    write("| joint | points | method | energy | clamp force error, certified (true) |")
    write(" largest pressure error |\n|---|---|---|---|---|---|\n")
    for name, options in JOINTS.items():
        loose = fy.lap_joint(**options)
        model = fy.preload(loose, dict.fromkeys(loose.bolts, 10e3))
        for method, ratios in sharpness(model).items():
            write(f"| {name} | {model.contact.n_points} | {method} | {ratios} |\n")
            sys.stdout.flush()


def sharpness(model: fy.Model) -> dict[str, str]:
    """Return, by method, median / worst of bound over truth of energy and of pressure."""
    classic = fy.craig_bampton(model, normal_modes=20)
    forces = fy.static_snapshots(model, BOX.random_loads(model, LOADS, seed=1))
    bases = {
        "craig-bampton": classic,
        "jim-a, 20": fy.jim_a(model, joint_modes=20, classic=classic),
        "jim-b, 20": fy.jim_b(model, forces, joint_modes=20, classic=classic),
    }
    loads = BOX.random_loads(model, LOADS, seed=5)
    exact, judge = fy.solve_static_cases(model, loads), certifier(model)
    H = model.static_contact.flexibility
    found = {}
    for name, basis in bases.items():
        fast = fy.solve_static_cases(fy.reduce(model, basis), loads)
        bound = judge.certify_inputs(fast.inputs, fast.pressure)
        moved = fast.contact_forces - exact.contact_forces
        norms = [np.sqrt(((x @ H) * x).sum(axis=1)) for x in (moved, exact.contact_forces)]
        clamp = [total(model, solution) for solution in (fast, exact)]
        force = (np.abs(clamp[0] - clamp[1]) / clamp[1]).max(axis=1)
        peak = [
            np.abs(relative_error(p, q)).max()
            for p, q in zip(fast.pressure, exact.pressure, strict=True)
        ]
        found[name] = (
            f"{_shown(np.sqrt(2 * bound.energy) / norms[0])} | "
            f"{np.median(bound.contact_force_error):.2%} ({np.median(force):.3%}) | "
            f"{_shown(bound.max_relative_error / np.array(peak))}"
        )
    return found


def total(model: fy.Model, solution: fy.Solution) -> np.ndarray:
    """Return the total force of each interface (n_load, n_interface)."""
    return np.array([solution.contact_force(name) for name in model.interfaces]).T


def _shown(ratios: np.ndarray) -> str:
    return f"{np.median(ratios):.3g} / {ratios.max():.3g}"


if __name__ == "__main__":
    main()
