"""Slip reserve: load factors at which a joint begins to slip, and at which it slips as a whole."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Mask, Matrix, Vector
from faying.assessment.growth import LARGEST_FACTOR, Event, first_events
from faying.assessment.opening import (
    Openings,
    areas_that_open,
    enough,
    opening_event,
    pressed_depth,
    pressed_shares,
)
from faying.assessment.sliding import resistance_used
from faying.assessment.slip import SLIP, SlipStates, point_states
from faying.exceptions import refuse_model
from faying.joint.system import System
from faying.simulation.load import InputRow, Load
from faying.simulation.path import moved_alone, path_inputs, path_start, solve_path
from faying.simulation.path_steps import PathStep, follow
from faying.simulation.solution import Solution

ONSET_SHARE = 0.05
"""Slipping share of the area in contact that defines the onset of slip.

Of points that stick after tightening. Tractions after tightening go continuously up to their
bounds, so that a first point can slip under nearly no load.
"""

SLIDING_SHARE = 0.9
"""Used share of the friction against one rigid motion above which an interface slips as a whole.

When all points first slip it is 0.9 to 1 if the sides slide over each other, and 0 to 0.01 if a
load bends the joint and tangential forces cancel (``docs/how-to/follow_friction.md``).
"""

SPENT_SHARE = 0.97
"""Sum of tangential forces over that of their bounds above which all points count as slipping.

Single points stick for an increment when their direction reverses.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class SlipReserve:
    """Load factors of slip on a proportional load path from the preloaded joint.

    Attributes
    ----------
    first_slip : [1]
        Load factor at which the first point slips; None if none does up to ``largest``.
    interface
        Interface of that point; empty without slip.
    point : [1]
        Its number in the points of the interface, of the one with the largest slip if several
        begin together; -1 without slip.
    onset : [1]
        Load factor at which a twentieth of the area in contact slips, without points at their
        friction limit after tightening; None if less slips.
    share : [1]
        Share of the area in contact for ``share_slip``.
    share_slip : [1]
        Load factor at which that share slips; None if less slips.
    gross_slip : [1]
        Load factor at which some interface with friction slips as a whole: all closed points slip,
        along one rigid motion; None if none does.
    largest : [1]
        Largest load factor of the path.
    stopped
        Whether the path ended there because the next increment had no solution.
    slides
        Interface that slips as a whole; empty if none does.
    areas
        Interfaces, and their parts nearest to bolts, whose opening was followed.
    openings : (n_area,) [1]
        Load factor from which each is open; infinite where it is not.
    """

    first_slip: float | None
    interface: str
    point: int
    onset: float | None
    share: float
    share_slip: float | None
    gross_slip: float | None
    largest: float
    stopped: bool
    slides: str = ""
    areas: tuple[str, ...] = ()
    openings: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        # Arrays from the file of an interrupted run.
        object.__setattr__(self, "areas", tuple(map(str, self.areas)))
        object.__setattr__(self, "openings", tuple(map(float, self.openings)))

    def scaled(self, share: float) -> "SlipReserve":
        """Return a share of all load factors: those at a share of all preloads, if similar."""
        names = ("first_slip", "onset", "share_slip", "gross_slip", "largest")
        factors = {name: getattr(self, name) for name in names}
        shares = {name: share * factor for name, factor in factors.items() if factor is not None}
        return replace(self, openings=tuple(share * np.array(self.openings)), **shares)


