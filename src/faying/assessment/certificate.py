"""Certified error of any contact pressure, without the full solution, (C6).

The exact contact forces must lie in a ball in the energy norm around any candidate λ̂ ≥ 0: for the
problem s = Hλ + g_free ≥ 0, λ ≥ 0, λᵀs = 0 and *any* z ≥ 0,

    ½ ‖λ̂ − λ*‖²_H  ≤  B(z) = λ̂ᵀ z + ½ (s − z)ᵀ H⁻¹ (s − z),   s = Hλ̂ + g_free,      (C6)

is the gap between the energy of λ̂ and a lower bound of the least energy. Pressures, total forces
and largest errors follow as intervals. ``docs/theory/certificate.md`` derives them and the choices
of z; equation numbers (C…) are from that page.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np

from faying._typing import Frozen, Mask, Matrix, Vector
from faying.assessment.flexibility import Flexibility, joint_flexibility
from faying.exceptions import check_known, refuse_model
from faying.joint.system import Joint
from faying.reduction.recovery import static_displacements
from faying.simulation.load import Load


@dataclass(frozen=True, eq=False, kw_only=True)
class Enclosure:
    """A ball that contains the exact contact forces λ*, for one or many candidates.

    Attributes
    ----------
    energy : (...) [force·length]
        B ≥ ½ ‖λ̂ − λ*‖²_H.
    centre : (..., n_point) [force]
        c of the ball ‖λ* − c‖_H ≤ r, (C12).
    radius : (...) [√(force·length)]
        r.
    slack : (..., n_point) [length]
        s of the candidates.
    """

    energy: Vector
    centre: Matrix
    radius: Vector
    slack: Matrix


def enclose(flexibility: Flexibility, g_free: Matrix, forces: Matrix) -> Enclosure:
    """Return a ball with the exact contact forces of bare contact problems, from candidates λ̂ ≥ 0.

    Free gaps and forces are (..., n_point) [length], [force].

    Notes
    -----
    The best of three z: s⁺, (C18); s⁺ where λ̂ = 0 and 0 elsewhere, (C8), second order in the
    error and usually the sharpest; and the minimizer point by point, (s − λ̂/(H⁻¹)_kk)⁺, (C9).
    O(n²) a candidate.
    """
    slack = flexibility.times(forces) + g_free
    open_gap = np.maximum(slack, 0.0)
    wishes = (
        open_gap,
        np.where(forces > 0, 0.0, open_gap),
        np.maximum(slack - forces / flexibility.point_norms**2, 0.0),
    )
    pairs = [flexibility.admissible(slack, wish) for wish in wishes]
    works = np.array([(forces * z).sum(axis=-1) for z, _ in pairs])
    rests = np.array([slack - z for z, _ in pairs])
    answers = flexibility.solve(rests)
    energies = np.maximum((rests * answers).sum(axis=-1), 0.0)
    possible = np.array([exists for _, exists in pairs])
    bounds = np.where(possible, works + 0.5 * energies, np.inf)
    best = np.argmin(bounds, axis=0)[None]
    answer = np.take_along_axis(answers, best[..., None], axis=0)[0]
    energy = np.take_along_axis(bounds, best, axis=0)[0]
    squared = np.take_along_axis(works + 0.25 * energies, best, axis=0)[0]
    return Enclosure(
        energy=energy,
        centre=forces - 0.5 * answer,
        radius=np.where(np.isfinite(energy), np.sqrt(squared), np.inf),
        slack=slack,
    )


Measure = Literal["energy_error", "contact_force_error", "max_relative_error"]
"""Certified quantities for tolerances and searches."""

POWERS = (1, 2, 4)
"""Powers of the candidate as weights of means, which bound the largest pressure."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Certificate(Frozen):
    """Certified bounds of the exact pressures, from a candidate.

    Arrays have no leading axis for one load, otherwise one entry per load case.

    Attributes
    ----------
    pressure : (..., n_point) [force/length²]
        The candidate, negative values set to zero.
    clipped_pressure : (...)
        Magnitude of the largest negative pressure that was clipped to zero.
    energy : (...) [force·length]
        Bound of ½ (λ̂ − λ*)ᵀ H (λ̂ − λ*), the strain energy of the error.
    energy_error : (...)
        Bound of ‖λ̂ − λ*‖_H / ‖λ*‖_H; infinite where there is no bound.
    pressure_low, pressure_high : (..., n_point) [force/length²]
        Bounds of the exact pressure of each contact point.
    contact_force : interface to (..., 2) [force]
        Bounds of the exact total force of each interface.
    area_force : (interface, bolt) to (..., 2) [force]
        Bounds of the exact total force of each requested area.
    contact_force_error : (...)
        Bound of the relative error of the candidate's total force, the largest over the
        interfaces.
    rms_pressure_error : (...) [force/length²]
        Bound of the area-weighted root mean square of p̂ − p* over all interfaces.
    max_relative_error : (...)
        Bound of the seed's measure max |p̂ − p*| / max p*, Eq. (15.31); infinite where no pressure
        is certain.
    """

    pressure: Matrix
    clipped_pressure: Vector
    energy: Vector
    energy_error: Vector
    pressure_low: Matrix
    pressure_high: Matrix
    contact_force: Mapping[str, Matrix]
    contact_force_error: Vector
    rms_pressure_error: Vector
    max_relative_error: Vector
    area_force: Mapping[tuple[str, str], Matrix] = field(default_factory=dict)

    def bound(self, measure: Measure) -> Vector:
        """Return one of the certified relative errors (...)."""
        bounds: dict[Measure, Vector] = {
            "energy_error": self.energy_error,
            "contact_force_error": self.contact_force_error,
            "max_relative_error": self.max_relative_error,
        }
        check_known(measure, bounds, "certified bound")
        return bounds[measure]


