"""The offline part of a run: model, preload, bases, reduced models."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from hashlib import blake2b
from typing import Any

import numpy as np

from faying._typing import Matrix
from faying.assessment.certificate import Certifier, certifier
from faying.assessment.choose_joint_modes import JointModeChoice, choose_joint_modes
from faying.assessment.stuck_modes import preloaded_frequencies
from faying.exceptions import refuse_study
from faying.execution.checkpoint import Bundles
from faying.joint.model import Model
from faying.joint.smooth_joint import smooth_joint
from faying.joint.structure import Structure
from faying.joint.system import Joint, System
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.craig_bampton import classic_basis
from faying.reduction.method import CLASSIC, Method, OfflineData
from faying.reduction.methods import METHODS
from faying.reduction.mode_count import ModeCount, check_modes
from faying.reduction.normal_modes import NormalModes
from faying.reduction.projection import projected
from faying.reduction.snapshots import static_snapshots
from faying.simulation.load import Load
from faying.simulation.path import last_of, solve_static
from faying.simulation.preload import Sticking, with_sticking
from faying.simulation.preload_loss import PreloadLoss
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import arrays_of
from faying.simulation.stepping import TransientSolver, transient_solver
from faying.simulation.tightening import Tightening, tighten, tightened_joint
from faying.study.inputs.bolts import losses
from faying.study.inputs.load_model import LoadedModel, build_loaded, check_interfaces, load_model
from faying.study.inputs.loads import check_loads, is_trained, time_step, training_box
from faying.study.keys.tables import Study
from faying.study.stages.books import Books
from faying.study.stages.path_cases import rest_state
from faying.study.stages.training import StepTraining, step_groups, step_loads

Models = Mapping[str, Mapping[int, System]]
"""Reduced models by method and number of joint modes."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PreparedJoint:
    """The tightened joint of a study with its sticking area.

    Attributes
    ----------
    study
        Study of the joint.
    books
        Books of the run.
    loaded
        Loaded model description.
    model
        Model with locked bolts.
    tightening
        Tightening of the bolts, before the sticking area was tied.
    preload
        Static state after this tightening (Fig. 15.3).
    rest
        Static state of the model with locked bolts, where transients start.
    preload_path
        Loads that tightened the bolts with friction; empty if without friction.
    """

    study: Study
    books: Books
    loaded: LoadedModel
    model: Model
    tightening: Tightening
    preload: Solution
    rest: Solution
    preload_path: tuple[Load, ...] = ()

    @cached_property
    def period(self) -> float:
        """Longest period of small vibrations about the preloaded state; infinite without mass."""
        if not self.model.structure.has_mass:
            return np.inf
        with self.books.stage("frequencies"):
            return 1.0 / float(preloaded_frequencies(self.model, 1, state=self.rest)[0])

    @cached_property
    def certifier(self) -> Certifier:
        """Certifier of static load cases, factorized once for all of them."""
        return certifier(self.model)


def assembled(study: Study) -> tuple[LoadedModel, Model]:
    """Return the loaded source of a study, and its model before tightening.

    Raises
    ------
    ModelError
        As :func:`prepare_joint`.
    """
    loaded = load_model(study)
    check_interfaces(study, loaded)
    return loaded, build_loaded(loaded).with_bolt_forces(loaded.initial_forces)


def prepare_joint(
    study: Study, books: Books | None = None, built: tuple[LoadedModel, Model] | None = None
) -> PreparedJoint:
    """Build the model, tighten its bolts and tie the sticking area (§15.4.2).

    Bolt forces and states are read from the checkpoint of the run's books if present. ``built`` is
    what :func:`assembled` returned, where that was needed before.

    Raises
    ------
    ModelError
        If a body has no support; the message names it.
    """
    books = books or Books()
    checkpoint = books.checkpoint
    with books.stage("assembly"):
        loaded, model = built or assembled(study)
        check_loads(study, model)
        _ = model.K  # formed here so that its time counts in this stage
        check_same_joint(checkpoint, model)
    _condense(model, books, "compliance")
    forces = {name: force for name, force in loaded.preloads.items() if force > 0}
    # The nominal preload determines what sticks, losses come after.
    lost = (losses(study), {}) if study.sticking is None else ({}, losses(study))
    first = "rest" if study.sticking is None else "preload"
    with books.stage("preload"):
        keep = partial(kept_state, checkpoint, first, model)
        compute = partial(_tightened, study, model, forces, lost[0], keep)
        tightening = books.value(Tightening, "tightening", compute)
        path = tightening.loads if study.friction_during_preload else ()
        locked = model.with_bolt_forces(tightening.initial_forces)
        state = kept_state(checkpoint, first, locked, lambda: rest_state(locked, path))
    model, preloaded = locked, state
    if study.sticking is not None:
        sticking = Sticking(threshold=study.sticking.threshold, stiffness=study.sticking.stiffness)
        tied = with_sticking(model, sticking)
        _condense(tied, books, "compliance of tied parts")
        with books.stage("preload"):
            compute_again = partial(tighten, tied, forces, losses=lost[1])
            again = books.value(Tightening, "tightening again", compute_again)
            model = final = tied.with_bolt_forces(again.initial_forces)
            preloaded = kept_state(checkpoint, "rest", final, lambda: solve_static(final))
    return PreparedJoint(
        study=study,
        books=books,
        loaded=loaded,
        model=model,
        tightening=tightening,
        preload=state,
        rest=preloaded,
        preload_path=path,
    )


