"""Strength of bolts over many solved cases, and the cases that decide at the ends of preloads."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from faying._typing import Indices
from faying.assessment.case_metrics import bent_bolts
from faying.assessment.check import Check
from faying.assessment.joint_record import CaseState
from faying.assessment.strength.checks import strength_checks
from faying.assessment.strength.clamp_ends import clamp_checks
from faying.assessment.strength.preload_ends import PreloadEnd, preload_ends
from faying.assessment.strength.thread import Thread
from faying.assessment.strength.tightening import PreloadRange
from faying.interface.surface import ContactSurface
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import InputRow, Load
from faying.simulation.solution import Solution
from faying.study.inputs.load_set import LoadSet
from faying.study.keys.requirement_tables import MarginsSection, ScatterSection
from faying.workflow.solved_cases import SolvedCases

STATIC = ""
"""Name of the static cases among sets of cases."""

ALL_STATIC = "all static cases"
"""Where a range of stress over all of them is from."""


@dataclass(frozen=True, kw_only=True)
class BoltStrengths:
    """What the strength of bolts is judged by.

    Attributes
    ----------
    threads
        Of the bolts whose strength is judged.
    ranges
        Of the preloads.
    margins
        Standard that is demanded, with its factors.
    scatter
        Of the preloads, with temperatures and friction.
    tightened : [force]
        Bolt to the force it was tightened to.
    """

    threads: Mapping[str, Thread] = field(default_factory=dict)
    ranges: Mapping[str, PreloadRange] = field(default_factory=dict)
    margins: MarginsSection | None = None
    scatter: ScatterSection | None = None
    tightened: Mapping[str, float] = field(default_factory=dict)

    @property
    def temperatures(self) -> dict[str, Load]:
        """Those that every static case may have beside its loads."""
        names = () if self.scatter is None else self.scatter.temperatures
        return {name: Load({name: 1.0}, name=name) for name in names}

    def rubbing(self, surfaces: Mapping[str, ContactSurface]) -> dict[str, float]:
        """Return the coefficients of the interfaces that have friction, of a range the smallest."""
        ends = None if self.scatter is None else self.scatter.surface_friction
        return {
            name: surface.friction if ends is None else ends[0]
            for name, surface in surfaces.items()
            if surface.friction > 0
        }


def solved_strength(
    judged: BoltStrengths,
    rom: ReducedModel,
    sets: Mapping[str, SolvedCases],
    at_rest: CaseState,
    loads: LoadSet,
    deciding: Sequence[InputRow],
    limits: Mapping[str, float],
) -> Iterator[Check]:
    """Yield the checks of the bolts whose threads are known, each in its worst case.

    Where preloads scatter, the static cases that decide are solved at both ends, and bolt forces of
    all others moved by as much as the preloads; clamp forces at the ends are judged then, too.

    Parameters
    ----------
    sets
        Solved cases: static ones under an empty name, and transients by name.
    at_rest
        The preloaded state.
    deciding
        Static cases without friction that are solved anew.
    limits : [force]
        Interface to the least clamp force that is demanded of it.
    """
    if not rom.bolts:
        return
    solved = {name: np.flatnonzero(_solved(cases, rom)) for name, cases in sets.items()}
    nominal = {
        name: _state(cases, rom, solved[name]) for name, cases in sets.items() if len(solved[name])
    }
    anew = {load.name: load for load in deciding}
    ends = preload_ends(
        rom, at_rest, nominal, anew, judged.ranges, judged.tightened, judged.temperatures
    )
    if ends[0].solved:
        yield from clamp_checks(ends, rom.interfaces, rom.bolts, limits, rom.units)
    counted = {name: times for name, times in loads.repetitions.items() if times}
    told_apart = [_told_apart(end, loads.names, solved, anew, counted) for end in ends]
    for check in strength_checks(judged.threads, told_apart, rom.units, counted):
        label = check.case
        if check.instant is not None:  # the number of a row, as it was given below
            label = sets[check.case].named(check.case, int(check.instant))
        elif check.quantity.startswith("fatigue"):
            label = label or ALL_STATIC
        yield replace(check, case=label, instant=None)


def _told_apart(
    end: PreloadEnd,
    names: Sequence[str],
    solved: Mapping[str, Indices],
    anew: Mapping[str, InputRow],
    counted: Mapping[str, float],
) -> PreloadEnd:
    """Return an end with what was solved anew among all static cases, and those counted apart."""
    if STATIC not in end.cases:
        return replace(end, solved=frozenset())
    static = end.cases[STATIC]
    numbers = {names[row]: number for number, row in enumerate(solved[STATIC].tolist())}
    forces = {bolt: values.copy() for bolt, values in static.bolt_forces.items()}
    moments = {bolt: values.copy() for bolt, values in static.bolt_moments.items()}
    for name in end.solved & anew.keys() & numbers.keys():
        state = end.cases[name]
        for bolt, values in forces.items():
            values[numbers[name]] = state.bolt_forces[bolt][0]
        for bolt, bent in moments.items():
            bent[numbers[name]] = state.bolt_moments[bolt][0]
    merged = replace(static, bolt_forces=forces, bolt_moments=moments)
    apart = {
        name: replace(_rows(merged, [numbers[name]]), times=None)
        for name in counted
        if name in numbers
    }
    others = [number for name, number in numbers.items() if name not in apart]
    cases = {name: state for name, state in end.cases.items() if name not in anew}
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


def _solved(cases: SolvedCases, rom: ReducedModel) -> np.ndarray:
    return ~np.isnan(cases.column(f"bolt_force.{next(iter(rom.bolts))}"))


def rest_of(rom: ReducedModel, state: Solution) -> CaseState:
    """Return the preloaded state as a case."""
    return CaseState(
        pressure=state.pressure.reshape(-1, rom.contact.n_points)[-1:],
        bolt_forces={name: np.ravel(state.bolt_force(name))[-1:] for name in rom.bolts},
        bolt_moments={
            name: state.bolt_bending(name).reshape(-1, 2, 2)[-1:] for name in bent_bolts(rom.bolts)
        },
    )


def _state(cases: SolvedCases, rom: ReducedModel, rows: Indices) -> CaseState:
    """Return cases as one over "time", which is their number."""
    return CaseState(
        pressure=np.empty((len(rows), 0)),
        bolt_forces={name: cases.column(f"bolt_force.{name}")[rows] for name in rom.bolts},
        bolt_moments={name: cases.bending(name)[rows] for name in bent_bolts(rom.bolts)},
        times=rows.astype(float),
    )