@dataclass(frozen=True, eq=False, kw_only=True)
class Certifier:
    """Certifies candidates for a model, with all that is independent of them precomputed.

    Attributes
    ----------
    system
        The model of the exact solution, usually the full one.
    flexibility
        Factorized H of its static contact problem.
    """

    system: Joint
    flexibility: Flexibility

    @cached_property
    def totals(self) -> Matrix:
        """Rows that sum the forces of each interface (n_interface, n_point)."""
        contact = self.system.contact
        rows = np.zeros((len(contact.slices), contact.n_points))
        for row, points in zip(rows, contact.slices.values(), strict=True):
            row[points] = 1.0
        return rows

    @cached_property
    def total_norms(self) -> Vector:
        """√(1ᵀ H⁻¹ 1) of each interface (n_interface,)."""
        return self.flexibility.norms(self.totals)

    @cached_property
    def rms_factor(self) -> float:
        """Bound of √(Σ λ²/w) per ‖λ‖_H: √c_n of (C15), or (C17) where that may be smaller.

        Without eigenvalues: at ten thousand points they take longer than all else in a run.
        """
        contact = self.system.contact
        by_law = float(np.sqrt(contact.penalty.max()))
        if np.isfinite(by_law) and contact.n_points > self.system.port_compliance.n_relative:
            return by_law
        root = np.sqrt(contact.weights)
        scaled = self.flexibility.solve(np.diag(1.0 / root)) / root
        return min(by_law, float(np.sqrt(np.abs(scaled).sum(axis=1).max())))

    def certify_inputs(
        self,
        inputs: Matrix,
        pressure: Matrix,
        areas: Mapping[tuple[str, str], Mask] | None = None,
    ) -> Certificate:
        """Return the certificates of pressures (..., n_point) under inputs (..., n_input).

        The total force of areas of points (n_point,), as around a bolt of an interface, is bounded
        too.

        Raises
        ------
        ModelError
            If shapes do not fit or a pressure is not finite.
        """
        contact = self.system.contact
        checked = self._checked_pressure(inputs, pressure)
        displacement = static_displacements(self.system.port_compliance, inputs)
        n_relative = self.system.port_compliance.n_relative
        g_free = self.system.contact.free_gap(displacement[..., :n_relative])
        candidate = np.maximum(checked, 0.0)
        forces = candidate * contact.weights
        where = enclose(self.flexibility, g_free, forces)
        force_error = _functional_bound(forces - where.centre, where, self.flexibility.point_norms)
        # ‖λ̂‖_H and the bound of the distance to the exact forces.
        closed = ((where.slack - g_free) * forces).sum(axis=-1)
        norm, distance = np.sqrt(np.maximum(closed, 0.0)), np.sqrt(2 * where.energy)
        error, weights = force_error / contact.weights, contact.weights
        totals = _totals(where, self.totals, self.total_norms)
        low, high = self._pressures(where)
        lowest = self._least_maximum(candidate, low, totals, where)
        return Certificate(
            pressure=candidate,
            clipped_pressure=np.maximum(-checked, 0.0).max(axis=-1, initial=0.0),
            energy=where.energy,
            energy_error=_ratio(distance, norm - distance),
            pressure_low=low,
            pressure_high=high,
            contact_force={name: totals[..., row, :] for row, name in enumerate(contact.slices)},
            contact_force_error=_total_error(forces @ self.totals.T, totals),
            rms_pressure_error=self._rms(forces, where) / np.sqrt(weights.sum()),
            max_relative_error=_ratio(error.max(axis=-1), lowest),
            area_force={} if not areas else self._areas(where, areas),
        )

    def _checked_pressure(self, inputs: Matrix, pressure: Matrix) -> Matrix:
        checked = np.asarray(pressure, dtype=float)
        expected = (*np.shape(inputs)[:-1], self.system.contact.n_points)
        if checked.shape != expected or not np.isfinite(checked).all():
            refuse_model(
                f"the pressure to certify has shape {checked.shape}, expected {expected} finite "
                "values: one per contact point of the full model"
            )
        return checked

    def _pressures(self, where: Enclosure) -> tuple[Matrix, Matrix]:
        """Return bounds (..., n_point) of the exact pressures."""
        reach = _reach(where.radius, self.flexibility.point_norms)
        low = np.maximum(where.centre - reach, 0.0) / self.system.contact.weights
        high = np.maximum(where.centre + reach, 0.0) / self.system.contact.weights
        return low, high

    def _areas(
        self, where: Enclosure, areas: Mapping[tuple[str, str], Mask]
    ) -> dict[tuple[str, str], Matrix]:
        """Return bounds (..., 2) of the exact total forces of areas."""
        rows = np.array(list(areas.values()), dtype=float)
        totals = _totals(where, rows, self.flexibility.norms(rows))
        return {area: totals[..., row, :] for row, area in enumerate(areas)}

    def _least_maximum(
        self, candidate: Matrix, low: Matrix, totals: Matrix, where: Enclosure
    ) -> Vector:
        """Return a lower bound of the largest pressure, (C14).

        It is the largest of the lower bounds at a point, of the mean over an interface, and of the
        mean weighted with a power of the candidate.
        """
        weights = self.system.contact.weights
        means = (totals[..., 0] / (self.totals @ weights)).max(axis=-1)
        lowest: Vector = np.maximum(low.max(axis=-1), means)
        for power in POWERS:
            scale = np.maximum(candidate.max(axis=-1, keepdims=True), np.finfo(float).tiny)
            pattern = (candidate / scale) ** power
            middle = (pattern * where.centre).sum(axis=-1)
            area = np.maximum(pattern @ weights, np.finfo(float).tiny)
            reach = _product(where.radius, self.flexibility.norms(pattern))
            lowest = np.maximum(lowest, (middle - reach) / area)
        return lowest

    def _rms(self, forces: Matrix, where: Enclosure) -> Vector:
        if not self.flexibility.unique:
            return np.full_like(where.energy, np.inf)
        weights = self.system.contact.weights
        offset = np.sqrt(((forces - where.centre) ** 2 / weights).sum(axis=-1))
        whole: Vector = np.sqrt(2 * where.energy) * self.rms_factor
        ball: Vector = offset + where.radius * self.rms_factor
        return np.minimum(ball, whole)


