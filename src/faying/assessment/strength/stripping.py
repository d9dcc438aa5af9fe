"""Stripping of threads by engaged length: shear areas of the basic profile (FED-STD-H28/2B)."""

import numpy as np

from faying.assessment.strength.thread import Thread

SHEAR = 0.6
"""Shear strength over ultimate strength of steels, as commonly taken."""


def stripping_force(thread: Thread, engagement: float, ultimate: float) -> float:
    """Return the force at which the thread of a bolt strips [force].

    The cylinder that shears is at the minor diameter D₁ = d − 5/4 H of the nut: of each pitch
    P/2 + (d₂ − D₁)/√3 is metal of the bolt.

    Parameters
    ----------
    engagement : [length]
    ultimate : [force/length²]
        R_m of the bolt.
    """
    minor = thread.diameter - 5 / 4 * np.sqrt(3) / 2 * thread.pitch
    metal = thread.pitch / 2 + (thread.pitch_diameter - minor) / np.sqrt(3)
    area = np.pi * minor * engagement / thread.pitch * metal
    return float(SHEAR * ultimate * area)
