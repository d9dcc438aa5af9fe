"""The number of normal modes that the pressures of a transient need, by estimated errors.

The residual compliance keeps the static part of what is left out, so that only modes that are
moved faster than they can follow statically matter. ``docs/theory/transient_accuracy.md`` has what
was measured.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import final

import numpy as np

from faying._typing import Frozen, Indices, Matrix, Vector
from faying.assessment.transient_error import (
    LARGE_ERROR,
    OBSERVED_RATIOS,
    finer_model,
    stepped,
    transient_error,
)
from faying.digits import CURVE_POINTS
from faying.exceptions import ConvergenceError, ModelError
from faying.joint.model import Model
from faying.joint.system import System
from faying.linalg.memory import NotEnoughMemoryError
from faying.linalg.singular import InertiaError
from faying.reduction.craig_bampton import classic_basis
from faying.reduction.mode_count import count_modes_below
from faying.reduction.normal_modes import NormalModes, fixed_interface_normal_modes
from faying.reduction.projection import projected
from faying.simulation.instants import check_times
from faying.simulation.integrators import Integrator
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.static import AT_REST

FEWEST_MODES, MOST_MODES = 5, 320
"""Normal modes that are tried first, then twice as many, and so on, and last."""

LARGEST_RATIO = 1.25
"""Estimated error over the least of all from which on fewer modes are not as good as more."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class NormalModeChoice(Frozen):
    """How many normal modes a pressure tolerance of a transient needs.

    Attributes
    ----------
    count : [1]
        Chosen number of normal modes: of those tried the fewest within the tolerance, or, where
        none is, the fewest that are as good as the best (``met``).
    met
        Whether the estimated error over :data:`~.transient_error.OBSERVED_RATIOS`, the most
        that the true one was seen to be, is within the tolerance.
    tolerance : [1]
        Largest pressure error over the peak that was asked for.
    excited : [1/time]
        Up to which the loads move an oscillator by more than the tolerance beside its static
        response, as far as time steps follow.
    resolved : [1/time]
        Steps per time: modes above it have periods shorter than a step.
    counts : (n,) [1]
        Numbers of normal modes that were tried.
    highest : (n,) [1/time]
        Highest frequency of each number.
    estimates : (n,) [1]
        Largest pressure error of each over the peak, estimated; infinite where that failed.
    tractions : (n_traction,) [1]
        Largest traction error of each over the largest traction, estimated likewise; zero where
        there is none, NaN where that failed. The choice does not look at it. Files of before have
        none where nothing rubs.
    """

    count: int
    met: bool
    tolerance: float
    excited: float
    resolved: float
    counts: Indices
    highest: Vector
    estimates: Vector
    tractions: Vector = field(default_factory=lambda: np.empty(0))

    @property
    def error(self) -> float:
        """Estimated error of the chosen number."""
        return float(self.estimates[self.counts == self.count][0])

    @property
    def traction_error(self) -> float:
        """Estimated traction error of the chosen number."""
        counted = self.counts[: len(self.tractions)] == self.count
        return float(self.tractions[counted].sum())


