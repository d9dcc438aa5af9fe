"""The seed's numerical study: methods A and B against the full model, over penalty and mode count.

Run it with ``python examples/seed_reproduction.py [OUT.md]``; it takes about three minutes on two
cores and prints the tables of the validation page. LC1 and LC2 are not among the training loads,
and neither are the hundred random loads of the same box.
"""

import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import faying as fy

COUNTS = (5, 10, 20, 40)
PENALTIES = (1e4, 3e4, 1e5, 8.4e5)
"""c_n [N/mm³]: soft; where both bounds of the seed hold; middle; 10 E/h of the default mesh."""

PRELOAD = {"bolt": 10e3}
LC1 = fy.Load({"tip.Fz": -500.0}, name="LC1")
LC2 = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
BOX = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)})
STEPS_PER_PERIOD = 100


@dataclass(frozen=True, kw_only=True)
class Row:
    """Errors of one basis at one penalty, relative to the largest pressure, Eq. (15.31).

    Attributes
    ----------
    lc1, lc2
        Largest error of the static cases.
    unseen_median, unseen_worst
        Of the largest errors of a hundred random loads from the training box.
    step
        Accuracy of the LC2 step response over two periods.
    """

    penalty: float
    method: str
    joint_modes: int
    lc1: float
    lc2: float
    unseen_median: float
    unseen_worst: float
    step: fy.Accuracy


def joint(element_size: float = 2.5) -> fy.Model:
    """Build the default cantilever, preloaded and with its sticking area."""
    model = fy.lap_joint(element_size=element_size, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    return fy.preload(model, PRELOAD, sticking=fy.Sticking(threshold=0.5, stiffness=1e6))


def bases(model: fy.Model, step: float) -> Mapping[str, fy.Basis]:
    """Build all bases with the largest number of joint modes; shorter ones are their parts."""
    most = max(COUNTS)
    classic = fy.craig_bampton(model, normal_modes=20)
    training = np.hstack(
        [
            fy.static_snapshots(model, BOX.static_loads(model)),
            fy.step_snapshots(model, BOX.step_loads(), step=step, duration=STEPS_PER_PERIOD * step),
        ]
    )
    return {
        "craig-bampton": classic,
        "jim-a (W = K)": fy.jim_a(model, joint_modes=most, classic=classic),
        "jim-a (W = I)": fy.jim_a(model, joint_modes=most, weight="I", classic=classic),
        "jim-b": fy.jim_b(model, training, joint_modes=most, classic=classic),
    }


def rows(model: fy.Model, penalty: float, n_unseen: int = 100) -> Iterator[Row]:
    """Compare every basis with the full model at one penalty."""
    model = model.with_penalty(penalty)
    model = model.with_bolt_forces(fy.tighten(model, PRELOAD).initial_forces)
    step = 1.0 / fy.preloaded_frequencies(model, 1)[0] / STEPS_PER_PERIOD
    duration = 2 * STEPS_PER_PERIOD * step
    unseen = BOX.random_loads(model, n_unseen, seed=1)
    statics = fy.solve_static_cases(model, [LC1, LC2, *unseen])
    full_step = fy.solve_transient(model, LC2, step=step, duration=duration)
    for name, basis in bases(model, step).items():
        for count in COUNTS if name != "craig-bampton" else (0,):
            rom = fy.reduce(model, basis.with_joint_modes(count))
            reduced = fy.solve_static_cases(rom, [LC1, LC2, *unseen])
            largest = np.abs(reduced.pressure - statics.pressure).max(axis=1)
            error = largest / statics.max_pressure
            fast = fy.solve_transient(rom, LC2, step=step, duration=duration)
            yield Row(
                penalty=penalty,
                method=name,
                joint_modes=count,
                lc1=float(error[0]),
                lc2=float(error[1]),
                unseen_median=float(np.median(error[2:])),
                unseen_worst=float(error[2:].max()),
                step=fy.compare(fast, full_step),
            )


def table(entries: list[Row]) -> str:
    """Return the rows as a Markdown table; errors in per cent of the largest pressure."""
    lines = [
        "# Errors of the seed's methods over modes and penalties",
        "",
        "| c_n [N/mm³] | method | joint modes | LC1 | LC2 | unseen, median | unseen, worst "
        "| LC2 step, max | rms | peak ratio | tip error |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row.penalty:.2g} | {row.method} | {row.joint_modes} | {row.lc1:.1%} | {row.lc2:.1%} "
        f"| {row.unseen_median:.1%} | {row.unseen_worst:.1%} | {row.step.max_relative_error:.1%} "
        f"| {row.step.rms_relative_error:.2%} | {row.step.max_pressure_ratio:.3f} "
        f"| {row.step.displacement_error:.2%} |"
        for row in entries
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Print the table, and write it where a file is named."""
    model = joint()
    text = table([row for penalty in PENALTIES for row in rows(model, penalty)])
    sys.stdout.write(text)
    if len(sys.argv) > 1:
        Path(sys.argv[1]).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
