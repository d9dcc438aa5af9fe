"""The step responses that train method B, computed side by side in groups."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from faying.execution.checkpoint import Arrays
from faying.execution.groups import grouped
from faying.execution.transients import step_responses
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.stepping import TransientSolver
from faying.study.inputs.loads import time_span, time_step, training_box
from faying.study.keys.tables import TrainingSection


@dataclass(frozen=True, eq=False, kw_only=True)
class StepTraining:
    """Training steps of a joint, Eqs. (15.27) to (15.29).

    Attributes
    ----------
    training
        Training options of the study.
    period
        Longest period of the preloaded joint [time].
    solver
        Function that builds the solver at the first use.
    rest
        Initial state, if known.
    """

    training: TrainingSection
    period: float
    solver: Callable[[], TransientSolver]
    rest: Solution | None

    @property
    def n_steps(self) -> int:
        """Number of time steps of a response."""
        step = time_step(self.training, self.period)
        return round(time_span(self.training, self.period) / step)

    def forces(
        self, numbers: Sequence[int], progress: Callable[[int], object] | None = None
    ) -> Iterator[Arrays]:
        """Yield the contact forces λ (n_point, n_time) [force] of the responses to some loads."""
        loads = step_loads(self.training)
        solutions = step_responses(
            self._solver,
            [loads[number] for number in numbers],
            duration=time_span(self.training, self.period),
            initial=self.rest,
            progress=progress,
        )
        return ({"forces": solution.contact_forces.T} for solution in solutions)

    @cached_property
    def _solver(self) -> TransientSolver:
        return self.solver()


def step_loads(training: TrainingSection) -> Sequence[Load]:
    """Return the loads of the training steps."""
    return training_box(training).step_loads() if training.dynamics else []


def step_groups(training: TrainingSection) -> list[dict[str, int]]:
    """Return groups of training steps that are computed together: numbers by key."""
    numbers = range(len(step_loads(training)))
    return grouped({f"training step {number}": number for number in numbers})
