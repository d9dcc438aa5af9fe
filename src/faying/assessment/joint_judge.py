"""The judge of a joint over solved load cases, for any source of the solutions."""

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from types import MappingProxyType
from typing import Self

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.case_metrics import bent_bolts
from faying.assessment.certificate import Certifier, certifier
from faying.assessment.joint_assessment import dissimilar_checks, judged, loosest_checks
from faying.assessment.joint_record import Assessment, CaseState
from faying.assessment.opening import Openings, areas_that_open, opening_factors
from faying.assessment.preload_scatter import PreloadScatter, spreads_of_cases
from faying.assessment.recovery import solve_cases_at_ports
from faying.assessment.requirements import Requirements, check_names
from faying.assessment.slip_demand import SlipDemand, slip_coefficients, slip_demands
from faying.assessment.slip_reserve import SlipReserve, followed_openings
from faying.assessment.strength.checks import with_threads
from faying.assessment.strength.clamp_ends import clamp_checks
from faying.assessment.strength.preload_ends import (
    BoltStrengths,
    PreloadEnd,
    least_share,
    loosest_forces,
    preload_ends,
    state_of,
    with_initial,
)
from faying.assessment.strength.thread import Thread
from faying.assessment.strength.tightening import PreloadRange, variation_of
from faying.assessment.verdicts import wanted_clamps
from faying.exceptions import refuse_model
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import surroundings
from faying.joint.model import Model
from faying.joint.smooth_joint import smooth_joint
from faying.joint.system import Joint
from faying.joint.tangential import TangentialRows, tangential_rows
from faying.reduction.projection import contact_surfaces
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import Load, NamedLoad
from faying.simulation.path import contact_at_ends, moved_alone, solve_static, unstressed
from faying.simulation.solution import Solution
from faying.simulation.static import AT_REST, solve_static_cases
from faying.units import units_of

UNTOLD = "the file has no tangential forces along it; reduce the study again"
"""Reason for unknown slip by sums with files of earlier versions."""


