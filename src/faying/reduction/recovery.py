"""The recovery matrices of a basis: port displacements of the full model per motion of q.

:mod:`faying.assessment.recovery` takes inertia and damping forces from a reduced trajectory; these
matrices give the port displacements due to them. ``docs/theory/recovery.md`` derives them.
"""

from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Frozen, Matrix
from faying.exceptions import refuse_model
from faying.joint.model import Model
from faying.joint.system import Joint, PortCompliance
from faying.linalg.interface import Factorization
from faying.linalg.partial import port_compliance
from faying.reduction.basis import Basis
from faying.simulation.frame_motion import frame_loads
from faying.simulation.static import port_forces


@dataclass(frozen=True, eq=False, kw_only=True)
class Recovery(Frozen):
    """The data that recovery needs of a model and a basis: a few dense matrices.

    With Q the ports (relative displacements, boundary, bolt elongations, load patterns):

    Attributes
    ----------
    joint
        The full model, or its part at the ports: contact points, law and compliance.
    inertia : (n_port, n_mode)
        Q K⁻¹ M Φ.
    damping : (n_port, n_mode)
        Q K⁻¹ C Φ.
    frame : (n_port, 12) or None
        Q K⁻¹ M A for moving supports, see :mod:`faying.simulation.frame_motion`.
    """

    joint: Joint
    inertia: Matrix
    damping: Matrix
    frame: Matrix | None = None

    def free_displacements(
        self, inputs: Matrix, velocities: Matrix, accelerations: Matrix
    ) -> Matrix:
        """Return Q K⁻¹ (f − M Φ q̈ − C Φ q̇) (..., n_port) for all instants at once."""
        moving = accelerations @ self.inertia.T + velocities @ self.damping.T
        return static_displacements(self.joint.port_compliance, inputs) - moving


def recovery_operator(model: Model, basis: Basis) -> Recovery:
    """Return the matrices that recover pressures of the full model from a motion in a basis.

    A program that integrates the reduced model needs no more than these. A reduced model has them
    as ``rom.recovery``, except those of moving supports.

    Parameters
    ----------
    model
        The preloaded full model.
    basis
        Basis of the motion, whose coordinates :func:`faying.recover_from_modal` takes.

    Raises
    ------
    ModelError
        If the basis belongs to a model with another number of degrees of freedom.
    SingularMatrixError
        If the structure is not held without its boundary.

    Notes
    -----
    One back-substitution per trial vector, two with damping that is not proportional, and twelve
    for moving supports.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> fy.recovery_operator(joint, fy.craig_bampton(joint, normal_modes=4)).inertia.shape[1]
    11
    """
    return replace(supported_operator(model, basis), frame=frame_operator(model))


def supported_operator(model: Model, basis: Basis) -> Recovery:
    """Return the recovery matrices of a model whose supports are at rest.

    As :func:`recovery_operator`, without the matrix for moving supports.

    Notes
    -----
    One back-substitution per trial vector. Damping proportional to mass and stiffness needs no
    other, K⁻¹ (α M + β K) Φ = α K⁻¹ M Φ + β Φ; any other takes a second one.
    """
    structure, vectors = model.structure, basis.vectors
    law, dampers = model.damping, structure.matrices.dampers
    if vectors.shape[0] != structure.n_dof:
        refuse_model(
            f"the basis has {vectors.shape[0]} rows but the model has {structure.n_dof} "
            "degrees of freedom; recover with the model the basis was made from"
        )
    inertia = at_ports(model, structure.solve(model.M @ vectors))
    damping = law.alpha * inertia + law.beta * at_ports(model, vectors)
    if dampers is not None:
        damping = damping + at_ports(model, structure.solve(dampers @ vectors))
    return Recovery(joint=model, inertia=inertia, damping=damping)


def frame_operator(model: Model) -> Matrix:
    """Return Q K⁻¹ M A (n_port, 12) for moving supports.

    Notes
    -----
    One assembly of the mass matrix and twelve back-substitutions.
    """
    return at_ports(model, model.structure.solve(frame_loads(model)))


def at_ports(model: Model, displacements: Matrix) -> Matrix:
    """Return Q U (n_port[, k]) from displacements U (n_dof[, k])."""
    structure = model.structure
    return np.concatenate(
        [
            structure.relative_operator @ displacements,
            displacements[structure.boundary],
            structure.elongations @ displacements,
            model.pattern_forces @ displacements,
        ]
    )


def static_displacements(ports: PortCompliance, inputs: Matrix) -> Matrix:
    """Return port displacements Q K⁻¹ f (..., n_port) under inputs alone."""
    return ports.per_input(port_forces(ports, inputs))


def interface_compliance(model: Model, factor: Factorization | None = None) -> Matrix:
    """Return S = G K⁻¹ Gᵀ (n_point, n_point) [length/force], (M1).

    Column k is the opening of every contact point under a unit force at point k.

    Parameters
    ----------
    model
        It must be held without contact.
    factor
        Factorization of ``model.K``; by default that of the model.

    Notes
    -----
    One back-substitution per pair of nodes (three where an interface is curved), in blocks of
    bounded memory.

    Examples
    --------
    >>> import faying as fy
    >>> S = fy.interface_compliance(fy.lap_joint(element_size=5.0))
    >>> S.shape, bool(abs(S - S.T).max() < 1e-9 * S.max())
    ((112, 112), True)
    """
    if factor is None:
        relative = model.port_compliance.relative
    else:
        relative = port_compliance(model.contact.relative_operator, factor)
    return model.contact.at_points(relative)
