"""Responses to harmonic loads over frequency, one curve for each level of the load."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

import numpy as np

from faying._typing import ComplexMatrix, ComplexVector, Mask, Matrix, Vector, frozen
from faying.assessment.backbone import amplitude_unit
from faying.assessment.single_mode import single_mode
from faying.display.facts import Shown, with_unit
from faying.exceptions import ModelError
from faying.joint.system import System
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.units import units_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, kw_only=True)
class Peak:
    """The highest point of a curve.

    Attributes
    ----------
    level
        Factor of the load.
    frequency : [1/time]
    amplitude : [length]
        Amplitude of the fundamental.
    phase : [degree]
        Phase of the displacement relative to the load.
    at_end
        Whether that is where the curve begins or ends, so that no peak lies in it.
    """

    level: float
    frequency: float
    amplitude: float
    phase: float
    at_end: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactInMotion:
    """Results of contact along a curve, in one period of each point.

    Attributes
    ----------
    load_work : (n,) [force·length]
        Work of the load.
    damping_energy : (n,) [force·length]
        Energy dissipated by the damping matrix.
    friction_energy : (n,) [force·length]
        Energy dissipated by friction, from slip.
    motion_energy : (n,) [force·length]
        Largest kinetic energy of the first harmonic, ω² Σ |q|²/2 of the modes.
    peak_pressure : (n,) [force/length²]
        Largest pressure of all points.
    stick_share : (n,) [1]
        Smallest sticking share of the closed area of an interface with friction.
    slip_share : (n,) [1]
        Share of the area ever closed that slips at some time.
    open_share : (n,) [1]
        Largest share of the area closed at rest that opens.
    clamp_force : (n,) [force]
        Least sum of the normal forces of all points.
    bolt_force_range : (n, n_bolt) [force]
        Largest less smallest force.
    error : (n,) [1]
        Next step of Newton's method over the unknowns.
    """

    load_work: Vector
    damping_energy: Vector
    friction_energy: Vector
    motion_energy: Vector
    peak_pressure: Vector
    stick_share: Vector
    slip_share: Vector
    open_share: Vector
    clamp_force: Vector
    bolt_force_range: Matrix
    error: Vector

    def __post_init__(self) -> None:
        for member in fields(self):
            object.__setattr__(self, member.name, frozen(getattr(self, member.name)))

    @property
    def imbalance(self) -> Vector:
        """Relative difference of the load's work and the dissipation (n,)."""
        left = self.load_work - self.damping_energy - self.friction_energy
        return np.asarray(left / self.load_work)

    @property
    def damping_ratio(self) -> Vector:
        """Dissipation over 4π times the energy of the motion (n,)."""
        lost = self.damping_energy + self.friction_energy
        return np.asarray(lost / (4 * np.pi * self.motion_energy))


@dataclass(frozen=True, eq=False, kw_only=True)
class Period:
    """Pressures, bolt forces and bending moments along one period of a motion.

    Attributes
    ----------
    times : (n_time,) [time]
        From just after the start of the period to its end.
    pressure : (n_time, n_point) [force/length²]
        Pressure of each contact point.
    bolt_forces : (n_time,) [force]
        Force of each bolt.
    bolt_moments : (n_time, 2, 2) [force·length]
        Moments of each bolt with known bending: end, and component across the axis.
    """

    times: Vector
    pressure: Matrix
    bolt_forces: Mapping[str, Vector]
    bolt_moments: Mapping[str, Matrix]


