"""Attachment modes: static contact shapes with inertia, where ``compliance`` has no mass.

(M8), (M9) and (M10) of ``docs/theory/method.md``.
"""

import numpy as np
import scipy.linalg as la

from faying.exceptions import refuse_model
from faying.joint.model import Model
from faying.linalg.memory import require_room
from faying.linalg.substitution import dense
from faying.reduction.basis import VANISHING, Basis, ModeKind
from faying.reduction.craig_bampton import craig_bampton

INERTIA_SHAPES = 12
"""Static shapes of inertia forces, each of the one before, for each boundary motion and load."""

REFINED_SHAPES = 200
"""Number of slowest shapes with static shapes of their inertia forces."""

SHAPE_COPIES = 4
"""Sets of all shapes in memory at once: known, new, their forces, scratch."""


def attachment_modes(
    model: Model,
    *,
    normal_modes: int = 20,
    moments: int = INERTIA_SHAPES,
    refined: int = REFINED_SHAPES,
    classic: Basis | None = None,
) -> Basis:
    """Extend the classic basis by all static contact shapes, and by shapes of inertia forces.

    The static shape of a unit force at every contact pair makes static solutions exact, as the
    residual compliance of :func:`faying.reduce` does, but with inertia: transients after a jump
    converge. The other shapes are static responses to inertia forces: ``moments`` times to those of
    boundary motions and load patterns, and once to those of the ``refined`` slowest shapes so far:
    (M8) and (M10).

    Parameters
    ----------
    model
        Usually preloaded, with its sticking area.
    normal_modes
        Number of fixed-interface normal modes.
    moments, refined
        Higher values, or more normal modes, represent the motion after a jump better.
    classic
        Result of :func:`craig_bampton` if it has been computed.

    Returns
    -------
    Basis
        As many vectors as contact pairs (three times as many where an interface is curved) and
        those above. Reduce with it without residual compliance, which would vanish.

    Raises
    ------
    ModelError
        If the structure has no mass.
    NotEnoughMemoryError
        If all shapes would not fit.

    Notes
    -----
    One back-substitution a vector, and products of n_dof n² operations for n vectors, which take
    longer from about a thousand vectors on. A step of the reduced model costs 4 n² operations more
    than one of ``compliance``.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> len(fy.attachment_modes(joint, normal_modes=4, moments=2, refined=10)) > 20
    True
    """
    structure = model.structure
    if not structure.has_mass:
        refuse_model(
            "attachment modes give inertia to the interface, and the structure has no mass; take "
            "the residual compliance, which statics do not distinguish, or give a density"
        )
    start = craig_bampton(model, normal_modes=normal_modes) if classic is None else classic
    inputs = len(structure.boundary) + len(model.load_patterns)
    n = len(start) + moments * inputs + structure.relative_operator.shape[0] + refined
    require_room(
        8 * SHAPE_COPIES * n * structure.n_dof,
        f"{n} shapes of interface and inertia",
        "take the residual compliance instead, or a coarser interface",
    )
    K, M, P = structure.supported_stiffness, structure.M, structure.relative_operator
    kind, basis = ModeKind.ATTACHMENT, start
    carried = np.hstack([M @ structure.constraint_modes, model.pattern_forces.T])
    for _ in range(moments):
        n_modes = len(basis)
        basis = basis.extended(structure.solve_held(carried), kind, K)
        carried = M @ basis.vectors[:, n_modes:]
    basis = basis.extended(structure.solve_held(dense(P.T)), kind, K)
    return refined_basis(model, basis, refined)


def refined_basis(model: Model, basis: Basis, count: int = REFINED_SHAPES) -> Basis:
    """Extend a basis by static shapes of the inertia forces of its slowest Ritz vectors.

    The Ritz vectors of lowest frequency vanish on the boundary: one step of subspace iteration.

    Notes
    -----
    One back-substitution a vector.
    """
    M, shapes = model.structure.M, basis.of_kind(*VANISHING)
    n = shapes.shape[1]
    if count == 0 or n == 0:
        return basis
    gram = shapes.T @ (M @ shapes)
    softest = [max(n - count, 0), n - 1]
    _, directions = la.eigh((gram + gram.T) / 2, subset_by_index=softest)
    answers = model.structure.solve_held(M @ (shapes @ directions))
    return basis.extended(answers, ModeKind.ATTACHMENT, model.structure.supported_stiffness)
