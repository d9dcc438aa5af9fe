"""Joints of small studies: coarse lap joints with one bolt."""

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

TINY_JOINT = """
[model]
source = "lap-joint"
lap_joint = { element_size = 10.0, hole_radius = 0.0, washer_radius = 11.0 }

[[bolt]]
name = "bolt"
preload = 5e3
"""
