"""
Tighten several bolts
=====================

A bolt loosens its neighbours when it is tightened. The initial forces that lead to equal final
ones are solved for, and how far a little more of each changes the others is a derivative.
"""

import matplotlib.pyplot as plt
import numpy as np

import faying as fy

model = fy.lap_joint(
    element_size=5.0,
    overlap=60.0,
    length=140.0,
    bolt_positions=((-18.0, 0.0), (0.0, 0.0), (18.0, 0.0)),
)
wanted = dict.fromkeys(model.bolts, 8e3)
tightened = fy.tighten(model, wanted)
assert np.allclose(tightened.bolt_forces[-1], 8e3, rtol=1e-9)

# %%
# In the end contact carries what all bolts pull.

joint = fy.preload(model, wanted)
state = fy.solve_static(joint)
pull = sum(float(state.bolt_force(name)) for name in model.bolts)
assert abs(state.contact_forces.sum() - pull) < 1e-9 * pull

# %%
# What another newton of final force in each bolt does to the clamp force: it adds that newton,
# for the others are held at theirs.

change = fy.sensitivity(joint, state).final_preloads
assert np.allclose(change.contact_force("joint"), 1.0, rtol=1e-9)

figure, axes = plt.subplots(layout="constrained")
for bolt, forces in zip(tightened.bolts, tightened.bolt_forces.T, strict=True):
    axes.plot(1e-3 * forces, label=bolt)
axes.set(xlabel="increments of tightening", ylabel="bolt force [kN]")
axes.legend()
