"""
A thousand load cases
=====================

With the interface compliance a static case costs a small contact problem. The envelope says where
the joint is ever pressed hardest, and where it ever opens.
"""

from time import process_time

import matplotlib.pyplot as plt
import numpy as np

import faying as fy

joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=5), compliance=True)
box = fy.LoadBox(ranges={"tip.Fz": (-500.0, 500.0), "tip.Mx": (-20e3, 20e3)})
loads = box.random_loads(joint, 1000, seed=1)

start = process_time()
cases = fy.solve_static_cases(rom, loads)
print(f"{1e3 * (process_time() - start) / len(loads):.2f} ms a case")
most, least = cases.pressure.max(axis=0), cases.pressure.min(axis=0)

# %%
# Any case is what a solution of the full model alone gives.

for number in (0, 499, 999):
    alone = fy.solve_static(joint, loads[number]).pressure
    assert np.abs(cases.pressure[number] - alone).max() < 1e-8 * alone.max()

x, y, _ = joint.interfaces["joint"].points.T
figure, axes = plt.subplots(2, 1, sharex=True, layout="constrained", figsize=(7, 5))
for one, values, title in zip(axes, (most, least), ("largest", "smallest"), strict=True):
    dots = one.scatter(x, y, c=values, s=60)
    one.set(title=f"{title} pressure of 1000 cases", aspect="equal", ylabel="y [mm]")
    figure.colorbar(dots, ax=one, label="[MPa]")
axes[1].set_xlabel("x [mm]")
