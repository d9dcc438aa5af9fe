"""Assessment of a joint over many solved cases: the deciding ones are judged as in a run."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying.assessment.case_metrics import bent_bolts
from faying.assessment.check import Check
from faying.assessment.joint_checks import joint_checks
from faying.assessment.joint_judge import JointJudge, rest_of
from faying.assessment.joint_record import CaseState
from faying.assessment.opening import Openings, area_name, areas_that_open
from faying.assessment.requirements import ClosedRing, Verdict
from faying.assessment.sealing import Ring, ring_around
from faying.assessment.slip_demand import slip_coefficients
from faying.assessment.slip_reserve import SlipReserve, followed_openings
from faying.assessment.strength.checks import with_threads
from faying.assessment.strength.preload_ends import BoltStrengths, PreloadEnd
from faying.assessment.strength.thread import fibre_stresses, normal_stresses
from faying.assessment.verdicts import ring_surface
from faying.exceptions import refuse_model
from faying.joint.bolt_surroundings import pressed_near
from faying.joint.tangential import TangentialRows
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import InputRow
from faying.simulation.solution import Solution
from faying.study.inputs.load_set import LoadSet
from faying.study.judgement.margins import NASA, with_margins
from faying.workflow.deciding_cases import Deciding
from faying.workflow.solve_cases import CaseSolver, SolveOptions
from faying.workflow.solved_cases import BENDING, OPENS, SLIDES, Demanded, SolvedCases

STATIC = ""
"""Name of the set of static cases."""

ALL_STATIC = "all static cases"
"""Load case of a stress range over all static cases."""


def demanded_of(options: SolveOptions, rom: ReducedModel, rest: Solution) -> Demanded:
    """Return the rings, areas and points that requirements judge in every case."""
    requirements = options.requirements
    radius = requirements.no_opening_within
    near = {}
    if radius is not None:
        preload = rest_of(rest).pressure[0]
        near = {
            name: pressed_near(rom.interfaces, bolt, radius, preload)
            for name, bolt in rom.bolts.items()
        }
    return Demanded(
        rings=dict(_rings(requirements.closed_ring, rom)),
        areas=_areas(options, rom),
        opens=areas_that_open(rom.interfaces, rom.contact.slices, rom.bolts),
        open_below=requirements.open_share,
        pressed={name: points for name, points in near.items() if points.any()},
    )


def _areas(options: SolveOptions, rom: ReducedModel) -> dict[str, TangentialRows]:
    """Return the tangential force rows, by name, of the areas whose slip is judged by sums.

    Areas around bolts are judged only by the margins of a standard.
    """
    of_smooth = options.requirements.slip_friction
    judged = slip_coefficients(rom.contact, options.strengths.smallest_friction, of_smooth)
    around = options.margins is not None and options.margins.standard == NASA
    return {
        area_name(rows.interface, rows.bolt): rows
        for rows in rom.tangential
        if rows.interface in judged and not rows.unknown and (around or not rows.bolt)
    }


def _rings(rings: Sequence[ClosedRing], rom: ReducedModel) -> Iterator[tuple[str, Ring]]:
    """Yield the rings of the requirements, with the names of their metrics."""
    places = [ring_surface(ring, rom.interfaces) for ring in rings]
    for number, (ring, surface) in enumerate(zip(rings, places, strict=True), start=1):
        several = places.count(surface) > 1
        name = f"{surface}.{places[:number].count(surface)}" if several else surface
        yield name, ring_around(rom.interfaces[surface], ring.around)


def solved_checks(
    solver: CaseSolver,
    static: SolvedCases | None,
    transients: Mapping[str, SolvedCases],
) -> tuple[tuple[Verdict, ...], tuple[Check, ...]]:
    """Return verdicts and checks of a joint in its deciding cases, and of its bolts in all."""
    rom, loads = solver.rom, solver.loads
    options, sets = solver.options, {**({} if static is None else {STATIC: static}), **transients}
    decided, paths = dict[int, CaseState](), dict[int, CaseState]()
    if static is not None:
        deciding = static.deciding(options.worst)
        paths = solver.followed(deciding)
        decided = paths or static.states(deciding)
    rows = list(decided)
    states = {loads.names[row]: state for row, state in decided.items()}
    for name, cases in transients.items():
        at = cases.states(cases.deciding(options.worst))
        states |= {cases.named(name, row): state for row, state in at.items()}
    if not states:
        refuse_model("no case was solved, so there is nothing to judge")
    openings: Mapping[str, Openings] = {}
    reserves: Mapping[str, SlipReserve] = {}
    if static is not None:
        demanded = solver.demanded
        followed = Deciding(
            rom=rom,
            loads=loads,
            areas=demanded.opens,
            open_below=demanded.open_below,
            # Openings on paths are followed only where a requirement needs them.
            along=options.requirements.min_opening_factor is not None,
        )
        slides, opens = static.of_all(SLIDES, OPENS)
        with solver.books.attempt("load factors of opening and sliding"):
            reserves = followed.reserves(solver.rest, slides, opens)
            alone = solver.memoryless
            openings = followed.openings(opens) if alone else followed_openings(reserves)
    summed = _loads(loads, rows)
    judge = JointJudge(
        system=rom,
        exact=rom,
        preloaded=rest_of(solver.rest),
        cases=states,
        requirements=options.requirements,
        strengths=options.strengths,
        attempt=solver.books.attempt,
        loads=_loads(loads, [*rows, *map(loads.names.index, openings)]),
        # One by one, where the search for the first that opens has failed.
        followed=() if openings else [loads.names[row] for row in rows],
        summed=summed,
        reserves=reserves,
        openings=openings,
        rest=solver.rest,
    ).certified(lambda: solver.judge)
    assessment, threads = judge.assessment(), options.strengths.threads
    histories = {name: _history(cases, rom) for name, cases in sets.items()} if rom.bolts else {}
    histories = {name: state for name, state in histories.items() if len(state.pressure)}
    while True:
        if histories:
            histories |= {loads.names[row]: state for row, state in paths.items()}
        ends = judge.ends(histories)
        apart = [_merged_end(end, loads) for end in ends]
        stressed = with_threads(assessment, histories, threads, rom.units, apart, loads.repetitions)
        solved = {*histories, *(name for end in ends for name in end.solved)}
        worst = _worst_rows(loads, options.strengths, apart, stressed.checks)
        more = [row for row in sorted(worst) if loads.names[row] not in solved]
        if not more or not (paths or ends[0].solved):
            break
        judge = replace(judge, loads=[*judge.loads, *_loads(loads, more)])
        paths = solver.followed(more)
    assessment = judge.at_ends(assessment, ends)
    assessment = with_threads(assessment, histories, threads, rom.units, apart, loads.repetitions)
    checks = tuple(_labelled(check, sets) for check in assessment.checks)
    assessment = with_margins(replace(assessment, checks=checks), judge, options.margins, summed)
    return assessment.verdicts, joint_checks(assessment, rom.unit_set, reserves)


def _loads(loads: LoadSet, rows: Iterable[int]) -> list[InputRow]:
    """Return distinct static cases as loads."""
    return [InputRow(name=loads.names[row], row=loads.inputs[row]) for row in dict.fromkeys(rows)]


def _worst_rows(
    loads: LoadSet, strengths: BoltStrengths, ends: Sequence[PreloadEnd], checks: Sequence[Check]
) -> set[int]:
    """Return the static cases that decide a check or have extreme stress in a thread fibre."""
    stated = [check for check in checks if check.case == STATIC and check.instant is not None]
    rows = {int(check.instant or 0) for check in stated}
    rows |= {loads.names.index(check.case) for check in checks if check.case in loads.repetitions}
    for state in (end.cases[STATIC] for end in ends if STATIC in end.cases):
        for bolt, thread in strengths.threads.items():
            moments = state.bolt_moments.get(bolt)
            stresses = fibre_stresses(normal_stresses(thread, state.bolt_forces[bolt], moments))
            extremes = np.concatenate([stresses.argmax(axis=0), stresses.argmin(axis=0)])
            rows |= set(np.asarray(state.times)[extremes].astype(int).tolist())
    return rows


def _history(cases: SolvedCases, rom: ReducedModel) -> CaseState:
    """Return bolt forces and moments in all solved cases, with the row number as time."""
    bent, metrics = bent_bolts(rom.bolts), [metric.name for metric in cases.metrics]
    table, *moments = cases.of_all("metrics", *(f"{BENDING}{name}" for name in bent))
    forces = {name: table[:, metrics.index(f"bolt_force.{name}")] for name in rom.bolts}
    rows = np.flatnonzero(~np.isnan(next(iter(forces.values()))))
    return CaseState(
        pressure=np.empty((len(rows), 0)),
        bolt_forces={name: column[rows] for name, column in forces.items()},
        bolt_moments={name: bending[rows] for name, bending in zip(bent, moments, strict=True)},
        times=rows.astype(float),
    )


def _merged_end(end: PreloadEnd, loads: LoadSet) -> PreloadEnd:
    """Return an end of the preload scatter with its solved cases merged into the static ones."""
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
    return replace(end, cases={**apart, **cases}, solved=end.solved & apart.keys())


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
    """Return a check with the name of its case or instant in place of the row number."""
    label = check.case
    if check.instant is not None:
        label = sets[check.case].named(check.case, int(check.instant))
    elif check.quantity.startswith("fatigue"):
        label = label or ALL_STATIC
    return replace(check, case=label, instant=None)
