"""The steps of a load path, and the solution of one load after another."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.increment import Increment, IncrementSolver
from faying.exceptions import ConvergenceError
from faying.linalg.threads import threads_for

MOST_DIVISIONS = 6
"""Most halvings of an increment, an interval or a step of Newton's method: 64 parts."""

TURNED = 1e-3
"""Part of the last step by which an increment starts back after a reversal of the load.

Points at their friction limit then stick: both reversals of a flange with slip nearly everywhere
took 11 Newton steps each, and 17 and 15 from the end of the step before.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class PathStep:
    """The state of a path after a load.

    Attributes
    ----------
    relative : (n_relative,) [length]
        Displacements of the pairs under the load alone.
    increment
        The last increment of the load.
    slip : (2, n_point)
    iterations, dissipation
        Totals over all increments of the load.
    previous
        Increment after the load before; None where that is unknown.
    """

    relative: Vector
    increment: Increment
    slip: Matrix
    iterations: int = 0
    dissipation: float = 0.0
    previous: "PathStep | None" = None


def follow(
    solver: IncrementSolver,
    relative: Matrix,
    step: PathStep,
    part: range | None = None,
    *,
    before: Sequence[PathStep] = (),
) -> Iterator[PathStep]:
    """Yield the step of a path after each load, starting from ``step``.

    Loads are given by displacements of the pairs under them alone (n_load, n_relative); ``part``
    selects some of them, if ``step`` is the one before these. For cycles, ``before`` holds the
    steps of the same loads in the cycle before: increments are then predicted from theirs.

    Raises
    ------
    ConvergenceError
        If an increment is not solved even when it is divided; the message names its load.
    """
    numbers = range(len(relative)) if part is None else part
    with threads_for(solver.contact.rows.shape[1]):
        for number in numbers:
            try:
                if before:
                    start = _repeat(step, before[number].increment, before[number + 1].increment)
                else:
                    start = _extrapolated(step, relative[number])
                step = _solve_increment(solver, step, relative[number], MOST_DIVISIONS, start)
            except ConvergenceError as error:
                message = f"load {number + 1} of {len(relative)} on the path: {error}"
                raise ConvergenceError(message) from None
            yield step


def _in_proportion(contact: Contact, step: PathStep) -> bool:
    """Return whether half a load is the same problem scaled, and so no easier to solve."""
    unloaded = not (step.relative.any() or step.increment.forces.any() or step.slip.any())
    return unloaded and contact.proportional and not contact.initial_gap.any()


def _solve_increment(
    solver: IncrementSolver,
    step: PathStep,
    target: Vector,
    divisions: int,
    start: Increment | None,
) -> PathStep:
    """Return the step after one increment to a load, or after halves of it without convergence."""
    offset, previous = solver.contact.offset(step.slip), replace(step, previous=None)
    try:
        increment = solver.solve(target, offset, start)
    except ConvergenceError:
        if divisions == 0 or _in_proportion(solver.contact, step):
            raise
        half = (step.relative + target) / 2
        middle = _solve_increment(solver, step, half, divisions - 1, _extrapolated(step, half))
        end = _solve_increment(solver, middle, target, divisions - 1, _extrapolated(middle, target))
        return replace(
            end,
            previous=previous,
            iterations=middle.iterations + end.iterations,
            dissipation=middle.dissipation + end.dissipation,
        )
    return PathStep(
        relative=target,
        increment=increment,
        slip=step.slip + increment.slack[1:],
        iterations=increment.iterations,
        dissipation=increment.dissipation,
        previous=previous,
    )


def _extrapolated(step: PathStep, target: Vector) -> Increment | None:
    """Return the predicted start of an increment, extrapolated from the step before.

    At most to the length of that step: round-off between equal loads then leads nowhere, and a
    reversal hardly back, since slipped points stick at first.
    """
    start, previous = step.increment, step.previous
    if not start.begun:
        return None
    if previous is None or not previous.increment.begun:
        return start
    line, ahead = step.relative - previous.relative, target - step.relative
    length = float(line @ line)
    part = float(np.clip(ahead @ line / length, -TURNED, 1.0)) if length > 0 else 0.0
    return replace(start, moved=start.moved + part * (start.moved - previous.increment.moved))


def _repeat(step: PathStep, earlier: Increment, later: Increment) -> Increment | None:
    """Return the predicted start of an increment that repeats one between two earlier states."""
    start = step.increment
    return replace(start, moved=start.moved + later.moved - earlier.moved) if start.begun else None
