"""Strength of bolts over many solved cases, from their forces and bending moments alone."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from faying.assessment.check import Check
from faying.assessment.joint_record import CaseState
from faying.assessment.strength.checks import strength_checks
from faying.assessment.strength.preload_ends import PreloadEnd
from faying.assessment.strength.thread import Thread
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.solution import Solution
from faying.workflow.solved_pieces import Pieces

NO_DIRECTION = "of bending moments the size alone is kept here; faying run judges it"
"""Why fatigue of bolts that are bent is not known."""


def solved_strength(
    threads: Mapping[str, Thread],
    rom: ReducedModel,
    sets: Mapping[str, Pieces],
    rest: Solution,
) -> Iterator[Check]:
    """Yield the checks of the bolts whose threads are known, each in its worst case.

    Parameters
    ----------
    sets
        Solved cases: static ones under an empty name, and transients by name.
    rest
        The preloaded state.
    """
    bent = {name for name in threads if rom.bolts[name].bending is not None}
    solved = {name: np.flatnonzero(_solved(pieces, rom)) for name, pieces in sets.items()}
    end = PreloadEnd(
        name="",
        rest=CaseState(
            pressure=np.empty((1, 0)),
            bolt_forces={name: np.ravel(rest.bolt_force(name))[-1:] for name in rom.bolts},
            bolt_moments={name: rest.bolt_bending(name).reshape(-1, 2, 2)[-1:] for name in bent},
        ),
        cases={
            name: _state(pieces, rom, bent, solved[name])
            for name, pieces in sets.items()
            if len(solved[name])
        },
    )
    for check in strength_checks(threads, [end], rom.units):
        if check.quantity.startswith("fatigue") and check.part in bent:
            yield Check(
                part=check.part,
                kind="bolt",
                quantity=check.quantity,
                outcome="unknown",
                reason=NO_DIRECTION,
            )
            continue
        label = check.case
        if check.instant is not None:  # the number of a row, as it was given below
            label = sets[check.case].named(check.case, int(check.instant))
        elif check.quantity.startswith("fatigue"):  # of the range over all of them
            label = label or "all static cases"
        yield replace(check, case=label, instant=None)


def _solved(pieces: Pieces, rom: ReducedModel) -> np.ndarray:
    return ~np.isnan(pieces.column(f"bolt_force.{next(iter(rom.bolts))}"))


def _state(pieces: Pieces, rom: ReducedModel, bent: set[str], rows: np.ndarray) -> CaseState:
    """Return cases as one over "time", which is their number."""
    moments = {}
    for name in bent:
        moments[name] = np.zeros((len(rows), 2, 2))
        moments[name][:, 0, 0] = pieces.column(f"bolt_bending.{name}")[rows]
    return CaseState(
        pressure=np.empty((len(rows), 0)),
        bolt_forces={name: pieces.column(f"bolt_force.{name}")[rows] for name in rom.bolts},
        bolt_moments=moments,
        times=rows.astype(float),
    )
