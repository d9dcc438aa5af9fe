"""Static cases and transients solved on a reduced model, piece by piece."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from faying._typing import Indices, Matrix
from faying.assessment.case_metrics import Metric, bent_bolts, metrics_of
from faying.assessment.certificate import Certifier, certifier
from faying.assessment.growth import DEFAULT_INCREMENTS
from faying.assessment.joint_record import CaseState
from faying.assessment.requirements import Requirements
from faying.assessment.strength.preload_ends import BoltStrengths, state_of
from faying.exceptions import ConvergenceError, refuse_study
from faying.execution.campaign import run_campaign
from faying.execution.checkpoint import Arrays, Checkpoint
from faying.execution.executor import Executor
from faying.files.flattening import flattened, restored
from faying.linalg.pieces import PIECE_NUMBERS
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.energy_guard import MOST_GAIN, gain_message
from faying.simulation.load import InputRow
from faying.simulation.path import solve_path, solve_ramps
from faying.simulation.restart import Restart
from faying.simulation.solution import Solution
from faying.simulation.static import similar_loads
from faying.simulation.stepping import transient_solver
from faying.simulation.transient_windows import transient_windows
from faying.study.inputs.load_set import LoadSet, TimedLoad
from faying.study.keys.requirement_tables import MarginsSection
from faying.study.results.metric_table import TableFormat
from faying.study.stages.books import FAILED, Books
from faying.workflow.solved_cases import Demanded, SolvedCases, arrays_of, factors_of

FEWEST, MOST = 16, 2000
"""Least and largest number of cases of a piece."""

Piece = Indices | TimedLoad
"""Row numbers of static cases, or a transient load."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SolveOptions:
    """Options of solving many loads.

    Attributes
    ----------
    worst
        Number of worst cases of each metric whose fields are stored.
    named
        Names of further static cases whose fields are stored.
    certificates
        Whether errors of static cases are bounded, where the model has the full compliance.
    table
        Format of the tables of metrics.
    requirements
        Requirements on the joint.
    strengths
        Strengths of the bolts.
    margins
        Standard of the strength margins, with its factors.
    """

    worst: int = 1
    named: tuple[str, ...] = ()
    certificates: bool = True
    table: TableFormat = "csv"
    requirements: Requirements = field(default_factory=Requirements)
    strengths: BoltStrengths = field(default_factory=BoltStrengths)
    margins: MarginsSection | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class CaseSolver:
    """Solver of the pieces of many loads.

    Attributes
    ----------
    rom
        The reduced model.
    loads
        Loads to solve.
    checkpoint
        Store of finished pieces.
    books
        Progress and timings of the call.
    options
        Options of the call.
    demanded
        Areas and rings that requirements judge.
    rest
        State of the preloaded joint, at which all loads begin.
    """

    rom: ReducedModel
    loads: LoadSet
    checkpoint: Checkpoint
    books: Books
    options: SolveOptions
    demanded: Demanded
    rest: Solution

    @cached_property
    def named(self) -> list[int]:
        """Rows of the static cases whose fields are stored by name."""
        return [self.loads.names.index(name) for name in self.options.named]

    @property
    def increments(self) -> int:
        """Increments of a static case from the preload; one where the path does not matter."""
        return self.rom.contact.increments(DEFAULT_INCREMENTS)

    @property
    def memoryless(self) -> bool:
        """Whether static solutions do not depend on the load path."""
        return self.increments == 1

    @cached_property
    def judge(self) -> Certifier | None:
        """Certifier of static cases; None if not requested, or if solutions depend on paths."""
        if not (self.options.certificates and self.memoryless):
            return None
        with self.books.timed("certificates"), self.books.attempt("certified bounds"):
            return certifier(self.rom.joint)
        return None

    def share(self, executor: Executor) -> None:
        """Have workers compute the missing pieces.

        Workers return static pieces. They store the pieces of transients, which may be long,
        themselves, so they must see the folder of the checkpoint.

        Raises
        ------
        FayingError
            As without workers, or if workers fail; finished pieces are stored.
        """
        transients = {end_key(load): load for load in self.loads.transients}
        pieces: dict[str, Piece] = {**transients, **self._static_pieces}  # the longest first
        weights = {key: len(rows) for key, rows in self._static_pieces.items()}
        weights |= {key: n_steps(load) for key, load in transients.items()}
        folder = self.checkpoint.folder.resolve()
        sent = replace(self, checkpoint=Checkpoint(folder), books=Books())
        with self.books.stage("workers", sum(weights.values())) as advance:
            run_campaign(
                partial(on_worker, sent),
                pieces,
                executor,
                keep=self.checkpoint,
                progress=lambda key: advance(weights[key]),
            )

    def piece(self, piece: Piece) -> Arrays:
        """Solve a piece of the static cases, or a transient; return the arrays to store."""
        return self._integrate(piece) if isinstance(piece, TimedLoad) else self._static_piece(piece)

    def static(self) -> SolvedCases:
        """Solve the static cases that are not in the checkpoint; return all of them."""
        failed = list[str]()
        with self.books.stage("static cases", len(self.loads.names)) as advance:
            for key, rows in self._static_pieces.items():
                arrays = self.checkpoint.bundle(key, partial(self.piece, rows))
                failed += arrays[FAILED].tolist()
                advance(len(rows))
        return SolvedCases(
            checkpoint=self.checkpoint,
            keys=list(self._static_pieces),
            metrics=self._metrics(static=True),
            label=self.loads.names.__getitem__,
            failed=failed,
            ordered=False,
        )

    def transient(self, load: TimedLoad) -> SolvedCases:
        """Solve a transient, continued from the checkpoint; return its instants."""
        end = self.checkpoint.bundle(end_key(load), partial(self.piece, load))
        return SolvedCases(
            checkpoint=self.checkpoint,
            keys=[_piece_key(load, number) for number in range(int(end["count"]))],
            metrics=self._metrics(static=False),
            label=lambda row: f"{row * load.step:.12g}",
            failed=end[FAILED].tolist(),
        )

    @cached_property
    def _static_pieces(self) -> dict[str, Indices]:
        """Rows of each piece of similar static cases, by its key in the checkpoint."""
        loads = self.loads
        groups = similar_loads(self.rom, loads.inputs, self._length) if loads.names else []
        return {f"static {number}": np.sort(rows) for number, rows in enumerate(groups)}

    def _metrics(self, *, static: bool) -> list[Metric]:
        interfaces = self.rom.interfaces
        return metrics_of(
            self.rom,
            interfaces,
            certified=static and self.judge is not None,
            rings=self.demanded.rings,
            areas=self.demanded.areas if static else (),
        )

    @property
    def _length(self) -> int:
        """Number of cases or instants of a piece."""
        return min(max(PIECE_NUMBERS // self.rom.contact.n_points, FEWEST), MOST)

    def _static_piece(self, rows: Indices) -> Arrays:
        """Solve a piece of the static cases; return the arrays to store."""
        judge = self.judge
        solved, failed = self._solved(rows)
        with self.books.timed("certificates"):
            judged = [
                (
                    n,
                    state,
                    None if judge is None else judge.certify_inputs(state.inputs, state.pressure),
                )
                for n, state in solved
            ]
        metrics = self._metrics(static=True)
        worst = self.options.worst
        arrays = arrays_of(self.rom, rows, judged, self.demanded, metrics, worst, self.named)
        with self.books.timed("load factors"):
            arrays |= factors_of(rows, judged, self.demanded, self.rest)
        return arrays | {FAILED: np.array(failed, dtype=str)}

    def _solved(self, rows: Indices) -> tuple[list[tuple[Indices, Solution]], list[str]]:
        """Solve static cases together; where one fails, in halves down to single cases."""
        try:
            return [(rows, self._ends(self.loads.inputs[rows]))], []
        except ConvergenceError as error:
            if len(rows) == 1:
                return [], [f"{self.loads.names[rows[0]]}: {error}"]
        halves = [self._solved(half) for half in np.array_split(rows, 2)]
        return [solution for half_solved, _ in halves for solution in half_solved], [
            text for _, failed in halves for text in failed
        ]

    def _ends(self, inputs: Matrix) -> Solution:
        """Return the ends of static cases, in increments from the preload where paths matter."""
        return solve_ramps(self.rom, inputs, self.rest, increments=DEFAULT_INCREMENTS)

    def followed(self, rows: Sequence[int]) -> dict[int, CaseState]:
        """Return the states of static cases at every increment, as a run judges them.

        The result is empty where a case has one increment, which is the solution itself.
        """
        shares = np.arange(1, self.increments + 1) / self.increments
        states: dict[int, CaseState] = {}
        for row in () if self.memoryless else rows:
            load = InputRow(name=self.loads.names[row], row=self.loads.inputs[row])
            path = solve_path(self.rom, [load.scaled(share) for share in shares], self.rest)
            states[row] = state_of(path, slice(None), bent_bolts(self.rom.bolts))
        return states

    def _integrate(self, load: TimedLoad) -> Arrays:
        """Store the pieces of a transient; return their number, and messages of failures.

        It continues after the last stored piece of an interrupted call.
        """
        name, count, restart, gain = load.load.name, 0, None, 0.0
        if self.checkpoint.has(_stand_key(load)):
            stand = self.checkpoint.get(_stand_key(load))
            count, restart = int(stand["count"]), restored(Restart, stand)
            gain = restart.ledger.gain if restart.ledger else 0.0
        demanded, metrics = replace(self.demanded, areas={}), self._metrics(static=False)
        solver = transient_solver(self.rom, step=load.step, integrator=load.integrator)
        worst, failed = self.options.worst, list[str]()
        with self.books.stage(name, n_steps(load)) as advance:
            first = 0 if restart is None else restart.done + 1
            advance(max(first - 1, 0))
            parts = transient_windows(
                solver,
                [load.load],
                duration=load.duration,
                length=self._length,
                initial=[self.rest],
                restarts=None if restart is None else [restart],
                progress=advance,
            )
            try:
                for (solution,), (end,) in parts:
                    numbers = np.arange(first, first + len(solution.states))
                    solved = [(numbers, solution, None)]
                    arrays = arrays_of(self.rom, numbers, solved, demanded, metrics, worst)
                    self.checkpoint.put(_piece_key(load, count), arrays)
                    first, count, gain = first + len(numbers), count + 1, solution.energy_gain
                    stand = flattened(end) | {"count": np.asarray(count)}
                    self.checkpoint.put(_stand_key(load), stand)
            except ConvergenceError as error:
                failed.append(f"{name}: {error}")
        if gain > MOST_GAIN:
            failed.append(f"{name}: {gain_message(gain)}")
        return {"count": np.asarray(count), FAILED: np.array(failed, dtype=str)}


def on_worker(solver: CaseSolver) -> Callable[[Piece], Arrays]:
    """Return the function that solves a piece on a worker."""
    if solver.loads.transients and not solver.checkpoint.folder.is_dir():
        refuse_study(
            f"a worker does not see {solver.checkpoint.folder}, where it stores finished pieces of "
            "loads over time; choose a folder that all machines share with --out"
        )
    return solver.piece


def end_key(load: TimedLoad) -> str:
    """Return the key of the checkpoint that marks a transient as finished."""
    return f"transient {load.load.name} end"


def n_steps(load: TimedLoad) -> int:
    """Return the number of steps of a transient."""
    return round(load.duration / load.step)


def _piece_key(load: TimedLoad, number: int) -> str:
    return f"transient {load.load.name} {number}"


def _stand_key(load: TimedLoad) -> str:
    """Return the key of the checkpoint for the progress of a transient."""
    return f"transient {load.load.name} stand"
