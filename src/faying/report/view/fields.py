"""What a report shows on the contact faces, in the order in which it is kept if room is short."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix
from faying.report.style import label
from faying.report.view.frames import Frames
from faying.study.comparison import increments
from faying.study.interface_surface import nodal_average
from faying.study.results import CaseResult, Response, Results


@dataclass(frozen=True, eq=False, kw_only=True)
class Field:
    """A field of one load case and model.

    Attributes
    ----------
    case, model
        Their numbers in the view.
    name
        ``"pressure"``, ``"gap"``, ``"slip"`` or ``"displacement"``.
    at
        Numbers of the frames it is known in.
    values
        Returns the values, (n_pair, n_frame) as nodal averages of all interfaces one after the
        other; of displacements (n, 3) at the nodes of the outer surface.
    """

    case: int
    model: int
    name: str
    at: tuple[int, ...]
    values: Callable[[], Matrix]


def models(case: CaseResult) -> list[tuple[str, Response]]:
    """Return the models that solved a load case by what people call them, the reference first."""
    found = [(case.reference_model, case.reference)]
    for method, sizes in case.methods.items():
        found += [(label(method, n), sizes[n].response) for n in sorted(sizes, reverse=True)]
    return found


def fields(results: Results, frames_of: dict[str, Frames], nodes: Indices) -> Iterator[Field]:
    """Yield the fields of a run: first what the references found, then the methods.

    Parameters
    ----------
    frames_of
        By load case.
    nodes
        Those of the outer surface.
    """
    every = [
        (number, place, list(fields_of_response(results, response, frames_of[name], nodes)))
        for number, (name, case) in enumerate(results.cases.items())
        for place, (_, response) in enumerate(models(case))
    ]
    for wanted in (("pressure",), ("gap", "slip"), ("displacement",)):
        for references in (True, False):
            for number, place, found in every:
                for name, at, values in found:
                    if name in wanted and (place == 0) is references:
                        yield Field(case=number, model=place, name=name, at=at, values=values)


def fields_of_response(
    results: Results, response: Response, frames: Frames, nodes: Indices
) -> Iterator[tuple[str, tuple[int, ...], Callable[[], Matrix]]]:
    """Yield name, frames and values of the fields of a response."""
    everywhere, last = tuple(range(len(frames.chosen))), (len(frames.chosen) - 1,)
    found = increments(response)
    if found:
        path = found[-1]
        yield "pressure", everywhere, lambda: averages(results, path.pressure[frames.chosen])
        yield "gap", last, lambda: averages(results, response.gap[None])
        if any(record.friction > 0 for record in results.interfaces.values()):
            slip = path.slip[frames.chosen]
            yield "slip", everywhere, lambda: averages(results, np.linalg.norm(slip, axis=-1))
    else:
        of_time = response.pressure.ndim > 1
        chosen = frames.chosen if of_time else slice(None)
        pressure, gap = (
            np.atleast_2d(values)[chosen] for values in (response.pressure, response.gap)
        )
        yield "pressure", everywhere, lambda: averages(results, pressure)
        yield "gap", everywhere, lambda: averages(results, gap)
    moved = response.nodal_displacement
    if moved is not None:
        yield "displacement", last, lambda: moved[nodes]


def averages(results: Results, values: Matrix) -> Matrix:
    """Return nodal averages (n_pair, n_frame) of values (n_frame, n_point), all interfaces."""
    parts = [nodal_average(record, values) for record in results.interfaces.values()]
    return np.concatenate([*parts, np.empty((len(values), 0))], axis=1).T
