"""Damping and frequency of the first modes of the default joint over their amplitude.

    python examples/joint_damping.py [FIGURE.png]

Full cycles of a reduced model with interface compliance; a few minutes.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import faying as fy

AMPLITUDES = np.geomspace(2e-3, 0.5, 12)
"""Displacement of the tip if nothing slipped [mm]."""


def main() -> None:
    """Draw both over the amplitude."""
    joint = fy.lap_joint().with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=20), compliance=True)
    figure, (damping, frequency) = plt.subplots(2, 1, sharex=True, layout="constrained")
    for mode in (1, 2, 3):
        found = fy.backbone(rom, mode, AMPLITUDES)
        for remark in found.remarks:
            sys.stdout.write(f"mode {mode}: {remark}\n")
        label = f"mode {mode}, {found.small_frequency:.0f} Hz"
        damping.loglog(found.amplitude, found.damping_ratio, "o-", label=label)
        shift = found.frequency / found.small_frequency - 1
        frequency.semilogx(found.amplitude, 100 * shift, "o-")
    damping.set_ylabel("damping ratio")
    damping.legend()
    frequency.set_ylabel("change of frequency [%]")
    frequency.set_xlabel("amplitude at the tip [mm]")
    figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "joint_damping.png", dpi=150)


if __name__ == "__main__":
    main()
