"""Stress in the thread of a bolt against its grade, in the symbols of VDI 2230 part 1 (2015).

The basic profile of a metric thread is a triangle of height H = √3/2 P, so that d₂ = d − 3/4 H and
d₃ = d − 17/12 H; the stress area is that of the diameter between both, A_S = π/4 ((d₂ + d₃)/2)²,
and so is the section modulus, W_S = π/32 ((d₂ + d₃)/2)³.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.strength.grades import BoltStrength, check_grade, strength_of
from faying.assessment.strength.sizes import size_named
from faying.exceptions import ModelError, refuse_model
from faying.units import LENGTHS

SHEAR = 0.6
"""Shear strength over ultimate strength of steels, where that of the bolt is unknown."""

WORKING = 0.5
"""k_τ: share of the tightening torsion in service, section 5.5.2."""

ANGLES = 72
"""Number of fibres around the section of which one is the worst: its bending is off by 0.1 %."""

FLANK = float(1 / np.cos(np.pi / 6))
"""1 / cos 30°, for the flanks of a metric thread."""


@dataclass(frozen=True, kw_only=True)
class Thread:
    """The thread of a bolt, its grade, and its bearing area.

    Attributes
    ----------
    diameter : [length]
        Nominal, d.
    pitch : [length]
        P.
    grade
        As ``"8.8"``: tensile strength of 800 MPa, yield strength 0.8 of it; or ``"A2-70"``,
        ``"SAE 5"``. Empty where ``strength`` is given, or it is unknown.
    strength
        Strength in place of that of the grade.
    unified
        Whether it is an inch thread.
    friction
        μ_G in the thread during tightening; None is no torsion.
    head_friction
        μ_K under the turned head or nut.
    head_diameter : [length]
        D_Km, mean diameter of the friction area under the turned head or nut.
    bearing : [length]
        Outer and inner diameter of the bearing area under head and nut.
    pressure_limit : [force/length²]
        p_G, the limiting surface pressure of the plate under the head.
    engagement : [length]
        Length of thread engagement.

    Examples
    --------
    >>> import faying as fy
    >>> round(fy.Thread(diameter=8.0, pitch=1.25, grade="8.8").stress_area, 1)
    36.6
    """

    diameter: float
    pitch: float
    grade: str = ""
    strength: BoltStrength | None = None
    unified: bool = False
    friction: float | None = None
    head_friction: float | None = None
    head_diameter: float | None = None
    bearing: tuple[float, float] | None = None
    pressure_limit: float | None = None
    engagement: float | None = None

    def __post_init__(self) -> None:
        if not (0 < self.pitch < self.diameter / 2):
            refuse_model(
                f"a thread of diameter {self.diameter:g} has the pitch {self.pitch:g}; give a "
                "positive one, less than half the diameter"
            )
        if self.grade:
            check_grade(self.grade)
        if self.bearing is not None and not self.bearing[0] > self.bearing[1] >= 0:
            refuse_model(
                f"a head of diameter {self.bearing[0]:g} bears on nothing around a hole of "
                f"{self.bearing[1]:g}; enlarge it, or make the hole smaller"
            )

    @classmethod
    def named(
        cls,
        size: str,
        grade: str = "",
        units: str = "mm-t-s",
        head: str = "ISO 4014",
        **others: Any,
    ) -> "Thread":
        """Return a thread by the name of its size, as ``"M8"``, ``"M8x1"`` or ``"3/8-24 UNF"``.

        Parameters
        ----------
        units
            Consistent unit set of the lengths.
        head
            ``"ISO 4014"`` hexagon, ``"ISO 4762"`` socket, ``"ISO 7089"`` hexagon on a washer.
        **others
            Other attributes; bearing and head_diameter are by default those of the head on a
            clearance hole (ISO 273), if the size has one.

        Raises
        ------
        ModelError
            If the size is unknown, or the unit of length.
        """
        unit, listed = _metres(units), size_named(size, head)
        if listed.face is not None and listed.hole is not None and listed.bearing is not None:
            others.setdefault("bearing", (listed.bearing / unit, listed.hole / unit))
            others.setdefault("head_diameter", (listed.face + listed.hole) / 2 / unit)
        return cls(
            diameter=listed.diameter / unit,
            pitch=listed.pitch / unit,
            grade=grade,
            unified=listed.unified,
            **others,
        )

    @property
    def pitch_diameter(self) -> float:
        """d₂ [length]."""
        return float(self.diameter - 3 / 4 * np.sqrt(3) / 2 * self.pitch)

    @property
    def stress_diameter(self) -> float:
        """d_S = (d₂ + d₃)/2, for inch threads d − 0.9743 P (ASME B1.1) [length]."""
        if self.unified:
            return self.diameter - 0.9743 * self.pitch
        root = self.diameter - 17 / 12 * np.sqrt(3) / 2 * self.pitch
        return float((self.pitch_diameter + root) / 2)

    @property
    def stress_area(self) -> float:
        """A_S [length²]."""
        return float(np.pi / 4 * self.stress_diameter**2)

    @property
    def minor_area(self) -> float:
        """A_3 at the minor diameter d₃ = 2 d_S − d₂ [length²]."""
        minor = 2 * self.stress_diameter - self.pitch_diameter
        return float(np.pi / 4 * minor**2)

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
        return lead + flanks * thread_friction + self.head_diameter / 2 * head_friction

    def strengths(self, units: str) -> BoltStrength:
        """Return the strength of the bolt.

        Raises
        ------
        ModelError
            If it is not known what a pressure is in these units.
        """
        return strength_of(self.grade, units) if self.strength is None else self.strength


def _metres(units: str) -> float:
    """Return the unit of length in metres."""
    length = units.split("-")[0]
    if length not in LENGTHS:
        refuse_model(f"a size is a length, and what that is in {units} is not known")
    return LENGTHS[length]


@dataclass(frozen=True, kw_only=True)
class ThreadStress:
    """Stress in the stress area of a bolt over all load cases.

    Attributes
    ----------
    axial : [force/length²]
        Axial stress σ_z = F_S / A_S; with bending, at the instant of the largest sum of both.
    bending : [force/length²]
        Bending stress σ_b = M_b / W_S of the outer fibre at that instant; None where unknown.
    torsion : [force/length²]
        Shear stress τ from tightening; zero if the friction of the thread is not given.
    reduced : [force/length²]
        σ_red,B = √((σ_z + σ_b)² + 3 (k_τ τ)²), section 5.5.2, there without σ_b.
    amplitude : [force/length²]
        σ_a, half the range of σ_z, section 5.5.3; with bending, for the fibre with the largest
        range of stress.
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
    """Return the stress in a thread after tightening to a preload [force].

    Bolt forces in service are (n_instant,) [force], bending moments with them (n_instant, 2, 2)
    [force·length] by end and component across the axis. The thread is assumed at the end with the
    larger moments.
    """
    stresses = forces / thread.stress_area
    bent = None if moments is None else moments / thread.section_modulus
    outer = _outer(stresses, bent)
    worst = int((stresses + outer).argmax())
    axial, bending = float(stresses[worst]), float(outer[worst])
    torsion = torsion_of(thread, preload)
    reduced = float(np.sqrt((axial + bending) ** 2 + 3 * (WORKING * torsion) ** 2))
    proof = thread.strengths(units).yields
    return ThreadStress(
        axial=axial,
        bending=None if bent is None else bending,
        torsion=torsion,
        reduced=reduced,
        amplitude=largest_amplitude(normal_stresses(thread, forces, moments)),
        proof=proof,
        safety=proof / reduced if reduced > 0 else float("inf"),
    )


