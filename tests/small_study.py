"""The joint of small studies: a coarse lap joint with one bolt and some damping."""

SMALL_JOINT = """
[model]
source = "lap-joint"
lap_joint = { element_size = 5.0 }

[[bolt]]
name = "bolt"
preload = 5e3

[damping]
beta = 1e-6
"""
