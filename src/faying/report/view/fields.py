"""Fields on the contact faces of the view, in order of priority if room is short."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from faying._typing import Indices, Matrix
from faying.interface.surface import nodal_average
from faying.report.style import label
from faying.study.judgement.comparison import increments, rubbed
from faying.study.results.nodal_motion import shown_states
from faying.study.results.values import CaseResult, Response, Results
from faying.units import Units


@dataclass(frozen=True, eq=False, kw_only=True)
class Frames:
    """The shown states of a load case in order.

    Attributes
    ----------
    label, unit
        Quantity of the states, such as time; no label if there is one state.
    values
        Values of that quantity.
    chosen
        Numbers of the shown states among all.
    """

    label: str
    unit: str
    values: tuple[float, ...]
    chosen: Indices


def frames(case: CaseResult, units: Units) -> Frames:
    """Return the shown states of a load case: evenly spaced, and that of largest pressure."""
    paths = increments(case.reference)
    if paths:
        path = paths[-1]
        chosen = shown_states(path.pressure.max(axis=1, initial=0.0))
        if path.factors.shape[1] == 1:
            values = path.factors[chosen, 0]
            return Frames(label="load factor", unit="", values=tuple(values), chosen=chosen)
        return Frames(label="increment", unit="", values=tuple(chosen + 1.0), chosen=chosen)
    if case.times is None:
        return Frames(label="", unit="", values=(0.0,), chosen=np.zeros(1, dtype=np.int64))
    chosen = shown_states(case.reference.pressure.max(axis=1, initial=0.0))
    times = tuple(case.times[chosen])
    return Frames(label="time", unit=units.time, values=times, chosen=chosen)


@dataclass(frozen=True, eq=False, kw_only=True)
class Field:
    """A field of a load case and a model.

    Attributes
    ----------
    case, model
        Numbers of load case and model in the view.
    name
        ``"pressure"``, ``"gap"``, ``"slip"`` or ``"displacement"``.
    at
        Numbers of the frames that have the field.
    values
        Function that returns nodal averages (n_pair, n_frame) of all interfaces in
        order; for displacements, shapes (n, 3 n_shape) at the nodes of the outer surface.
    amplitudes : (n_frame, n_shape), optional
        Factors of the shapes of displacements in each frame.
    largest
        Largest displacement of all frames.
    """

    case: int
    model: int
    name: str
    at: tuple[int, ...]
    values: Callable[[], Matrix]
    amplitudes: Matrix | None = None
    largest: float = 0.0


ORDER = (
    (("pressure",), True),
    (("displacement",), True),
    (("pressure",), False),
    (("gap", "slip"), True),
    (("gap", "slip"), False),
    (("displacement",), False),
)
"""Fields in order of priority, and whether of references or of methods."""


def models(case: CaseResult) -> list[tuple[str, Response]]:
    """Return names and responses of the models of a load case, the reference first."""
    responses = [(case.reference_model, case.reference)]
    for method, sizes in case.methods.items():
        responses += [(label(method, n), sizes[n].response) for n in sorted(sizes, reverse=True)]
    return responses


def fields(results: Results, frames_of: dict[str, Frames], nodes: Indices) -> Iterator[Field]:
    """Yield the fields of a run in order of priority.

    ``frames_of`` has the frames of load cases, ``nodes`` the nodes of the outer surface.
    """
    every = [
        replace(field, case=number, model=index)
        for number, (name, case) in enumerate(results.cases.items())
        for index, (_, response) in enumerate(models(case))
        for field in fields_of_response(results, response, frames_of[name], nodes)
    ]
    for names, of_reference in ORDER:
        for field in every:
            if field.name in names and (field.model == 0) is of_reference:
                yield field


def fields_of_response(
    results: Results, response: Response, frames: Frames, nodes: Indices
) -> Iterator[Field]:
    """Yield the fields of a response, numbered as the first model and load case."""
    field = partial(Field, case=0, model=0)
    everywhere, last = tuple(range(len(frames.chosen))), (len(frames.chosen) - 1,)
    paths = increments(response)
    if paths:
        path = paths[-1]
        pressed = path.pressure[frames.chosen]
        yield field(name="pressure", at=everywhere, values=lambda: averages(results, pressed))
        yield field(name="gap", at=last, values=lambda: averages(results, response.gap[None]))
    else:
        of_time = response.pressure.ndim > 1
        chosen = frames.chosen if of_time else slice(None)
        pressure, gap = (
            np.atleast_2d(values)[chosen] for values in (response.pressure, response.gap)
        )
        yield field(name="pressure", at=everywhere, values=lambda: averages(results, pressure))
        yield field(name="gap", at=everywhere, values=lambda: averages(results, gap))
    for record in rubbed(response)[-1:]:
        slip = np.linalg.norm(record.slip[frames.chosen], axis=-1)
        if slip.any():
            yield field(name="slip", at=everywhere, values=partial(averages, results, slip))
    motion, moved = response.motion, response.nodal_displacement
    if motion is not None:
        shapes, amplitudes = motion.shapes[:, nodes], motion.amplitudes
        steps = np.linalg.norm(np.tensordot(amplitudes, shapes, axes=1), axis=-1)
        yield field(
            name="displacement",
            at=tuple(np.flatnonzero(np.isin(frames.chosen, motion.chosen)).tolist()),
            values=lambda: np.moveaxis(shapes, 0, 1).reshape(len(nodes), -1),
            amplitudes=amplitudes[np.isin(motion.chosen, frames.chosen)],
            largest=float(steps.max(initial=0.0)),
        )
    elif moved is not None:
        yield field(
            name="displacement",
            at=last,
            values=lambda: moved[nodes],
            amplitudes=np.ones((1, 1)),
            largest=float(np.linalg.norm(moved[nodes], axis=-1).max(initial=0.0)),
        )


def averages(results: Results, values: Matrix) -> Matrix:
    """Return nodal averages (n_pair, n_frame) of values (n_frame, n_point), all interfaces."""
    parts = [nodal_average(record, values) for record in results.interfaces.values()]
    return np.concatenate([*parts, np.empty((len(values), 0))], axis=1).T