@dataclass(frozen=True, eq=False, kw_only=True)
class ResponseCurve:
    """Periodic motion under one level of a harmonic load; points in the order of the curve.

    Attributes
    ----------
    level : [1]
        Factor of the load.
    components : (n_boundary,)
        Names of the displacements, as ``"tip.uz"``.
    frequency : (n,) [1/time]
        Cyclic, of the load.
    harmonics : (n, n_harmonic + 1, n_boundary) [length]
        h of u = u₀ + Re Σ h_k exp(i k ω t) about the joint at rest; k = 0 is its mean.
    missed : (n_missed,)
        Frequencies without a solution, and why.
    contact
        Results of contact; None for an estimate.
    periods
        Pressures and bolt forces along a period, by the frequencies of the largest pressure, the
        least clamp force and the largest range of each bolt.
    deviation : (n,) [1]
        Relative change of each motion by three more harmonics, with the modes and samples that
        these bring: solved for where it is largest, and estimated elsewhere. None where the number
        of harmonics is given, or for a curve from a backbone.
    remarks : (n_remark,)
        Remarks for the reader.
    """

    level: float
    components: tuple[str, ...]
    frequency: Vector
    harmonics: ComplexMatrix
    missed: tuple[str, ...] = ()
    contact: ContactInMotion | None = None
    periods: Mapping[str, Period] = field(default_factory=dict)
    deviation: Vector | None = None
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "frequency", frozen(self.frequency))
        object.__setattr__(self, "harmonics", frozen(self.harmonics, np.complex128))

    @property
    def swept_up(self) -> Mask:
        """Whether a slow sweep from low to high frequencies passes each point (n,)."""
        return np.asarray(self.frequency >= np.maximum.accumulate(self.frequency))

    @property
    def swept_down(self) -> Mask:
        """Whether a slow sweep from high to low frequencies passes each point (n,)."""
        lowest = np.minimum.accumulate(self.frequency[::-1])[::-1]
        return np.asarray(self.frequency <= lowest)

    def between(self, other: "ResponseCurve") -> "ResponseCurve":
        """Return the motion of a sweep up between the frequencies of another curve."""
        low, high = np.min(other.frequency, initial=np.inf), np.max(other.frequency, initial=0.0)
        passed = self.swept_up & (self.frequency >= low) & (self.frequency <= high)
        return ResponseCurve(
            level=self.level,
            components=self.components,
            frequency=self.frequency[passed],
            harmonics=self.harmonics[passed],
        )

    def fitted_damping(self, component: str) -> float:
        """Return the damping ratio of a mode fitted to the motion of a component.

        NaN where the curve has fewer than five points, or none on one side of its peak.
        """
        try:
            return single_mode(self.frequency, self.response(component)).damping_ratio
        except ModelError:
            return float("nan")

    def response(self, component: str, harmonic: int = 1) -> ComplexVector:
        """Return one harmonic of a component, as ``"tip.uz"``, along the curve (n,).

        Raises
        ------
        ModelError
            If there is no such component or harmonic.
        """
        if component not in self.components:
            message = (
                f"there is no component '{component}'; they are "
                f"{', '.join(self.components) or 'none'}"
            )
            raise ModelError(message)
        count = self.harmonics.shape[1]
        if harmonic not in range(count):
            message = f"there is no harmonic {harmonic}; they are 0 to {count - 1}"
            raise ModelError(message)
        return np.asarray(self.harmonics[:, harmonic, self.components.index(component)])

    def peak(self, component: str) -> Peak:
        """Return where the fundamental of a component is largest, among the points computed.

        Raises
        ------
        ModelError
            If there is no such component, or no point.
        """
        if not len(self.frequency):
            message = f"the curve of level {self.level:g} has no points"
            raise ModelError(message)
        response = self.response(component)
        row = int(np.argmax(np.abs(response)))
        return Peak(
            level=self.level,
            frequency=float(self.frequency[row]),
            amplitude=float(np.abs(response[row])),
            phase=float(np.angle(response[row], deg=True)),
            at_end=row in (0, len(response) - 1),
        )


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class FrequencyResponse(Shown):
    """Curves of several levels of one harmonic load.

    Attributes
    ----------
    load : [1]
        Complex amplitudes at level one, each in the unit of its load.
    curves : (n_level,)
        One for each level.
    linear
        Linear response with all closed points stuck, at level one.
    remarks : (n_remark,)
        Remarks for the reader.
    units
        Consistent unit set of the model, length-mass-time.
    """

    load: Mapping[str, complex]
    curves: tuple[ResponseCurve, ...]
    linear: ResponseCurve
    remarks: tuple[str, ...] = ()
    units: str = "mm-t-s"

    @property
    def facts(self) -> Mapping[str, str]:
        """The load, its levels and the range of frequencies."""
        unit = units_of(self.units).frequency
        low, high = self.linear.frequency[[0, -1]].tolist()
        return {
            "load": ", ".join(self.load),
            "levels": ", ".join(f"{curve.level:g}" for curve in self.curves),
            "frequencies": f"{low:.5g} to {with_unit(high, unit)}",
        }

    def plot(
        self,
        component: str,
        axes: "tuple[Axes, Axes] | None" = None,
        *,
        expected: "FrequencyResponse | None" = None,
    ) -> "tuple[Axes, Axes]":
        """Draw amplitude over level (above) and phase (below) over frequency.

        The linear curve, with all closed points stuck, is dashed.

        Parameters
        ----------
        expected
            Curves from the backbone of a mode, drawn as dotted lines.

        Raises
        ------
        ModelError
            If there is no such component.
        """
        if axes is None:
            from matplotlib import pyplot

            figure = pyplot.figure(figsize=(7.0, 6.0), layout="constrained")
            above = figure.add_subplot(2, 1, 1)
            below = figure.add_subplot(2, 1, 2, sharex=above)
        else:
            above, below = axes
        units = units_of(self.units)
        lines = [
            (curve, f"level {curve.level:g}", f"C{i}.-") for i, curve in enumerate(self.curves)
        ]
        if expected is not None:
            lines += [
                (curve, "from the backbone" if i == 0 else "", f"C{i}:")
                for i, curve in enumerate(expected.curves)
            ]
        for curve, name, style in [*lines, (self.linear, "stuck", "k--")]:
            response = curve.response(component) / curve.level
            above.semilogy(curve.frequency, np.abs(response), style, label=name, markersize=3)
            turned = np.unwrap(np.angle(response))
            below.plot(curve.frequency, np.degrees(turned), style, markersize=3)
        unit = amplitude_unit(component, self.units)
        above.set_ylabel(f"amplitude of {component} per level [{unit}]")
        below.set_ylabel("phase [°]")
        below.set_xlabel(f"frequency [{units.frequency}]")
        above.legend()
        return above, below


def remarks_of(curves: Sequence[ResponseCurve]) -> tuple[str, ...]:
    """Return the remarks on curves, frequencies without a solution included."""
    return tuple(
        f"level {curve.level:g}, {text}"
        for curve in curves
        for text in (*curve.remarks, *curve.missed)
    )


def boundary_components(system: System) -> tuple[str, ...]:
    """Return the names of all boundary degrees of freedom, with the node if there are many."""
    names = []
    for name, boundary in system.boundaries.items():
        multiple = len(np.unique(boundary.nodes)) > 1
        for node, component in zip(boundary.nodes, boundary.components, strict=True):
            label = f"{name}[{node}]" if multiple else name
            names.append(f"{label}.{DISPLACEMENT_NAMES[component]}")
    return tuple(names)


def rows_of(values: Matrix, system: System) -> Matrix:
    """Return the rows of a matrix (n_dof, ...) at all boundaries (n_boundary, ...)."""
    empty = np.zeros((0, *values.shape[1:]))
    return np.concatenate(
        [empty, *(values[boundary.dofs] for boundary in system.boundaries.values())]
    )
