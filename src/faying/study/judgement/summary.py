"""The figures of a run in one JSON document, keys as in ``docs/results.md``."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from faying import __version__
from faying.assessment.backbone import Backbone
from faying.assessment.joint_verdict import summarized
from faying.reduction.methods import METHODS
from faying.study.judgement.comparison import backbone_errors, increments, rubbed
from faying.study.judgement.frequency_figures import frequency_figures
from faying.study.judgement.model_warnings import barely_held, missing_contacts
from faying.study.judgement.opening import opening
from faying.study.judgement.remarks import remarks
from faying.study.judgement.step_check import step_check, step_choice
from faying.study.judgement.verdict import run_verdict
from faying.study.keys.measurements import compared
from faying.study.results.mode_choice import chosen_count, mode_sentences
from faying.study.results.path_record import CycleRecord
from faying.study.results.validation_record import ValidationRecord
from faying.study.results.values import CaseResult, InterfaceRecord, MethodResult, Response, Results

TRAINING = ["static training", "step training"]
"""Stages of training."""


def summarize(results: Results) -> dict[str, Any]:
    """Return the contents of ``summary.json``.

    For transients, figures of the reference are the largest over time, and ``iterations`` the
    mean over the steps.
    """
    return {
        "faying": __version__,
        "mark": results.provenance.get("mark", ""),
        "title": results.title,
        "units": results.units,
        "converged": not results.warnings,
        "not_converged": list(results.warnings),
        "warnings": [
            *results.doubts,
            *missing_contacts(results),
            *barely_held(results),
            *results.omissions,
        ],
        "model": {
            "nodes": len(results.nodes),
            "elements": sum(len(block.ids) for block in results.blocks),
            "dofs": results.dofs,
            "mass": results.mass,
            "factorization": results.provenance.get("factorization", ""),
            "factor_bytes": results.factor_bytes,
        },
        "normal_modes": None if results.normal_modes is None else asdict(results.normal_modes),
        "normal_mode_choice": _chosen_modes(results),
        "interfaces": {name: _interface(face) for name, face in results.interfaces.items()},
        "bolts": {
            name: {"preload": bolt.preload, "initial_force": bolt.initial_force}
            for name, bolt in results.bolts.items()
        },
        "reference": {"kind": results.reference, "reason": results.reference_reason},
        "load_cases": {name: _case(results, case) for name, case in results.cases.items()},
        "measurements": {
            curve.name: compared(curve, results.cases[curve.case].reference.backbones)
            for curve in results.measurements
            if curve.case in results.cases
        },
        "frequencies": {
            name: frequency_figures(record) for name, record in results.frequencies.items()
        },
        "assessment": None if results.assessment is None else plain(asdict(results.assessment)),
        "requirements": list(results.study_tables.get("requirement", {})),
        "verdict": plain(summarized(run_verdict(results))),
        "remarks": remarks(results),
        "validation": _validation(results.validation),
        "timings": timings(results),
    }


def plain(value: Any) -> Any:
    """Return values as JSON types; infinite and undefined numbers become null."""
    if isinstance(value, Mapping):
        return {name: plain(member) for name, member in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(member) for member in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, np.integer):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if np.isfinite(value) else None
    return value


def _chosen_modes(results: Results) -> dict[str, Any] | None:
    """Return the chosen normal modes with their reasons; None where the study gave the number."""
    choices = results.mode_choices
    if not choices:
        return None
    said = mode_sentences(choices, results.unit_set)
    return {
        "count": chosen_count(choices),
        "load_cases": {
            name: {**plain(asdict(choice)), "error": plain(choice.error), "reason": reason}
            for (name, choice), reason in zip(choices.items(), said, strict=True)
        },
    }


def _validation(record: ValidationRecord) -> dict[str, Any]:
    summary: dict[str, Any] = {}
    if record.load_space is not None:
        summary["unseen_loads"] = {
            name: {str(count): asdict(errors) for count, errors in sizes.items()}
            for name, sizes in record.load_space.methods.items()
        }
    if record.choices:
        summary["joint_modes"] = {
            name: {"count": choice.count, "met": choice.met, "tolerance": choice.tolerance}
            for name, choice in record.choices.items()
        }
    return summary


def timings(results: Results) -> dict[str, Any]:
    """Return wall seconds of the whole run, by stage, and per method."""
    seconds = results.timings
    table: dict[str, Any] = {"run": sum(seconds.values()), "stages": dict(seconds)}
    full = [(case, case.reference) for case in results.cases.values() if case.is_full]
    table["full"] = _per_solution(full)
    names = dict.fromkeys(name for case in results.cases.values() for name in case.methods)
    methods: dict[str, Any] = {}
    for name in names:
        solved = [
            (case, result.response)
            for case in results.cases.values()
            for result in case.methods.get(name, {}).values()
        ]
        methods[name] = {"offline": _offline(name, seconds), **_per_solution(solved)}
    # A separate mapping, because "compliance" is both a stage and a method.
    return {**table, "methods": methods}


def _offline(name: str, seconds: Mapping[str, float]) -> float:
    """Return the offline seconds of a method without factorization, with all shared stages."""
    method = METHODS[name]
    stages = ["normal_modes", f"project {name}"]
    stages += [method.joint_modes.name] if method.joint_modes else []
    stages += TRAINING if method.trained else []
    stages += ["compliance"] if method.compliance else []
    return sum(seconds.get(stage, 0.0) for stage in stages)


def _per_solution(solved: list[tuple[CaseResult, Response]]) -> dict[str, float]:
    """Return the median wall time of a static case and of a time step [s]."""
    static = [response.seconds for case, response in solved if case.kind == "static"]
    steps = [
        response.seconds / max(len(case.times) - 1, 1)
        for case, response in solved
        if case.times is not None
    ]
    times: dict[str, float] = {}
    if static:
        times["per_static_case"] = float(np.median(static))
    if steps:
        times["per_step"] = float(np.median(steps))
    return times


def _interface(face: InterfaceRecord) -> dict[str, Any]:
    hard = face.penalty == float("inf")
    return {
        "pairs": len(face.pairs),
        "points": len(face.weights),
        "area": float(face.weights.sum()),
        "declared_area": face.declared_area,
        "penalty": "hard" if hard else face.penalty,
        "closure": json.loads(face.closure) if face.closure else None,
        "friction": face.friction,
        "quadrature": face.quadrature,
        "stuck_pairs": int(face.stuck.sum()),
        "preload_open_fraction": float(face.weights[face.preload_pressure <= 0].sum())
        / float(face.weights.sum()),
    }


def _case(results: Results, case: CaseResult) -> dict[str, Any]:
    summary: dict[str, Any] = {
        "kind": case.kind,
        "reference": {
            "model": case.reference_model,
            **_reference(case.reference),
            **_estimated(case.reference),
            "opening": _openings(results, case),
            "mesh_error": {name: asdict(error) for name, error in case.mesh_errors.items()},
        },
        "methods": {
            name: {str(count): _method(result, case) for count, result in sizes.items()}
            for name, sizes in case.methods.items()
        },
    }
    check, choice = step_check(case), step_choice(case)
    if case.times is not None:
        summary["tolerance"] = case.tolerance
        summary["jumps"] = [asdict(jump) for jump in case.jumps]
        summary["steps"] = None if choice is None else {**asdict(choice), "met": choice.met}
        summary["remedy"] = None if case.remedy is None else asdict(case.remedy)
        halved = None if check is None else "half step"
        summary["step_check"] = halved if choice is None else "divided steps"
    summary |= _slip(case)
    if check is not None:
        changes = {name.replace("error", "change"): v for name, v in asdict(check.change).items()}
        del changes["max_pressure_ratio"]
        summary["half_step_max_pressure"] = check.half_peak
        summary["half_step"] = {**changes, "dissipation_change": check.dissipation}
    return summary


def _slip(case: CaseResult) -> dict[str, Any]:
    """Return figures of friction in a load case; empty without friction."""
    records = rubbed(case.reference)
    if case.reference.backbones:
        return {
            "backbones": {
                mode: _backbone(record) for mode, record in case.reference.backbones.items()
            }
        }
    if not records:
        return {}
    largest, cycles = records[-1], list(case.reference.cycles.values())
    increment = -1 if case.kind == "static" else largest.most_slip
    summary: dict[str, Any] = {
        "max_traction": max(record.max_traction for record in records),
        "stick_fraction": float(largest.stick_share[increment]),
        "slip_fraction": float(largest.slip_share[increment]),
        "dissipated_energy": float(largest.dissipation.sum()),
        "macroslip": any(bool(record.macroslip.any()) for record in records),
        "first_slip_factor": None if case.reserve is None else case.reserve.first_slip,
        "slip_onset_factor": None if case.reserve is None else case.reserve.onset,
    }
    if case.reserve is not None:
        summary["slip_reserve"] = asdict(case.reserve)
    if cycles:
        summary["cycles"] = {name: _cycle(record) for name, record in case.reference.cycles.items()}
    return summary


LISTS = (
    "amplitude", "energy", "frequency", "damping_ratio", "linear_damping", "energy_per_cycle",
    "macroslip", "stationary", "masing_frequency", "masing_damping", "masing_deviation",
)  # fmt: skip
"""Quantities of a backbone at each amplitude; some are optional."""


def _backbone(curve: Backbone) -> dict[str, Any]:
    lists = {name: getattr(curve, name) for name in LISTS}
    return {
        "small_frequency": curve.small_frequency,
        "measured_at": curve.measured_at,
        "stick_fraction": curve.stick_share.tolist(),
        "remarks": list(curve.remarks),
        **{name: values.tolist() for name, values in lists.items() if values is not None},
    }


def _cycle(cycle: CycleRecord) -> dict[str, Any]:
    return {
        "energy_per_cycle": float(cycle.energies[-1]),
        "loop_area": cycle.loop_area,
        "cycles": len(cycle.energies),
        "stationary": cycle.stationary,
        "max_slip_range": float(cycle.slip_range.max(initial=0.0)),
        "max_fretting": float(cycle.fretting.max(initial=0.0)),
    }


def _openings(results: Results, case: CaseResult) -> dict[str, Any]:
    """Return the opened area and gap of each interface under the load."""
    openings = {name: opening(record, case) for name, record in results.interfaces.items()}
    return {
        name: {
            "opened_fraction": change.opened,
            "closed_fraction": change.closed,
            "max_gap": change.gap,
            "max_gap_point": change.point.tolist(),
        }
        for name, change in openings.items()
        if change is not None
    }


def _reference(response: Response) -> dict[str, Any]:
    total = sum(np.asarray(force) for force in response.contact_forces.values())
    pressures = [response.pressure, *(values.pressure for values in increments(response))]
    weak = {body: plain(float(np.max(share))) for body, share in response.weak_shares.items()}
    return {
        **({"weak_share": weak} if weak else {}),
        "max_pressure": max(float(values.max(initial=0.0)) for values in pressures),
        "contact_force": float(np.max(total)),
        "open_fraction": float(max(np.max(part) for part in response.open_fraction.values())),
        "max_penetration": float(np.maximum(-response.gap, 0.0).max(initial=0.0)),
        "iterations": float(np.mean(response.iterations)),
        "bolt_force": {name: float(np.max(force)) for name, force in response.bolt_forces.items()},
    }


def _estimated(response: Response) -> dict[str, float]:
    """Return the errors of a reduced transient estimated without a full solution."""
    estimate = response.estimate
    if estimate is None:
        return {}
    told = ("max_relative_error", "rms_relative_error", "max_traction_error")
    return _finite({f"estimated_{name}": getattr(estimate, name) for name in told})


def _method(result: MethodResult, case: CaseResult) -> dict[str, float]:
    backbones = backbone_errors(result.response, case.reference)
    return _finite(
        {
            **asdict(result.accuracy),
            **_estimated(result.response),
            "recovered_max_relative_error": result.recovered_error,
            "certified_energy_error": result.certified_energy_error,
            "certified_force_error": result.certified_force_error,
            "certified_bound": result.certified_bound,
            "certified_increment_error": result.response.increment_error,
            "law_residual": result.response.law_residual,
            "dissipation_error": result.dissipation_error,
            "frequency_error": None if backbones is None else backbones.frequency,
            "damping_error": None if backbones is None else backbones.damping,
        }
    )


def _finite(figures: Mapping[str, float | None]) -> dict[str, float]:
    """Return the figures that are present and finite."""
    return {
        name: value for name, value in figures.items() if value is not None and np.isfinite(value)
    }
