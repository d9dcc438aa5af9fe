"""The tables of a study file for requirements on a joint, and for preload scatter."""

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field

from faying.assessment.preload_scatter import PreloadScatter
from faying.iterations import MOST_SOLVED
from faying.study.keys.section import (
    Count,
    Name,
    NotNegative,
    Number,
    Point,
    Positive,
    Section,
    Switch,
)


class ScatterSection(Section):
    """preload_scatter: see :class:`faying.assessment.preload_scatter.PreloadScatter`."""

    tightening_factor: Annotated[Number, Field(ge=1)] = 1.0
    settlement: NotNegative = 0.0
    thread_friction: tuple[NotNegative, NotNegative] | None = None
    head_friction: tuple[NotNegative, NotNegative] | None = None
    surface_friction: tuple[NotNegative, NotNegative] | None = None
    samples: Annotated[Count, Field(le=MOST_SOLVED)] = 200
    temperatures: tuple[Name, ...] = ()

    @property
    def spread(self) -> PreloadScatter:
        """The scatter without temperatures."""
        return PreloadScatter(**self.model_dump(exclude={"temperatures"}))


class RingSection(Section):
    """[requirement] closed_ring: see :class:`faying.assessment.requirements.ClosedRing`."""

    around: Point
    pressure: NotNegative = 0.0
    interface: Name | None = None


class MarginsSection(Section):
    """[requirement.margins]: the standard for the strength of bolts, and its factors."""

    standard: Literal["nasa-std-5020b", "vdi-symbols"]
    FF: Annotated[Number, Field(ge=1)] = 1.0
    FS_u: Annotated[Number, Field(ge=1)] = 1.0
    FS_y: Annotated[Number, Field(ge=1)] = 1.0
    FS_sep: Annotated[Number, Field(ge=1)] = 1.0
    FS_slip: Annotated[Number, Field(ge=1)] = 1.0
    S_F: Annotated[Number, Field(ge=1)] = 1.0
    S_D: Annotated[Number, Field(ge=1)] = 1.0
    S_p: Annotated[Number, Field(ge=1)] = 1.0
    shear_plane: Literal["thread", "shank"] = "thread"
    separation_critical: Switch = False
    control: tuple[Annotated[Positive, Field(le=1)], Annotated[Number, Field(ge=1)]] = (1.0, 1.0)
    relaxation: Annotated[NotNegative, Field(lt=1)] = 0.05
    creep: NotNegative = 0.0
    thermal_gain: NotNegative = 0.0
    thermal_loss: NotNegative = 0.0


class RequirementSection(Section):
    """[requirement]: limits for every load case; the exit status is 3 if one is exceeded.

    See :class:`faying.assessment.requirements.Requirements`.
    """

    min_clamp_force: Positive | Mapping[Name, Positive] | None = None
    max_pressure: Positive | None = None
    max_nodal_pressure: Positive | None = None
    no_opening_within: Positive | None = None
    min_opening_factor: Positive | None = None
    open_below: Annotated[Number, Field(ge=0, le=1)] | None = None
    min_slip_safety: Positive | None = None
    min_sliding_factor: Positive | None = None
    slip_friction: Positive | Mapping[Name, Positive] | None = None
    closed_ring: tuple[RingSection, ...] = ()
    margins: MarginsSection | None = None
