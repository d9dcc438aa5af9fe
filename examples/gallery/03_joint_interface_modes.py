"""
Joint interface modes
=====================

The seed of this package: shapes of unit pressures on parts of the joint (method A), or of contact
forces met in training (method B), beside the classic modes. The error falls with their number, and
a certificate bounds it without the full solution.
"""

import matplotlib.pyplot as plt

import faying as fy

joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})
full = fy.solve_static(joint, load)
classic = fy.craig_bampton(joint, normal_modes=10)
box = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)}, levels=3)
training = fy.static_snapshots(joint, box.static_loads(joint))

counts, errors, bounds = (5, 10, 20, 40), {"A": [], "B": []}, {"A": [], "B": []}
for count in counts:
    bases = {
        "A": fy.jim_a(joint, joint_modes=count, classic=classic),
        "B": fy.jim_b(joint, training, joint_modes=min(count, 20), classic=classic),
    }
    for method, basis in bases.items():
        found = fy.solve_static(fy.reduce(joint, basis), load)
        errors[method].append(fy.compare(found, full).max_relative_error)
        bounds[method].append(float(fy.certify(joint, load, found.pressure).max_relative_error))

for method in errors:
    assert errors[method][-1] < errors[method][0]
    assert all(e <= b for e, b in zip(errors[method], bounds[method], strict=True))

figure, axes = plt.subplots(layout="constrained")
for method, colour in (("A", "tab:blue"), ("B", "tab:orange")):
    axes.semilogy(counts, errors[method], "o-", color=colour, label=f"method {method}")
    axes.semilogy(counts, bounds[method], "x:", color=colour, label=f"method {method}, certified")
axes.set(xlabel="joint modes", ylabel="pressure error over the largest pressure")
axes.legend()
