"""Slip by sums: the friction that an area needs for its tangential forces.

Without a friction law no single point of an interface indicates slip. Sums do, as in VDI 2230: the
clamp force F_K, and the tangential resultant, a force F_Q and a moment M about the centre of
pressure. With the mean arm of pressure r about the point of its minimum,

    μ_needed = F_Q / F_K + |M| / (F_K r),   S_G = μ / μ_needed.

At S_G ≥ 1 tangential tractions of at most μ p carry the load; ``docs/theory/slip_by_sums.md``
derives it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from faying._typing import Mask, Matrix, Vector
from faying.contact.contact import Contact
from faying.digits import DECK_DIGITS, ROUND_OFF
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import surroundings
from faying.joint.system import Joint
from faying.joint.tangential import CURVED, TangentialRows

MOST_PASSES = 1000
"""Passes after which the search for the point of the least mean arm ends.

Of 160 sets of 20 random pressures on points, lines and grids 23 need more for some; their arm is
then too long by 4e-5 at most.
"""

BENT_SHARE = 0.01
"""What tilted points press along the plane of an area over the clamp force, up to which it is flat.

The friction needed is off by no more: a hundredth, to which coefficients are known at best.
"""

SMALLEST_FRICTION = DECK_DIGITS
"""Needed coefficient that counts as zero, below that of any surfaces; round-off is 1e-14."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SlipDemand:
    """The friction that an area needs, over static load cases.

    Attributes
    ----------
    tangential_force : [force]
        Load case to F_Q, the tangential force.
    moment : [force·length]
        Load case to M, the moment about the normal through the centre of pressure.
    clamp_force : [force]
        Load case to F_K.
    needed_friction : [1]
        Load case to the coefficient needed for both; infinite without contact.
    coefficient : [1]
        Coefficient of friction of the area; None where none is given.
    safety : [1]
        Load case to S_G, the coefficient over the needed one, for loads that need friction.
    unknown
        Why none of this is known; empty if it is known.
    """

    tangential_force: Mapping[str, float] = field(default_factory=dict)
    moment: Mapping[str, float] = field(default_factory=dict)
    clamp_force: Mapping[str, float] = field(default_factory=dict)
    needed_friction: Mapping[str, float] = field(default_factory=dict)
    coefficient: float | None = None
    safety: Mapping[str, float] = field(default_factory=dict)
    unknown: str = ""

    @property
    def asked(self) -> bool:
        """Whether tangential loads act on the area, with or without a known result."""
        return bool(self.needed_friction or self.unknown)