def tightening_stress(thread: Thread, preload: float) -> float:
    """Return σ_red,M during tightening, with the full torsion [force/length²]."""
    return float(np.hypot(preload / thread.stress_area, np.sqrt(3) * torsion_of(thread, preload)))


def working_stress(
    thread: Thread, preload: float, forces: Vector, moments: Matrix | None
) -> Vector:
    """Return σ_red,B (n_instant,) [force/length²] of the outer fibre, see :func:`thread_stress`."""
    stresses = forces / thread.stress_area
    bent = None if moments is None else moments / thread.section_modulus
    twisted = np.sqrt(3) * WORKING * torsion_of(thread, preload)
    return np.asarray(np.hypot(stresses + _outer(stresses, bent), twisted))


def torsion_of(thread: Thread, preload: float) -> float:
    """Return τ from tightening [force/length²]; zero without friction in the thread."""
    if thread.friction is None:
        return 0.0
    lead = thread.pitch / (np.pi * thread.pitch_diameter)
    moment = preload * thread.pitch_diameter / 2 * (lead + FLANK * thread.friction)
    return float(moment / (np.pi / 16 * thread.stress_diameter**3))


def _outer(stresses: Vector, bent: Matrix | None) -> Vector:
    """Return the bending stress of the outer fibre at the end with the larger one."""
    if bent is None:
        return np.zeros_like(stresses)
    return np.asarray(np.linalg.norm(bent, axis=-1).max(axis=-1))


def normal_stresses(thread: Thread, forces: Vector, moments: Matrix | None) -> Matrix:
    """Return normal stresses at the root of the thread (n_instant, n_end, 3).

    They are the axial stress, and those of bending in two fibres a quarter of a turn apart. Bolt
    forces are (n_instant,) [force], moments (n_instant, 2, 2) [force·length] by end of the bolt and
    component across its axis.
    """
    bent = np.zeros((len(forces), 1, 2)) if moments is None else moments / thread.section_modulus
    axial = np.asarray(forces) / thread.stress_area
    return np.concatenate([np.broadcast_to(axial[:, None, None], (*bent.shape[:2], 1)), bent], 2)


def fibre_stresses(stresses: Matrix) -> Matrix:
    """Return the stress of fibres around both ends (n_instant, n_fibre) from normal stresses."""
    angles = np.linspace(0, 2 * np.pi, ANGLES, endpoint=False)
    around = np.stack([np.ones(ANGLES), np.cos(angles), np.sin(angles)])
    return np.asarray((stresses @ around).reshape(len(stresses), -1))


def largest_amplitude(stresses: Matrix) -> float:
    """Return half the largest range of stress of all fibres, from normal stresses.

    Between two instants it is Δσ_z + |Δσ_b|, in the fibre that Δσ_b points to. Instants are those
    of the extremes of sampled fibres.
    """
    fibres = fibre_stresses(stresses)
    extremes = stresses[np.unique([fibres.argmax(axis=0), fibres.argmin(axis=0)])]
    changes = extremes[:, None] - extremes
    return float((changes[..., 0] + np.linalg.norm(changes[..., 1:], axis=-1)).max()) / 2
