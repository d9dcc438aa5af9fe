"""Certified error of increments with friction at fixed friction bounds, (C19).

With given bounds b (Tresca), an increment minimizes a convex energy over λ_n ≥ 0, |λ_t| ≤ b, and
for any y with y_n ≥ 0

    ½ ‖x̂ − x*‖²_H  ≤  λ̂_nᵀ y_n + Σ (b |y_t| + λ̂_t · y_t) + ½ (z − y)ᵀ H⁻¹ (z − y),

z = Hx̂ + z_free.

Coulomb's bounds are b = μ λ_n of the unknown solution: their error is not certified; the residual
of (F1) measures it. ``docs/theory/certificate.md`` derives it.
"""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.assessment.flexibility import Flexibility, flexibility, flexibility_by_pairs
from faying.assessment.natural_map import NaturalMap
from faying.assessment.slip import slip_history
from faying.digits import ROUND_OFF
from faying.exceptions import refuse_model
from faying.joint.system import Joint
from faying.reduction.recovery import static_displacements
from faying.simulation.solution import Solution


@dataclass(frozen=True, eq=False, kw_only=True)
class IncrementCertificate:
    """Bounds of the errors of the increments of a path; one entry for each increment.

    Attributes
    ----------
    energy : (n_increment,) [force·length]
        Bound of ½ (x̂ − x*)ᵀ H (x̂ − x*), x* the forces of the full model after the same increment,
        from the same slip, with the friction bounds of the candidate; infinite where hard contact
        has more points than the pairs have displacements.
    energy_error : (n_increment,)
        Bound of ‖x̂ − x*‖_H / ‖x*‖_H; infinite where there is no bound.
    residual : (n_increment,)
        Largest residual of Coulomb's law, (F1), over the largest force; it is no bound.
    """

    energy: Vector
    energy_error: Vector
    residual: Vector


def certify_increments(
    model: Joint, path: Solution, initial: Solution | None = None
) -> IncrementCertificate:
    """Return bounds of the errors of a path with friction, by increment, without solving the model.

    Parameters
    ----------
    model
        The full model with friction, with the exact increments.
    path
        Result of :func:`faying.solve_path`, usually of a reduced model.
    initial
        State from which it continued; by default without slip.

    Raises
    ------
    ModelError
        If the model has no friction, or the path has other contact points.

    Notes
    -----
    The slip before an increment is taken from the path: errors are not accumulated, and a halved
    increment counts as one. One factorization between pairs, ⅓ n_relative³, then
    O(n_relative²) an increment. Hard contact takes ⅔ (3 n_point)³, and n_point² an increment.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
    >>> joint = joint.with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    >>> path = fy.solve_path(joint, [fy.Load({"tip.Fz": -50.0}), fy.Load({"tip.Fz": -100.0})])
    >>> bool((fy.certify_increments(joint, path).energy_error < 1e-6).all())
    True
    """
    contact = model.contact
    contact.check_rubs()
    if path.shear_forces.shape[-2:] != (contact.components - 1, contact.n_points):
        refuse_model(
            f"the path '{path.name}' is not one with friction at the {contact.n_points} contact "
            "points of the model; give a result of solve_path, of the model or one reduced from it"
        )
    contact.check_proportional()
    equations, n = NaturalMap.of(model), contact.n_points
    free = static_displacements(model.port_compliance, np.atleast_2d(path.inputs))
    free = free[:, : model.port_compliance.n_relative]
    slip = slip_history(path, initial)[:-1]
    z_free = np.array([contact.free_slack(*row) for row in zip(free, slip, strict=True)])
    shear = path.shear_forces.reshape(-1, 2, n)
    forces_given = np.concatenate([np.atleast_2d(path.contact_forces)[:, None], shear], axis=1)
    forces = np.array([equations.laws.admissible(force) for force in forces_given])
    slack = np.array([equations.moved(x) + equations.laws.closure(x)[0] for x in forces]) + z_free
    tried = forces - equations.scale * slack
    wrong = forces - np.array([equations.laws.admissible(force) for force in tried])
    largest = np.maximum(np.abs(forces).max(axis=(1, 2)), np.finfo(float).tiny)
    used = np.concatenate([np.arange(n), n + contact.rubbing, 2 * n + contact.rubbing])
    rows, yields = equations.G[used], equations.yields.ravel()[used]
    H = flexibility_by_pairs(model, rows, yields)
    if H is None:
        H = flexibility(contact.at_points(equations.S, rows) + np.diag(yields))
    bound = contact.friction * forces[:, 0, contact.rubbing]
    energy = tresca_gap(H, forces, slack, contact.rubbing, bound)
    stored = forces.reshape(len(forces), -1)[:, used]
    norm = np.sqrt(np.maximum((H.times(stored) * stored).sum(axis=1), 0.0))
    apart = np.sqrt(2 * energy)
    resolved = norm > apart
    return IncrementCertificate(
        energy=energy,
        energy_error=np.where(resolved, apart / np.where(resolved, norm - apart, 1.0), np.inf),
        residual=np.abs(wrong).max(axis=(1, 2)) / largest,
    )


def tresca_gap(
    flexibility: Flexibility,
    forces: Matrix,
    slack: Matrix,
    rubbing: Indices,
    bound: Matrix,
) -> Vector:
    """Return the bound (C19) for increments with fixed friction bounds (n_increment,).

    ``flexibility`` is of H: all normal components, then both tangential ones of the points with
    friction (n_rubbing,). Admissible candidates x̂ [force] and their z [length] are (n_increment,
    3, n_point), friction bounds b (n_increment, n_rubbing) [force].

    Notes
    -----
    y as in (C20): zero where a point is closed or sticks, else the part of z that opens it, or
    slides it against its force, so that the first two sums of (C19) vanish.
    """
    if not flexibility.unique:
        return np.full(len(forces), np.inf)
    y = np.zeros_like(slack)
    y[:, 0] = np.where(forces[:, 0] > 0, 0.0, np.maximum(slack[:, 0], 0.0))
    shear, slides = forces[:, 1:, rubbing], slack[:, 1:, rubbing]
    size = np.hypot(shear[:, 0], shear[:, 1])
    along = shear / np.where(size > 0, size, 1.0)[:, None]
    against = np.maximum(-(slides * along).sum(axis=1), 0.0)
    full = size >= bound * (1 - ROUND_OFF)
    y_t = np.where((full & (size > 0))[:, None], -against[:, None] * along, 0.0)
    y[:, 1:, rubbing] = np.where((bound <= 0)[:, None], slides, y_t)
    work = (bound * np.hypot(*np.moveaxis(y[:, 1:, rubbing], 1, 0))).sum(axis=1)
    work += (forces * y).sum(axis=(1, 2))
    left = slack - y
    used = np.concatenate([left[:, 0], left[:, 1][:, rubbing], left[:, 2][:, rubbing]], axis=1)
    return np.asarray(np.maximum(work, 0.0) + 0.5 * flexibility.energy(used))
