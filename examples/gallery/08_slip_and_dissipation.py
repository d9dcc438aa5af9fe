"""
Slip, and the energy it takes
=============================

A joint with friction is pulled to and fro. It remembers what has slipped, so force over
displacement is a loop. Its area is the energy that friction takes.
"""

import matplotlib.pyplot as plt
import numpy as np

import faying as fy

joint = fy.lap_joint(element_size=5.0).with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=5), compliance=True)
pull = fy.Load({"tip.Fx": 2500.0}, name="pull")
cycles = fy.solve_cycles(rom, pull, increments=20)
taken = cycles.energies[-1]

along = cycles.cycle.displacement("tip")[:, 0]
forces = 2500.0 * cycles.factors
start = cycles.start.displacement("tip")[-1, 0]
area = np.trapezoid(np.append(2500.0, forces), np.append(start, along))
print(f"{taken:.3f} mJ a cycle by slip, {area:.3f} mJ by the loop")
assert cycles.stationary
assert abs(area - taken) < 0.02 * taken  # they meet as increments shrink
assert (np.linalg.norm(cycles.cycle.traction, axis=2) <= 0.2 * cycles.cycle.pressure + 1e-6).all()

figure, axes = plt.subplots(layout="constrained")
axes.plot(1e3 * np.append(start, along), np.append(2500.0, forces), ".-")
axes.set(xlabel="tip [µm]", ylabel="force [N]")
