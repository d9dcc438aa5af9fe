"""Load cases of a run, solved by the full model and every reduced model, and compared."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from faying._typing import Matrix, SparseMatrix
from faying.assessment.certificate import Certificate, Certifier, Measure
from faying.assessment.mesh_error import MeshError, mesh_errors, smoothings
from faying.assessment.slip_reserve import SlipReserve
from faying.assessment.transient_error import EXACT, REMEDY
from faying.exceptions import ConvergenceError
from faying.files.flattening import flattened, restored
from faying.joint.system import System
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.reduction.attachment import attachment_modes
from faying.reduction.basis import Basis
from faying.reduction.methods import METHODS
from faying.reduction.projection import projected
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.energy_guard import MOST_GAIN, gain_message
from faying.simulation.path_steps import PathStep
from faying.simulation.solution import Solution
from faying.study.inputs.jumps import Jump, load_jumps
from faying.study.inputs.loads import case_load, time_span, time_step
from faying.study.judgement.comparison import accuracy, dissipation_error, recovered_error
from faying.study.keys.friction_rules import has_reserve
from faying.study.keys.requirement_rules import requirements_of
from faying.study.keys.tables import LoadCaseSection
from faying.study.results.responses import respond
from faying.study.results.second_solution import PROJECTION, SHAPES, Remedy
from faying.study.results.values import FULL_MODEL, CaseResult, MethodResult, Response
from faying.study.stages.books import Books
from faying.study.stages.case_solution import judged, remedy_of, solve_case
from faying.study.stages.full_transients import FullTransient, full_transients, response_key
from faying.study.stages.offline import Models, PreparedJoint
from faying.study.stages.path_cases import (
    IncrementalCase,
    advances,
    goes_in_increments,
    path_response,
    reserve_of,
    rest_state,
)
from faying.study.stages.reference import REDUCED, Reference, Solved


@dataclass(eq=False, kw_only=True)
class CaseRunner:
    """Solver of the load cases of a run.

    ``classic`` is the classic basis of the study's methods. ``built`` is the reduced model with
    inertia at the interface, where a transient needs it and the study does not name it;
    ``docs/theory/transient_accuracy.md`` describes when. Runners keep preloaded states by model
    label, and the increments of the full model by load case for slip reserves.
    """

    joint: PreparedJoint
    models: Models
    groups: Sequence[Mapping[str, FullTransient]]
    reference: Reference
    classic: Basis
    built: ReducedModel | None = None
    _rest_states: dict[str, Solution] = field(default_factory=dict)
    _path_steps: dict[str, Sequence[PathStep]] = field(default_factory=dict)

    @property
    def books(self) -> Books:
        """Books of the run."""
        return self.joint.books

    def solve(
        self, case: LoadCaseSection, *, confirmed: bool = False
    ) -> tuple[CaseResult, list[str]]:
        """Solve a load case with every model; return the result and messages of failures.

        A ``confirmed`` static case is compared with the full model, whatever the reference is.

        Raises
        ------
        ConvergenceError
            If the reference does not converge, so that there is nothing to compare with.
        """
        model = self.joint.model
        full = confirmed or self.reference.kind == "full" or goes_in_increments(case, model)
        solved = self._reference(case, full=full)
        reference, remedy = solved.response, solved.remedy
        methods: dict[str, dict[int, MethodResult]] = {}
        failures = _gained(f"{case.name}, {solved.name}", reference)
        for method, sizes in self.models.items():
            methods[method] = {}
            if case.transient and not METHODS[method].transient:
                continue
            for count, rom in sizes.items():
                compared = self._compared(case, rom, method, count, reference, failures)
                if compared is not None:
                    methods[method][count] = compared
        if remedy is None and REMEDY not in self.models:
            with self.books.attempt(f"{case.name}, {REMEDY}"):
                remedy = self._solve_with_inertia(case, methods, reference, failures)
        half_step = None
        with self.books.attempt(f"{case.name}, half the time step"):
            response = self._half_step(case, solved)
            if response is not None and response.energy_gain > MOST_GAIN:
                raise ConvergenceError(gain_message(response.energy_gain))
            half_step = response
        reserve = None
        with self.books.attempt(f"{case.name}, slip reserve"):
            reserve = self._reserve(case)
        result = CaseResult(
            name=case.name,
            kind=case.kind,
            times=self._times(case),
            components=self._components,
            reference=reference,
            methods=methods,
            half_step=half_step,
            half_step_times=None if half_step is None else self._times(case, 2),
            reserve=reserve,
            reference_model=solved.name,
            remedy=remedy,
            tolerance=self._tolerance(case) if case.transient else None,
            jumps=self._jumps(case),
            mesh_errors=self._mesh_errors(case, reference),
        )
        return result, failures

    def _compared(
        self,
        case: LoadCaseSection,
        rom: System,
        method: str,
        count: int,
        reference: Response,
        failures: list[str],
    ) -> MethodResult | None:
        """Solve with a reduced model and compare; None, and a message in failures, if it fails."""
        label = f"{case.name}, {method} with {count} joint modes"
        try:
            response = self._response(case, rom, f"{method}/{count}", reference)
        except ConvergenceError as error:
            failures.append(f"{label}: {error}")
            return None
        failures += _gained(label, response)
        errors = None
        with self.books.timed("comparison"), self.books.attempt(f"{label}, comparison"):
            errors = accuracy(self._components, response, reference)
        if errors is None:
            return None
        certificate = self._certificate(case, response)
        return MethodResult(
            joint_modes=count,
            n_modes=int(rom.K.shape[0]),
            response=response,
            accuracy=errors,
            recovered_error=recovered_error(response, reference),
            dissipation_error=dissipation_error(response, reference),
            certified_energy_error=_bound(certificate, "energy_error"),
            certified_force_error=_bound(certificate, "contact_force_error"),
            certified_bound=_bound(certificate, "max_relative_error"),
        )

    def _solve_with_inertia(
        self,
        case: LoadCaseSection,
        methods: dict[str, dict[int, MethodResult]],
        reference: Response,
        failures: list[str],
    ) -> Remedy | None:
        """Solve again with inertia at the interface where the estimated error is large."""
        first = methods.get(EXACT, {}).get(0)
        if first is None or not self._is_off(first.response, self._tolerance(case)):
            return None
        result = self._compared(case, self._with_inertia, REMEDY, 0, reference, failures)
        if result is None:
            return None
        methods[REMEDY] = {0: result}
        second = (REMEDY, result.response)
        return remedy_of((EXACT, first.response), second, self._tolerance(case))

    @property
    def _with_inertia(self) -> System:
        """The reduced model with inertia at the interface, built once for all load cases.

        Notes
        -----
        It needs about one back-substitution per contact pair, as
        :func:`~faying.reduction.attachment.attachment_modes`.
        """
        if REMEDY in self.models:
            return self.models[REMEDY][0]
        if self.built is None:
            with self.books.stage(SHAPES):
                basis = attachment_modes(self.joint.model, classic=self.classic)
            with self.books.stage(PROJECTION):
                self.built = projected(self.joint.model, basis)
        return self.built

    def _is_off(self, response: Response, tolerance: float) -> bool:
        """Return whether the estimated error of a transient is above the tolerance."""
        allowed, estimate = self.joint.study.reduction.inertia, response.estimate
        return allowed and estimate is not None and estimate.max_relative_error > tolerance

    def _jumps(self, case: LoadCaseSection) -> tuple[Jump, ...]:
        if not case.transient:
            return ()
        period = self.joint.period
        return tuple(load_jumps(case, step=time_step(case, period), period=period))

    def _tolerance(self, case: LoadCaseSection) -> float:
        """Return the tolerance for the estimated pressure error of a transient."""
        default = self.joint.study.reduction.transient_tolerance
        return default if case.tolerance is None else case.tolerance

    def _times(self, case: LoadCaseSection, refinement: int = 1) -> Matrix | None:
        if not case.transient:
            return None
        step = time_step(case, self.joint.period) / refinement
        return step * np.arange(self._steps(case, refinement) + 1, dtype=float)

    def _steps(self, case: LoadCaseSection, refinement: int = 1) -> int:
        step = time_step(case, self.joint.period) / refinement
        return round(time_span(case, self.joint.period) / step)

    def _mesh_errors(self, case: LoadCaseSection, response: Response) -> Mapping[str, MeshError]:
        """Return the estimated mesh errors of the pressures of a response."""
        with self.books.timed("mesh error"), self.books.attempt(f"{case.name}, mesh error"):
            return mesh_errors(self._smoothings, self.joint.model, response.pressure)
        return {}

    @cached_property
    def _components(self) -> dict[str, tuple[str, ...]]:
        """Names of the displacement components of each boundary."""
        return {
            name: tuple(DISPLACEMENT_NAMES[c] for c in boundary.components)
            for name, boundary in self.joint.model.boundaries.items()
        }

    @cached_property
    def _smoothings(self) -> dict[str, SparseMatrix]:
        return smoothings(self.joint.model)

    @cached_property
    def _judge(self) -> Certifier | None:
        with self.books.attempt("certified bounds"):
            return self.joint.certifier
        return None

    def _rest(self, system: System, label: str) -> Solution:
        """Return the preloaded state of a model."""
        if label == "full":
            return self.joint.rest
        if label not in self._rest_states:
            self._rest_states[label] = rest_state(system, self.joint.preload_path, self.joint.rest)
        return self._rest_states[label]

    def _reserve(self, case: LoadCaseSection) -> SlipReserve | None:
        """Return the slip reserve of a static load or cycle with friction; None for others."""
        if not has_reserve(case, self.joint.model):
            return None
        demanded = requirements_of(self.joint.study.requirement)
        open_below = None if demanded.min_opening_factor is None else demanded.open_share

        def compute() -> SlipReserve:
            along = self._path_steps.get(case.name, ())
            with self.books.stage("slip reserve"):
                return reserve_of(self.joint.model, case, self.joint.rest, open_below, along)

        return self.books.value(SlipReserve, f"{case.name} slip reserve", compute)

    def _certificate(self, case: LoadCaseSection, response: Response) -> Certificate | None:
        """Return certified error bounds of a static case without friction; None for others."""
        if case.kind != "static" or response.path is not None:
            return None
        with self.books.timed("certificates"), self.books.attempt(f"{case.name}, bounds"):
            inputs = case_load(case).inputs(self.joint.model, np.zeros(1))[0]
            if self._judge is not None:
                return self._judge.certify_inputs(inputs, response.pressure)
        return None

    def _reference(self, case: LoadCaseSection, *, full: bool) -> Solved:
        """Solve a load case with the reference model."""
        if full and case.transient:
            return Solved(self._full_transient(response_key(case)), self.joint.model, FULL_MODEL)
        if full:
            model = self.joint.model
            return Solved(self._response(case, model, "full"), model, FULL_MODEL)
        first = Solved(
            self._response(case, self.reference.system, REDUCED),
            self.reference.system,
            self.reference.name,
        )
        tolerance = self._tolerance(case)
        if not self._is_off(first.response, tolerance):
            return first
        with self.books.attempt(f"{case.name}, {REMEDY}"):
            system, label = self._with_inertia, f"{REMEDY}/0"
            response = self._response(case, system, label)
            remedy = remedy_of((first.name, first.response), (REMEDY, response), tolerance)
            if remedy.helped:
                return Solved(response, system, REMEDY, label, remedy)
            return replace(first, remedy=remedy)
        return first

    def _half_step(self, case: LoadCaseSection, reference: Solved) -> Response | None:
        """Repeat a transient of the reference with half the time step, if the study asks for it."""
        if self.reference.kind != "full":
            if (
                not (case.transient and self.joint.study.validation.half_step)
                or case.tolerance is not None
            ):
                return None
            return self._response(case, reference.system, reference.label, refinement=2)
        key = response_key(case, refinement=2)
        return self._full_transient(key) if any(key in group for group in self.groups) else None

    def _full_transient(self, key: str) -> Response:
        """Return a transient of the full model, solved together with its group."""
        group = next(group for group in self.groups if key in group)
        runs = list(group.values())
        first, more = runs[0], f" and {len(runs) - 1} more" if len(runs) > 1 else ""
        label = "full" if first.refinement == 1 else "half step"

        def compute() -> list[dict[str, Matrix]]:
            total = self._steps(first.case, first.refinement) * len(runs)
            with self.books.stage(f"{first.case.name}{more} {label}", total) as advance:
                return list(map(flattened, full_transients(self.joint, runs, advance)))

        with self.books.timed("checkpoint"):
            self.books.checkpoint.fill(list(group), compute)
            return restored(Response, self.books.checkpoint.get(key))

    def _response(
        self,
        case: LoadCaseSection,
        system: System,
        label: str,
        like: Response | None = None,
        *,
        refinement: int = 1,
    ) -> Response:
        """Return the response of a model to a load case, solved or read from the checkpoint."""
        model = self.joint.model
        total = self._steps(case, refinement) if case.transient else advances(case, model)
        key = response_key(case, label, refinement)
        reserved = system is model and has_reserve(case, model)

        def compute() -> Response:
            with self.books.stage(f"{case.name} {label}", total) as advance:
                if goes_in_increments(case, model):
                    run = IncrementalCase(
                        case=case,
                        model=model,
                        system=system,
                        preloaded=self._rest(system, label),
                        books=self.books,
                        key=key,
                        progress=advance,
                        led=partial(self._path_steps.__setitem__, case.name) if reserved else len,
                    )
                    response = path_response(run, like)
                else:
                    initial = self._rest(system, label) if case.transient else None
                    solution, seconds = solve_case(
                        self.joint, case, system, advance, refinement, initial, like
                    )
                    drawn = like is None and refinement == 1
                    response = respond(solution, model, seconds, moves=drawn)
            if case.transient and refinement == 1 and isinstance(system, ReducedModel):
                name, recovered = f"{case.name}, {label}", label != REDUCED
                response = judged(self.joint, case, response, solution, name, recovered=recovered)
            return response

        return self.books.value(Response, key, compute)


def _gained(what: str, response: Response) -> list[str]:
    """Return a message if the time integration of a transient added energy."""
    gain = response.energy_gain
    return [f"{what}: {gain_message(gain)}"] if gain > MOST_GAIN else []


def _bound(certificate: Certificate | None, measure: Measure) -> float | None:
    return None if certificate is None else float(certificate.bound(measure))
