"""Stress in the thread of a bolt against its grade, in the symbols of VDI 2230 part 1 (2015).

The basic profile of a metric thread is a triangle of height H = √3/2 P, so that d₂ = d − 3/4 H and
d₃ = d − 17/12 H; the stress area is that of the diameter between both, A_S = π/4 ((d₂ + d₃)/2)²,
and so is the section modulus, W_S = π/32 ((d₂ + d₃)/2)³.
"""

import re
from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix, Vector
from faying.exceptions import ModelError
from faying.units import pascals

WORKING = 0.5
"""k_τ: share of the torsion of tightening that counts in service, section 5.5.2."""

ANGLES = 72
"""Places around the section at which the range of its stress is taken: 0.1 % of it at most lost."""

FLANK = 2 / np.sqrt(3)
"""1 / cos 30°, of the flanks of a metric thread."""


@dataclass(frozen=True, kw_only=True)
class Thread:
    """A metric thread and the grade of its bolt.

    Attributes
    ----------
    diameter : [length]
        Nominal, d.
    pitch : [length]
        P.
    grade
        As ``"8.8"``: tensile strength of 800 MPa, of which it yields at 0.8.
    friction
        μ_G in the thread while the nut is turned; without it nothing twists.
    head_diameter : [length]
        D_Km, mean diameter of the area that rubs under the head or nut that is turned.
    """

    diameter: float
    pitch: float
    grade: str
    friction: float | None = None
    head_diameter: float | None = None

    def __post_init__(self) -> None:
        if not (0 < self.pitch < self.diameter / 2):
            message = (
                f"a thread of diameter {self.diameter:g} has the pitch {self.pitch:g}; give a "
                "positive one, less than half the diameter"
            )
            raise ModelError(message)
        if not re.fullmatch(r"\d{1,2}\.\d", self.grade) or self.grade.endswith(".0"):
            message = f"grade '{self.grade}' is none; give it as in '8.8' or '10.9'"
            raise ModelError(message)

    @property
    def pitch_diameter(self) -> float:
        """d₂ [length]."""
        return float(self.diameter - 3 / 4 * np.sqrt(3) / 2 * self.pitch)

    @property
    def stress_diameter(self) -> float:
        """d_S = (d₂ + d₃)/2 [length]."""
        root = self.diameter - 17 / 12 * np.sqrt(3) / 2 * self.pitch
        return float((self.pitch_diameter + root) / 2)

    @property
    def stress_area(self) -> float:
        """A_S [length²]."""
        return float(np.pi / 4 * self.stress_diameter**2)

    @property
    def section_modulus(self) -> float:
        """W_S [length³]."""
        return float(np.pi / 32 * self.stress_diameter**3)

    def torque_per_force(self, thread_friction: Vector, head_friction: Vector) -> Vector:
        """Return M_A / F_M = P/(2π) + d₂/2 1.155 μ_G + D_Km/2 μ_K [length].

        Raises
        ------
        ModelError
            If the diameter under the head is not given.
        """
        if self.head_diameter is None:
            message = "the torque of tightening takes the head_diameter D_Km of the thread; give it"
            raise ModelError(message)
        lead, flanks = self.pitch / (2 * np.pi), self.pitch_diameter / 2 * FLANK
        ratio: Vector = lead + flanks * thread_friction + self.head_diameter / 2 * head_friction
        return ratio

    def proof_stress(self, units: str) -> float:
        """Return R_p0.2 of the grade [force/length²].

        Raises
        ------
        ModelError
            If it is not known what a pressure is in these units.
        """
        pascal = pascals(units)
        if pascal is None:
            message = f"a grade is a stress in MPa, and what that is in {units} is not known"
            raise ModelError(message)
        strength, share = self.grade.split(".")
        return float(int(strength) * 100e6 * int(share) / 10 / pascal)


@final
@dataclass(frozen=True, kw_only=True)
class ThreadStress:
    """Stress in the stress area of a bolt over all load cases.

    Attributes
    ----------
    axial : [force/length²]
        Axial stress σ_z = F_S / A_S, with bending at the instant where both are worst together.
    bending : [force/length²]
        Bending stress σ_b = M_b / W_S of the outer fibre at that instant; None where not seen.
    torsion : [force/length²]
        Shear stress τ that tightening leaves; zero where the friction of the thread is not given.
    reduced : [force/length²]
        σ_red,B = √((σ_z + σ_b)² + 3 (k_τ τ)²), section 5.5.2, there without σ_b.
    amplitude : [force/length²]
        σ_a, half the range of σ_z, section 5.5.3; with bending of the fibre whose stress has the
        largest range.
    proof : [force/length²]
        Proof stress R_p0.2 of the grade.
    safety : [1]
        S_F = R_p0.2 / σ_red,B.
    """

    axial: float
    bending: float | None
    torsion: float
    reduced: float
    amplitude: float
    proof: float
    safety: float


def thread_stress(
    thread: Thread, preload: float, forces: Vector, moments: Matrix | None, units: str
) -> ThreadStress:
    """Return the stress in a thread.

    Parameters
    ----------
    preload : [force]
        Force the bolt is tightened to.
    forces : (n_instant,) [force]
        Bolt forces in service.
    moments : (n_instant, 2, 2) or None [force·length]
        Bending moments with them: end, component across the axis. The thread is taken to be where
        they are larger.
    """
    area, pitch_diameter = thread.stress_area, thread.pitch_diameter
    stresses = forces / area
    bent = None if moments is None else moments / thread.section_modulus
    outer = np.zeros_like(stresses) if bent is None else np.linalg.norm(bent, axis=-1).max(axis=-1)
    worst = int((stresses + outer).argmax())
    axial, bending, torsion = float(stresses[worst]), float(outer[worst]), 0.0
    if thread.friction is not None:
        lead = thread.pitch / (np.pi * pitch_diameter)
        moment = preload * pitch_diameter / 2 * (lead + FLANK * thread.friction)
        torsion = float(moment / (np.pi / 16 * thread.stress_diameter**3))
    reduced = float(np.sqrt((axial + bending) ** 2 + 3 * (WORKING * torsion) ** 2))
    proof = thread.proof_stress(units)
    return ThreadStress(
        axial=axial,
        bending=None if bent is None else bending,
        torsion=torsion,
        reduced=reduced,
        amplitude=_amplitude(stresses, bent),
        proof=proof,
        safety=proof / reduced if reduced > 0 else float("inf"),
    )


def _amplitude(stresses: Vector, bent: Matrix | None) -> float:
    """Return half the largest range of stress of a fibre, at either end where it is bent."""
    if bent is None:
        return float(np.ptp(stresses)) / 2
    around = np.linspace(0, 2 * np.pi, ANGLES, endpoint=False)
    ranges = [
        np.ptp(stresses[:, None] + bent @ [np.cos(angle), np.sin(angle)], axis=0).max()
        for angle in around
    ]
    return float(max(ranges)) / 2