def certifier(system: Joint) -> Certifier:
    """Factorize the flexibility of a model once, to certify many candidates.

    Notes
    -----
    One inverse between pairs, n_relative³, once; then O(n_relative²) per candidate. Hard contact
    takes ⅔ n_point³, and n_point² per candidate.
    """
    return Certifier(system=system, flexibility=joint_flexibility(system))


def certify(model: Joint, load: Load, pressure: Matrix) -> Certificate:
    """Return bounds of the error of a pressure at a static load, without solving the model.

    Parameters
    ----------
    model
        The full model, or any other whose exact static solution is unknown.
    load
        Histories are taken at time zero.
    pressure : (n_point,) [force/length²]
        From any method; negative values are set to zero before.

    Returns
    -------
    Certificate

    Raises
    ------
    ModelError
        If the pressure has another number of points, or the load does not fit the model.

    Notes
    -----
    Rigorous up to round-off (about 1e-12 of ‖λ̂‖_H). The model's compliance must be known, with
    which the exact solution costs milliseconds: certificates are for searches over many loads and
    bases, and for pressures of doubtful origin. See :func:`certifier` for many.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> push = fy.Load({"tip.Fz": -500.0})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    >>> certificate = fy.certify(joint, push, fy.solve_static(rom, push).pressure)
    >>> bool(certificate.max_relative_error < 1e-6)
    True
    """
    inputs = load.inputs(model, np.zeros(1))[0]
    return certifier(model).certify_inputs(inputs, pressure)


