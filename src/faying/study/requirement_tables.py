"""The tables of a study file that say what a joint must hold, and how its preloads scatter."""

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from faying.study.section import Count, Name, NotNegative, Number, Point, Positive, Section

MOST_SAMPLES = 10_000
"""Tightenings of one load case: their fields are in memory together."""


class ScatterSection(Section):
    """preload_scatter: see :class:`faying.assessment.preload_scatter.PreloadScatter`."""

    tightening_factor: Annotated[Number, Field(ge=1)] = 1.0
    settlement: NotNegative = 0.0
    thread_friction: tuple[NotNegative, NotNegative] | None = None
    head_friction: tuple[NotNegative, NotNegative] | None = None
    surface_friction: tuple[NotNegative, NotNegative] | None = None
    samples: Annotated[Count, Field(le=MOST_SAMPLES)] = 200


class RingSection(Section):
    """[requirement] closed_ring: see :class:`faying.assessment.requirements.ClosedRing`."""

    around: Point
    pressure: NotNegative = 0.0
    interface: Name | None = None


class RequirementSection(Section):
    """[requirement]: what the joint must hold under every load case; status 3 if it does not.

    Attributes
    ----------
    min_clamp_force : [force]
        Total normal force of every interface, or of those named.
    max_pressure : [force/length²]
        Of every contact point.
    max_nodal_pressure : [force/length²]
        Of the average around every node.
    no_opening_within : [length]
        Distance from a bolt's axis within which what the preload presses stays pressed.
    min_opening_factor
        Factor of a static load case at which an interface, or its part nearest to a bolt, opens.
    open_below
        Share of the area that the preload presses below which it is open; half unless given.
    min_slip_safety
        S_G of static load cases, by sums: bolts carry nothing across their axes.
    min_sliding_factor
        Factor of a static load case or cycle with friction at which an interface slides as a
        whole, bolts carrying what they do.
    slip_friction
        Coefficient that interfaces without friction, or those named, are judged with.
    closed_ring
        Holes around which a closed ring stays pressed.
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
