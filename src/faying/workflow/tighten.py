"""Tightening plans of studies."""

from collections.abc import Mapping
from pathlib import Path

from faying.assessment.strength.thread import tightening_stress
from faying.assessment.strength.tightening import force_of_torque
from faying.exceptions import refuse_study
from faying.files.csv_rows import write_rows
from faying.linalg.threads import one_thread
from faying.simulation.tightening_plan import TighteningPlan, tightening_plan
from faying.study.inputs.load_model import build_loaded, check_interfaces, load_model
from faying.study.keys.tables import Study
from faying.study.keys.threads import StudyBolts, thread_of
from faying.study.stages.books import Books, ProgressBar
from faying.study.stages.offline import joint_while_tightened


@one_thread()
def plan_of_study(
    study: Study, *, passes: int = 1, progress: ProgressBar | None = None
) -> TighteningPlan:
    """Return a plan that tightens a study's bolts to their preloads in the order of the study.

    Parameters
    ----------
    passes
        Number of rounds, as in :func:`faying.tightening_plan`.

    Raises
    ------
    FayingError
        If study and model do not fit together, no bolt has a preload, or no plan meets the targets.
    """
    books = Books(progress)
    with books.stage("assembly"):
        loaded = load_model(study)
        check_interfaces(study, loaded)
        targets = {name: force for name, force in loaded.preloads.items() if force > 0}
        if not targets:
            refuse_study(f"{study.path.name}: no bolt has a preload; give one")
        model = build_loaded(loaded).with_bolt_forces(loaded.initial_forces)
    with books.stage("compliance"):
        _ = model.static_contact
    with books.stage("tightening"):
        joint = joint_while_tightened(study, model)
        return tightening_plan(joint, targets, passes=passes)


def torques_per_force(study: Study) -> dict[str, float]:
    """Return M_A / F_M [length] of the bolts with known size and friction in thread and head."""
    threads = {bolt.name: thread_of(bolt, study.units) for bolt in study.bolts}
    return {
        name: 1.0 / force_of_torque(thread, 1.0)
        for name, thread in threads.items()
        if thread is not None
        and None not in (thread.friction, thread.head_friction, thread.head_diameter)
    }


def overstressed(study: Study, plan: TighteningPlan) -> dict[str, float]:
    """Return the bolts that yield while tightened, with stress over yield stress."""
    largest: dict[str, float] = {}
    for bolt, setting in zip(plan.turned, plan.settings.tolist(), strict=True):
        largest[bolt] = max(setting, largest.get(bolt, 0.0))
    threads = StudyBolts.of(study).threads
    used = {
        bolt: tightening_stress(threads[bolt], setting)
        / threads[bolt].strengths(study.units).yields
        for bolt, setting in largest.items()
        if bolt in threads
    }
    return {bolt: share for bolt, share in used.items() if share > 1}


def write_plan(plan: TighteningPlan, path: Path, torques: Mapping[str, float]) -> None:
    """Write a plan as csv, one row per turn with the forces of all bolts after it.

    Torques per force [length] are given by bolt; bolts without one get an empty cell.
    """
    header = ["turn", "pass", "bolt", "tighten to", "share of preload", "torque"]
    rows: list[list[object]] = [[*header, *(f"{name} after" for name in plan.bolts)]]
    columns = (plan.passes, plan.turned, plan.settings, plan.shares, plan.bolt_forces)
    for turn, (of_pass, bolt, setting, share, forces) in enumerate(zip(*columns, strict=True), 1):
        torque = setting * torques[bolt] if bolt in torques else ""
        rows.append([turn, of_pass, bolt, setting, share, torque, *forces])
    write_rows(path, rows)