NO_DEMAND = SlipDemand()
"""Demand of an area without static load cases."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AreaSums:
    """Sums over an area, one entry per load case.

    Attributes
    ----------
    clamp_force, tangential_force : (n_case,) [force]
    moment : (n_case,) [force·length]
    needed_friction : (n_case,) [1]
        Infinite where the area is bent.
    bent : (n_case,)
        Whether it presses in several directions, so that no plane has its resultants.
    """

    clamp_force: Vector
    tangential_force: Vector
    moment: Vector
    needed_friction: Vector
    bent: Mask


def area_sums(
    area: TangentialRows, points: Matrix, normals: Matrix, forces: Matrix, carried: Matrix
) -> AreaSums:
    """Return the sums of pressure and tangential forces over an area.

    It has points (n_point, 3) [length] and normals (n_point, 3) with contact forces
    (n_case, n_point) [force]; ``carried`` (n_case, 3) [force], [force·length] comes from
    :meth:`TangentialRows.carried`.
    """
    places = (points - area.origin) @ area.tangents.T
    facing = normals @ np.cross(*area.tangents) > 0
    tilts = np.where(facing, np.hypot(*(normals @ area.tangents.T).T), 1.0)
    clamp = forces.sum(axis=1)
    pressed = clamp > 0
    shares = forces / np.where(pressed, clamp, 1.0)[:, None]
    centre = shares @ places
    tangential = np.hypot(*carried[:, :2].T)
    moment = np.abs(carried[:, 2] - centre[:, 0] * carried[:, 1] + centre[:, 1] * carried[:, 0])
    turned = clamp * least_mean_arm(places, shares)
    needed = _quotient(tangential, clamp) + _quotient(moment, turned)
    bent = forces @ tilts > BENT_SHARE * clamp
    needed[bent] = np.inf
    return AreaSums(
        clamp_force=clamp,
        tangential_force=tangential,
        moment=moment,
        needed_friction=needed,
        bent=bent,
    )


def _quotient(load: Vector, resistance: Vector) -> Vector:
    """Return a quotient: infinite for a load without resistance, zero without load."""
    quotient = load / np.where(resistance > 0, resistance, 1.0)
    return np.where(resistance > 0, quotient, np.where(load > 0, np.inf, 0.0))


def least_mean_arm(places: Matrix, shares: Matrix) -> Vector:
    """Return the least mean distance (n_case,) of places from any one point, weighted by shares.

    Places are (n_point, 2) [length]; shares (n_case, n_point) are not negative, and their sum is
    one, or zero.

    Notes
    -----
    From the centre by Newton's method, and where that fails by E. Weiszfeld, "Sur le point pour
    lequel la somme des distances de n points donnés est minimum", Tohoku Math. J. 43 (1937)
    355-386. Distances change only in second order, so a few passes suffice.
    """
    # The weight of a place is bounded near it: at zero distance it would be infinite.
    reach = DECK_DIGITS * float(np.ptp(places, axis=0).max(initial=0.0))
    point = shares @ places
    arms, left = _mean_arms(places, shares, point), np.arange(len(shares))
    for _ in range(MOST_PASSES):
        fast, slow = _nearer(places, shares[left], point[left], reach)
        arms_found = _mean_arms(places, shares[left], fast)
        worse = ~(arms_found < arms[left])
        arms_found[worse] = _mean_arms(places, shares[left[worse]], slow[worse])
        better = arms[left] - arms_found > ROUND_OFF * arms[left]
        point[left] = np.where(worse[:, None], slow, fast)
        arms[left] = np.minimum(arms[left], arms_found)
        left = left[better]
        if not len(left):
            break
    # If a place itself is the point, the search ends close to it.
    away = np.hypot(*(places - point[:, None]).transpose(2, 0, 1))
    at_place = _mean_arms(places, shares, places[away.argmin(axis=1)])
    return np.minimum(arms, at_place)


def _mean_arms(places: Matrix, shares: Matrix, point: Matrix) -> Vector:
    """Return the mean distances (n_case,) of places from points (n_case, 2)."""
    x, y = (places - point[:, None]).transpose(2, 0, 1)
    return np.asarray((shares * np.hypot(x, y)).sum(axis=1))


def _nearer(places: Matrix, shares: Matrix, point: Matrix, reach: float) -> tuple[Matrix, Matrix]:
    """Return the next points (n_case, 2) of Newton's and of Weiszfeld's method."""
    x, y = (places - point[:, None]).transpose(2, 0, 1)
    arms = np.maximum(np.hypot(x, y), reach)
    pulls = shares / arms
    total = np.maximum(pulls.sum(axis=1), np.finfo(float).tiny)
    pull = np.stack([(pulls * x).sum(axis=1), (pulls * y).sum(axis=1)], axis=1)
    bends = pulls / arms**2
    xx, xy, yy = ((bends * factor).sum(axis=1) for factor in (y * y, -x * y, x * x))
    size = xx * yy - xy**2
    solvable = size > ROUND_OFF * total**2
    scale = np.where(solvable, size, 1.0)
    step = np.stack([yy * pull[:, 0] - xy * pull[:, 1], xx * pull[:, 1] - xy * pull[:, 0]], axis=1)
    slow = point + pull / total[:, None]
    fast = np.where(solvable[:, None], point + step / scale[:, None], slow)
    return fast, slow


def slip_coefficients(
    contact: Contact,
    smallest: float | None,
    of_smooth: float | Mapping[str, float] | None,
) -> dict[str, float]:
    """Return the coefficient of friction for each interface that has one.

    Interfaces with friction have that of their law, or the smallest if it scatters; smooth ones
    have the given coefficients.
    """
    given = of_smooth
    if not isinstance(given, Mapping):
        given = dict.fromkeys(contact.laws, given or 0.0)
    laws = contact.laws
    if smallest is not None:
        laws = {name: law.with_coefficient(smallest) for name, law in laws.items()}
    coefficients = {name: law.friction_or(given.get(name, 0.0)) for name, law in laws.items()}
    return {name: coefficient for name, coefficient in coefficients.items() if coefficient > 0}


def slip_demands(
    joint: Joint,
    surfaces: Mapping[str, ContactSurface],
    rows: Sequence[TangentialRows],
    cases: Sequence[str],
    inputs: Matrix,
    pressure: Matrix,
    coefficients: Mapping[str, float],
) -> dict[tuple[str, str], SlipDemand]:
    """Return the demand of every area, by interface and bolt; an empty bolt is the whole interface.

    Rows are those of the same model. Static load cases have inputs (n_case, n_input) and pressures
    (n_case, n_point) [force/length²].
    """
    forces = pressure * joint.contact.weights
    pairs, around = joint.contact.at_pairs(forces).T, surroundings(surfaces, joint.bolts)
    demands = {}
    for area in rows:
        coefficient = coefficients.get(area.interface)
        if area.unknown:
            demand = SlipDemand(coefficient=coefficient, unknown=area.unknown)
        else:
            surface = surfaces[area.interface]
            columns = slice(*surface.slice)
            points = around[area.interface, area.bolt][columns] if area.bolt else slice(None)
            sums = area_sums(
                area,
                surface.points[points],
                surface.normals[points],
                forces[:, columns][:, points],
                area.carried(inputs, pairs),
            )
            demand = _demand(sums, cases, coefficient)
            if sums.bent.any():
                demand = SlipDemand(coefficient=coefficient, unknown=CURVED)
        demands[area.interface, area.bolt] = demand
    return demands


def _demand(sums: AreaSums, cases: Sequence[str], coefficient: float | None) -> SlipDemand:
    def by_case(values: Vector) -> dict[str, float]:
        return dict(zip(cases, values.tolist(), strict=True))

    needed = sums.needed_friction
    rubbed = {} if coefficient is None else by_case(needed)
    safety = {
        n: (coefficient or 0.0) / rubbing
        for n, rubbing in rubbed.items()
        if rubbing > SMALLEST_FRICTION
    }
    return SlipDemand(
        tangential_force=by_case(sums.tangential_force),
        moment=by_case(sums.moment),
        clamp_force=by_case(sums.clamp_force),
        needed_friction=by_case(needed),
        coefficient=coefficient,
        safety=safety,
    )
