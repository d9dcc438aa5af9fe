"""The study table [[frequency]]: a joint under harmonic loads."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from faying._typing import Vector
from faying.iterations import MOST_SOLVED
from faying.study.keys.loading_table import Loading
from faying.study.keys.section import Count, Name, Number, Positive, Section

MOST_HARMONICS = 50
"""Largest number of harmonics; each adds an unknown per active mode."""


class HarmonicForce(Loading):
    """[[frequency]] forces: value · cos(ω t + phase), at level one."""

    value: Number
    phase: Number = 0.0


class FrequencySection(Section):
    """[[frequency]]: see :func:`faying.frequency_response`."""

    name: Name
    forces: Annotated[tuple[HarmonicForce, ...], Field(min_length=1)]
    levels: Annotated[tuple[Positive, ...], Field(min_length=1)] = (1.0,)
    lowest: Positive = Field(alias="from")
    highest: Positive = Field(alias="to")
    points: Annotated[Count, Field(ge=2, le=MOST_SOLVED)] = 40
    harmonics: Annotated[Count, Field(le=MOST_HARMONICS)] | None = None
    samples: Count | None = None
    at: Name | None = None
    check: Literal["transient"] | None = None

    @property
    def load(self) -> dict[str, complex]:
        """Complex amplitudes at level one, by load target."""
        turned = {
            force.target: complex(np.exp(1j * np.radians(force.phase))) for force in self.forces
        }
        return {force.target: force.value * turned[force.target] for force in self.forces}

    @property
    def asked(self) -> Vector:
        """Requested frequencies (n,)."""
        return np.linspace(self.lowest, self.highest, self.points)
