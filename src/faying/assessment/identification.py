"""Parameters of a joint from measured backbones by least squares, and their uncertainty."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.optimize import least_squares
from scipy.stats import t as student

from faying._typing import Mask, Matrix, Vector
from faying.assessment.backbone import Backbone
from faying.assessment.measured_curve import MeasuredCurve
from faying.assessment.parameter import Parameter, values_at
from faying.display.facts import Shown
from faying.exceptions import ModelError, refuse_model
from faying.simulation.cycles import STATIONARY

STEP = 0.02
"""Share of a range as first step for derivatives, and a fifth of the longest.

Cycles repeat to 1e-3 of their energy, which is the noise of a damping ratio: if a step changes it
by a few percent, the noise is a few percent of the derivative.
"""

Compute = Callable[[Sequence[Mapping[str, float]]], Sequence[Mapping[str, Backbone]]]
"""Function from parameter values, one mapping a trial, to backbones by the name of the curve."""


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Identification(Shown):
    """Parameters identified from measured backbones.

    Attributes
    ----------
    parameters
        Given parameters.
    values
        Name to the best-fitting value.
    intervals
        Name to both ends of its 95 % interval, within the range.
    correlations : (n_parameter, n_parameter) [1]
        Correlations of the errors of the values.
    directions : (n_parameter, n_parameter) [1]
        Rows: combinations of parameters, as shares of their ranges, the most certain first.
    spreads : (n_parameter,) [1]
        Standard deviation along each direction, over the ranges.
    misfit : [1]
        Root mean square of the deviations over the scatter of the measurements, per degree of
        freedom; about 1 where the model explains the data.
    residuals : (n_residual,) [1]
        Logarithm of computed over measured, over the scatter: curve by curve, frequencies first.
    curves
        Name of each measured curve to the best-fitting computed backbone.
    trials
        Number of computed sets of parameters.
    remarks
        Remarks for the reader, also on parameters that the data do not determine.
    """

    parameters: tuple[Parameter, ...]
    values: Mapping[str, float]
    intervals: Mapping[str, tuple[float, float]]
    correlations: Matrix
    directions: Matrix
    spreads: Vector
    misfit: float
    residuals: Vector
    curves: Mapping[str, Backbone]
    trials: int
    remarks: tuple[str, ...]

    @property
    def facts(self) -> Mapping[str, str]:
        """Values with their intervals, and the misfit."""
        shown = {
            name: f"{value:.4g} ({low:.4g} to {high:.4g})"
            for (name, value), (low, high) in zip(
                self.values.items(), self.intervals.values(), strict=True
            )
        }
        return {**shown, "misfit": f"{self.misfit:.3g}"}


def identify(
    compute: Compute, parameters: Sequence[Parameter], measured: Sequence[MeasuredCurve]
) -> Identification:
    """Return the parameters whose backbones are closest to measured ones.

    Parameters
    ----------
    compute
        Function from trials, each a mapping of names to values, to the backbones of each by the
        names of the measured curves. Trials of one call may be computed in parallel.
    parameters
        Numbers with their ranges, within which the search stays.
    measured
        Curves with scatter: ``frequency_scatter``, ``damping_scatter``.

    Returns
    -------
    Identification

    Raises
    ------
    ModelError
        If scatter is missing, or there are not more measured numbers than parameters.
    FayingError
        As ``compute`` raises.

    Notes
    -----
    Minimizes the squares of ln(computed/measured)/scatter at the measured amplitudes that the
    backbones of the start reach, by SciPy's trust-region method with derivatives by differences:
    one trial per step and parameter. Intervals follow from the linear problem at the end. If the
    misfit exceeds the scatter of the data, intervals are wider by the same factor.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
    >>> joint = joint.with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=8), compliance=True)
    >>> test = fy.backbone(rom, 1, [0.05, 0.1, 0.2])
    >>> ring = fy.MeasuredCurve(
    ...     name="ring", case="ring", mode=1, amplitude=test.amplitude,
    ...     damping_ratio=test.damping_ratio, damping_scatter=0.05,
    ... )
    >>> def compute(trials):
    ...     return [{"ring": fy.backbone(rubbing(one), 1, [0.04, 0.1, 0.25])} for one in trials]
    >>> def rubbing(trial):
    ...     other = joint.with_friction(trial["friction"])
    ...     basis = fy.craig_bampton(other, normal_modes=8)
    ...     return fy.reduce(other, basis, compliance=True)
    >>> friction = fy.Parameter(name="friction", low=0.1, high=0.4, start=0.3)
    >>> found = fy.identify(compute, [friction], [ring])
    >>> low, high = found.intervals["friction"]
    >>> low < 0.2 < high
    True
    """
    comparison = _Comparison(compute, tuple(parameters), tuple(measured))
    _check(parameters, measured)
    start = np.array([0.5 if p.start is None else p.share(p.start) for p in parameters])
    comparison.reach(start)
    n_residual = len(comparison.residuals([start])[0])
    free = n_residual - len(parameters)
    if free <= 0:
        refuse_model(
            f"{n_residual} measured numbers at amplitudes that the backbones reach do not give "
            f"{len(parameters)} parameters; measure more, widen the amplitudes of the backbones, "
            "or fix parameters"
        )
    ended = least_squares(
        lambda shares: comparison.residuals([shares])[0],
        start,
        comparison.derivatives,
        bounds=(0.0, 1.0),
        ftol=STATIONARY,  # noise of cycles, which repeat to this accuracy
        xtol=STATIONARY,
    )
    return _identification(comparison, ended.x, ended.fun, ended.jac, free)


@dataclass(eq=False)
class _Comparison:
    """Deviations of computed from measured curves, with a memory of computed trials."""

    compute: Compute
    parameters: tuple[Parameter, ...]
    measured: tuple[MeasuredCurve, ...]
    within: dict[str, Mask] = field(default_factory=dict)
    computed: dict[bytes, tuple[Vector, Mapping[str, Backbone]]] = field(default_factory=dict)
    moves: Matrix | None = None

    def reach(self, start: Vector) -> None:
        """Exclude measured amplitudes that the backbones of the start do not reach."""
        (curves,) = self.compute([values_at(self.parameters, start)])
        for test in self.measured:
            reached = curves[test.name].amplitude
            inside = (test.amplitude >= reached.min()) & (test.amplitude <= reached.max())
            self.within[test.name] = inside
        self.computed[start.tobytes()] = (self._deviations(curves), curves)

    def residuals(self, trials: Sequence[Vector]) -> list[Vector]:
        """Return the residuals (n_residual,) for shares of the ranges."""
        missing = [point for point in trials if point.tobytes() not in self.computed]
        if missing:
            answers = self.compute([values_at(self.parameters, point) for point in missing])
            for point, curves in zip(missing, answers, strict=True):
                self.computed[point.tobytes()] = (self._deviations(curves), curves)
        return [self.computed[point.tobytes()][0] for point in trials]

    def derivatives(self, shares: Vector) -> Matrix:
        """Return derivatives of residuals (n_residual, n_parameter) by steps both ways.

        After the first time they go along the principal directions of the derivatives before, as
        far as changes residuals by about one: where the data tell little, curvature of what they
        tell well would else be taken for it.
        """
        axes = STEP * np.eye(len(shares))
        moves = axes if self.moves is None else self.moves
        ahead, back = _room(shares, moves), _room(shares, -moves)
        if (ahead + back < 0.5).any():  # in a corner of the ranges only axes lead inside
            moves, ahead, back = axes, _room(shares, axes), _room(shares, -axes)
        ends = [*(shares + ahead[:, None] * moves), *(shares - back[:, None] * moves)]
        far, near = np.split(np.array(self.residuals(ends)), 2)
        changes = (far - near) / (ahead + back)[:, None]
        slopes: Matrix = np.asarray(np.linalg.solve(moves, changes).T, dtype=float)
        _, sizes, directions = np.linalg.svd(slopes, full_matrices=False)
        steps = 1 / np.maximum(sizes, 1 / (5 * STEP))
        self.moves = np.asarray(steps[:, None] * directions, dtype=float)
        return slopes

    def _deviations(self, curves: Mapping[str, Backbone], degree: int = 1) -> Vector:
        parts = []
        for test in self.measured:
            curve, inside = curves[test.name], self.within[test.name]
            for truth, scatter, computed in (
                (test.frequency, test.frequency_scatter, curve.frequency),
                (test.damping_ratio, test.damping_scatter, curve.damping_ratio),
            ):
                if truth is not None and scatter is not None:
                    if not (computed > 0).all():
                        still = curve.amplitude[computed <= 0].max()
                        refuse_model(
                            f"nothing damps the backbone of '{test.name}' at {still:.3g}, though "
                            "the test has damping there: give what damps beside friction "
                            "([damping] of a study), or larger amplitudes"
                        )
                    there = _at(test.amplitude[inside], curve.amplitude, np.log(computed), degree)
                    parts.append((there - np.log(truth[inside])) / scatter)
        return np.concatenate(parts)


def _room(shares: Vector, moves: Matrix) -> Vector:
    """Return how far moves (n_move, n) may go within the ranges, at most one (n_move,)."""
    ends = np.where(moves > 0, 1.0 - shares, shares)
    with np.errstate(divide="ignore", invalid="ignore"):
        room = np.where(moves != 0, ends / np.abs(moves), np.inf)
    return np.asarray(np.minimum(room.min(axis=1), 1.0))


def _at(amplitude: Vector, reached: Vector, values: Vector, degree: int) -> Vector:
    """Return values interpolated over the logarithm of the amplitude by splines."""
    order = np.argsort(reached)
    x, y = np.log(reached[order]), values[order]
    return np.asarray(make_interp_spline(x, y, k=min(degree, len(x) - 1))(np.log(amplitude)))


def _check(parameters: Sequence[Parameter], measured: Sequence[MeasuredCurve]) -> None:
    wrong = [] if parameters else ["there is no parameter; give one with its range"]
    wrong += [] if measured else ["there is no measured curve; give one"]
    for test in measured:
        columns = ("frequency", test.frequency), ("damping", test.damping_ratio)
        for name, column in columns:
            if column is not None and getattr(test, f"{name}_scatter") is None:
                wrong.append(
                    f"curve '{test.name}' has no scatter of its {name}; give "
                    f"{name}_scatter, the standard deviation of a measurement over its value"
                )
    if wrong:
        raise ModelError("; ".join(wrong))


def _identification(
    comparison: _Comparison,
    shares: Vector,
    residuals: Vector,
    slopes: Matrix,
    free: int,
) -> Identification:
    parameters = comparison.parameters
    names = [parameter.name for parameter in parameters]
    misfit = float(np.sqrt(residuals @ residuals / free))
    _, sizes, directions = np.linalg.svd(slopes, full_matrices=False)
    # A direction without effect on any number is limited by the ranges alone.
    with np.errstate(divide="ignore"):
        spreads = max(misfit, 1.0) / sizes
    finite = np.minimum(spreads, 1.0 / np.finfo(float).eps)
    covariance = (directions.T * finite**2) @ directions
    errors = np.sqrt(np.diag(covariance))
    half = float(student.ppf(0.975, free))  # 95 % interval, errors on either side
    intervals = {
        p.name: (p.value(max(share - wide, 0.0)), p.value(min(share + wide, 1.0)))
        for p, share, wide in zip(parameters, shares, half * errors, strict=True)
    }
    remarks = [
        f"the data do not tell {_combination(names, row)}: along it values are uncertain by more "
        "than half of their ranges"
        for row, spread in zip(directions, spreads, strict=True)
        if not half * spread < 0.5
    ]
    for name, share in zip(names, shares, strict=True):
        if min(share, 1.0 - share) < STATIONARY:
            remarks.append(
                f"'{name}' ends at the {'lower' if share < 0.5 else 'upper'} end of its "
                "range; better values may lie outside"
            )
    curves = comparison.computed[shares.tobytes()][1]
    bend = float(np.abs(comparison._deviations(curves, 2) - residuals).max())
    if bend > 1.0:
        remarks.append(
            f"between the amplitudes of the load case backbones bend by up to {bend:.2g} times the "
            "scatter, which counts as misfit: compute amplitudes that lie at the measured ones"
        )
    if misfit > 2.0:
        lacking = "the model lacks something, " if bend <= 1.0 else ""
        remarks.append(
            f"computed curves miss the measured ones by {misfit:.2g} times their scatter: "
            f"{lacking}intervals are as much wider"
        )
    for test in comparison.measured:
        out = int(np.count_nonzero(~comparison.within[test.name]))
        if out:
            remarks.append(
                f"{out} of {len(test.amplitude)} amplitudes of '{test.name}' are not used, for "
                "backbones do not reach them at the start: let amplitudes of the load case begin "
                "below the first and end beyond the last"
            )
    return Identification(
        parameters=parameters,
        values=values_at(parameters, shares),
        intervals=intervals,
        correlations=covariance / np.outer(errors, errors),
        directions=directions,
        spreads=spreads,
        misfit=misfit,
        residuals=residuals,
        curves=curves,
        trials=len(comparison.computed),
        remarks=tuple(remarks),
    )


SMALLEST_NAMED_SHARE = 0.3
"""Least share of a parameter in a direction to be named in it."""


def _combination(names: Sequence[str], direction: Vector) -> str:
    """Return a text on which parameters change along a direction, and in which sense."""
    direction = direction * np.sign(direction[np.argmax(np.abs(direction) >= SMALLEST_NAMED_SHARE)])
    parts = [
        (name, x)
        for name, x in zip(names, direction, strict=True)
        if abs(x) >= SMALLEST_NAMED_SHARE
    ]
    if len(parts) == 1:
        return f"'{parts[0][0]}'"
    ways = ", ".join(f"'{name}' {'up' if x > 0 else 'down'} by {abs(x):.1f}" for name, x in parts)
    return f"{ways} (shares of the ranges)"
