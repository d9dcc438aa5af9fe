"""
Choose the penalty
==================

How stiff must contact be? A sweep over the penalty shows from where on pressures no longer follow
it.
"""

import matplotlib.pyplot as plt
import numpy as np

import faying as fy

joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
load = fy.Load({"tip.Fz": -500.0})
sweep = fy.penalty_sweep(joint, [load])
advice = fy.recommend_penalty(sweep)
print(advice.text)

# %%
# Stiffer contact penetrates less, and comes nearer to hard contact.

assert (np.diff(sweep.penetration[:, 0]) < 0).all()
assert sweep.rms_deviation[-1, 0] < sweep.rms_deviation[0, 0]

figure, axes = plt.subplots(layout="constrained")
axes.loglog(sweep.penalties, sweep.rms_deviation[:, 0], "o-")
axes.axvline(sweep.automatic, ls=":", color="gray", label="auto: 10 E/h")
axes.set(xlabel="penalty [N/mm³]", ylabel="difference to hard contact, rms")
axes.legend()
