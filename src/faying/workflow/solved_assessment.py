"""The joint judged over many solved cases: those that decide as a run judges its own."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying.assessment.case_metrics import bent_bolts
from faying.assessment.check import Check
from faying.assessment.joint_record import Assessment, CaseState
from faying.assessment.opening import areas_that_open, opening_margins
from faying.assessment.requirements import ClosedRing, Requirements, Verdict
from faying.assessment.sealing import Ring, ring_around
from faying.assessment.slip_demand import slip_coefficients
from faying.assessment.strength.preload_ends import PreloadEnd
from faying.assessment.verdicts import ring_surface
from faying.exceptions import ModelError
from faying.joint.bolt_surroundings import pressed_near
from faying.joint.tangential import TangentialRows
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import InputRow, Load
from faying.study.inputs.load_set import LoadSet
from faying.study.keys.threads import BoltStrengths
from faying.study.stages.joint_judge import JointJudge, certified_cases, rest_of
from faying.study.stages.path_cases import rest_state
from faying.workflow.solve_cases import CaseSolver
from faying.workflow.solved_cases import SolvedCases
from faying.workflow.solved_pieces import Demanded, Opening

ALL_JUDGED = 50
"""Static cases up to which all are judged one by one; some milliseconds each at every end."""

FOLLOWED = 5
"""Static cases that are followed to their openings, seconds each: those that open the first.

