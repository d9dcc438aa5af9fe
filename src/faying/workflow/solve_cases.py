"""Many static cases, or a transient, solved on a reduced model a part at a time."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.assessment.case_metrics import Metric, metrics_of
from faying.assessment.certificate import Certifier, certifier
from faying.assessment.friction_metrics import friction_metrics
from faying.assessment.opening import opening_margins
from faying.assessment.sealing import Ring
from faying.exceptions import ConvergenceError
from faying.execution.checkpoint import Arrays, Checkpoint
from faying.joint.tangential import TangentialRows
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.energy_guard import MOST_GAIN, gain_message
from faying.simulation.load import Load
from faying.simulation.ramps import solve_ramps
from faying.simulation.restart import kept_restart, restart_from
from faying.simulation.solution import Solution
from faying.simulation.static import similar_loads, solve_static_inputs
from faying.simulation.stepping import transient_solver
from faying.simulation.transient_windows import transient_windows
from faying.study.inputs.load_set import LoadSet, TimedLoad
from faying.study.keys.tables import DEFAULT_INCREMENTS
from faying.study.stages.optional import Extras
from faying.study.stages.path_cases import rest_state
from faying.study.stages.progress import Stages
from faying.workflow.solved_cases import OPENING, SolvedCases, piece_of

PIECE_NUMBERS = 2**18
"""Numbers of one field of all cases solved together: 2 MB, of which some twenty are at hand."""

FEWEST, MOST = 16, 2000
"""Cases of a piece."""

FAILED = "failed"
"""Name of the sentences about what went wrong, beside the arrays of a piece."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Opening:
    """A load factor at which areas must not have opened.

    Attributes
    ----------
    areas
        Name to the points (n_point,) of what opens.
    factor
    open_below
        Share of the area pressed at rest.
    """

    areas: Mapping[str, Mask]
    factor: float
    open_below: float


