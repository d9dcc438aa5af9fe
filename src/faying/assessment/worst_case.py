"""The load of a box that a reduced model gets most wrong, found without full solutions."""

from dataclasses import dataclass, field, replace
from itertools import product
from typing import final

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.accuracy import Accuracy, compare
from faying.assessment.certificate import Certificate, Certifier, Measure, certifier
from faying.assessment.recovery import Recovered, solve_at_ports, solve_cases_at_ports
from faying.exceptions import ModelError
from faying.reduction.reduced_model import ReducedModel
from faying.reduction.snapshots import LoadBox
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.static import solve_static, solve_static_cases

MOST_CORNERS = 1024
"""Corners tried; a random choice of them where the box has more."""

SMALLEST_STEP = 1 / 64
"""Step of the local search, as a part of each range, at which it ends."""

DOUBTFUL = 1e-4
"""Certified energy errors above this are no round-off; below, full solutions tell.

The certificate has a round-off of its own: 1e-13 at full solutions of the default cantilever, but
1e-6 at those of a double lap joint.
"""

ROUND_OFF = 1e-7
"""Pressure errors below this are what solvers leave, not what a basis lacks.

Measured at most 1e-12 on the default cantilever and 1e-8 on a double lap joint with a residual
compliance. The largest of them moves to another load with the last digits of any number.
"""

STARTS = 3
"""Local searches, from the worst loads known until then."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class WorstCase:
    """The worst load found.

    Attributes
    ----------
    load
        Named ``"worst case"``.
    measure
        Certified quantity that was maximized.
    bound
        Its value at the load: no more than this is wrong there.
    certificate
        Of the reduced solution at the load.
    reduced, exact
        Static solutions of the reduced and, once, of the full model.
    accuracy
        The true error.
    evaluations
        Loads that were judged by their certificate.
    within_round_off
        Whether the reduced model is exact to round-off at every load tried. None is then worse
        than another: nothing is searched, and the load is the lowest corner of the box.
    """

    load: Load
    measure: Measure
    bound: float
    certificate: Certificate
    reduced: Solution
    exact: Recovered
    accuracy: Accuracy
    evaluations: int
    within_round_off: bool = False


def worst_case_load(
    rom: ReducedModel,
    box: LoadBox,
    *,
    measure: Measure = "energy_error",
    samples: int = 100,
    seed: int = 0,
) -> WorstCase:
    """Search a load box for the static load with the largest certified error; confirm it.

    Corners, the middle and random loads first, then a pattern search from the worst of them,
    unless the model is exact to round-off at all of these. The same seed gives the same load.

    Parameters
    ----------
    box
        Load ranges and preload factors (any value between the smallest and the largest factor).
    measure
        What is maximized; ``"energy_error"`` follows the true error most closely.
    samples
        Random loads.

    Raises
    ------
    ModelError
        If the box names a boundary the model lacks.

    Notes
    -----
    One reduced solution and certificate per load tried, some milliseconds each, and a single
    solution of the full model; one at each of the first loads where only full solutions can tell
    errors from round-off. A maximum over samples is a lower estimate of the maximum over the box:
    the certificate holds at every load tried, not between them.
    """
    search = _Search(rom=rom, box=box, judge=certifier(rom.joint), measure=measure)
    rng = np.random.default_rng(seed)
    places = np.vstack([_corners(search.dimension, rng), rng.random((samples, search.dimension))])
    judged = search.certificate(places)
    evaluations = len(places)
    if float(np.max(judged.energy_error)) <= DOUBTFUL and _within_round_off(search, places):
        lowest = search.load(places[0], "worst case")
        return replace(_confirmed(search, lowest, evaluations), within_round_off=True)
    bounds = judged.bound(measure)
    order = np.argsort(-bounds, kind="stable")[:STARTS]
    finalists = [_climb(search, places[row], float(bounds[row])) for row in order]
    evaluations += sum(tried for _, _, tried in finalists)
    place = max(finalists, key=lambda finalist: finalist[1])[0]
    return _confirmed(search, search.load(place, "worst case"), evaluations)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Search:
    """A box as the unit cube, judged by certificates."""

    rom: ReducedModel
    box: LoadBox
    judge: Certifier
    measure: Measure
    low: Vector = field(init=False)
    high: Vector = field(init=False)

    def __post_init__(self) -> None:
        factors = self.box.preload_factors
        bounds = [*self.box.ranges.values(), (min(factors), max(factors))]
        low, high = np.array(bounds, dtype=float).T
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)

    @property
    def dimension(self) -> int:
        """Load components, and the preload factor."""
        return len(self.low)

    def load(self, place: Vector, name: str = "trial") -> Load:
        """Load at a place of the unit cube."""
        *values, factor = (self.low + place * (self.high - self.low)).tolist()
        bolts = {bolt: factor * b.initial_force for bolt, b in self.rom.bolts.items()}
        return Load(dict(zip(self.box.ranges, values, strict=True)), name=name, bolt_forces=bolts)

    def certificate(self, places: Matrix) -> Certificate:
        """Certificate of the reduced model at places (n, dimension)."""
        cases = solve_static_cases(self.rom, [self.load(place) for place in places])
        return self.judge.certify_inputs(cases.inputs, cases.pressure)


def _within_round_off(search: _Search, places: Matrix) -> bool:
    """Say whether pressures at all places are those of the full model, which is cheap by then."""
    loads = [search.load(place) for place in places]
    found = solve_static_cases(search.rom, loads).pressure
    full = solve_cases_at_ports(search.rom.joint, loads)
    errors = np.abs(found - full.pressure).max(axis=1)
    return bool((errors <= ROUND_OFF * full.max_pressure).all())


def _corners(dimension: int, rng: np.random.Generator) -> Matrix:
    """Corners of the unit cube and its middle."""
    if 2**dimension <= MOST_CORNERS:
        corners = np.array(list(product((0.0, 1.0), repeat=dimension)))
    else:
        corners = rng.integers(0, 2, (MOST_CORNERS, dimension)).astype(float)
    return np.vstack([corners, np.full(dimension, 0.5)])


def _climb(search: _Search, place: Vector, bound: float) -> tuple[Vector, float, int]:
    """Pattern search: move to the worst neighbour, halve the step where none is worse."""
    step, tried = 0.25, 0
    directions = np.vstack([np.eye(search.dimension), -np.eye(search.dimension)])
    while step >= SMALLEST_STEP and np.isfinite(bound):
        neighbours = np.clip(place + step * directions, 0.0, 1.0)
        bounds = search.certificate(neighbours).bound(search.measure)
        tried += len(neighbours)
        worst = int(np.argmax(bounds))
        if bounds[worst] > bound:
            place, bound = neighbours[worst], float(bounds[worst])
        else:
            step /= 2
    return place, bound, tried


def _confirmed(search: _Search, load: Load, evaluations: int) -> WorstCase:
    reduced = solve_static(search.rom, load)
    exact = solve_at_ports(search.rom.joint, load)
    if exact.max_pressure <= 0:
        message = (
            "the interfaces open entirely at the worst load of the box, so no relative error "
            "exists; reduce the ranges or raise the preload factors"
        )
        raise ModelError(message)
    certificate = search.judge.certify_inputs(reduced.inputs, reduced.pressure)
    return WorstCase(
        load=load,
        measure=search.measure,
        bound=float(certificate.bound(search.measure)),
        certificate=certificate,
        reduced=reduced,
        exact=exact,
        accuracy=compare(reduced, exact),
        evaluations=evaluations,
    )
