"""Where a path stands after each of its loads, and how it goes from one to the next."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.increment import Increment, IncrementSolver
from faying.exceptions import ConvergenceError
from faying.linalg.threads import threads_for

MOST_DIVISIONS = 6
"""Times an increment, an interval or a step of Newton's method is halved: 64 parts of it."""

TURNED = 1e-3
"""Part of the last step that an increment begins back of where it ended, as its load turns.

Points at their bounds stick there: both turns of a flange of which nearly all slips took 11 Newton
steps each, and 17 and 15 from where the step had begun.
"""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PathStep:
    """Where a path stands after a load.

    Attributes
    ----------
    relative : (n_relative,) [length]
        What the load alone would move the pairs.
    increment
        The last increment of the load.
    slip : (2, n_point)
    iterations, dissipation
        Of all increments of the load.
    previous
        Where the load before left the path; None where that is not known.
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
    """Yield where a path stands after each load (n_load, n_relative), from where it begins.

    Some of the loads may be given, if ``step`` is where those before them led. Where the same loads
    came before, as in cycles, it is told where they began and where each of them led: increments
    then begin as those did, past where the path now is.

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
                    start = _again(step, before[number].increment, before[number + 1].increment)
                else:
                    start = _ahead(step, relative[number])
                step = _to(solver, step, relative[number], MOST_DIVISIONS, start)
            except ConvergenceError as error:
                message = f"load {number + 1} of {len(relative)} on the path: {error}"
                raise ConvergenceError(message) from None
            yield step


def _in_proportion(contact: Contact, step: PathStep) -> bool:
    """Say whether a part of a load is that part of the same problem, no easier to solve."""
    unloaded = not (step.relative.any() or step.increment.forces.any() or step.slip.any())
    return unloaded and contact.proportional and not contact.initial_gap.any()


def _to(
    solver: IncrementSolver,
    step: PathStep,
    target: Vector,
    divisions: int,
    start: Increment | None,
) -> PathStep:
    """Go to a load in one increment from a start, or by halves where that is too far."""
    offset, previous = solver.contact.offset(step.slip), replace(step, previous=None)
    try:
        increment = solver.solve(target, offset, start)
    except ConvergenceError:
        if divisions == 0 or _in_proportion(solver.contact, step):
            raise
        half = (step.relative + target) / 2
        middle = _to(solver, step, half, divisions - 1, _ahead(step, half))
        end = _to(solver, middle, target, divisions - 1, _ahead(middle, target))
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


def _ahead(step: PathStep, target: Vector) -> Increment | None:
    """Return where an increment begins: on the line from the step before, as far as the load goes.

    At most as far as that was, so that round-off between equal loads leads nowhere, and hardly
    back, where what slipped sticks at first.
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


def _again(step: PathStep, earlier: Increment, later: Increment) -> Increment | None:
    """Return where an increment begins that goes as far as from an earlier one to a later one."""
    start = step.increment
    return replace(start, moved=start.moved + later.moved - earlier.moved) if start.begun else None