def _functional_bound(offset: Matrix, where: Enclosure, norms: Vector) -> Matrix:
    """|λ̂_k − λ*_k| ≤ min(|λ̂_k − c_k| + r h_k, √(2B) h_k), (C10) and (C13)."""
    ball = np.abs(offset) + _reach(where.radius, norms)
    return np.minimum(ball, _reach(np.sqrt(2 * where.energy), norms))


def _totals(where: Enclosure, rows: Matrix, norms: Vector) -> Matrix:
    """Return bounds (..., k, 2) of the exact forces summed by rows of ones (k, n_point), (C13)."""
    middle = where.centre @ rows.T
    reach = _reach(where.radius, norms)
    return np.maximum(np.stack([middle - reach, middle + reach], axis=-1), 0.0)


def _reach(radius: Vector, norms: Vector) -> Matrix:
    """Return the extent r h_k (..., k) of a ball in the directions of several functionals."""
    return _product(radius[..., None], norms)


def _product(radius: Matrix, norm: Matrix) -> Matrix:
    """Return a product that is infinite if either factor is, even if the other is zero."""
    bounded = np.isfinite(radius) & np.isfinite(norm)
    product: Matrix = np.where(np.isfinite(radius), radius, 0.0) * np.where(bounded, norm, 0.0)
    return np.where(bounded, product, np.inf)


def _total_error(pressure: Matrix, totals: Matrix) -> Vector:
    """Return the largest relative distance of the candidates' totals from their bounds."""
    distance = np.abs(pressure[..., None] - totals).max(axis=-1)
    largest: Vector = _ratio(distance, totals[..., 0]).max(axis=-1)
    return largest


def _ratio(numerator: Vector, denominator: Vector) -> Vector:
    """Return a quotient: zero for a zero numerator, else infinite for a denominator ≤ 0."""
    positive = denominator > 0
    quotient = np.asarray(numerator) / np.where(positive, denominator, 1.0)
    return np.where(positive, quotient, np.where(np.asarray(numerator) > 0, np.inf, 0.0))
