"""
One file for everyone
=====================

A reduced model goes into one file. Whoever loads it solves static and transient loads without the
finite element model, to the same bits.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

import faying as fy

joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=10), compliance=True)
load = fy.Load({"tip.Fz": -500.0})
with TemporaryDirectory() as folder:
    file = Path(folder) / "joint.faying"
    rom.save(file)
    kilobytes = file.stat().st_size / 1e3
    loaded = fy.read_reduced_model(file)

here, there = fy.solve_static(rom, load), fy.solve_static(loaded, load)
assert (here.pressure == there.pressure).all()
size = joint.K.shape[0]
print(f"{size} degrees of freedom became {rom.K.shape[0]}, in a file of {kilobytes:.0f} kB")

run = {"step": 2e-5, "duration": 2e-3}
swing = fy.solve_transient(loaded, load, **run)
assert (fy.solve_transient(rom, load, **run).states == swing.states).all()

figure, axes = plt.subplots(layout="constrained")
axes.plot(1e3 * swing.times, swing.displacement("tip")[:, 2])
axes.set(xlabel="time [ms]", ylabel="tip [mm]", title="swung by the loaded model")