def choose_normal_modes(
    model: Model,
    load: Load,
    *,
    step: float,
    duration: float,
    integrator: Integrator | None = None,
    tolerance: float = LARGE_ERROR,
    step_tolerance: float | None = None,
    rest: Callable[[System], Solution] | None = None,
    modes: Callable[[int], NormalModes] | None = None,
) -> NormalModeChoice:
    """Find the normal modes that a transient under residual compliance needs for its pressures.

    Parameters
    ----------
    model
        The full model; no time step of it is solved.
    load, step, duration, integrator
        As :func:`faying.solve_transient`.
    tolerance
        Largest pressure error of the reduction over the peak.
    step_tolerance
        With it time steps are divided as by ``tolerance`` of :func:`faying.solve_transient`; all
        numbers of modes take those of the first.
    rest
        Returns the static solution that a reduced model starts from; by default the joint under
        its bolts alone.
    modes
        Returns so many of the lowest normal modes; unless given they are computed.

    Raises
    ------
    ModelError
        If step, duration or tolerance is not positive, or the structure has no mass.

    Notes
    -----
    The first number tried, 5, 10, 20 … 320, is the one whose modes reach up to what the loads
    excite, which one factorization counts. Each takes a Lanczos run, a projection and two reduced
    transients (:func:`faying.transient_error`). More are tried until 2.5 times the estimate is
    within the tolerance, modes have periods shorter than a step, or the last two estimates say that
    320 modes would not do either. Estimates are no bounds. Tractions are estimated too, and often
    off by several times as much.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
    >>> joint = fy.preload(joint, {"bolt": 10e3})
    >>> tap = fy.Load({"tip.Fz": -50.0})
    >>> fy.choose_normal_modes(joint, tap, step=1e-5, duration=2e-4, tolerance=0.1).met
    True
    """
    check_times(step, duration)
    if not tolerance > 0:
        message = f"the tolerance is {tolerance:g}; give a positive share of the largest pressure"
        raise ModelError(message)
    modes_of = modes or (lambda count: fixed_interface_normal_modes(model.structure, count))
    start: Callable[[System], Solution | None] = rest or (lambda _: None)

    def estimate(basis: NormalModes, steps: Indices | None) -> tuple[float, float, Indices | None]:
        rom = projected(model, classic_basis(model, basis), compliance=True)
        times = step, duration, integrator
        try:
            motion = stepped(rom, load, *times, start(rom), step_tolerance, steps)
            finer = finer_model(model, motion)
            error = transient_error(
                finer, motion, load, integrator=integrator, initial=start(finer)
            )
        except ConvergenceError:
            return np.inf, np.nan, steps
        return error.max_relative_error, error.max_traction_error or 0.0, motion.substeps

    resolved, excited = 1.0 / step, excited_frequency(model, load, step, duration, tolerance)
    counts, highest, estimates, tractions = [], [], [], []
    enough = OBSERVED_RATIOS[0] * tolerance
    steps: Indices | None = None
    for count in _numbers(len(model.structure.interior), _moved(model, excited)):
        basis = modes_of(count)
        error, rubbed, steps = estimate(basis, steps)
        counts.append(count)
        highest.append(float(basis.frequencies.max(initial=0.0)))
        estimates.append(error)
        tractions.append(rubbed)
        if steps is not None:
            resolved = float(steps.max()) / step
        if error <= enough or highest[-1] > resolved or _hopeless(estimates, count, enough):
            break
    return NormalModeChoice(
        count=_chosen(counts, estimates, enough),
        met=estimates[-1] <= enough,
        tolerance=tolerance,
        excited=excited,
        resolved=resolved,
        counts=np.array(counts),
        highest=np.array(highest),
        estimates=np.array(estimates),
        tractions=np.array(tractions),
    )


def _numbers(n_interior: int, first: int) -> list[int]:
    """Return the numbers of modes to try, rising, from ``first`` or the last on."""
    doubled = [FEWEST_MODES]
    while doubled[-1] < MOST_MODES:
        doubled.append(2 * doubled[-1])
    every = sorted({min(count, n_interior) for count in doubled})
    return [count for count in every if count >= first] or every[-1:]


def _moved(model: Model, excited: float) -> int:
    """Return how many modes lie below a frequency; none where they cannot be counted."""
    try:
        return count_modes_below(model, excited) if excited > 0 else 0
    except (InertiaError, NotEnoughMemoryError):
        return 0  # what is then tried besides are fewer modes


def _hopeless(estimates: list[float], count: int, tolerance: float) -> bool:
    """Say whether errors that go on falling as they last did stay above the tolerance."""
    if len(estimates) < 2 or not np.isfinite(estimates[-1]):
        return False
    previous, now = estimates[-2:]
    if now >= previous:
        return len(estimates) > 2  # once may be chance
    at_most: float = (
        now * (now / previous) ** np.log2(MOST_MODES / count) if np.isfinite(previous) else 0.0
    )
    return bool(at_most > tolerance)


def _chosen(counts: list[int], estimates: list[float], tolerance: float) -> int:
    enough = max(tolerance, LARGEST_RATIO * min(estimates))
    return next(n for n, error in zip(counts, estimates, strict=True) if error <= enough)


def excited_frequency(
    model: Model, load: Load, step: float, duration: float, tolerance: float
) -> float:
    """Return the frequency [1/time] up to which a load excites what time steps follow.

    An undamped oscillator of frequency f under a load F(t) is beside its static response by
    ∫ F′(τ) cos 2πf(t − τ) dτ, in terms of what F does statically. Above the frequency returned that
    is less than the tolerance at all instants, of every load over its own largest value; or a step
    takes more than a radian of the oscillation.
    """
    times: Vector = step * np.arange(round(duration / step) + 1, dtype=np.float64)
    inputs = load.inputs(model, times) - AT_REST.inputs(model, np.zeros(1))
    peaks = np.abs(inputs).max(axis=0)
    forces = inputs[:, peaks > 0] / peaks[peaks > 0]
    resolved = 1.0 / (2 * np.pi * step)
    for frequency in resolved * np.geomspace(1.0, 1e-4, CURVE_POINTS):
        if _beside_static(forces, times, frequency) > tolerance:
            return float(frequency)
    return 0.0


def _beside_static(forces: Matrix, times: Vector, frequency: float) -> float:
    """Return the largest of the integrals of forces that are linear between instants."""
    step, turn = times[1], np.exp(2j * np.pi * frequency * times)[:, None]
    middle = np.sinc(frequency * step) * np.exp(1j * np.pi * frequency * step)
    changes = np.vstack([forces[:1], middle * np.diff(forces, axis=0)])
    return float(np.abs((turn * np.cumsum(changes / turn, axis=0)).real).max(initial=0.0))
