"""Margins of bolts by NASA-STD-5020B from a contact model, with its clauses and equations.

Loads are factored, preloads are not (4.4.5). Strength is judged at P_p,max in all bolts and without
friction (TFSR 13), separation and slip at P_p,min. The contact model gives bolt forces in place of
n φ P_t, and the loss of clamp force under the load in place of P_tL.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from faying._typing import Vector
from faying.assessment.check import Check, PartKind
from faying.assessment.slip_demand import SMALLEST_FRICTION, SlipDemand, slip_demands
from faying.assessment.strength.margins import (
    SHANK,
    THREAD,
    contact_margin,
    interaction,
    slip_margin,
)
from faying.assessment.strength.preload_ends import LEAST, MOST, initial_forces_at
from faying.assessment.strength.thread import SHEAR, Thread
from faying.assessment.strength.tightening import PreloadRange
from faying.exceptions import refuse_model
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import contact_areas
from faying.joint.smooth_joint import smooth_joint
from faying.joint.system import System
from faying.joint.tangential import TangentialRows
from faying.simulation.load import NamedLoad
from faying.simulation.solution import Solution
from faying.simulation.static import AT_REST, solved_inputs

MOST_FRICTION = 0.2
"""Coefficient above which slip is judged by tests alone, TFSR 14."""

UNTESTED = "μ above 0.2 takes a test (TFSR 14)"


@dataclass(frozen=True, kw_only=True)
class DesignFactors:
    """Design factors of loads.

    Attributes
    ----------
    fitting
        FF.
    ultimate, yields, separation, slip
        FS_u, FS_y, FS_sep and FS of slip.
    shear_plane
        Whether the thread or the shank is in the plane where the members meet.
    separation_critical
        Whether P_p,min has the scatter of a single bolt (4), else that of their mean (5).
    """

    fitting: float = 1.0
    ultimate: float = 1.0
    yields: float = 1.0
    separation: float = 1.0
    slip: float = 1.0
    shear_plane: Literal["thread", "shank"] = "thread"
    separation_critical: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class _Factored:
    """Solutions at rest and under factored static loads, at one end of the preloads.

    Attributes
    ----------
    end
        Name of the end.
    names
        Names of the load cases.
    solution
        Rest, then each load case.
    """

    end: str
    names: Sequence[str]
    solution: Solution

    def demands(
        self,
        surfaces: Mapping[str, ContactSurface],
        rows: Sequence[TangentialRows],
        coefficients: Mapping[str, float],
    ) -> dict[tuple[str, str], SlipDemand]:
        """Return the tangential forces of the areas, also at rest."""
        inputs, pressure = self.solution.inputs, self.solution.pressure
        cases = [AT_REST.name, *self.names]
        system = self.solution.system
        return slip_demands(system, surfaces, rows, cases, inputs, pressure, coefficients)


def margin_checks(
    system: System,
    surfaces: Mapping[str, ContactSurface],
    rows: Sequence[TangentialRows],
    threads: Mapping[str, Thread],
    loads: Sequence[NamedLoad],
    preloads: Mapping[str, float],
    ranges: Mapping[str, PreloadRange],
    factors: DesignFactors,
    coefficients: Mapping[str, float],
    units: str,
) -> Iterator[Check]:
    """Yield the least margins of bolts over static loads, and of interfaces against slip.

    Bolts to be judged have threads, nominal forces [force] and ranges of the preload. ``rows`` are
    the tangential resultants of the interfaces, which slip with their coefficients.

    Raises
    ------
    ModelError
        If there is no static load, or the units are not known.
    ConvergenceError
        If bolts cannot reach an end of their preloads.

    Notes
    -----
    Four solutions a load case, without friction.
    """
    if not loads:
        refuse_model("margins are of static load cases, and there is none; add one")
    scatter = {name: ranges.get(name, PreloadRange()) for name in preloads}
    most = {name: scatter[name].most(force) for name, force in preloads.items()}
    sharing = 1 if factors.separation_critical else len(preloads)
    single = {name: scatter[name].least(force, sharing) for name, force in preloads.items()}
    shared = {name: scatter[name].least(force, len(preloads)) for name, force in preloads.items()}
    tight, loose = initial_forces_at(system, most), initial_forces_at(system, single)
    slack = loose if single == shared else initial_forces_at(system, shared)
    every = (
        (MOST, tight, factors.ultimate),
        (MOST, tight, factors.yields),
        (LEAST, loose, factors.separation),
        (LEAST, slack, factors.slip),
    )
    ultimate, yields, apart, slips = (
        _solve_factored(system, loads, end, initial, factors.fitting * factor)
        for end, initial, factor in every
    )
    sheared = ultimate.demands(surfaces, rows, {})
    for name, thread in threads.items():
        allowed = thread.strengths(units)
        yield _tension_check(
            name, ultimate, allowed.ultimate * thread.stress_area,
            "MS_u", "NASA-STD-5020B 4.4.1 (7, 10), P_tb of the contact model",
        )  # fmt: skip
        yield _combined_check(name, thread, allowed.ultimate, ultimate, sheared, factors)
        yield _tension_check(
            name, yields, allowed.yields * thread.stress_area,
            "MS_y", "NASA-STD-5020B 4.4.2 (16, 17, 18), P_tb of the contact model",
        )  # fmt: skip
    yield from _separation_checks(apart, surfaces)
    yield from _slip_checks(slips, slips.demands(surfaces, rows, coefficients))


def _solve_factored(
    system: System, loads: Sequence[NamedLoad], end: str, initial: Vector, factor: float
) -> _Factored:
    """Return rest and factored loads with the initial forces (n_bolt,) of one end."""
    start = np.zeros(1)
    rest = AT_REST.inputs(system, start)
    applied = np.concatenate([load.inputs(system, start) for load in loads])
    inputs = np.concatenate([rest, rest + factor * (applied - rest)])
    inputs[:, system.port_compliance.bolts] = initial
    return _Factored(
        end=end,
        names=[load.name for load in loads],
        solution=solved_inputs(system, smooth_joint(system), inputs, "factored loads"),
    )


def _margin(
    part: str,
    quantity: str,
    margins: Vector,
    factored: _Factored,
    source: str,
    kind: PartKind = "bolt",
) -> Check:
    """Return the check of the least of the margins (n_case,)."""
    worst = int(margins.argmin())
    margin = float(margins[worst])
    pulled = bool(np.isfinite(margin))
    return Check(
        part=part,
        kind=kind,
        quantity=quantity,
        outcome="met" if margin >= 0 else "not met",
        utilisation=float(1 / (1 + margin)) if margin > -1 else np.inf,
        value=margin if pulled else None,
        limit=0.0,
        case=factored.names[worst] if pulled else "",
        scatter=factored.end,
        source=source,
        required=True,
    )


def _tension_check(
    bolt: str, factored: _Factored, allowed: float, quantity: str, source: str
) -> Check:
    preload, *tensions = np.asarray(factored.solution.bolt_force(bolt)).tolist()
    margins = np.array([contact_margin(allowed, preload, tension) for tension in tensions])
    return _margin(bolt, quantity, margins, factored, source)


def _combined_check(
    bolt: str,
    thread: Thread,
    ultimate: float,
    factored: _Factored,
    sheared: Mapping[tuple[str, str], SlipDemand],
    factors: DesignFactors,
) -> Check:
    """Return the check of (20) or (22) with the shear along the interfaces around a bolt."""
    threaded = factors.shear_plane == "thread"
    source = f"NASA-STD-5020B 4.4.4 ({22 if threaded else 20}), preload included, F_su = 0.6 F_tu"
    check = Check(
        part=bolt, kind="bolt", quantity="ultimate, combined", source=source, required=True
    )
    crossed = [demand for (_, name), demand in sheared.items() if name == bolt]
    unknown = [demand.unknown for demand in crossed if demand.unknown]
    if unknown or not crossed:
        reason = unknown[0] if unknown else "the shear of the bolt is not known separately"
        return replace(check, reason=reason)
    area = thread.minor_area if threaded else np.pi / 4 * thread.diameter**2
    tensions = np.asarray(factored.solution.bolt_force(bolt))[1:]
    bent = np.zeros_like(tensions)
    if factored.solution.system.bolts[bolt].bending is not None:
        moments = np.linalg.norm(factored.solution.bolt_bending(bolt)[1:], axis=-1)
        bent = moments.max(axis=-1) / thread.section_modulus
    shears = [max(demand.tangential_force[case] for demand in crossed) for case in factored.names]
    sums = np.array(
        [
            interaction(
                shear / (SHEAR * ultimate * area),
                max(tension, 0.0) / (ultimate * thread.stress_area),
                bend / ultimate,
                THREAD if threaded else SHANK,
            )
            for shear, tension, bend in zip(shears, tensions.tolist(), bent.tolist(), strict=True)
        ]
    )
    worst = int(sums.argmax())
    decided = replace(check, case=factored.names[worst], scatter=factored.end)
    return decided.at_most(float(sums[worst]), 1.0)


def _separation_checks(
    factored: _Factored, surfaces: Mapping[str, ContactSurface]
) -> Iterator[Check]:
    """Yield checks of the clamp force around each bolt under factored loads."""
    source = "NASA-STD-5020B 4.4.3 (19), P_tL by the loss of clamp force of the contact model"
    solution = factored.solution
    margins: dict[str, list[Vector]] = {}
    for (_, bolt), weights in contact_areas(surfaces, solution.system.bolts).items():
        clamp = solution.pressure @ weights
        if not bolt or not clamp[0] > 0:
            continue
        lost = np.maximum(clamp[0] - clamp[1:], 0.0) / clamp[0]
        margin = np.full(len(lost), np.inf)
        margin[lost > 0] = 1 / lost[lost > 0] - 1
        # A clamp force of zero is separation, by any margin.
        margins.setdefault(bolt, []).append(np.where(clamp[1:] > 0, margin, -1.0))
    for bolt, by_interface in margins.items():
        yield _margin(bolt, "MS_sep", np.min(by_interface, axis=0), factored, source)


def _slip_checks(
    factored: _Factored, demands: Mapping[tuple[str, str], SlipDemand]
) -> Iterator[Check]:
    """Yield checks of slip by sums, of interfaces and of the area around each bolt."""
    alone = len(factored.solution.system.bolts) == 1
    for (interface, bolt), demand in demands.items():
        if bolt and alone:
            continue  # it has the whole interface
        friction, rest = demand.coefficient, AT_REST.name
        if friction is None or demand.unknown or not demand.clamp_force[rest] > 0:
            continue
        clamp = demand.clamp_force[rest]
        margins = []
        for case in factored.names:
            left, needed = demand.clamp_force[case], demand.needed_friction[case]
            shear = needed * left if left > 0 else np.inf
            shear = shear if needed > SMALLEST_FRICTION else 0.0
            margins.append(slip_margin(friction, clamp, shear, max(clamp - left, 0.0)))
        equation = "(86)" if bolt else "(84)"
        check = _margin(
            bolt or interface,
            f"MS_slip at {interface}" if bolt else "MS_slip",
            np.array(margins),
            factored,
            f"NASA-STD-5020B A.10 {equation}, by sums over the contact model, μ {friction:g}",
            "bolt" if bolt else "interface",
        )
        untested = friction > MOST_FRICTION and check.outcome == "met"
        yield replace(check, reason=UNTESTED) if untested else check
