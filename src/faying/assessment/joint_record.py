"""Results of a joint over its load cases, as plain values."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.check import Check
from faying.assessment.extremes import find_least, find_most
from faying.assessment.preload_scatter import Spread
from faying.assessment.requirements import OPEN_BELOW, Verdict
from faying.assessment.slip_demand import NO_DEMAND, SlipDemand
from faying.assessment.strength.thread import ThreadStress


@dataclass(frozen=True, eq=False, kw_only=True)
class ClampRange:
    """Clamp force of an area over all load cases.

    Attributes
    ----------
    preload : [force]
        Clamp force at rest.
    least : [force]
        Smallest clamp force.
    least_case
        Load case of the smallest clamp force.
    certified_least : (2,) [force]
        Bounds of the full model's clamp force in that case, for static cases.
    most : [force]
        Largest clamp force.
    most_case
        Load case of the largest clamp force.
    certified_most : (2,) [force]
        Bounds of the full model's clamp force in that case, for static cases.
    certified_width : [force]
        Width of the widest of these intervals over all static cases.
    """

    preload: float
    least: float
    least_case: str
    certified_least: Vector | None
    most: float
    most_case: str
    certified_most: Vector | None
    certified_width: float | None = None


def clamp_range(
    preload: float, forces: Mapping[str, Vector], certified: Mapping[str, Vector]
) -> ClampRange:
    """Return the range of the clamp force of an area, from its preload at rest [force].

    Forces of a load case are (n_instant,) [force]. Certified cases have bounds (2,) [force];
    infinite ones, from parts of hard contact, are left out.
    """
    certified = {case: ends for case, ends in certified.items() if np.isfinite(ends).all()}
    lowest, low = find_least({case: float(force.min()) for case, force in forces.items()})
    highest, high = find_most({case: float(force.max()) for case, force in forces.items()})
    return ClampRange(
        preload=preload,
        least=low,
        least_case=lowest,
        certified_least=certified.get(lowest),
        most=high,
        most_case=highest,
        certified_most=certified.get(highest),
        certified_width=max(
            (float(ends[1] - ends[0]) for ends in certified.values()), default=None
        ),
    )


@dataclass(frozen=True, kw_only=True)
class BoltBending:
    """Bending of a bolt over all load cases, the larger of both ends of its beams.

    Attributes
    ----------
    most : [force·length]
        Largest moment M_b, including bending from tightening.
    most_case
        Load case of this moment.
    added : [force·length]
        Largest change from the tightened joint.
    added_case
        Load case of this change.
    """

    most: float
    most_case: str
    added: float
    added_case: str


def bending_of(preload: Matrix, cases: Mapping[str, Matrix]) -> BoltBending:
    """Return the largest bending moments of a bolt [force·length].

    Moments, by end and component across the axis, are (2, 2) at rest, (n_instant, 2, 2) in a case.
    """
    worst, peak = find_most({case: _largest(moments) for case, moments in cases.items()})
    farthest, added = find_most(
        {case: _largest(moments - preload) for case, moments in cases.items()}
    )
    return BoltBending(most=peak, most_case=worst, added=added, added_case=farthest)


def _largest(moments: Matrix) -> float:
    return float(np.linalg.norm(moments, axis=-1).max())


REST = "at rest"
"""Name of the preloaded joint as a load case, in studies without loads."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CaseState:
    """Results of one load case for the assessment, one row per instant.

    Attributes
    ----------
    pressure : (n_instant, n_point) [force/length²]
    bolt_forces
        Bolt to (n_instant,) [force].
    certified
        Interface and bolt, or no bolt, to bounds (2,) [force] of the full model's clamp force
        there, for static cases.
    bolt_moments
        Bolt to its bending moments (n_instant, 2, 2) [force·length] at both ends, where known.
    retightened
        Whether bolts are loosened or tightened in it, so that changes are not due to loads alone.
    times : (n_instant,) [time]
        None for cases without time.
    """

    pressure: Matrix
    bolt_forces: Mapping[str, Vector]
    certified: Mapping[tuple[str, str], Vector] = field(default_factory=dict)
    bolt_moments: Mapping[str, Matrix] = field(default_factory=dict)
    retightened: bool = False
    times: Vector | None = None

    def scaled(self, share: float) -> "CaseState":
        """Return a share of pressures, forces and moments, without certified bounds."""
        return replace(
            self,
            pressure=share * self.pressure,
            bolt_forces={name: share * force for name, force in self.bolt_forces.items()},
            bolt_moments={name: share * moment for name, moment in self.bolt_moments.items()},
            certified={},
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class BoltAssessment:
    """One bolt over all load cases.

    Attributes
    ----------
    preload : [force]
        Axial force at rest.
    least : [force]
        Smallest axial force.
    least_case
        Load case of the smallest axial force.
    most : [force]
        Largest axial force.
    most_case
        Load case of the largest axial force.
    axial_loads : [force]
        Load case to F_A = ΔF_S − ΔF_K, the axial load on the bolt and the area around it
        (VDI 2230): the largest over interfaces and instants. Without load cases that loosen or
        tighten bolts.
    load_factors : [1]
        Load case to Φ = ΔF_S / F_A, the share of F_A in the bolt, 0 to 1; only where F_A is a
        fifth or more of all force changes in the bolt and around it.
    clamp_around
        Interface to the clamp force of its points nearest to this bolt; empty where the axes of
        several bolts are not all known.
    bending
        Bending of the bolt; None where it is unknown, as for springs.
    thread
        Stress in the thread, where known.
    slip_around
        Interface to the friction that its points nearest to this bolt need.
    opening_around : [1]
        Interface to load case to the factor from which the area nearest to this bolt is open, if
        there are several bolts.
    """

    preload: float
    least: float
    least_case: str
    most: float
    most_case: str
    axial_loads: Mapping[str, float]
    load_factors: Mapping[str, float]
    clamp_around: Mapping[str, ClampRange]
    bending: BoltBending | None = None
    thread: ThreadStress | None = None
    slip_around: Mapping[str, SlipDemand] = field(default_factory=dict)
    opening_around: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class InterfaceAssessment:
    """One interface over all load cases.

    Attributes
    ----------
    preload : [force]
        Clamp force at rest.
    least_clamp : [force]
        Smallest clamp force.
    least_clamp_case
        Load case of the smallest clamp force.
    certified : (2,) [force]
        Bounds of the full model's clamp force in that case.
    most_clamp : [force]
        Largest clamp force.
    most_clamp_case
        Load case of the largest clamp force.
    certified_most : (2,) [force]
        Bounds of the full model's clamp force in that case.
    certified_width : [force]
        Width of the widest of these intervals over all static cases; None without any.
    max_pressure : [force/length²]
        Largest pressure of a contact point.
    max_pressure_case
        Load case of this pressure.
    max_pressure_point : (3,) [length]
        Position of this contact point.
    max_nodal_pressure : [force/length²]
        Largest average pressure around a node.
    max_nodal_pressure_case
        Load case of this average.
    closed_area : [length²]
        Smallest area under pressure.
    closed_area_case
        Load case of this area.
    slip
        Friction that static load cases need; empty without static load cases.
    opening : [1]
        Load case to the factor from which less than a share (``open_below``) of the area under
        preload pressure is still under pressure; infinite if that never happens.
    opened : [1]
        Load case to the largest open share of the area under preload pressure; not for cases that
        tighten or loosen bolts, or that are followed to the factor at which the area opens.
    """

    preload: float
    least_clamp: float
    least_clamp_case: str
    certified: Vector | None
    most_clamp: float
    most_clamp_case: str
    certified_most: Vector | None
    certified_width: float | None
    max_pressure: float
    max_pressure_case: str
    max_pressure_point: Vector
    max_nodal_pressure: float
    max_nodal_pressure_case: str
    closed_area: float
    closed_area_case: str
    slip: SlipDemand = NO_DEMAND
    opening: Mapping[str, float] = field(default_factory=dict)
    opened: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class Assessment:
    """The assessment of a joint over load cases.

    Attributes
    ----------
    bolts
        Bolts by name.
    interfaces
        Interfaces by name.
    verdicts
        Requirements, each in its most critical place and case.
    scatter
        Effect of the scatter of the preloads on static load cases, if requested.
    open_below : [1]
        Share of the area pressed at rest below which an area is open.
    checks
        Strength of the bolts with known threads, each in its most critical case.
    loosened
        Opening and slip with all preloads at their least; empty without scatter.
    followed : [1]
        Load case to the largest factor at which its openings were looked for.
    """

    bolts: Mapping[str, BoltAssessment]
    interfaces: Mapping[str, InterfaceAssessment]
    verdicts: tuple[Verdict, ...] = ()
    scatter: tuple[Spread, ...] = ()
    open_below: float = OPEN_BELOW
    checks: tuple[Check, ...] = ()
    loosened: tuple[Check, ...] = ()
    followed: Mapping[str, float] = field(default_factory=dict)

    @property
    def met(self) -> bool:
        """Whether every requirement is known to be met."""
        return all(verdict.met is True for verdict in self.verdicts)

    @property
    def opening_first(self) -> list[str]:
        """Load cases that are the first to open some area."""
        areas = [interface.opening for interface in self.interfaces.values()]
        areas += [
            factors for bolt in self.bolts.values() for factors in bolt.opening_around.values()
        ]
        return list(dict.fromkeys(find_least(factors)[0] for factors in areas if factors))
