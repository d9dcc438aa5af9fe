"""
When does it open?
==================

The load grows with the bolts locked: at which factor does a first point open, and from which is
less than half of the area pressed that the preload presses?
"""

import matplotlib.pyplot as plt
import numpy as np

import faying as fy

joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
lift = fy.Load({"tip.Fz": -400.0, "tip.Fx": 2e3}, name="lift")
face = fy.assess(joint, [lift]).interfaces["joint"]
all_closed = fy.assess(joint, [lift], fy.Requirements(open_below=1.0)).interfaces["joint"]
first, half = all_closed.opening["lift"], face.opening["lift"]
print(f"first opening at {first:.3f} times the load, half of the area at {half:.3f}")

# %%
# Separate solutions on both sides say the same.

factors = np.linspace(0.0, 6.0, 61)
cases = fy.solve_static_cases(joint, [lift.scaled(factor) for factor in factors])
pressed = (cases.pressure[0] > 0) & (cases.pressure > 0)
share = pressed @ joint.contact.weights / (pressed[0] @ joint.contact.weights)
assert ((share < 0.5) == (factors > half)).all()

figure, axes = plt.subplots(layout="constrained")
axes.plot(factors, cases.contact_force("joint"), label="clamp force")
axes.axvline(first, color="tab:red", ls="--", label="first point opens")
axes.axvline(half, color="tab:orange", ls=":", label="half of the area is open")
axes.set(xlabel="load factor", ylabel="clamp force [N]")
axes.legend()
