"""Run a study: every method on every load case, next to the full model."""

import json
import platform
import time
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from faying import __version__
from faying._typing import Matrix
from faying.exceptions import ConvergenceError
from faying.model.bodies import bodies
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.model.matrices import mass_properties
from faying.model.model import Model
from faying.model.system import System
from faying.reduction.reduced_model import ReducedModel, reduce
from faying.simulation.accuracy import compare
from faying.simulation.integrators import GeneralizedAlpha, ImplicitEuler, Integrator
from faying.simulation.solution import Solution
from faying.simulation.static import solve_static
from faying.simulation.transient import solve_transient
from faying.study.checkpoint import Checkpoint, open_checkpoint
from faying.study.files import write_text
from faying.study.loads import case_load
from faying.study.offline import PreparedJoint, build_bases, prepare_joint, reduced_models
from faying.study.progress import ProgressBar, Stages
from faying.study.results import (
    BoltRecord,
    CaseResult,
    InterfaceRecord,
    MethodResult,
    Response,
    Results,
)
from faying.study.store import write_results
from faying.study.summary import summarize
from faying.study.tables import LoadCaseSection, Study
from faying.study.timing import time_span, time_step

Models = Mapping[str, Mapping[int, ReducedModel]]


@dataclass(frozen=True, eq=False, kw_only=True)
class RunSummary:
    """Outcome of a run.

    Attributes
    ----------
    converged
        Whether every solution was found.
    summary
        Contents of ``summary.json``.
    """

    converged: bool
    summary: Mapping[str, Any]


def run(
    study: Study, out: Path, *, resume: bool = False, progress: ProgressBar | None = None
) -> RunSummary:
    """Compute a study and leave its results in a folder.

    Parameters
    ----------
    out
        Receives ``results.h5``, ``summary.json``, ``study.toml``, interface and report files.
    resume
        Take over what an interrupted run of the same study has finished.

    Raises
    ------
    FayingError
        If the study, its model or its loads do not fit together. Solutions that do not converge
        are recorded instead.
    """
    out.mkdir(parents=True, exist_ok=True)
    checkpoint = open_checkpoint(out, study.text, resume=resume)
    stages = Stages(progress)
    joint = prepare_joint(study, stages)
    models = reduced_models(
        study, joint.model, build_bases(study, joint, stages, checkpoint), stages
    )
    failures: list[str] = []
    cases = {
        case.name: _solve_case(case, joint, models, stages, checkpoint, failures)
        for case in study.load_cases
    }
    results = _results(study, joint, cases, stages, failures)
    write_results(results, out / "results.h5")
    summary = summarize(results)
    write_text(out / "summary.json", json.dumps(summary, indent=2) + "\n")
    write_text(out / "study.toml", study.text)
    _write_report(study, results, out, stages)
    checkpoint.discard()
    return RunSummary(converged=not failures, summary=summary)


def integrator_of(case: LoadCaseSection) -> Integrator:
    """Return the integrator of a transient load case; the seed's implicit Euler by default."""
    if case.integrator != "generalized-alpha":
        return ImplicitEuler()
    return GeneralizedAlpha() if case.rho_infinity is None else GeneralizedAlpha(case.rho_infinity)


def _solve_case(
    case: LoadCaseSection,
    joint: PreparedJoint,
    models: Models,
    stages: Stages,
    checkpoint: Checkpoint,
    failures: list[str],
) -> CaseResult:
    """Solve one load case with the full model and with every reduced one."""
    reference = _solved(case, joint, joint.model, "full", stages, checkpoint)
    methods: dict[str, dict[int, MethodResult]] = {}
    for name, sizes in models.items():
        methods[name] = {}
        for count, rom in sizes.items():
            try:
                solved = _solved(case, joint, rom, f"{name}/{count}", stages, checkpoint)
            except ConvergenceError as error:
                failures.append(f"load case {case.name}, {name} with {count} joint modes: {error}")
                continue
            methods[name][count] = MethodResult(
                joint_modes=count,
                n_modes=len(rom.basis),
                response=solved.response,
                accuracy=compare(solved.solution, reference.solution),
            )
    half = _half_step(case, joint, models, stages, checkpoint)
    return CaseResult(
        name=case.name,
        kind=case.kind,
        times=reference.solution.times,
        components={
            name: tuple(DISPLACEMENT_NAMES[c] for c in boundary.components)
            for name, boundary in joint.model.boundaries.items()
        },
        reference=reference.response,
        methods=methods,
        half_step=half.response if half else None,
        half_step_times=half.solution.times if half else None,
    )


@dataclass(frozen=True, eq=False)
class _Solved:
    solution: Solution
    response: Response