def slip_reserve(
    system: System,
    load: Load | InputRow,
    initial: Solution | None = None,
    *,
    share: float | None = 0.5,
    increments: int = 10,
    largest: float = LARGEST_FACTOR,
    open_below: float | None = None,
    along: Sequence[PathStep] = (),
) -> SlipReserve:
    """Return the load factors at which a joint begins to slip, slips by a share, and as a whole.

    The load grows in equal increments to its nominal value, then by the same share of its current
    value, with increments cut at first events (:func:`~faying.assessment.growth.first_events`).
    Results depend on these increments: ``gross_slip`` of a bolted tee varies within 0.4 % for 5 to
    80 of them.

    Parameters
    ----------
    system
        Full or reduced model with friction.
    load
        Nominal load, of constant forces; the bolts stay locked.
    initial
        Preloaded state at the start of the path; by default the bolts are tightened first, in one
        increment with friction.
    share
        Share of the area in contact, above 0 and at most 1; None for no share.
    increments
        Number of increments up to the nominal load.
    largest
        Load factor at which the search ends.
    open_below
        Share of the area pressed at rest below which an interface, or its part nearest to a bolt,
        is open; by default openings are not followed.
    along
        Steps of a path of the same increments of the load, if it has been solved.

    Raises
    ------
    ModelError
        If the system has no friction, the load is a history, or a number is out of range.
    ConvergenceError
        If a trial in an increment is not solved.

    Notes
    -----
    Some 35 increments up to a factor of ten, and ten for each factor found; no displacements are
    computed. Points at their friction limit after tightening slip under almost any load, so that
    ``first_slip`` can be nearly zero: ``onset`` excludes them.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
    >>> joint = joint.with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    >>> reserve = fy.slip_reserve(joint, fy.Load({"tip.Fx": 500.0}))
    >>> reserve.first_slip < reserve.share_slip < reserve.gross_slip
    True
    """
    _check(system, load, share, increments, largest)
    preloaded = solve_path(system, [Load()]) if initial is None else initial
    search = _Search(system=system, load=load, start=path_start(system, preloaded))
    opens = {} if open_below is None else search.opening(open_below)
    events: dict[str, Event[PathStep]] = {
        **{f"{AREA}{name}": happens for name, happens in opens.items()},
        "gross": _whether(lambda trial, _: bool(search.sliding(trial))),
    }
    if share is not None:
        events |= search.slipping(share)
    events_found = first_events(
        search.at,
        search.start,
        events,
        increments=increments,
        largest=largest,
        known=search.known(along, increments),
    )
    factors, states = events_found.factors, events_found.states
    interface, point = search.farthest(*states["first"]) if "first" in states else ("", -1)
    return SlipReserve(
        first_slip=factors.get("first"),
        interface=interface,
        point=point,
        onset=factors.get("onset"),
        share=share or 0.0,
        share_slip=factors.get("share"),
        gross_slip=factors.get("gross"),
        largest=events_found.largest,
        stopped=events_found.stopped,
        slides=search.sliding(states["gross"][0]) if "gross" in states else "",
        areas=tuple(opens),
        openings=tuple(factors.get(f"{AREA}{name}", np.inf) for name in opens),
    )


AREA = "area "
"""Prefix of opening events."""


def followed_openings(reserves: Mapping[str, SlipReserve]) -> dict[str, Openings]:
    """Return the openings of load cases that were followed with friction."""
    return {
        case: Openings(
            opened=dict(zip(reserve.areas, reserve.openings, strict=True)), followed=reserve.largest
        )
        for case, reserve in reserves.items()
        if reserve.areas
    }


def friction_used(system: System, name: str, forces: Matrix) -> float:
    """Return the share of the friction against a rigid motion that an interface uses.

    NaN where there is none. Contact forces (3, n_point) [force] are normal and along both tangents.
    """
    contact = system.contact
    points = contact.slices[name]
    pressed = np.flatnonzero(forces[0, points] > 0)
    chosen = pressed + points.start
    return resistance_used(
        system.interfaces[name].points[pressed],
        contact.tangents[:, chosen],
        forces[1:, chosen],
        contact.laws[name].friction * forces[0, chosen],
    )


def _check(
    system: System, load: Load | InputRow, share: float | None, increments: int, largest: float
) -> None:
    system.contact.check_rubs()
    if share is not None and not 0 < share <= 1:
        refuse_model(f"the share of slipping area is {share:g}; give one above 0 and at most 1")
    if increments < 1 or not 0 < largest < np.inf:
        refuse_model(
            f"found {increments} increments up to a factor of {largest:g}; give one or more, and a "
            "positive factor"
        )
    load.scaled(1.0)


def _whether(happens: Callable[[PathStep, PathStep], bool]) -> Event[PathStep]:
    """Return an event without a number: whether a condition holds after an increment."""
    return lambda trial, state: -np.inf if happens(trial, state) else np.inf


