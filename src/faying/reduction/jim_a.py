"""Joint interface modes from test loads: method A (§15.3.3)."""

from typing import Literal

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import refuse_model
from faying.interface.interface import Interface
from faying.joint.model import Model
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.craig_bampton import craig_bampton
from faying.reduction.pod import pod


def subareas(interface: Interface, count: int) -> Indices:
    """Divide an interface into parts of nearly equal area; return part 0 … count − 1 of each point.

    The largest part is halved in area across its longest side, until there are enough. Facets are
    not divided, so that there is at most one part per facet.
    """
    if count < 1:
        refuse_model(f"{count} subareas asked for; give at least one")
    # A nodal point belongs to one of its facets, and some facets may have no point.
    numbers, facet = np.unique(interface.face_of_point, return_inverse=True)
    n_facet = len(numbers)
    area: Vector = np.bincount(facet, interface.weights, n_facet).astype(float)
    moment = [np.bincount(facet, interface.weights * x, n_facet) for x in interface.points.T]
    centres = np.array(moment).T / area[:, None]
    part = np.zeros(n_facet, dtype=np.int64)
    for new in range(1, min(count, n_facet)):
        size = np.bincount(part, area, new) * (np.bincount(part, minlength=new) > 1)
        members = np.flatnonzero(part == size.argmax())
        part[members[_far_half(centres[members], area[members])]] = new
    return part[facet]


def _far_half(centres: Matrix, area: Vector) -> Indices:
    """Facets beyond the plane that halves the area across the longest extent."""
    longest = int(np.ptp(centres, axis=0).argmax())
    order = np.lexsort((*np.delete(centres, longest, axis=1).T, centres[:, longest]))
    reached = np.cumsum(area[order])
    first = int(np.searchsorted(reached, reached[-1] * (0.5 + 1e-12), side="right"))
    return order[min(max(first, 1), len(order) - 1) :]


def jim_a(
    model: Model,
    *,
    normal_modes: int = 20,
    joint_modes: int = 20,
    subarea_count: int = 200,
    weight: Literal["K", "I"] = "K",
    classic: Basis | None = None,
) -> Basis:
    """Extend the classic basis by joint modes of unit pressures on subareas (method A).

    Parameters
    ----------
    model
        Usually preloaded, with its sticking area.
    normal_modes
        Number of fixed-interface normal modes; not used where ``classic`` is given.
    joint_modes
        Number of joint modes, the most important first.
    subarea_count
        Number of test loads on all interfaces together, each a unit pressure on one subarea,
        Eq. (15.23); at most one per facet.
    weight
        Inner product W of the POD: the stiffness matrix, or the identity.
    classic
        Result of :func:`craig_bampton` if it has been computed.

    Notes
    -----
    Eqs. (15.23), (15.24): one back-substitution per subarea with the boundary held, one POD.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> fy.jim_a(joint, normal_modes=4, joint_modes=8)
    Basis(trial vectors: 19 (6 constraint, 4 normal, 1 bolt, 8 joint), degrees of freedom: 1326)
    """
    start = craig_bampton(model, normal_modes=normal_modes) if classic is None else classic
    fields = model.structure.solve_held(unit_pressure_loads(model, subarea_count))
    inner = model.K if weight == "K" else None
    modes = pod(fields, inner=inner, count=joint_modes).vectors
    joint = Basis(vectors=modes, kinds=(ModeKind.JOINT,) * modes.shape[1])
    return (start + joint).orthonormalized(model.structure.supported_stiffness)


def unit_pressure_loads(model: Model, count: int) -> Matrix:
    """Return nodal forces (n_dof, n_subarea) of unit pressure on each subarea, Eq. (15.23)."""
    contact = model.contact
    total = contact.weights.sum()
    pressures = []
    for name, interface in model.interfaces.items():
        points = contact.slices[name]
        share = max(1, round(count * interface.area / total))
        part = subareas(interface, share)
        pressure = np.zeros((contact.n_points, int(part.max()) + 1))
        pressure[np.arange(points.start, points.stop), part] = 1.0
        pressures.append(pressure)
    forces = contact.weights[:, None] * np.hstack(pressures)
    at_pairs = contact.interpolation.T @ forces
    return np.asarray(contact.relative_operator.T @ at_pairs)
