"""How far the response of a reduced model is from that of the full one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix
from faying.assessment.accuracy import Accuracy, measure, traction_error
from faying.joint.model import Model
from faying.study.results.path_record import PathRecord
from faying.study.results.slip_record import SlipRecord
from faying.study.results.values import Response


def accuracy(model: Model, response: Response, reference: Response) -> Accuracy:
    """Measure the errors of pressures and boundary displacements, of paths in every increment."""
    mine, exact = increments(response), increments(reference)
    if mine:
        pressures = [np.concatenate([one.pressure for one in path]) for path in (mine, exact)]
    else:
        pressures = [response.pressure, reference.pressure]
    displacements = [
        (_displacements(response, name), _displacements(reference, name), boundary.components)
        for name, boundary in model.boundaries.items()
    ]
    return measure(pressures[0], pressures[1], displacements)


def increments(response: Response) -> list[PathRecord]:
    """Return what a response has of increments: a path, or the last cycle of each amplitude."""
    if response.path is not None:
        return [response.path]
    return [one.increments for one in response.cycles.values()]


def rubbed(response: Response) -> Sequence[SlipRecord]:
    """Return what friction did in a response: in its increments, or at its instants."""
    return increments(response) if response.friction is None else [response.friction]


def _displacements(response: Response, boundary: str) -> Matrix:
    found = increments(response)
    if not found:
        return response.displacements[boundary]
    return np.concatenate([one.displacements[boundary] for one in found])


@dataclass(frozen=True, kw_only=True)
class SlipErrors:
    """Errors that only friction has, as fractions; None where nothing rubs or slips.

    Attributes
    ----------
    traction
        Largest difference of tractions over points and increments or instants, over the largest.
    dissipation
        Difference of the energies that friction took, over that of the full model.
    """

    traction: float | None
    dissipation: float | None


def slip_errors(response: Response, reference: Response) -> SlipErrors:
    """Compare tractions and energies of two responses to the same path or load over time."""
    mine, exact = rubbed(response), rubbed(reference)
    energy = _energy(exact)
    tractions = [[one.traction for one in path] for path in (mine, exact)]
    return SlipErrors(
        traction=traction_error(*tractions),
        dissipation=abs(_energy(mine) - energy) / energy if energy > 0 else None,
    )


def _energy(path: Sequence[SlipRecord]) -> float:
    return float(sum(one.dissipation.sum() for one in path))


def recovered_error(response: Response, reference: Response) -> float | None:
    """Return the largest relative error of pressures recovered from a motion."""
    if response.recovered_pressure is None:
        return None
    return measure(response.recovered_pressure, reference.pressure, []).max_relative_error
