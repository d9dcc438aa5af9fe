"""The tables of a study file that say what a joint must hold, and how its preloads scatter."""

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field

from faying.study.keys.ranges import MOST_SOLVED
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
    """preload_scatter: see :class:`faying.assessment.preload_scatter.PreloadScatter`.

    Attributes
    ----------
    temperatures
        Those that every static load case may have beside its loads.
    """

    tightening_factor: Annotated[Number, Field(ge=1)] = 1.0
    settlement: NotNegative = 0.0
    thread_friction: tuple[NotNegative, NotNegative] | None = None
    head_friction: tuple[NotNegative, NotNegative] | None = None
    surface_friction: tuple[NotNegative, NotNegative] | None = None
    samples: Annotated[Count, Field(le=MOST_SOLVED)] = 200
    temperatures: tuple[Name, ...] = ()


class RingSection(Section):
    """[requirement] closed_ring: see :class:`faying.assessment.requirements.ClosedRing`."""

    around: Point
    pressure: NotNegative = 0.0
    interface: Name | None = None


class MarginsSection(Section):
    """[requirement.margins]: by which standard the strength of bolts is judged, and its factors.

    Attributes
    ----------
    standard
        ``"nasa-std-5020b"``, margins under factored loads
        (:mod:`faying.assessment.strength.nasa_std_5020b`), or ``"vdi-symbols"``, safeties.
    FF, FS_u, FS_y, FS_sep, FS_slip
        Fitting factor, and factors of safety.
    S_F, S_D, S_p
        Safeties against yield, fatigue and pressure under the head.
    shear_plane
        What of a bolt is where the members meet.
    separation_critical
        Whether P_p,min of separation is that of each bolt by itself, (4).
    control
        c_min and c_max of what is controlled while tightening.
    relaxation
        Share of the preload that is lost, P_pr.
    creep, thermal_gain, thermal_loss : [force]
        P_pc, P_Δt,max and P_Δt,min.
    """

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
    margins
        Standard by which the strength of bolts is judged.
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
