"""
Judge the joint
===============

Requirements, verdicts, the load factor of the bolt and the clamp force with its certified
interval, from a reduced model.
"""

import matplotlib.pyplot as plt
import numpy as np

import faying as fy

joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
basis = fy.jim_a(joint, joint_modes=40, normal_modes=10)
rom = fy.reduce(joint, basis)
loads = [fy.Load({"tip.Fz": -100.0 * n}, name=f"{100 * n} N") for n in range(1, 7)]
demanded = fy.Requirements(min_clamp_force=8e3, max_pressure=100.0)
found = fy.assess(rom, loads, demanded)
for verdict in found.verdicts:
    print("met" if verdict.met else "NOT MET", verdict)

# %%
# The full model's clamp force lies in the certified interval of the reduced one.

forces = fy.solve_static_cases(joint, loads).contact_forces.sum(axis=1)
intervals = np.array(
    [
        fy.certify(joint, load, fy.solve_static(rom, load).pressure).contact_force["joint"]
        for load in loads
    ]
)
assert (intervals[:, 0] <= forces).all()
assert (forces <= intervals[:, 1]).all()

figure, axes = plt.subplots(layout="constrained")
names = [load.name for load in loads]
axes.fill_between(names, *intervals.T, alpha=0.3, label="certified, 40 joint modes")
axes.plot(names, forces, "ko-", label="full model")
axes.axhline(demanded.min_clamp_force, color="tab:red", ls="--", label="demanded")
axes.set(xlabel="force at the tip", ylabel="clamp force [N]")
axes.legend()
