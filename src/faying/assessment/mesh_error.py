"""The mesh error of pressures of the full model, estimated without a finer mesh.

Pressures are averaged to the nodes and interpolated to the contact points, and the difference is
taken for the error (Zienkiewicz and Zhu 1987, doi:10.1002/nme.1620240206, for stresses in bodies).
This is an estimate and no bound: it measures how well the mesh resolves the computed pressure, not
the effect of a wrong stiffness of the bodies. Its ratio to the change by a real refinement was
measured, `docs/how-to/choose_the_mesh.md`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix, SparseMatrix, Vector
from faying.assessment.accuracy import Compared
from faying.exceptions import refuse_model
from faying.interface.smoothing import smoothing
from faying.joint.model import Model


@dataclass(frozen=True, kw_only=True)
class MeshError:
    """Estimated errors of the pressure of one interface, over its largest pressure.

    Attributes
    ----------
    field : [1]
        Root mean square over the area under pressure, relative to the peak.
    largest : [1]
        Largest at a contact point, usually at the edge of contact, relative to the peak.
    """

    field: float
    largest: float


def mesh_error(model: Model, solution: Compared) -> dict[str, MeshError]:
    """Return an estimate of the mesh error of the pressures of a solution.

    Parameters
    ----------
    model
        The full model, with the facets for averages.
    solution
        Solution of the full or a reduced model. For each interface the load case or instant of its
        largest pressure is taken.

    Returns
    -------
    dict
        By interface; interfaces without pressure are absent.

    Raises
    ------
    ModelError
        If the solution has other contact points than the model.

    Notes
    -----
    A few products with sparse matrices. The estimate was 0.3 to 1.5 times the change by refinement
    on joints with edges, and up to twelve times where Gauss points of a smooth contact are more
    accurate than the mesh between them. There is no estimate for the peak alone: at a sharp edge it
    grows with every refinement, and elsewhere such an estimate was 0.15 to 550 times the truth.

    Examples
    --------
    >>> import faying as fy
    >>> model = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> errors = fy.mesh_error(model, fy.solve_static(model, fy.Load({"tip.Fz": -500.0})))
    >>> errors["joint"].field > 0.1  # bricks of 5 mm are coarse
    True
    """
    return mesh_errors(smoothings(model), model, solution.pressure)


def smoothings(model: Model) -> dict[str, SparseMatrix]:
    """Return the smoothings of a model for :func:`mesh_errors` of any number of solutions."""
    nodes = model.assembly.mesh.nodes
    return {name: smoothing(interface, nodes) for name, interface in model.interfaces.items()}


def mesh_errors(
    smooth: Mapping[str, SparseMatrix], model: Model, pressure: Matrix
) -> dict[str, MeshError]:
    """Return estimated errors of pressures (..., n_point), as :func:`mesh_error`."""
    if np.shape(pressure)[-1] != model.contact.n_points:
        refuse_model(
            f"the solution has {np.shape(pressure)[-1]} contact points, the model "
            f"{model.contact.n_points}; give the model it was solved with or reduced from"
        )
    rows = np.reshape(pressure, (-1, model.contact.n_points))
    errors = {}
    for name, interface in model.interfaces.items():
        pressures = rows[:, model.contact.slices[name]]
        if pressures.size and pressures.max() > 0:
            largest = pressures[int(pressures.max(axis=1).argmax())]
            errors[name] = _estimate(smooth[name], interface.weights, largest)
    return errors


def _estimate(smooth: SparseMatrix, weights: Vector, pressure: Vector) -> MeshError:
    """Return the estimate for one field (n_point,) that is not zero."""
    peak = float(pressure.max())
    error = np.abs(pressure - np.maximum(smooth @ pressure, 0.0)) / peak
    pressed = float(weights[pressure > 0].sum())
    return MeshError(
        field=float(np.sqrt(weights @ error**2 / pressed)),
        largest=float(error.max()),
    )
