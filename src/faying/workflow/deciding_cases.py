"""The static cases that decide among many without friction, judged one by one as a run does."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from faying._typing import Vector
from faying.assessment.case_metrics import bent_bolts
from faying.assessment.check import Check
from faying.assessment.joint_assessment import judged, loosest_checks, opening_cases
from faying.assessment.joint_record import Assessment, CaseState
from faying.assessment.opening import areas_that_open, opening_factors, opening_margins
from faying.assessment.requirements import Requirements
from faying.assessment.slip_demand import slip_demands
from faying.assessment.strength.preload_ends import loosest_forces, state_of, with_initial
from faying.assessment.strength.tightening import PreloadRange
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import InputRow
from faying.simulation.static import solve_static_inputs
from faying.study.inputs.load_set import LoadSet
from faying.workflow.solve_cases import Opening
from faying.workflow.solved_cases import SolvedCases

ALL_JUDGED = 50
"""Static cases up to which all are judged one by one; some milliseconds each at every end."""

FOLLOWED = 5
"""Static cases that are followed to their openings, seconds each: those that open the first.

Where a factor is demanded all are solved at it, which decides; else those that are judged at one.
"""


def deciding_loads(loads: LoadSet, static: SolvedCases | None) -> list[InputRow]:
    """Return the static cases that are judged one by one, as loads.

    All where they are few, else those in which some metric is worst: these alone are solved at the
    ends of the preloads and under factored loads.
    """
    if static is None:
        return []
    worst = {worst.row for worst in static.worst(1)}
    rows = range(len(loads.names)) if len(loads.names) <= ALL_JUDGED else sorted(worst)
    return [InputRow(name=loads.names[row], row=loads.inputs[row]) for row in rows]


def not_judged(loads: LoadSet, static: SolvedCases | None, *, rubs: bool) -> list[str]:
    """Say what a run judges of its cases, and many that are solved leave open."""
    if rubs:
        return [
            "opening and sliding factors, and slip at the ends of the scatter: faying run follows "
            "joints with friction"
        ]
    n_judged = len(deciding_loads(loads, static))
    if n_judged == len(loads.names):
        return []
    return [
        "opening, clamp around bolts, and ends of the scatter: beyond the "
        f"{n_judged} of {len(loads.names)} static cases in which some metric is worst"
    ]


def opening_of(requirements: Requirements, rom: ReducedModel) -> Opening | None:
    """Return what must not open at which factor; None where it is not asked or not known."""
    if requirements.min_opening_factor is None or len(rom.contact.rubbing):
        return None
    return Opening(
        areas=areas_that_open(rom.interfaces, rom.contact.slices, rom.bolts),
        factor=requirements.min_opening_factor,
        open_below=requirements.open_share,
    )


def followed_loads(
    requirements: Requirements,
    rom: ReducedModel,
    loads: LoadSet,
    static: SolvedCases,
    deciding: Sequence[InputRow],
) -> list[InputRow]:
    """Return the static cases that open the first, which are followed to their openings."""
    if opening_of(requirements, rom) is not None:
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


def judged_loads(
    rom: ReducedModel,
    at_rest: CaseState,
    loads: Sequence[InputRow],
    followed: Collection[str],
    requirements: Requirements,
    coefficients: Mapping[str, float],
    initial: Vector | None = None,
) -> Assessment:
    """Judge static cases without friction, with bolts locked at initial forces (n_bolt,)."""
    inputs = with_initial(rom, np.array([load.row for load in loads]), initial)
    names = [load.name for load in loads]
    solution, bent = solve_static_inputs(rom, inputs, "cases that decide"), bent_bolts(rom.bolts)
    areas = areas_that_open(rom.interfaces, rom.contact.slices, rom.bolts)
    paths = {
        name: opening_factors(rom.joint, row, areas, open_below=requirements.open_share)
        for name, row in zip(names, inputs, strict=True)
        if name in followed
    }
    demands = slip_demands(
        rom, rom.interfaces, rom.tangential, names, inputs, solution.pressure, coefficients
    )
    states = {name: state_of(solution, row, bent) for row, name in enumerate(names)}
    return judged(rom.interfaces, rom.bolts, at_rest, states, requirements, paths, demands=demands)


def loosened_checks(
    rom: ReducedModel,
    at_rest: CaseState,
    loads: Sequence[InputRow],
    nominal: Assessment,
    requirements: Requirements,
    coefficients: Mapping[str, float],
    ranges: Mapping[str, PreloadRange],
) -> tuple[Check, ...]:
    """Return the checks of opening and slip at P_p,min; none where preloads do not scatter."""
    initial = loosest_forces(rom, at_rest, ranges)
    if initial is None:
        return ()
    opens = opening_cases(nominal)
    loose = judged_loads(rom, at_rest, loads, opens, requirements, coefficients, initial)
    return loosest_checks(loose, rom.unit_set)