def _tightened(
    study: Study,
    model: Model,
    forces: Mapping[str, float],
    lost: Mapping[str, PreloadLoss],
    keep: Callable[[Callable[[], Solution]], Solution],
) -> Tightening:
    tight = tightened_joint(joint_while_tightened(study, model), forces, losses=lost)
    # Stored before the path, which need not be followed a second time.
    keep(lambda: last_of(tight.rest(model)))
    return tight.tightening


def joint_while_tightened(study: Study, joint: Joint) -> Joint:
    """Return the joint during tightening, with or without friction."""
    return joint if study.friction_during_preload else smooth_joint(joint)


def _condense(model: Model, books: Books, key: str) -> None:
    """Factorize the structure and form its interface compliance, which it stores."""
    with books.stage("factorization"):
        _ = model.structure.boundary_factor
    with books.stage("compliance"):
        keep_compliance(books.checkpoint, key, model.structure)
        _ = model.static_contact.increments


@dataclass(frozen=True, eq=False, kw_only=True)
class TrainedBases:
    """The bases of the methods of a study.

    Attributes
    ----------
    bases
        The basis :data:`CLASSIC`, and the bases of methods by the name of their joint modes.
    contact_forces : (n_point, n_snapshot) [force]
        Contact forces of the training runs; no snapshot if no method is trained.
    mode_count
        Count that proves that no normal mode is missing.
    """

    bases: Mapping[str, Basis]
    contact_forces: Matrix
    mode_count: ModeCount | None

    def of(self, method: Method) -> Basis:
        """Return the longest basis of a method."""
        return self.bases[method.basis_name]


def build_bases(joint: PreparedJoint, modes: NormalModes) -> TrainedBases:
    """Build the bases of the methods of a study, with training where a method needs it.

    Raises
    ------
    ConvergenceError
        If a normal mode is missing.
    """
    reduction, model, books = joint.study.reduction, joint.model, joint.books
    count = max(reduction.joint_modes, default=MOST_AUTOMATIC)
    with books.stage("normal_modes"):
        classic = classic_basis(model, modes)
    with books.stage("mode_count"):
        mode_count = check_modes(model.structure, modes)
    forces = np.zeros((model.contact.n_points, 0))
    if is_trained(joint.study):
        forces = _training_forces(joint, classic)
    data = OfflineData(
        classic=classic,
        contact_forces=forces,
        subareas=reduction.training.subareas or DEFAULT_SUBAREAS,
        weight=reduction.training.weight,
    )
    bases = {CLASSIC: classic}
    for joint_modes in dict.fromkeys(METHODS[name].joint_modes for name in reduction.methods):
        if joint_modes is not None:
            with books.stage(joint_modes.name):
                bases[joint_modes.name] = joint_modes.extended(model, data, count)
    return TrainedBases(bases=bases, contact_forces=forces, mode_count=mode_count)


MOST_AUTOMATIC = 60
"""Largest automatic number of joint modes."""

AUTOMATIC_LOADS = 30
"""Random loads of the training box at which an automatic number is certified."""

DEFAULT_SUBAREAS = 200
"""Test loads of method A: far more than the 40 modes of the default study need."""


