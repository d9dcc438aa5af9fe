"""
A step load in time
===================

A load that jumps makes the joint swing. The reduced model with interface compliance takes the same
steps as the full one, each for a small part of the cost, and pressures recovered from its motion
can be compared.
"""

import matplotlib.pyplot as plt
import numpy as np

import faying as fy

joint = fy.preload(fy.lap_joint(element_size=5.0, damping=fy.Rayleigh(beta=5e-7)), {"bolt": 10e3})
load = fy.Load({"tip.Fz": -300.0})
step = 1 / fy.preloaded_frequencies(joint, 1)[0] / 100
run = {"step": step, "duration": 150 * step}
rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=20), compliance=True)
full, fast = fy.solve_transient(joint, load, **run), fy.solve_transient(rom, load, **run)

error = fy.compare(fast, full)
print(f"pressure within {error.max_relative_error:.2%}, rms {error.rms_relative_error:.3%}")
assert error.rms_relative_error < 0.01

# %%
# Energy: implicit Euler takes some, and makes none.

balance = fy.energy_balance(full)
assert (np.diff(balance.numerical_dissipation) > -1e-9 * balance.work.max()).all()

figure, (above, below) = plt.subplots(2, 1, sharex=True, layout="constrained")
for one, style in ((full, "k-"), (fast, "C1--")):
    above.plot(1e3 * one.times, one.displacement("tip")[:, 2], style)
    below.plot(1e3 * one.times, one.max_pressure, style)
above.set_ylabel("tip [mm]")
below.set(xlabel="time [ms]", ylabel="largest pressure [MPa]")
below.legend(["full", "reduced"])
