"""Contact as a load grows, followed exactly from kink to kink.

Without friction the contact forces of a static problem are piecewise linear in the load factor t:
with the free gap g(t) = a + t b, as long as the same points A are closed,

    λ_A(t) = −H_AA⁻¹ (a_A + t b_A),   s(t) = H λ(t) + a + t b,

(M3). A kink is where a force of A or a slack outside it reaches zero. The points that go on
together from there solve the same problem for the rates λ', s'. ``docs/theory/load_path.md``
derives it.
"""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Mask, Matrix, Vector, frozen
from faying.contact.active_set import solve_complementarity
from faying.contact.closed_points import LinearPiece, closed_points
from faying.contact.dense_points import DensePoints
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.system import Joint
from faying.simulation.load import Load
from faying.simulation.static import port_forces, solved_case

KINK_WIDTH = 1e-10
"""Force or slack, over the largest of the problem, below which a point is at a kink itself.

Points that a symmetry makes equal reach zero together up to round-off, about 1e-13 of the largest;
one that is counted wrongly changes forces by this much at most.
"""


SMALLEST_RATE = 1e-13
"""Rate over the largest one below which a force or a slack does not change."""


Followed = tuple[list[float], list[Vector], list[Mask], Vector, bool]
"""Kinks, forces and closed points there, the last rate, and whether all ended."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class LoadPath:
    """Contact forces of one load as its factor grows from zero, the bolts locked as they are.

    Attributes
    ----------
    system
        What was loaded.
    factors : (n_kink,)
        Load factors at which a point opens or closes, the first one zero, the last one where the
        path ends if it does.
    forces : (n_kink, n_point) [force]
        Contact forces there; linear in between.
    closed : (n_kink, n_point)
        Points in contact right after.
    rate : (n_point,) [force]
        Contact forces per factor after the last kink.
    ended
        Whether no kink follows, so that the rate holds for ever.
    """

    system: Joint
    factors: Vector
    forces: Matrix
    closed: Mask
    rate: Vector
    ended: bool

    def __post_init__(self) -> None:
        for name in ("factors", "forces", "rate"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    def at(self, factor: float) -> Vector:
        """Return the contact forces (n_point,) at a factor.

        Raises
        ------
        ModelError
            If the path was not followed that far.
        """
        if not factor >= 0 or (factor > self.factors[-1] and not self.ended):
            message = (
                f"the path was followed from 0 to {self.factors[-1]:g}, not to {factor:g}; "
                "follow it further"
            )
            raise ModelError(message)
        index = int(np.searchsorted(self.factors, factor, side="right")) - 1
        if index + 1 == len(self.factors):
            return np.asarray(self.forces[-1] + (factor - self.factors[-1]) * self.rate)
        low, high = self.factors[index : index + 2]
        share = (factor - low) / (high - low)
        between: Vector = (1 - share) * self.forces[index] + share * self.forces[index + 1]
        return between

    def first_opening(self, points: Mask | None = None) -> float:
        """Return the factor at which the first point closed at rest opens; infinite if none does.

        Parameters
        ----------
        points : (n_point,), optional
            Points that count, for instance those near a bolt; all unless given.
        """
        watched = self.closed[0] if points is None else self.closed[0] & points
        return self.factor_of(np.asarray((~self.closed & watched).any(axis=1)))

    def loss_of_clamp(self, interface: str) -> float:
        """Return the factor from which an interface carries no force; infinite if always some."""
        points = self.system.contact.slices[interface]
        return self.factor_of(np.asarray(~self.closed[:, points].any(axis=1)))

    def factor_of(self, kinks: Mask) -> float:
        """Return the factor of the first kink of a choice (n_kink,); infinite if it has none."""
        return float(self.factors[kinks.argmax()]) if kinks.any() else np.inf

    def clamp_force(self, interface: str) -> Vector:
        """Return the total normal force of an interface at the kinks (n_kink,) [force]."""
        points = self.system.contact.slices[interface]
        return np.asarray(self.forces[:, points].sum(axis=1))


def load_path(system: Joint, load: Load, *, largest: float = np.inf) -> LoadPath:
    """Follow the contact of a static load from zero, exactly from kink to kink.

    Parameters
    ----------
    system
        Full or reduced model, or ``rom.joint``. Its law must be frictionless.
    load
        What is multiplied by the factor: boundary forces and load patterns; histories are taken at
        time zero. Initial bolt forces stay what they are.
    largest
        Factor to stop at; by default the path is followed until nothing changes any more.

    Raises
    ------
    ModelError
        If the load does not fit, or contact is hard at more points than there are relative
        displacements, whose forces are not unique.
    ConvergenceError
        If the kinks do not end.

    Notes
    -----
    A kink for each point that opens or closes, some hundreds on a joint, and a
    system between the pairs for each.
    """
    return input_path(system, load.inputs(system, np.zeros(1))[0], largest=largest)


def input_path(system: Joint, inputs: Vector, *, largest: float = np.inf) -> LoadPath:
    """Follow the contact as :func:`load_path`, of a load given by its inputs (n_input,)."""
    fixed, growing = growing_displacements(system, inputs)
    a, b = system.contact.free_gap(fixed), np.asarray(system.contact.interpolation @ growing)
    at_rest = solved_case(system, fixed).forces
    solver = closed_points(system.contact, system.static_contact)
    segment = LinearPiece.of(solver, np.column_stack([a, b]))
    walk = Walk(a=a, b=b, at_rest=at_rest)
    factors, forces, closed, rate, ended = walk.followed(segment, largest)
    return LoadPath(
        system=system,
        factors=np.array(factors),
        forces=np.array(forces),
        closed=np.array(closed),
        rate=rate,
        ended=ended,
    )


def growing_displacements(system: Joint, inputs: Vector) -> tuple[Vector, Vector]:
    """Return what pairs (n_relative,) move without contact, at rest and per load factor.

    The bolts stay locked.
    """
    ports = system.port_compliance
    start, growing = inputs.copy(), inputs.copy()
    start[: ports.n_boundary] = 0.0
    start[ports.bolts.stop :] = 0.0
    growing[ports.bolts] = 0.0
    at_rest, rate = port_forces(ports, np.array([start, growing])) @ ports.contact_columns
    return at_rest, rate


@dataclass(frozen=True, eq=False, kw_only=True)
class Walk:
    """The free gap a + t b, and the contact forces at t = 0."""

    a: Vector
    b: Vector
    at_rest: Vector

    def followed(self, segment: LinearPiece, largest: float) -> Followed:
        """Go from piece to piece, starting from any.

        Raises
        ------
        ConvergenceError
            If the kinks do not end.
        """
        a, t, forces = self.a, 0.0, self.at_rest
        segment = segment.moved_to(forces > 0)
        slack = np.where(forces > 0, 0.0, np.maximum(segment.slack[:, 0], 0.0))
        segment = self._onward(t, forces, slack, forces > 0, segment)
        factors, forces_at, closed = [0.0], [forces], [segment.active]
        for _ in range(50 * len(a) + 200):
            active, (base, rate) = segment.active, segment.forces.T
            opening = _roots(base, rate, t, active)
            gap_base, gap_rate = segment.slack.T
            closing = _roots(gap_base, gap_rate, t, ~active)
            following = float(min(opening.min(initial=np.inf), closing.min(initial=np.inf)))
            if following > largest or not np.isfinite(following):
                if np.isfinite(largest):
                    factors.append(largest)
                    forces_at.append(np.maximum(base + largest * rate, 0.0))
                    closed.append(active)
                return factors, forces_at, closed, rate.copy(), not np.isfinite(following)
            t = following
            forces = np.where(active, np.maximum(base + t * rate, 0.0), 0.0)
            slack = np.where(active, 0.0, np.maximum(gap_base + t * gap_rate, 0.0))
            turned = active ^ ((opening <= t) | (closing <= t))
            segment = self._onward(t, forces, slack, turned, segment)
            if t > factors[-1]:
                factors.append(t)
                forces_at.append(forces)
                closed.append(segment.active)
            else:
                forces_at[-1], closed[-1] = forces, segment.active
        message = (
            f"the contact of {len(a)} points does not settle as the load grows beyond factor "
            f"{t:g}; check that the stiffness matrix is symmetric and the structure held"
        )
        raise ConvergenceError(message)

    def _onward(
        self, t: float, forces: Vector, slack: Vector, turned: Mask, segment: LinearPiece
    ) -> LinearPiece:
        """Return the piece right after a kink.

        Parameters
        ----------
        turned
            The points closed there if one point alone changes sides.
        """
        # Of what cancels: where all points let go at once, gap and forces themselves vanish.
        gap = (np.abs(self.a) + t * np.abs(self.b)).max(initial=0.0)
        closing = forces * segment.solver.self_compliance
        small = KINK_WIDTH * max(gap, np.abs(closing).max(initial=0.0))
        at_once = (closing <= small) & (slack <= small)
        if np.count_nonzero(at_once) <= 1:
            return segment.moved_to(turned)
        closed, both = (forces > 0) & ~at_once, np.flatnonzero(at_once)
        pressed = segment.moved_to(closed)
        H, q = pressed.between(both), pressed.slack[both, 1]
        closed = closed.copy()
        closed[both] = solve_complementarity(DensePoints(H=(H + H.T) / 2), q).forces > 0
        return pressed.moved_to(closed)


def _roots(base: Vector, rate: Vector, t: float, chosen: Mask) -> Vector:
    """Return where chosen values base + t rate that fall reach zero; infinite for the others."""
    falling = chosen & (rate < -SMALLEST_RATE * np.abs(rate).max(initial=0.0))
    roots = np.full(len(base), np.inf)
    roots[falling] = np.maximum(-base[falling] / rate[falling], t)
    return roots
