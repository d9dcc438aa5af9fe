"""Errors of responses of reduced models against the full model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Matrix
from faying.assessment.accuracy import Accuracy, measure, traction_error
from faying.assessment.joint_record import CaseState
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.study.results.path_record import PathRecord, SlipRecord
from faying.study.results.values import CaseResult, Response


def accuracy(
    components: Mapping[str, Sequence[str]], response: Response, reference: Response
) -> Accuracy:
    """Return errors of pressures, tractions and displacements, over all increments of paths.

    ``components`` names the displacement components of each boundary.
    """
    mine, exact = increments(response), increments(reference)
    pressures = [response.pressure, reference.pressure]
    if mine:
        pressures = [np.concatenate([record.pressure for record in path]) for path in (mine, exact)]
    errors = measure(
        pressures[0],
        pressures[1],
        [
            (
                _displacements(response, name),
                _displacements(reference, name),
                np.array([DISPLACEMENT_NAMES.index(component) for component in names]),
            )
            for name, names in components.items()
        ],
    )
    tractions = [
        [record.traction for record in rubbed(solution)] for solution in (response, reference)
    ]
    return replace(errors, max_traction_error=traction_error(*tractions))


def increments(response: Response) -> list[PathRecord]:
    """Return the increments of a response: of its path, or of the last cycle per amplitude."""
    if response.path is not None:
        return [response.path]
    return [cycle.increments for cycle in response.cycles.values()]


def state_of_case(case: CaseResult) -> CaseState:
    """Return the states of a load case to judge: all instants, or all increments of its paths."""
    response, paths = case.reference, increments(case.reference)
    # The response of a path holds its last increment alone.
    parts: Sequence[PathRecord | Response] = paths or [response]
    return CaseState(
        pressure=np.concatenate([np.atleast_2d(part.pressure) for part in parts]),
        bolt_forces={
            name: np.concatenate([np.atleast_1d(part.bolt_forces[name]) for part in parts])
            for name in response.bolt_forces
        },
        retightened=any(
            name in response.bolt_forces and (record.factors[:, column] != 1).any()
            for record in paths
            for column, name in enumerate(record.loads)
        ),
        times=case.times,
        bolt_moments={
            name: np.concatenate([part.bolt_moments[name].reshape(-1, 2, 2) for part in parts])
            for name in response.bolt_moments
        },
    )


def rubbed(response: Response) -> Sequence[SlipRecord]:
    """Return the slip records of a response, of increments or of instants."""
    return [*increments(response), *filter(len, [response.friction])]


def _displacements(response: Response, boundary: str) -> Matrix:
    records = increments(response)
    if not records:
        return response.displacements[boundary]
    return np.concatenate([record.displacements[boundary] for record in records])


def dissipation_error(response: Response, reference: Response) -> float | None:
    """Return the relative error of the energy dissipated by friction; None if that is zero."""
    mine, exact = (
        float(sum(record.dissipation.sum() for record in rubbed(solution)))
        for solution in (response, reference)
    )
    return abs(mine - exact) / exact if exact > 0 else None


def recovered_error(response: Response, reference: Response) -> float | None:
    """Return the largest relative error of pressures recovered from a motion."""
    if response.recovered_pressure is None:
        return None
    return measure(response.recovered_pressure, reference.pressure, []).max_relative_error


@dataclass(frozen=True, kw_only=True)
class BackboneErrors:
    """Largest relative errors of backbones over modes and amplitudes.

    Attributes
    ----------
    frequency, damping
        Relative errors of frequencies and damping ratios.
    """

    frequency: float
    damping: float


def backbone_errors(response: Response, reference: Response) -> BackboneErrors | None:
    """Return the backbone errors of a response; None where there are no backbones."""
    frequency, damping = [], []
    for mode, exact in reference.backbones.items():
        mine = response.backbones[mode]
        frequency.append(np.abs(mine.frequency / exact.frequency - 1).max())
        damped = exact.damping_ratio > 0
        off = np.abs(mine.damping_ratio - exact.damping_ratio)[damped] / exact.damping_ratio[damped]
        damping.append(off.max(initial=0.0))
    if not frequency:
        return None
    return BackboneErrors(frequency=float(max(frequency)), damping=float(max(damping)))