@dataclass(frozen=True, eq=False, kw_only=True)
class JointJudge:
    """A joint with its solved load cases, and the requirements on it.

    Attributes
    ----------
    system
        Preloaded full or reduced model.
    exact
        Model with the static pressures of the full one, for solutions at scattered preloads.
    preloaded
        The preloaded state.
    cases
        Load cases by name.
    requirements
        Requirements on the joint.
    strengths
        Threads, ranges and temperatures for the strength of bolts.
    attempt
        Context, by name, for parts that may fail; by default they raise.
    loads
        Static load cases.
    followed
        Names of load cases to follow to their openings, for joints without history.
    summed
        Loads for slip by sums of forces.
    reserves
        Load case to its slip reserve, of joints with friction.
    openings
        Load case to its openings, for cases that were followed before.
    rest
        Solution of the preloaded state, of joints with friction.
    """

    system: Model | ReducedModel
    exact: Model | ReducedModel
    preloaded: CaseState
    cases: Mapping[str, CaseState]
    requirements: Requirements
    strengths: BoltStrengths
    attempt: Callable[[str], AbstractContextManager[object]] = nullcontext
    loads: Sequence[NamedLoad] = ()
    followed: Collection[str] = ()
    summed: Sequence[NamedLoad] = ()
    reserves: Mapping[str, SlipReserve] = field(default_factory=dict)
    openings: Mapping[str, Openings] = field(default_factory=dict)
    rest: Solution | None = None

    @cached_property
    def memoryless(self) -> Mapping[str, NamedLoad]:
        """Static load cases, by name, that do not depend on earlier ones."""
        return {load.name: load for load in self.loads if self.system.contact.forgets}

    @property
    def rubbing(self) -> Solution | None:
        """The preloaded state of a joint with friction, else None."""
        return None if self.system.contact.components == 1 else self.rest

    @cached_property
    def surfaces(self) -> Mapping[str, ContactSurface]:
        """Geometry of the interfaces."""
        return surfaces_of(self.system)

    @cached_property
    def coefficients(self) -> dict[str, float]:
        """Coefficient of friction for each interface that has one."""
        smallest, of_smooth = self.strengths.smallest_friction, self.requirements.slip_friction
        return slip_coefficients(self.system.contact, smallest, of_smooth)

    def assessment(self) -> Assessment:
        """Return the assessment of bolts, interfaces and requirements over the load cases."""
        demands: dict[tuple[str, str], SlipDemand] = {}
        with self.attempt("slip by sums"):
            demands = self._demands()
        paths = {**self._paths(self.followed), **self.openings}
        # Cases without history are judged by the factors at which they open, where these are found.
        judged_by_factors = self.memoryless.keys() - (set(self.followed) - paths.keys())
        unfollowed = {n: state for n, state in self.cases.items() if n not in judged_by_factors}
        return self._assess(paths, demands, unfollowed)

    def certified(
        self, certifier: Callable[[], Certifier | None], pressure: Matrix | None = None
    ) -> Self:
        """Return a copy with certified clamp forces of its memoryless load cases.

        The function ``certifier``, which may return None, is called only if there are such cases.
        Pressures (n_case, n_point) are by default those of the load cases.
        """
        names = [name for name in self.memoryless if name in self.cases]
        judge = certifier() if names else None
        if judge is None:
            return self
        if pressure is None:
            pressure = np.concatenate([self.cases[name].pressure for name in names])
        areas = surroundings(self.surfaces, self.system.bolts)
        inputs = self._inputs([self.memoryless[name] for name in names], None)
        certificate = judge.certify_inputs(inputs, pressure, areas)
        ends = {(name, ""): bounds for name, bounds in certificate.contact_force.items()}
        ends |= certificate.area_force
        cases = dict(self.cases)
        for row, name in enumerate(names):
            bounds = {area: values[row] for area, values in ends.items()}
            cases[name] = replace(cases[name], certified=bounds)
        return replace(self, cases=cases)

    def ends(self, histories: Mapping[str, CaseState]) -> tuple[PreloadEnd, ...]:
        """Return load cases at both ends of the preloads, and at the temperatures of the joint."""
        strengths = self.strengths
        return preload_ends(
            self.exact,
            self.preloaded,
            histories,
            {load.name: load for load in self.loads},
            strengths.ranges,
            strengths.tightened,
            strengths.temperatures,
            self.rubbing,
        )

    def at_ends(self, assessment: Assessment, ends: Sequence[PreloadEnd]) -> Assessment:
        """Return an assessment with the results at the ends of the preloads."""
        system, units = self.system, self.system.units
        limits = wanted_clamps(self.requirements.min_clamp_force, self.surfaces)
        clamps = tuple(clamp_checks(ends, self.surfaces, system.bolts, limits, units))
        initial = loosest_forces(system, self.preloaded, self.strengths.ranges)
        if initial is None:
            return replace(assessment, checks=clamps)
        share = least_share(self.rubbing, self.preloaded, self.strengths.ranges)
        if self.reserves and share is None:
            unknown = (*clamps, *dissimilar_checks(assessment, self.requirements))
            return replace(assessment, checks=unknown)
        reserves = {case: reserve.scaled(share or 1.0) for case, reserve in self.reserves.items()}
        paths = {**self._paths(assessment.opening_first, initial), **followed_openings(reserves)}
        loose = self._assess(paths, self._demands(initial), reserves=reserves)
        loosened = loosest_checks(loose, units_of(units), reserves)
        return replace(assessment, checks=clamps, loosened=loosened)

    def with_strength(
        self,
        assessment: Assessment,
        histories: Mapping[str, CaseState],
        repetitions: Mapping[str, float],
    ) -> Assessment:
        """Return an assessment with the ends of the preloads, and the strength of bolts there.

        Repetitions are the numbers of times a load case occurs in the life of the joint, where
        known.
        """
        ends, threads, units = self.ends(histories), self.strengths.threads, self.system.units
        judged_ends = self.at_ends(assessment, ends)
        return with_threads(judged_ends, histories, threads, units, ends, repetitions)

    def _assess(
        self,
        paths: Mapping[str, Openings],
        demands: Mapping[tuple[str, str], SlipDemand],
        opens: Mapping[str, CaseState] = MappingProxyType({}),
        reserves: Mapping[str, SlipReserve] | None = None,
    ) -> Assessment:
        return judged(
            self.surfaces,
            self.system.bolts,
            self.preloaded,
            self.cases,
            self.requirements,
            paths,
            self.reserves if reserves is None else reserves,
            demands,
            opens,
        )

    def _paths(
        self, followed: Collection[str], initial: Vector | None = None
    ) -> dict[str, Openings]:
        """Return openings of memoryless load cases; cases that fail are missing."""
        system, openings = self.system, dict[str, Openings]()
        joint = system.joint if isinstance(system, ReducedModel) else system
        areas = areas_that_open(self.surfaces, system.contact.slices, system.bolts)
        for name, load in self.memoryless.items():
            if name in followed:
                with self.attempt(f"{name}, load factors of opening"):
                    (inputs,) = self._inputs([load], initial)
                    openings[name] = opening_factors(
                        joint,
                        inputs,
                        areas,
                        open_below=self.requirements.open_share,
                    )
        return openings

    def _inputs(self, loads: Sequence[NamedLoad], initial: Vector | None) -> Matrix:
        """Return inputs (n_load, n_input), with bolts locked at other initial forces (n_bolt,)."""
        rows = [load.inputs(self.system, np.zeros(1)) for load in loads]
        return with_initial(self.system, np.concatenate(rows), initial)

    def _demands(self, initial: Vector | None = None) -> dict[tuple[str, str], SlipDemand]:
        """Return the friction that loads need, computed without friction.

        Interfaces with friction are included if this is required, or if paths give the rest.
        """
        if not self.summed:
            return {}
        system, asked = self.system, bool(self.reserves)
        asked = asked or self.requirements.min_slip_safety is not None
        inputs, names = self._inputs(self.summed, initial), [load.name for load in self.summed]
        if initial is None and self.cases.keys() & self.memoryless.keys() >= set(names):
            pressure = np.concatenate([self.cases[name].pressure for name in names])
        else:
            rest = self._inputs([AT_REST], initial)
            forces = _forces_without_friction(smooth_joint(system), rest, inputs)
            pressure = forces / system.contact.weights
        demands = slip_demands(
            system,
            self.surfaces,
            tangential_of(system),
            names,
            inputs,
            pressure,
            self.coefficients,
        )
        untold = {
            (name, ""): SlipDemand(coefficient=self.coefficients.get(name), unknown=UNTOLD)
            for name in self.surfaces
        }
        judged_by_sums = list(self.surfaces) if asked else system.contact.smooth_interfaces
        return {
            area: demand
            for area, demand in {**untold, **demands}.items()
            if area[0] in judged_by_sums
        }