def _training_forces(joint: PreparedJoint, classic: Basis) -> Matrix:
    """Return the contact forces of the training runs of method B, Eq. (15.30)."""
    training, model, books = joint.study.reduction.training, joint.model, joint.books
    with books.stage("static training"):
        box = training_box(training)
        snapshots = [static_snapshots(model, box.static_loads(model))]
        steps = step_training(joint, classic)
    with books.stage("step training", len(step_loads(training)) * steps.n_steps) as advance:
        for group in step_groups(training):
            compute = partial(steps.forces, list(group.values()), advance)
            books.checkpoint.fill(list(group), compute)
            snapshots += [books.checkpoint.get(key)["forces"] for key in group]
    return np.hstack(snapshots)


def step_training(joint: PreparedJoint, classic: Basis | None) -> StepTraining:
    """Return the training steps of a study; a reduced training model needs a basis."""
    training, model = joint.study.reduction.training, joint.model

    def solver() -> TransientSolver:
        reduced = training.system == "reduced" and classic is not None
        system = projected(model, classic, compliance=True) if reduced and classic else model
        return transient_solver(system, step=time_step(training, joint.period))

    preloaded = joint.rest if training.system == "full" else None
    return StepTraining(training=training, period=joint.period, solver=solver, rest=preloaded)


def choose_counts(joint: PreparedJoint, trained: TrainedBases) -> dict[str, JointModeChoice]:
    """Return the chosen number of joint modes of each basis; empty if the study gives them."""
    reduction, model = joint.study.reduction, joint.model
    if reduction.joint_modes:
        return {}
    loads = training_box(reduction.training).random_loads(model, AUTOMATIC_LOADS, seed=2)
    with joint.books.stage("choose joint modes"):
        return {
            name: choose_joint_modes(model, basis, loads, reduction.tolerance)
            for name, basis in trained.bases.items()
            if basis.count(ModeKind.JOINT)
        }


def reduced_models(
    joint: PreparedJoint, trained: TrainedBases, choices: Mapping[str, JointModeChoice]
) -> dict[str, dict[int, System]]:
    """Return the reduced models of all methods of a study at all numbers of joint modes."""
    models: dict[str, dict[int, System]] = {}
    for name in joint.study.reduction.methods:
        with joint.books.stage(f"project {name}"):
            method, choice = METHODS[name], choices.get(METHODS[name].basis_name)
            basis, forces = trained.of(method), trained.contact_forces
            counts = [choice.count] if choice else joint.study.reduction.joint_modes
            models[name] = {
                count: method.reduced(joint.model, basis, forces, count)
                for count in method.counts(basis, counts)
            }
    return models


def joint_mark(model: Model) -> str:
    """Return a hash of the matrices, contact and bolts of a joint."""
    contact, digest = model.contact, blake2b(digest_size=16)
    arrays = [model.K.data, model.K.indices, model.M.data, contact.interpolation.data]
    arrays += [contact.weights, contact.initial_gap, model.pattern_forces]
    arrays += [bolt.elongation for bolt in model.bolts.values()]
    for array in arrays:
        digest.update(array.tobytes())
    return f"{digest.hexdigest()} {dict(contact.laws)}"


def check_same_joint(checkpoint: Bundles, model: Model) -> None:
    """Refuse to resume with results of another joint: a deck may have changed since."""
    mark = np.array(joint_mark(model))
    if checkpoint.bundle("joint", lambda: {"mark": mark})["mark"] != mark:
        refuse_study(
            "the interrupted run computed another joint: a deck, mesh or matrix of the "
            "study has changed since; run without --resume to start afresh"
        )


def keep_compliance(checkpoint: Bundles, key: str, structure: Structure) -> None:
    """Give a structure its stored compliance or stiffness between pairs, or compute and store it.

    Without effect if there are too many pairs for a matrix.
    """
    if not structure.is_kept_whole:
        return

    def arrays() -> dict[str, Matrix]:
        if structure.held_stiffness is not None:
            return {"held_stiffness": structure.held_stiffness}
        return {"held_compliance": np.asarray(structure.held_compliance)}

    for name, matrix in checkpoint.bundle(key, arrays).items():
        structure.take_held(name, matrix)


def kept_state(
    checkpoint: Bundles, key: str, system: System, compute: Callable[[], Solution]
) -> Solution:
    """Return a static state of a joint, stored under a key or computed."""

    def arrays() -> dict[str, Matrix]:
        state = compute()
        return {"name": np.array(state.name), **arrays_of(state)}

    members: dict[str, Any] = {
        name: value[()] for name, value in checkpoint.bundle(key, arrays).items()
    }
    return Solution(name=str(members.pop("name")), system=system, **members)
