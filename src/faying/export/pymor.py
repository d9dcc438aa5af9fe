"""The linear export as a pyMOR second-order model, for the system-theoretic methods of pyMOR."""

from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np

from faying.exceptions import StudyError, refuse_study
from faying.export.linearized import LinearModel, linearize
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.solution import Solution
from faying.study.keys.errors import nearest

Linearizable = ReducedModel | Solution | LinearModel


def second_order_model(
    source: Linearizable,
    *,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
) -> Any:
    """Return a ``pymor.models.iosys.SecondOrderModel``: M ẍ + E ẋ + K x = B f, y = Cp x + D f.

    Parameters
    ----------
    source
        A reduced model, linearized under its bolts alone; a static solution of a
        reduced model to linearize about; or a :class:`~faying.export.linearized.LinearModel`.
    inputs, outputs
        Names of inputs and outputs, from ``input_names`` and ``output_names`` of that class;
        all unless given. Balancing methods compare their bare numbers, whatever
        the units: name the important ones.

    Returns
    -------
    SecondOrderModel
        Inputs are the boundary forces, then the initial forces of the bolts, then the factors
        of deck loads; outputs are the boundary displacements, then bolt forces, then clamp
        forces of the interfaces; all as changes from the state.

    Raises
    ------
    StudyError
        If pyMOR is not installed, or an input or output does not exist.
    """
    try:
        SecondOrderModel = import_module("pymor.models.iosys").SecondOrderModel  # noqa: N806
    except ModuleNotFoundError:
        message = "pyMOR is not installed; pip install 'faying[pymor]'"
        raise StudyError(message) from None
    model = source if isinstance(source, LinearModel) else linearize(source)
    columns = _places("input", inputs, model.input_names)
    rows = _places("output", outputs, model.output_names)
    # Copies, because pyMOR keeps its arrays and these are read-only.
    return SecondOrderModel.from_matrices(
        M=np.array(model.M),
        E=np.array(model.C),
        K=np.array(model.K),
        B=model.inputs[:, columns],
        Cp=model.outputs[rows],
        D=model.feedthrough[np.ix_(rows, columns)],
        name="faying joint",
    )


def _places(kind: str, chosen: Sequence[str] | None, names: tuple[str, ...]) -> list[int]:
    if chosen is None:
        return list(range(len(names)))
    for name in chosen:
        if name not in names:
            refuse_study(f"the joint has no {kind} '{name}'; {nearest(name, names)}")
    return [names.index(name) for name in chosen]