def _forces_without_friction(joint: Joint, rest: Matrix, inputs: Matrix) -> Matrix:
    """Return contact forces (n_load, n_point) under loads, each starting from the tightened joint.

    Inputs at rest are (1, n_input), those of the loads (n_load, n_input).
    """
    ways = [moved_alone(joint, np.vstack([rest, load])) for load in inputs]
    return contact_at_ends(joint, ways, partial(unstressed, joint)).forces


def surfaces_of(system: Model | ReducedModel) -> Mapping[str, ContactSurface]:
    """Return the geometry of the interfaces of a full or reduced model."""
    return contact_surfaces(system) if isinstance(system, Model) else system.interfaces


def tangential_of(system: Model | ReducedModel) -> Sequence[TangentialRows]:
    """Return the tangential resultants of the interfaces of a full or reduced model."""
    return tangential_rows(system) if isinstance(system, Model) else system.tangential


def rest_of(preloaded: Solution) -> CaseState:
    """Return the state at rest from a preloaded state, or from the last one of a path."""
    return state_of(preloaded, slice(-1, None), bent_bolts(preloaded.system.bolts))


def assess(
    system: Model | ReducedModel,
    loads: Sequence[Load],
    requirements: Requirements | None = None,
    *,
    paths: bool = True,
    threads: Mapping[str, Thread] | None = None,
    scatter: PreloadScatter | None = None,
) -> Assessment:
    """Return the assessment of a joint without friction over static load cases.

    Parameters
    ----------
    system
        Preloaded full or reduced model.
    loads
        Histories are taken at time zero.
    requirements
        Requirements on the joint.
    paths
        Whether each load is followed to its openings
        (:func:`~faying.assessment.opening.opening_factors`).
    threads
        Bolt to its thread, whose stress is then compared with the grade.
    scatter
        Scatter of the preloads, for spreads of the metrics of each load.

    Raises
    ------
    ModelError
        If a load does not fit, or there is none.

    Notes
    -----
    Some milliseconds a load, besides its path. Clamp forces of the full model are certified; for a
    reduced model without residual compliance this takes a solution at the ports, as long again.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> found = fy.assess(joint, [fy.Load({"tip.Fz": -100.0}, name="push")])
    >>> found.bolts["bolt"].least_case, bool(found.interfaces["joint"].max_pressure > 0.0)
    ('push', True)
    """
    if not loads:
        refuse_model("there is no load to assess the joint under; give one or more")
    names = [load.name for load in loads]
    if len(set(names)) < len(names):
        refuse_model("two loads have the same name; give each a name of its own, Load(…, name=…)")
    demanded = requirements or Requirements()
    check_names(demanded, list(system.contact.slices), list(system.contact.slices))
    cases = solve_static_cases(system, loads)
    full = system.joint if isinstance(system, ReducedModel) else system
    bent = bent_bolts(system.bolts)
    states = {name: state_of(cases, slice(row, row + 1), bent) for row, name in enumerate(names)}
    factor = 1.0 if scatter is None else scatter.tightening_factor
    ranges = dict.fromkeys(system.bolts, PreloadRange(variation=variation_of(factor)))
    judge = JointJudge(
        system=system,
        exact=system,
        preloaded=rest_of(solve_static(system)),
        cases=states,
        requirements=demanded,
        strengths=BoltStrengths(threads=threads or {}, ranges=ranges),
        loads=loads,
        followed=names if paths else (),
        summed=loads,
    ).certified(partial(certifier, full), _exact(system, loads, cases))
    assessment, threads = judge.assessment(), judge.strengths.threads
    if scatter is not None:
        spreads = spreads_of_cases(system, judge.surfaces, loads, scatter, threads)
        assessment = replace(assessment, scatter=spreads)
    return judge.with_strength(assessment, states, {})


def _exact(system: Model | ReducedModel, loads: Sequence[Load], cases: Solution) -> Matrix:
    """Return the full model's pressures (n_case, n_point), for certificates."""
    if isinstance(system, Model) or system.contact.residual_compliance is not None:
        return cases.pressure
    return solve_cases_at_ports(system.joint, loads).pressure
