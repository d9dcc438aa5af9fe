"""
Damping of a mode over its amplitude
====================================

The damping of a bolted structure comes from slip: it grows with the amplitude while the frequency
falls. Full cycles of a reduced model give both, here of the second mode, in which the bars turn
about the bolt in their plane. (In modes that also open and close the edges of the joint the
frequency can rise as well.)
"""

import matplotlib.pyplot as plt
import numpy as np

import faying as fy

joint = fy.lap_joint(element_size=5.0).with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=10), compliance=True)
found = fy.backbone(rom, 2, np.geomspace(0.005, 0.05, 6), increments=20)

assert found.energy_per_cycle[0] == 0  # nothing slips yet
assert (np.diff(found.energy_per_cycle) > 0).all()
assert found.frequency[-1] < 0.996 * found.small_frequency

figure, (above, below) = plt.subplots(2, 1, sharex=True, layout="constrained")
above.semilogx(found.amplitude, found.damping_ratio, "o-")
above.set_ylabel("damping ratio")
below.semilogx(found.amplitude, 100 * (found.frequency / found.small_frequency - 1), "o-")
below.set(xlabel="amplitude at the tip [mm]", ylabel="change of frequency [%]")