@dataclass(frozen=True, eq=False, kw_only=True)
class _Search:
    """A growing load on the preloaded joint, condensed to its contact.

    Attributes
    ----------
    start
        The preloaded joint.
    """

    system: System
    load: Load | InputRow
    start: PathStep

    def at(self, factor: float, state: PathStep) -> PathStep:
        """Return the step at a load factor after one increment."""
        return next(follow(self.system.static_contact.increments, self.target(factor), state))

    def target(self, factor: float) -> Matrix:
        """Return the displacements of the pairs (1, n_relative) under a load factor alone."""
        # As in paths, to the last digit, so that their steps can be used here.
        return moved_alone(self.system, path_inputs(self.system, [self.load.scaled(factor)]))

    def known(self, path: Sequence[PathStep], increments: int) -> Sequence[PathStep]:
        """Return the steps of a path that are increments of the load from the preloaded joint."""
        alike = [
            np.array_equal(self.target((number + 1) / increments)[0], step.relative)
            for number, step in enumerate(path[:increments])
        ]
        return path[: alike.index(False) if False in alike else len(alike)]

    def states(self, trial: PathStep, state: PathStep) -> SlipStates:
        """Return the states of points after one increment."""
        forces, slip = trial.increment.forces, np.array([state.slip, trial.slip])
        return point_states(self.system.contact, forces[:1], forces[None, 1:], slip)

    def slipping(self, share: float) -> dict[str, Event[PathStep]]:
        """Return the events of slip: the first, the onset, and a share of the area."""
        stuck = self.stuck()
        return {
            "first": _whether(lambda trial, state: self.states(trial, state).slip_share[-1] > 0),
            "onset": _whether(
                lambda trial, state: self.share(self.states(trial, state), stuck) >= ONSET_SHARE
            ),
            "share": _whether(
                lambda trial, state: self.states(trial, state).slip_of_closed[-1] >= share
            ),
        }

    def stuck(self) -> Mask:
        """Return the points (n_point,) with tractions below their bounds after preload."""
        forces = self.start.increment.forces
        return self.system.contact.sticking(forces[0], forces[1:])

    def share(self, states: SlipStates, points: Mask) -> float:
        """Return the slipping area of some points over the area in contact with friction."""
        contact = self.system.contact
        status, area = states.status[-1, contact.rubbing], contact.weights[contact.rubbing]
        touching = float(area[status > 0].sum())
        slipping = float(area[(status == SLIP) & points[contact.rubbing]].sum())
        return slipping / touching if touching > 0 else 0.0

    def sliding(self, trial: PathStep) -> str:
        """Return the interface whose closed points all slip along one motion; '' if none."""
        contact, forces = self.system.contact, trial.increment.forces
        for name, points in contact.slices.items():
            bounds = contact.laws[name].friction * forces[0, points]
            spent = np.hypot(*forces[1:, points]).sum() > SPENT_SHARE * bounds.sum()
            if spent and friction_used(self.system, name, forces) >= SLIDING_SHARE:
                return name
        return ""

    def opening(self, open_below: float) -> dict[str, Event[PathStep]]:
        """Return the events of opening of areas, by their names."""
        contact, solver = self.system.contact, self.system.static_contact.increments
        areas = areas_that_open(self.system.interfaces, contact.slices, self.system.bolts)

        def pressed(step: PathStep) -> Vector:
            return pressed_depth(contact, step.increment.gap(solver.laws))

        shares = pressed_shares(areas, pressed(self.start) > 0, contact.weights)
        return {
            name: opening_event(pressed, share, enough(open_below))
            for name, share in shares.items()
        }

    def farthest(self, trial: PathStep, state: PathStep) -> tuple[str, int]:
        """Return the interface and the point with the largest slip in an increment."""
        change = np.hypot(*(trial.slip - state.slip))
        change[self.states(trial, state).status[-1] != SLIP] = 0.0
        point = int(change.argmax())
        for name, points in self.system.contact.slices.items():
            if points.start <= point < points.stop:
                return name, point - points.start
        return "", -1
