"""
When does it open?
==================

Without friction contact is linear between the load factors at which a point opens or closes. The
path from kink to kink is exact: no increments, no tolerance.
"""

import matplotlib.pyplot as plt
import numpy as np

import faying as fy

joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
lift = fy.Load({"tip.Fz": -400.0, "tip.Fx": 2e3}, name="lift")
path = fy.load_path(joint, lift, largest=6.0)
clamp = path.clamp_force("joint")
print(f"first opening at {path.first_opening():.3f} times the load, {len(path.factors)} kinks")

# %%
# Any point of it is what a separate solution gives.

for factor in (0.7, 2.3, 5.1):
    alone = fy.solve_static(joint, fy.Load({k: factor * v for k, v in lift.forces.items()}))
    assert np.abs(path.at(factor) - alone.contact_forces).max() < 1e-9 * alone.contact_forces.max()

figure, axes = plt.subplots(layout="constrained")
axes.plot(path.factors, clamp, ".-", label="clamp force, a dot at each kink")
axes.axvline(path.first_opening(), color="tab:red", ls="--", label="first point opens")
axes.set(xlabel="load factor", ylabel="clamp force [N]")
axes.legend()
