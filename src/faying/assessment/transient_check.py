"""Comparison of a motion by harmonics with a transient."""

from dataclasses import dataclass

LARGEST_DIFFERENCE = 0.01
"""Largest relative difference of amplitudes in agreement."""


@dataclass(frozen=True, kw_only=True)
class TransientCheck:
    """The highest point of a curve, and where a transient at its frequency settles.

    Attributes
    ----------
    level : [1]
        Factor of the load.
    frequency : [1/time]
        Cyclic.
    amplitude, transient_amplitude : [length]
        By harmonics, and of the transient.
    phase, transient_phase : [degree]
        Against the load.
    periods : [1]
        Number of periods of the transient.
    to_come : [1]
        Change that was still to come when it ended, over the amplitude.
    """

    level: float
    frequency: float
    amplitude: float
    transient_amplitude: float
    phase: float
    transient_phase: float
    periods: int
    to_come: float

    @property
    def difference(self) -> float:
        """Relative difference of the amplitude by harmonics from that of the transient."""
        return self.amplitude / self.transient_amplitude - 1

    @property
    def turn(self) -> float:
        """Phase by harmonics minus that of the transient [degree]."""
        return (self.phase - self.transient_phase + 180.0) % 360.0 - 180.0

    @property
    def agrees(self) -> bool:
        """Whether amplitudes differ by at most one per cent."""
        return abs(self.difference) <= LARGEST_DIFFERENCE

    @property
    def sentence(self) -> str:
        """The result of the check in a sentence."""
        left = (
            f", {self.to_come:.1%} still to come" if self.to_come > LARGEST_DIFFERENCE / 2 else ""
        )
        verb = "confirms" if self.agrees else "contradicts"
        return (
            f"level {self.level:g}: a transient of {self.periods} periods{left} {verb} "
            f"the largest motion: harmonics are off by {self.difference:+.2%} in amplitude and "
            f"{self.turn:+.2g}° in phase"
        )
