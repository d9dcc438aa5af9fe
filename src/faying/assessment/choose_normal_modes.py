"""Choice of the number of normal modes for the pressures of a transient, by estimated errors.

The residual compliance keeps the static part of the omitted modes, so only modes whose motion is
not quasi-static matter. ``docs/theory/transient_accuracy.md`` has the measurements.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

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
"""First and last number of normal modes to try; each is twice the one before."""

LARGEST_RATIO = 1.25
"""Estimated error over the least of all below which fewer modes are as good as more."""


@dataclass(frozen=True, eq=False, kw_only=True)
class NormalModeChoice(Frozen):
    """The number of normal modes for a pressure tolerance of a transient.

    Attributes
    ----------
    count : [1]
        Chosen number of normal modes: the smallest tried number within the tolerance, or, if none
        is, the smallest that is as good as the best (``met``).
    met
        Whether the estimated error, over its smallest ratio to the true one in
        :data:`~.transient_error.OBSERVED_RATIOS`, is within the tolerance.
    tolerance : [1]
        Given limit of the pressure error over the peak.
    excited : [1/time]
        Frequency up to which the loads excite an oscillator beyond its static response by more
        than the tolerance, as far as time steps resolve it.
    resolved : [1/time]
        Steps per time: modes above it have periods shorter than a step.
    counts : (n,) [1]
        Tried numbers of normal modes.
    highest : (n,) [1/time]
        Highest frequency of each number.
    estimates : (n,) [1]
        Estimated largest pressure error of each over the peak; infinite if the estimate failed.
    tractions : (n_traction,) [1]
        Estimated largest traction error of each over the largest traction; zero without
        tractions, NaN if the estimate failed. It does not affect the choice. Files of earlier
        versions have none without friction.
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
    """Return the number of normal modes for the pressures of a transient with residual compliance.

    Parameters
    ----------
    model
        The full model; no time step of it is solved.
    load, step, duration, integrator
        As :func:`faying.solve_transient`.
    tolerance
        Largest pressure error of the reduction over the peak.
    step_tolerance
        Tolerance for dividing time steps, as ``tolerance`` of :func:`faying.solve_transient`; all
        numbers of modes take the steps of the first.
    rest
        Function that returns the static solution from which a reduced model starts; by default
        the joint under its bolts alone.
    modes
        Function that returns a number of the lowest normal modes; by default they are computed.

    Raises
    ------
    ModelError
        If step, duration or tolerance is not positive, or the structure has no mass.

    Notes
    -----
    Numbers are 5, 10, 20 … 320. The first one tried covers the excited frequencies, which one
    factorization counts. Each takes a Lanczos run, a projection and two reduced transients
    (:func:`faying.transient_error`). More are tried until 2.5 times the estimate is within the
    tolerance, modes have periods shorter than a step, or the last two estimates indicate that 320
    modes would not suffice. Estimates are no bounds. Those of tractions are often several times
    less accurate.

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
    for count in _numbers(len(model.structure.interior), _excited_modes(model, excited)):
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
    """Return the numbers of modes to try, in ascending order, from ``first`` or the last on."""
    doubled = [FEWEST_MODES]
    while doubled[-1] < MOST_MODES:
        doubled.append(2 * doubled[-1])
    every = sorted({min(count, n_interior) for count in doubled})
    return [count for count in every if count >= first] or every[-1:]


def _excited_modes(model: Model, excited: float) -> int:
    """Return the number of modes below a frequency; 0 if they cannot be counted."""
    try:
        return count_modes_below(model, excited) if excited > 0 else 0
    except (InertiaError, NotEnoughMemoryError):
        return 0  # then fewer modes are tried first


def _hopeless(estimates: list[float], count: int, tolerance: float) -> bool:
    """Return whether errors stay above the tolerance if they fall on at their last rate."""
    if len(estimates) < 2 or not np.isfinite(estimates[-1]):
        return False
    previous, now = estimates[-2:]
    if now >= previous:
        return len(estimates) > 2  # one step may be chance
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

    An undamped oscillator of frequency f under a load F(t) differs from its static response by
    ∫ F′(τ) cos 2πf(t − τ) dτ, relative to the static response to F. Above the frequency returned
    this is less than the tolerance at all instants, for every load over its largest value; or a
    step is longer than a radian of the oscillation.
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
    """Return the largest of these integrals for forces that are linear between instants."""
    step, turn = times[1], np.exp(2j * np.pi * frequency * times)[:, None]
    middle = np.sinc(frequency * step) * np.exp(1j * np.pi * frequency * step)
    changes = np.vstack([forces[:1], middle * np.diff(forces, axis=0)])
    return float(np.abs((turn * np.cumsum(changes / turn, axis=0)).real).max(initial=0.0))
