"""Draw the pictures of the theory pages; about a minute: ``python docs/images/theory.py``.

compliance.png: pressure along the middle of the joint under LC2, by three models.
recovery.png: peak pressure of the LC2 step, online and recovered from the same motion.
certificate.png: certified against true energy error of random loads, and certified clamp forces.
"""

from pathlib import Path

import numpy as np

import faying as fy
from faying.assessment.certificate import certifier
from faying.report.style import REFERENCE, colour, house_style, new_figure, save

FOLDER = Path(__file__).parent
LC2 = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
BOX = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)})


def joint() -> fy.Model:
    """Build the default cantilever, preloaded, with its sticking area."""
    model = fy.lap_joint(damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


def compliance(model: fy.Model, classic: fy.Basis) -> None:
    """Draw the pressure along the row of contact points nearest to the edge of the hole."""
    face = model.interfaces["joint"]
    row = np.isclose(face.points[:, 1], face.points[np.abs(face.points[:, 1] + 6.0).argmin(), 1])
    order = np.flatnonzero(row)[np.argsort(face.points[row, 0])]
    along = face.points[order, 0]
    models = {
        "full": (model, REFERENCE, 3.0),
        "craig-bampton": (fy.reduce(model, classic), colour("craig-bampton"), 1.5),
        "compliance": (
            fy.reduce(model, classic, compliance=True),
            colour("compliance"),
            1.5,
        ),
    }
    figure = new_figure(8.0, 3.6)
    axes = figure.subplots()
    for name, (system, shade, width) in models.items():
        pressure = fy.solve_static(system, LC2).pressure[order]
        axes.plot(along, pressure, color=shade, linewidth=width, label=name)
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("contact pressure [MPa]")
    axes.set_title(f"LC2 along y = {face.points[order[0], 1]:.1f} mm, 20 normal modes")
    axes.legend()
    save(figure, FOLDER / "compliance.png")


def recovery(model: fy.Model, classic: fy.Basis) -> None:
    """Draw the peak pressure of the LC2 step: full, classic online, classic recovered."""
    period = 1.0 / fy.preloaded_frequencies(model, 1)[0]
    options = {"step": period / 100, "duration": 2 * period}
    full = fy.solve_transient(model, LC2, **options)
    online = fy.solve_transient(fy.reduce(model, classic), LC2, **options)
    recovered = fy.recover_pressure(model, online)
    figure = new_figure(8.0, 3.6)
    axes = figure.subplots()
    milliseconds = 1e3 * full.times
    shade = colour("craig-bampton")
    axes.plot(milliseconds, full.max_pressure, color=REFERENCE, linewidth=3.0, label="full")
    axes.plot(milliseconds, online.max_pressure, color=shade, label="craig-bampton, online")
    axes.plot(
        milliseconds,
        recovered.max_pressure,
        color=shade,
        linestyle="--",
        label="craig-bampton, recovered",
    )
    axes.set_ylim(0, None)
    axes.set_xlabel("time [ms]")
    axes.set_ylabel("largest pressure [MPa]")
    axes.set_title("LC2 as a step, implicit Euler, 100 steps per period")
    axes.legend(loc="center right")
    save(figure, FOLDER / "recovery.png")


def certificate(model: fy.Model, classic: fy.Basis) -> None:
    """Draw bounds against true errors, and intervals of the clamp force."""
    basis = fy.jim_b(
        model,
        fy.static_snapshots(model, BOX.static_loads(model)),
        joint_modes=20,
        classic=classic,
    )
    rom, judge = fy.reduce(model, basis), certifier(model)
    loads = BOX.random_loads(model, 60, seed=5)
    exact, fast = fy.solve_static_cases(model, loads), fy.solve_static_cases(rom, loads)
    found = judge.certify_inputs(fast.inputs, fast.pressure)
    H = model.static_contact.flexibility
    difference = fast.contact_forces - exact.contact_forces
    norms = [np.sqrt(np.einsum("ik,kl,il->i", x, H, x)) for x in (difference, exact.contact_forces)]
    figure = new_figure(10.0, 3.8)
    left, right = figure.subplots(1, 2)
    true = norms[0] / norms[1]
    left.loglog(true, found.energy_error, "o", color=colour("jim-b"), markersize=4)
    ends = np.array([true.min(), true.max()])
    left.loglog(ends, ends, color=REFERENCE, linewidth=1)
    left.set_xlabel("true energy error")
    left.set_ylabel("certified energy error")
    left.set_title("jim-b, 20 modes, 60 random loads; line: equal")
    force = exact.contact_force("joint")
    order = np.argsort(force)
    low, high = found.contact_force["joint"][order].T / 1e3
    right.fill_between(
        np.arange(60), low, high, color=colour("jim-b"), alpha=0.3, label="certified"
    )
    right.plot(force[order] / 1e3, color=REFERENCE, linewidth=1, label="exact")
    right.set_xlabel("load, sorted")
    right.set_ylabel("clamp force [kN]")
    right.set_title("clamp force: certified interval, exact value")
    right.legend()
    save(figure, FOLDER / "certificate.png")


def main() -> None:
    """Draw all three."""
    model = joint()
    classic = fy.craig_bampton(model, normal_modes=20)
    with house_style():
        compliance(model, classic)
        recovery(model, classic)
        certificate(model, classic)


if __name__ == "__main__":
    main()
