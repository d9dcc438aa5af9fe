"""
Why reduction loses the pressure, and what gives it back
========================================================

Craig–Bampton modes follow the motion of the joint and miss its pressure, whatever their number.
The interface compliance beside the same modes makes static pressures exact.
"""

import matplotlib.pyplot as plt

import faying as fy

joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})
full = fy.solve_static(joint, load)

counts, plain, exact, motion = (2, 5, 10, 20, 40), [], [], []
for count in counts:
    basis = fy.craig_bampton(joint, normal_modes=count)
    poor = fy.compare(fy.solve_static(fy.reduce(joint, basis), load), full)
    good = fy.compare(fy.solve_static(fy.reduce(joint, basis, compliance=True), load), full)
    plain.append(poor.max_relative_error)
    motion.append(poor.displacement_error)
    exact.append(good.max_relative_error)

assert min(plain) > 0.5  # more than half of the largest pressure, with every number of modes
assert max(exact) < 1e-8

figure, axes = plt.subplots(layout="constrained")
axes.semilogy(counts, plain, "o-", label="pressure, Craig–Bampton")
axes.semilogy(counts, motion, "s-", label="displacement of the tip, Craig–Bampton")
axes.semilogy(counts, exact, "^-", label="pressure, with interface compliance")
axes.set(xlabel="normal modes", ylabel="largest error over the largest value")
axes.legend()