@dataclass(frozen=True, eq=False, kw_only=True)
class CaseSolver:
    """What all pieces share.

    Attributes
    ----------
    rom
        The model.
    checkpoint
        Keeps finished pieces.
    worst
        Cases of each metric whose fields may be wanted.
    certificates
        Whether static cases are certified, where the model knows the full one's compliance.
    rings
        Around holes that are judged, by name.
    areas
        What is carried along interfaces whose slip is judged in static cases.
    opening
        What must not open at which factor of static cases.
    tightening
        How a joint with friction was tightened; None without.
    """

    rom: ReducedModel
    checkpoint: Checkpoint
    stages: Stages
    extras: Extras
    worst: int
    certificates: bool
    rings: Mapping[str, Ring] = field(default_factory=dict)
    areas: Mapping[str, TangentialRows] = field(default_factory=dict)
    opening: Opening | None = None
    tightening: tuple[Load, ...] | None = None

    @cached_property
    def rest(self) -> Solution | None:
        """Where all loads of a joint with friction begin; None without."""
        return None if self.tightening is None else rest_state(self.rom, self.tightening)

    def static(self, loads: LoadSet, named: Sequence[int]) -> SolvedCases:
        """Solve static cases, or take what an interrupted call has finished."""
        groups, failed = self.static_pieces(loads), list[str]()
        with self.stages.stage("static cases", len(loads.names)) as advance:
            for key, rows in groups.items():
                arrays = self.checkpoint.bundle(key, partial(self.static_piece, loads, rows, named))
                failed += arrays[FAILED].tolist()
                advance(len(rows))
        return SolvedCases(
            checkpoint=self.checkpoint,
            keys=list(groups),
            metrics=self._static_metrics,
            label=loads.names.__getitem__,
            failed=failed,
            ordered=False,
        )

    def transient(self, load: TimedLoad) -> SolvedCases:
        """Solve a transient, from where an interrupted call has kept it."""
        end = self.checkpoint.bundle(end_key(load), partial(self.walked, load))
        return SolvedCases(
            checkpoint=self.checkpoint,
            keys=[_piece_key(load, number) for number in range(int(end["count"]))],
            metrics=self._metrics,
            label=lambda row: f"{row * load.step:.12g}",
            failed=end[FAILED].tolist(),
        )

    def static_pieces(self, loads: LoadSet) -> dict[str, Indices]:
        """Return the rows of each piece of similar static cases, by the key it is kept under."""
        groups = similar_loads(self.rom, loads.inputs, self._length) if loads.names else []
        return {f"static {number}": np.sort(rows) for number, rows in enumerate(groups)}

    @property
    def _metrics(self) -> list[Metric]:
        metrics = metrics_of(self.rom, self.rom.interfaces, certified=False, rings=self.rings)
        return metrics + self._friction_metrics

    @property
    def _static_metrics(self) -> list[Metric]:
        certified = self._judge is not None
        metrics = metrics_of(
            self.rom, self.rom.interfaces, certified=certified, rings=self.rings, areas=self.areas
        )
        return metrics + self._friction_metrics

    @property
    def _friction_metrics(self) -> list[Metric]:
        return [] if self.tightening is None else friction_metrics(self.rom.interfaces)

    @property
    def _length(self) -> int:
        """Cases or instants of a piece."""
        return min(max(PIECE_NUMBERS // self.rom.contact.n_points, FEWEST), MOST)

    @cached_property
    def _judge(self) -> Certifier | None:
        if not self.certificates or self.tightening is not None:
            return None
        with self.stages.timed("certificates"), self.extras.attempt("certified bounds"):
            return certifier(self.rom.joint)
        return None

    def static_piece(self, loads: LoadSet, rows: Indices, named: Sequence[int]) -> Arrays:
        """Solve one piece of the static cases; return what is kept of it."""
        judge = self._judge
        solved, failed = self._solved(loads, rows)
        with self.stages.timed("certificates"):
            judged = [
                (
                    numbers,
                    state,
                    judge and judge.certify_inputs(state.inputs, state.pressure),
                )
                for numbers, state in solved
            ]
        arrays = piece_of(
            judged,
            self.rom.interfaces,
            self._static_metrics,
            rows=rows,
            count=self.worst,
            named=named,
            rings=self.rings,
            areas=self.areas,
        )
        if self.opening is not None:
            with self.stages.timed("openings"):
                arrays |= {OPENING: self._margins(self.opening, rows, solved)}
        return arrays | {FAILED: np.array(failed, dtype=str)}

    def _margins(
        self, opening: Opening, rows: Indices, solved: Sequence[tuple[Indices, Solution]]
    ) -> Vector:
        """Return how deep what must not open is pressed at the demanded factor of each case."""
        margins = np.full(len(rows), -np.inf)
        for numbers, state in solved:
            with suppress(ConvergenceError):  # followed increment by increment, which says so
                margins[np.searchsorted(rows, numbers)] = opening_margins(
                    self.rom.joint,
                    state.inputs,
                    opening.areas,
                    opening.factor,
                    open_below=opening.open_below,
                    forces=state.contact_forces,
                )
        return margins

    def _solved(
        self, loads: LoadSet, rows: Indices
    ) -> tuple[list[tuple[Indices, Solution]], list[str]]:
        """Solve static cases together; where one fails, in halves until it is alone."""
        try:
            return [(rows, self._ends(loads.inputs[rows]))], []
        except ConvergenceError as error:
            if len(rows) == 1:
                return [], [f"{loads.names[rows[0]]}: {error}"]
        halves = [self._solved(loads, half) for half in np.array_split(rows, 2)]
        return [solution for half_solved, _ in halves for solution in half_solved], [
            text for _, failed in halves for text in failed
        ]

    def _ends(self, inputs: Matrix) -> Solution:
        """Solve static cases, with friction in increments from the preload as in a study."""
        if self.rest is None:
            return solve_static_inputs(self.rom, inputs)
        return solve_ramps(self.rom, inputs, self.rest, increments=DEFAULT_INCREMENTS)

    def walked(self, load: TimedLoad) -> Arrays:
        """Keep the pieces of a transient; return their number, and what went wrong.

        It goes on after the last piece that an interrupted call has kept.
        """
        name, count, restart, gain = load.load.name, 0, None, 0.0
        if self.checkpoint.has(_stand_key(load)):
            stand = self.checkpoint.get(_stand_key(load))
            count, restart = int(stand["count"]), restart_from(stand)
            gain = restart.ledger.gain if restart.ledger else 0.0
        metrics = self._metrics
        solver = transient_solver(self.rom, step=load.step, integrator=load.integrator)
        failed: list[str] = []
        with self.stages.stage(name, n_steps(load)) as advance:
            first = 0 if restart is None else restart.done + 1
            advance(max(first - 1, 0))
            parts = transient_windows(
                solver,
                [load.load],
                duration=load.duration,
                length=self._length,
                initial=None if self.rest is None else [self.rest],
                restarts=None if restart is None else [restart],
                progress=advance,
            )
            try:
                for (solution,), (end,) in parts:
                    numbers = np.arange(first, first + len(solution.states))
                    arrays = piece_of(
                        [(numbers, solution, None)],
                        self.rom.interfaces,
                        metrics,
                        rows=numbers,
                        count=self.worst,
                        rings=self.rings,
                    )
                    self.checkpoint.put(_piece_key(load, count), arrays)
                    first, count, gain = first + len(numbers), count + 1, solution.energy_gain
                    stand = kept_restart(end) | {"count": np.asarray(count)}
                    self.checkpoint.put(_stand_key(load), stand)
            except ConvergenceError as error:
                failed.append(f"{name}: {error}")
        if gain > MOST_GAIN:
            failed.append(f"{name}: {gain_message(gain)}")
        return {"count": np.asarray(count), FAILED: np.array(failed, dtype=str)}


def end_key(load: TimedLoad) -> str:
    """Return the key under which it is kept that a transient is finished."""
    return f"transient {load.load.name} end"


def n_steps(load: TimedLoad) -> int:
    """Return the number of steps of a transient."""
    return round(load.duration / load.step)


def _piece_key(load: TimedLoad, number: int) -> str:
    return f"transient {load.load.name} {number}"


def _stand_key(load: TimedLoad) -> str:
    """Return the key under which it is kept how far a transient has come."""
    return f"transient {load.load.name} stand"
