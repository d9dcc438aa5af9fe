"""Lap joints of few bricks, for claims that do not depend on their number."""

import faying as fy


def tiny_lap(**parameters):
    """Return two plates of 10 mm bricks under one bolt, without a hole."""
    return fy.lap_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0, **parameters)