def _solved(
    case: LoadCaseSection,
    joint: PreparedJoint,
    system: System,
    label: str,
    stages: Stages,
    checkpoint: Checkpoint,
    refinement: int = 1,
) -> _Solved:
    """Solve a load case with one model, or take the solution an interrupted run left."""
    load = case_load(case)
    step = time_step(case, joint.period) / refinement
    span = time_span(case, joint.period)
    total = 1 if case.kind == "static" else round(span / step)

    def compute() -> dict[str, Matrix]:
        with stages.stage(f"{case.name} {label}", total) as advance:
            start = time.perf_counter()
            if case.kind == "static":
                solution = solve_static(system, load)
            else:
                solution = solve_transient(
                    system,
                    load,
                    step=step,
                    duration=span,
                    integrator=integrator_of(case),
                    progress=advance,
                )
            return _packed(solution, time.perf_counter() - start)

    kept = checkpoint.bundle(f"{case.name} {label} {refinement}", compute)
    solution = _unpacked(case.name, system, kept)
    return _Solved(solution, _response(solution, joint.model, float(kept["seconds"])))


def _packed(solution: Solution, seconds: float) -> dict[str, Matrix]:
    arrays = {
        "states": solution.states,
        "contact_forces": solution.contact_forces,
        "gap": solution.gap,
        "inputs": solution.inputs,
        "iterations": solution.iterations,
        "seconds": np.array(seconds),
    }
    if solution.times is not None:
        arrays["times"] = solution.times
    return arrays


def _unpacked(name: str, system: System, kept: Mapping[str, Matrix]) -> Solution:
    return Solution(
        name=name,
        system=system,
        states=kept["states"],
        contact_forces=kept["contact_forces"],
        gap=kept["gap"],
        inputs=kept["inputs"],
        iterations=np.asarray(kept["iterations"], dtype=np.int64),
        times=kept.get("times"),
    )


def _half_step(
    case: LoadCaseSection,
    joint: PreparedJoint,
    models: Models,
    stages: Stages,
    checkpoint: Checkpoint,
) -> _Solved | None:
    """Repeat a transient with half the time step, on a reduced model with exact compliance."""
    if case.kind == "static":
        return None
    if "compliance" in models:
        system = models["compliance"][0]
    else:
        first = next(iter(next(iter(models.values())).values()))
        system = reduce(joint.model, first.basis.with_joint_modes(0), compliance=True)
    return _solved(case, joint, system, "half step", stages, checkpoint, refinement=2)


def _response(solution: Solution, model: Model, seconds: float) -> Response:
    static = solution.times is None
    return Response(
        pressure=solution.pressure,
        gap=solution.gap,
        displacements={name: solution.displacement(name) for name in model.boundaries},
        bolt_forces={name: np.asarray(solution.bolt_force(name)) for name in model.bolts},
        contact_forces={name: solution.contact_force(name) for name in model.interfaces},
        open_fraction={name: solution.open_fraction(name) for name in model.interfaces},
        iterations=solution.iterations,
        seconds=seconds,
        nodal_displacement=(
            model.dofs.nodal(solution.full_displacement())[:, :3] if static else None
        ),
    )


def _results(
    study: Study,
    joint: PreparedJoint,
    cases: Mapping[str, CaseResult],
    stages: Stages,
    failures: list[str],
) -> Results:
    model, mesh = joint.model, joint.model.assembly.mesh
    history = joint.tightening.bolt_forces
    return Results(
        title=study.title or study.path.stem,
        units=model.units,
        study_text=study.text,
        nodes=mesh.nodes,
        node_ids=mesh.node_ids,
        body=bodies(mesh),
        blocks=mesh.blocks,
        mass=mass_properties(model.assembly).mass,
        dofs=model.structure.n_dof,
        interfaces={name: _interface_record(joint, name) for name in model.interfaces},
        bolts={
            name: BoltRecord(
                preload=joint.loaded.preloads[name],
                initial_force=bolt.initial_force,
                history=history[:, joint.tightening.bolts.index(name)],
            )
            for name, bolt in model.bolts.items()
        },
        tightening_stages=joint.tightening.stages,
        cases=cases,
        timings=dict(stages.seconds),
        provenance={
            "faying": __version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
            "platform": platform.platform(),
            "factorization": model.structure.interior_factor.backend,
            "date": datetime.now(UTC).isoformat(timespec="seconds"),
        },
        warnings=tuple(failures),
    )


def _interface_record(joint: PreparedJoint, name: str) -> InterfaceRecord:
    interface = joint.model.interfaces[name]
    points = joint.model.contact.slices[name]
    nodes = joint.model.assembly.mesh.nodes
    return InterfaceRecord(
        points=interface.points,
        normals=interface.normals,
        weights=interface.weights,
        initial_gap=interface.initial_gap,
        slice=(points.start, points.stop),
        pairs=interface.pairs,
        pair_points=nodes[interface.pairs].mean(axis=1),
        averaging=interface.nodal_average(np.eye(interface.n_points)).T,
        faces=interface.faces,
        penalty=interface.penalty,
        quadrature=interface.quadrature,
        stuck=joint.model.stuck.get(name, np.zeros(len(interface.pairs), dtype=bool)),
        preload_pressure=joint.preload.pressure[points],
    )


def _write_report(study: Study, results: Results, out: Path, stages: Stages) -> None:
    from faying.io.vtu import write_interface_vtu

    write_interface_vtu(results, out)
    if study.output.report:
        from faying.report.html import write_report

        with stages.stage("report"):
            write_report(results, out)
