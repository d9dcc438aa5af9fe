"""How far the errors of a method range from joint to joint.

``python benchmarks/method_ranges.py`` prints the tables of docs/how-to/choose_a_method.md: three
joints, static loads and half a period of transients at 100 steps per period. Needs gmsh.
"""

import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pipe_flange import pipe_flange

import faying as fy

DAMPING = fy.Rayleigh(alpha=160.0, beta=5e-7)
STEPS = 100
METHODS = ("craig-bampton", "jim-a", "jim-b", "compliance", "jim-a+compliance", "80 normal modes")


@dataclass(frozen=True)
class Joint:
    """A tightened joint, two loads, and the box that method B is trained in."""

    name: str
    model: fy.Model
    bending: dict[str, float]
    combined: dict[str, float]

    @property
    def box(self) -> fy.LoadBox:
        """All loads of both, half as much again, either way."""
        largest = {**self.combined, **self.bending}
        sides = {name: (-1.5 * abs(value), 1.5 * abs(value)) for name, value in largest.items()}
        return fy.LoadBox(ranges=sides, levels=3)


def joints(folder: Path) -> Iterator[Joint]:
    """Build the joints, one after the other."""
    lap = fy.lap_joint(damping=DAMPING)
    yield Joint(
        name="cantilever",
        model=fy.preload(lap, {"bolt": 10e3}, sticking=fy.Sticking()),
        bending={"tip.Fz": -500.0},
        combined={"tip.Fz": -500.0, "tip.Mx": 20e3},
    )
    plates = fy.lap_joint(
        plates=3,
        length=160.0,
        thickness=6.0,
        overlap=60.0,
        bolt_positions=((-15.0, 0.0), (15.0, 0.0)),
        damping=DAMPING,
    )
    forces = dict(zip(plates.bolts, (8e3, 6e3), strict=True))
    yield Joint(
        name="double lap joint",
        model=fy.preload(plates, forces, sticking=fy.Sticking()),
        bending={"tip.Fz": -400.0},
        combined={"tip.Fz": -250.0, "tip.Fx": 2e3, "tip.Mx": 10e3},
    )
    flange = pipe_flange(folder / "flange.msh")
    yield Joint(
        name="pipe flange",
        model=fy.preload(flange, dict.fromkeys(flange.bolts, 40e3), sticking=fy.Sticking()),
        bending={"end.My": 6e6},
        combined={"end.Fx": 1e4, "end.Mx": -3e6},
    )


def reduced(joint: Joint) -> dict[str, fy.ReducedModel]:
    """Reduce a joint by every method: 20 normal modes (80 once), 20 joint modes."""
    model = joint.model
    classic, more = (fy.craig_bampton(model, normal_modes=n) for n in (20, 80))
    by_pressure = fy.jim_a(model, joint_modes=20, classic=classic)
    training = fy.static_snapshots(model, joint.box.static_loads(model))
    by_training = fy.jim_b(model, training, joint_modes=20, classic=classic)
    found = (
        (classic, False),
        (by_pressure, False),
        (by_training, False),
        (classic, True),
        (by_pressure, True),
        (more, True),
    )
    return {
        name: fy.reduce(model, basis, compliance=exact)
        for name, (basis, exact) in zip(METHODS, found, strict=True)
    }


def rising(forces: dict[str, float], period: float, part: float) -> fy.Load:
    """Let forces rise by half a cosine within a part of the period."""
    times = np.linspace(0.0, period, 801)
    shape = 0.5 - 0.5 * np.cos(np.pi * np.minimum(times / (part * period), 1.0))
    return fy.Load({name: fy.History(times, value * shape) for name, value in forces.items()})


def rows(joint: Joint) -> Iterator[tuple[str, dict[str, fy.Accuracy], str]]:
    """Yield loads, errors of every method, and what half the step does to the full model."""
    model, models = joint.model, reduced(joint)
    for label, forces in (("bending", joint.bending), ("combined", joint.combined)):
        full = fy.solve_static(model, fy.Load(forces))
        found = {
            name: fy.compare(fy.solve_static(rom, fy.Load(forces)), full)
            for name, rom in models.items()
        }
        yield f"static, {label}", found, ""
    period = 1.0 / fy.preloaded_frequencies(model, 1)[0]
    jump = fy.Load(joint.bending)
    for label, load, scheme in (
        ("jump, implicit Euler", jump, fy.ImplicitEuler()),
        ("jump, generalized-α 0.8", jump, fy.GeneralizedAlpha(0.8)),
        ("rise over T/4, generalized-α 0.8", rising(joint.bending, period, 0.25),
         fy.GeneralizedAlpha(0.8)),
    ):  # fmt: skip
        options = {"step": period / STEPS, "duration": period / 2, "integrator": scheme}
        full = fy.solve_transient(model, load, **options)
        half = fy.solve_transient(model, load, **{**options, "step": period / STEPS / 2})
        moved = np.abs(half.pressure[::2] - full.pressure).max() / full.pressure.max()
        found = {
            name: fy.compare(fy.solve_transient(rom, load, **options), full)
            for name, rom in models.items()
        }
        yield label, found, f"{moved:.1%}"


def main() -> None:
    """Print pressure errors, then displacement errors."""
    columns = f"| joint | load | {' | '.join(METHODS)} |"
    pressure = [f"{columns} half the step, full model |", "|---" * (len(METHODS) + 3) + "|"]
    displacement = [columns, "|---" * (len(METHODS) + 2) + "|"]
    with tempfile.TemporaryDirectory() as folder:
        for joint in joints(Path(folder)):
            for label, found, moved in rows(joint):
                errors = [f"{one.max_relative_error:.2%}" for one in found.values()]
                pressure.append(f"| {joint.name} | {label} | {' | '.join(errors)} | {moved} |")
                errors = [f"{one.displacement_error:.2%}" for one in found.values()]
                displacement.append(f"| {joint.name} | {label} | {' | '.join(errors)} |")
                sys.stderr.write(f"{joint.name}, {label}\n")
    sys.stdout.write("\n".join([*pressure, "", *displacement, ""]))


if __name__ == "__main__":
    main()
