"""Joint interface modes from contact simulations: method B (§15.3.4)."""

import numpy as np

from faying._typing import Matrix
from faying.joint.model import Model
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.craig_bampton import craig_bampton
from faying.reduction.pod import pod


def jim_b(
    model: Model,
    contact_forces: Matrix,
    *,
    normal_modes: int = 20,
    joint_modes: int = 20,
    classic: Basis | None = None,
) -> Basis:
    """Extend the classic basis by joint modes of contact forces in training runs (method B).

    Parameters
    ----------
    model
        Usually preloaded, with its sticking area.
    normal_modes
        Number of fixed-interface normal modes; not used where ``classic`` is given.
    joint_modes
        Number of joint modes, the most important first.
    contact_forces : (n_point, n_snapshot) [force]
        λ of static and dynamic training runs, Eq. (15.30); see :mod:`faying.reduction.snapshots`.
    classic
        Result of :func:`craig_bampton` if it has been computed.

    Notes
    -----
    POD of the nodal contact forces with W = I, then Eq. (15.24) with the boundary held: one
    back-substitution per joint mode.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> box = fy.LoadBox(ranges={"tip.Fz": (-500.0, 500.0)}, levels=3)
    >>> forces = fy.static_snapshots(joint, box.static_loads(joint))
    >>> fy.jim_b(joint, forces, normal_modes=4, joint_modes=5)
    Basis(trial vectors: 16 (6 constraint, 4 normal, 1 bolt, 5 joint), degrees of freedom: 1326)
    """
    start = craig_bampton(model, normal_modes=normal_modes) if classic is None else classic
    at_pairs = model.contact.interpolation.T @ contact_forces
    nodal = model.structure.relative_operator.T.tocsr()
    loaded = np.flatnonzero(np.diff(nodal.indptr))
    modes = pod(nodal[loaded] @ at_pairs, count=joint_modes).vectors
    patterns = np.zeros((model.structure.n_dof, modes.shape[1]))
    patterns[loaded] = modes
    shapes = model.structure.solve_held(patterns)
    joint = Basis(vectors=shapes, kinds=(ModeKind.JOINT,) * shapes.shape[1])
    return (start + joint).orthonormalized(model.structure.supported_stiffness)
