"""
Pressure of a bolted joint
==========================

Two bars of steel, lapped and bolted: the pressure that the bolt makes, and what a load at the tip
leaves of it. The bolt presses a cone of the joint, and bending moves the pressure to one side.
"""

import matplotlib.pyplot as plt

import faying as fy

joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
bend = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="bent and twisted")
pressed, loaded = fy.solve_static(joint), fy.solve_static(joint, bend)

# %%
# Without a load the joint carries what the bolt pulls: both forces agree to round-off.

clamped = pressed.contact_forces.sum()
assert abs(clamped - pressed.bolt_force("bolt")) < 1e-9 * clamped

# %%
# Contact points coloured by their pressure in MPa.

figure, axes = plt.subplots(2, 1, sharex=True, layout="constrained", figsize=(7, 5))
x, y, _ = joint.interfaces["joint"].points.T
for one, solution, title in zip(axes, (pressed, loaded), ("bolt alone", bend.name), strict=True):
    dots = one.scatter(x, y, c=solution.pressure, s=60, vmin=0, vmax=loaded.pressure.max())
    one.set(title=title, aspect="equal", ylabel="y [mm]")
axes[1].set_xlabel("x [mm]")
figure.colorbar(dots, ax=axes, label="pressure [MPa]")
print(f"largest pressure {pressed.pressure.max():.1f} MPa, loaded {loaded.pressure.max():.1f} MPa")