Where a factor is demanded all are solved at it, which decides; else those that are judged at one.
"""

STATIC = ""
"""Name of the static cases among sets of cases."""

ALL_STATIC = "all static cases"
"""Where a range of stress over all of them is from."""

RUBBED = "it is followed with friction by faying run alone"
"""Why nothing is known of the opening and sliding of joints with friction."""


def demanded_of(
    requirements: Requirements, rom: ReducedModel, tightening: tuple[Load, ...] | None
) -> Demanded:
    """Return what is asked of every case because a requirement judges it."""
    opening, radius = None, requirements.no_opening_within
    if requirements.min_opening_factor is not None and not len(rom.contact.rubbing):
        opening = Opening(
            areas=areas_that_open(rom.interfaces, rom.contact.slices, rom.bolts),
            factor=requirements.min_opening_factor,
            open_below=requirements.open_share,
        )
    near = {}
    if radius is not None:
        preload = rest_of(rest_state(rom, tightening or ())).pressure[0]
        near = {
            name: pressed_near(rom.interfaces, bolt, radius, preload)
            for name, bolt in rom.bolts.items()
        }
    return Demanded(
        rings=dict(_rings(requirements.closed_ring, rom)),
        areas=_areas(requirements, rom),
        opening=opening,
        pressed={name: points for name, points in near.items() if points.any()},
    )


def _areas(requirements: Requirements, rom: ReducedModel) -> dict[str, TangentialRows]:
    """Return what is carried along the interfaces whose slip is judged by sums, by name."""
    smooth = [name for name, surface in rom.interfaces.items() if not surface.friction > 0]
    judged = slip_coefficients(requirements.slip_friction, smooth)
    carried = {rows.interface: rows for rows in rom.tangential if not rows.bolt}
    return {name: carried[name] for name in judged if name in carried and not carried[name].unknown}


def _rings(rings: Sequence[ClosedRing], rom: ReducedModel) -> Iterator[tuple[str, Ring]]:
    """Yield the rings that are demanded, with the names of their metrics."""
    places = [ring_surface(ring, rom.interfaces) for ring in rings]
    for number, (ring, surface) in enumerate(zip(rings, places, strict=True), start=1):
        several = places.count(surface) > 1
        name = f"{surface}.{places[:number].count(surface)}" if several else surface
        yield name, ring_around(rom.interfaces[surface], ring.around)


def rows_judged(loads: LoadSet, static: SolvedCases | None = None) -> list[int]:
    """Return the static cases that are judged one by one.

    All where they are few; else those that decide, once they are solved: these alone are solved at
    the ends of the preloads and under factored loads.
    """
    if len(loads.names) <= ALL_JUDGED:
        return list(range(len(loads.names)))
    return [] if static is None else static.deciding()


def not_judged(loads: LoadSet, static: SolvedCases | None, *, rubs: bool) -> list[str]:
    """Say what a run judges of its cases, and many that are solved leave open."""
    if rubs:
        return [
            "opening and sliding factors, and slip at the ends of the scatter: faying run follows "
            "joints with friction"
        ]
    n_judged = len(rows_judged(loads, static))
    if n_judged == len(loads.names):
        return []
    return [
        "opening, clamp around bolts, and ends of the scatter: beyond the "
        f"{n_judged} of {len(loads.names)} static cases in which some metric is worst"
    ]


def assess_solved(
    solver: CaseSolver,
    requirements: Requirements,
    strengths: BoltStrengths,
    static: SolvedCases | None,
    transients: Mapping[str, SolvedCases],
) -> Assessment:
    """Judge a joint over the cases and instants that decide, and its bolts over all.

    Raises
    ------
    ModelError
        If no case was solved.
    """
    rom, loads, rubs = solver.rom, solver.loads, solver.tightening is not None
    sets = {**({} if static is None else {STATIC: static}), **transients}
    decided = {} if static is None else static.states(rows_judged(loads, static))
    rows = list(decided)
    deciding = [InputRow(name=loads.names[row], row=loads.inputs[row]) for row in rows]
    states = {loads.names[row]: state for row, state in decided.items()}
    if rows and solver.judge is not None:
        pressure = np.concatenate([state.pressure for state in decided.values()])
        names = list(states)
        clamps = certified_cases(solver.judge, rom, names, loads.inputs[rows], pressure)
        states = {name: replace(states[name], certified=clamps[name]) for name in names}
    for name, cases in transients.items():
        at = cases.states(cases.deciding())
        states |= {cases.named(name, row): state for row, state in at.items()}
    if not states:
        message = "no case was solved, so there is nothing to judge"
        raise ModelError(message)
    followed = []
    if static is not None and not rubs:
        followed = _followed(solver, requirements, static, deciding)
    decide = {load.name for load in deciding}
    judge = JointJudge(
        system=rom,
        exact=rom,
        preloaded=rest_of(solver.rest),
        cases=states,
        requirements=requirements,
        strengths=strengths,
        books=solver.books,
        loads=() if rubs else [*deciding, *(load for load in followed if load.name not in decide)],
        followed={load.name for load in followed},
        summed=deciding,
        factored=deciding,
    )
    assessment = judge.assessment()
    if rubs:
        assessment = replace(assessment, verdicts=tuple(map(_left_to_a_run, assessment.verdicts)))
    histories = {name: _history(cases, rom) for name, cases in sets.items()} if rom.bolts else {}
    histories = {name: state for name, state in histories.items() if len(state.pressure)}
    ends = judge.ends(histories)
    assessment = judge.at_ends(assessment, ends)
    apart = [_told_apart(end, loads) for end in ends]
    assessment = judge.strengthened(assessment, histories, apart, loads.repetitions)
    checks = tuple(_labelled(check, sets) for check in assessment.checks)
    return judge.with_margins(replace(assessment, checks=checks))


def _left_to_a_run(verdict: Verdict) -> Verdict:
    """Say of what only a run follows with friction that it does."""
    left = verdict.requirement in ("min_opening_factor", "min_sliding_factor")
    return replace(verdict, reason=RUBBED) if left and verdict.met is None else verdict


def _followed(
    solver: CaseSolver,
    requirements: Requirements,
    static: SolvedCases,
    deciding: Sequence[InputRow],
) -> list[InputRow]:
    """Return the static cases that open the first, which are followed to their openings."""
    rom, loads = solver.rom, solver.loads
    if solver.demanded.opening is not None:
        first = np.argsort(static.margins(), kind="stable")[:FOLLOWED]
        return [InputRow(name=loads.names[case], row=loads.inputs[case]) for case in first]
    if len(deciding) <= FOLLOWED:
        return list(deciding)
    margins = opening_margins(
        rom.joint,
        np.array([load.row for load in deciding]),
        areas_that_open(rom.interfaces, rom.contact.slices, rom.bolts),
        1.0,
        open_below=requirements.open_share,
    )
    return [deciding[case] for case in np.argsort(margins, kind="stable")[:FOLLOWED]]


def _history(cases: SolvedCases, rom: ReducedModel) -> CaseState:
    """Return the bolts in all cases that were solved as one over "time", which is their number."""
    forces = {name: cases.column(f"bolt_force.{name}") for name in rom.bolts}
    rows = np.flatnonzero(~np.isnan(next(iter(forces.values()))))
    return CaseState(
        pressure=np.empty((len(rows), 0)),
        bolt_forces={name: column[rows] for name, column in forces.items()},
        bolt_moments={name: cases.bending(name)[rows] for name in bent_bolts(rom.bolts)},
        times=rows.astype(float),
    )


def _told_apart(end: PreloadEnd, loads: LoadSet) -> PreloadEnd:
    """Return an end with what was solved anew among all static cases, and those counted apart."""
    if STATIC not in end.cases:
        return replace(end, solved=frozenset())
    static = end.cases[STATIC]
    rows = [] if static.times is None else static.times.astype(int).tolist()
    numbers = {loads.names[row]: number for number, row in enumerate(rows)}
    forces = {bolt: values.copy() for bolt, values in static.bolt_forces.items()}
    moments = {bolt: values.copy() for bolt, values in static.bolt_moments.items()}
    for name in end.solved & numbers.keys():
        state = end.cases[name]
        for bolt, values in forces.items():
            values[numbers[name]] = state.bolt_forces[bolt][0]
        for bolt, bent in moments.items():
            bent[numbers[name]] = state.bolt_moments[bolt][0]
    merged = replace(static, bolt_forces=forces, bolt_moments=moments)
    apart = {
        name: replace(_rows(merged, [numbers[name]]), times=None)
        for name in loads.repetitions
        if name in numbers
    }
    others = [number for name, number in numbers.items() if name not in apart]
    cases = {name: state for name, state in end.cases.items() if name not in end.solved}
    cases[STATIC] = _rows(merged, others)
    if not others:
        del cases[STATIC]
    return replace(end, cases={**cases, **apart}, solved=frozenset())


def _rows(state: CaseState, rows: Sequence[int]) -> CaseState:
    chosen = list(rows)
    return replace(
        state,
        pressure=state.pressure[chosen],
        bolt_forces={bolt: values[chosen] for bolt, values in state.bolt_forces.items()},
        bolt_moments={bolt: values[chosen] for bolt, values in state.bolt_moments.items()},
        times=None if state.times is None else state.times[chosen],
    )


def _labelled(check: Check, sets: Mapping[str, SolvedCases]) -> Check:
    """Return a check with the case or instant whose number it has."""
    label = check.case
    if check.instant is not None:
        label = sets[check.case].named(check.case, int(check.instant))
    elif check.quantity.startswith("fatigue"):
        label = label or ALL_STATIC
    return replace(check, case=label, instant=None)


def sliding_checks(
    rom: ReducedModel, static: SolvedCases | None, transients: Mapping[str, SolvedCases]
) -> Iterator[Check]:
    """Judge interfaces with friction: what sticks somewhere in a case does not slide in it."""
    sets = {**({} if static is None else {"": static}), **transients}
    for name, surface in rom.interfaces.items():
        if not surface.friction > 0:
            continue
        shares: list[tuple[float, str]] = []
        for label, cases in sets.items():
            open_area, at_bound = (
                cases.column(f"{metric}.{name}") for metric in ("open_area", "area_at_bound")
            )
            closed = surface.weights.sum() - open_area
            slips = np.where(closed > 0, at_bound / np.where(closed > 0, closed, 1.0), 0.0)
            if not np.isnan(slips).all():
                row = int(np.nanargmax(slips))
                shares.append((float(slips[row]), cases.named(label, row)))
        share, case = max(shares, default=(np.inf, ""))
        slides = share > 1 - ALL
        yield Check(
            part=name,
            kind="interface",
            quantity="slipping share",
            outcome="unknown" if slides else "met",
            utilisation=share,
            value=100 * share,
            limit=100.0,
            unit="%",
            case=case,
            reason=SLIPS_ALL if slides else "",
        )


ALL = 1e-9
"""Distance from one from which a share of area is all of it: round-off of sums."""

SLIPS_ALL = "all that touches is at its friction bound; faying run tells whether it slides"
"""Why nothing is known of an interface that sticks nowhere."""
