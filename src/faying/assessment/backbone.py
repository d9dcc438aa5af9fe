"""Backbones: frequency and damping of a mode of a joint over its amplitude.

Quasi-static modal analysis: the preloaded joint is loaded by α M φ with the mode φ of small
vibrations, in which every closed point sticks. With q = φᵀ M (u − u₀), full cycles ±α give

    ω²(α) = α / q,    ζ(α) = D(α) / (2 π α q),                                                (F5)

with D the energy that friction takes in a cycle and q half of what it goes through
(quasi-static modal analysis of Festjens, Chevallier & Dion 2013 and Lacayo & Allen 2019).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, final

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector, frozen
from faying.assessment.modal_cycles import Measure, ModalCycle, Swing, measured
from faying.assessment.stuck_modes import StuckMode, stuck_mode
from faying.display.facts import Shown, with_unit
from faying.exceptions import ModelError, naming
from faying.joint.system import System
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.simulation.cycles import FEWEST_CYCLES, MOST_CYCLES
from faying.simulation.load import Load
from faying.simulation.path import path_start, solve_path
from faying.simulation.path_solver import path_solver
from faying.simulation.solution import Solution
from faying.units import units_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

AWAY = 1e-6
"""Share of a mode's strain energy below which its contact does not take part in it."""


@final
@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Backbone(Shown):
    """Frequency and damping of one mode at several amplitudes; arrays have one entry for each.

    Attributes
    ----------
    mode : [1]
        Number of the mode of small vibrations, from 1.
    small_frequency : [1/time]
        Of small vibrations, in which every closed point sticks: the limit of cycles that repeat.
    measured_at
        Where the amplitude is measured: a boundary, or one of its components.
    amplitude : (n,) [length]
        Half of the way there and back, in a stationary cycle.
    load : (n,)
        Largest load on the mass-normalized mode, α of (F5).
    modal_amplitude : (n,)
        Half of the way of the modal coordinate, q of (F5).
    frequency : (n,) [1/time]
        Frequency.
    damping_ratio : (n,) [1]
        Of friction and of the damping matrix C together.
    friction_damping : (n,) [1]
        Its share of friction.
    linear_damping : (n,) [1]
        Its share of the damping matrix.
    energy_per_cycle : (n,) [force·length]
        Energy that friction takes, by slip.
    loop_area : (n,) [force·length]
        The same by the loop of load and displacement; both agree as increments shrink.
    stick_share : (n,) [1]
        Least share of the closed area that sticks during the cycle.
    macroslip : (n,) [1]
        Whether all that is closed on an interface slips at once, nothing of it sticking.
    cycles : (n,) [1]
        Cycles solved until they repeated.
    stationary : (n,) [1]
        Whether they do.
    loop_load : (n, n_increment + 1)
        Load α along the last cycle, from its positive reversal on.
    loop_modal : (n, n_increment + 1)
        Modal coordinate q = φᵀ M (u − u₀) along it.
    slip_distance : (n, n_point) [length]
        How far each contact point slips in a cycle, there and back, while it is pressed on.
    masing_frequency : (n,) [1/time]
        By Masing's rule from the first loading alone; None unless asked for.
    masing_damping : (n,) [1]
        By Masing's rule from the first loading alone, friction only; None unless asked for.
    remarks : (n_remark,)
        What a reader should know.
    units
        Consistent unit set of the model, length-mass-time.
    over
        What was given for ``amplitude``: that, or ``"energy"``.
    """

    mode: int
    small_frequency: float
    measured_at: str
    amplitude: Vector
    load: Vector
    modal_amplitude: Vector
    frequency: Vector
    damping_ratio: Vector
    friction_damping: Vector
    linear_damping: Vector
    energy_per_cycle: Vector
    loop_area: Vector
    stick_share: Vector
    macroslip: Mask
    cycles: Indices
    stationary: Mask
    loop_load: Matrix
    loop_modal: Matrix
    slip_distance: Matrix | None = None
    masing_frequency: Vector | None = None
    masing_damping: Vector | None = None
    remarks: tuple[str, ...] = ()
    units: str = "mm-t-s"
    over: str = "amplitude"

    @property
    def facts(self) -> Mapping[str, str]:
        """Mode, frequency of small vibrations, and the ranges that were computed."""
        units = units_of(self.units)
        ranges = {
            "amplitudes": (self.amplitude, self._amplitude_unit),
            "frequencies": (self.frequency, f"1/{units.time}"),
            "damping ratios": (100 * self.damping_ratio, "%"),
        }
        return {
            "mode": str(self.mode),
            "small vibrations": with_unit(self.small_frequency, f"1/{units.time}"),
            "measured at": self.measured_at,
            **{
                name: f"{values.min():.4g} to {with_unit(values.max(), unit)}"
                for name, (values, unit) in ranges.items()
            },
        }

    @property
    def _amplitude_unit(self) -> str:
        turns = self.measured_at.rpartition(".")[2] in DISPLACEMENT_NAMES[3:]
        return "rad" if turns else units_of(self.units).length

    @property
    def energy(self) -> Vector:
        """Energy of the vibration (n,), α q/2 [force·length]: an amplitude of no one place."""
        return np.asarray(self.load * self.modal_amplitude / 2)

    def plot(
        self, axes: "Axes | None" = None, *, over: Literal["amplitude", "energy"] = "amplitude"
    ) -> "Axes":
        """Draw damping ratio (left) and frequency (right) over amplitude or energy.

        Parameters
        ----------
        axes
            Of matplotlib; new ones by default. Those of the frequency are their twin.
        over
            ``"amplitude"``, where it is measured, or ``"energy"`` of the vibration.

        Raises
        ------
        ModelError
            If ``over`` is neither.
        """
        from faying.display.axes import new_axes

        units = units_of(self.units)
        known = {
            "amplitude": f"amplitude at {self.measured_at} [{self._amplitude_unit}]",
            "energy": f"energy of the vibration [{units.of('force·length')}]",
        }
        if over not in known:
            message = f"there is no abscissa '{over}'; give 'amplitude' or 'energy'"
            raise ModelError(message)
        abscissa: Vector = getattr(self, over)

        left: Axes = new_axes() if axes is None else axes
        right = left.twinx()
        damping, frequency = "#0072B2", "#D55E00"
        left.semilogx(abscissa, 100 * self.damping_ratio, "o-", color=damping)
        right.semilogx(abscissa, self.frequency, "s--", color=frequency)
        left.set_xlabel(known[over])
        left.set_ylabel("damping ratio [%]", color=damping)
        right.set_ylabel(f"frequency [1/{units.time}]", color=frequency)
        left.set_title(f"mode {self.mode}")
        return left

    def __post_init__(self) -> None:
        for name in ("amplitude", "frequency", "damping_ratio", "energy_per_cycle", "loop_area"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def energy_difference(self) -> Vector:
        """Loop area less energy by slip, over the latter (n,); zero where nothing slips."""
        slipped = self.energy_per_cycle > 0
        difference = self.loop_area - self.energy_per_cycle
        over: Vector = difference / np.where(slipped, self.energy_per_cycle, 1.0)
        return np.where(slipped, over, 0.0)

    @property
    def masing_deviation(self) -> Vector | None:
        """Damping by Masing's rule less that of full cycles, over the latter (n,), or None."""
        if self.masing_damping is None:
            return None
        slipped = self.friction_damping > 0
        difference = self.masing_damping - self.friction_damping
        return np.where(slipped, difference / np.where(slipped, self.friction_damping, 1.0), 0.0)


def backbone(
    system: System,
    mode: int,
    amplitudes: Sequence[float] | Vector,
    *,
    over: Literal["amplitude", "energy"] = "amplitude",
    at: str | None = None,
    initial: Solution | None = None,
    increments: int = 50,
    masing: bool = False,
    compiled: bool | None = None,
    progress: Callable[[int], object] | None = None,
) -> Backbone:
    """Compute frequency and damping of a mode over its amplitude, by full cycles.

    Parameters
    ----------
    system
        Full or reduced model with friction.
    mode
        Number of the mode of small vibrations about the preloaded joint, from 1.
    amplitudes : (n,) [length]
        Displacements to reach where the amplitude is measured, if nothing slipped; where it
        slips the joint moves farther, and ``amplitude`` of the result says how far.
    over
        ``"energy"``: ``amplitudes`` are energies of the vibration [force·length], α²/2ω² if nothing
        slipped; ``energy`` of the result is what they became.
    at
        A boundary, whose translation is meant, or one of its components as ``"tip.rx"``
        (amplitudes are angles then). By default the boundary that the mode moves most.
    initial
        State to vibrate about, the last one of a path; by default the bolts are tightened with
        friction in one increment.
    increments
        Of a cycle; even.
    masing
        Give the result of Masing's rule too. It follows from the first quarter, and is wrong
        wherever normal forces change during a cycle.
    compiled
        As in :func:`faying.solve_path`, two cycles of each amplitude counted.
    progress
        Called with 1 after each amplitude.

    Raises
    ------
    ModelError
        If nothing rubs, a number is out of range, or the mode does not move what should measure it.
    ConvergenceError
        If an increment is not solved; the message names amplitude and load.

    Notes
    -----
    Each amplitude starts from the preloaded joint, in a quarter of ``increments``, then full cycles
    follow until they repeat, each from the amplitude to its opposite and back. An increment is a
    few Newton steps between pairs; no displacements but those asked for are computed. Cycles repeat
    where friction takes the same twice, to a thousandth, or where its work on what the first one
    leaves slipped is less.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=5.0).with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    >>> found = fy.backbone(joint, 2, [0.001, 0.05])
    >>> bool(found.frequency[1] < found.frequency[0])       # slip softens
    True
    >>> bool(found.damping_ratio[1] > found.damping_ratio[0])
    True
    """
    levels = _checked(system, mode, amplitudes, increments, over)
    rest = solve_path(system, [Load()]) if initial is None else initial
    found = stuck_mode(system, rest, mode)
    with naming(f"mode {mode}"):
        measure = measured(system, found, at)
    start = path_start(system, rest)
    whole = len(levels) * (FEWEST_CYCLES * increments + increments // 4)
    solver = path_solver(system, whole, start.increment.forces, compiled)
    swing = Swing.of(system, start, solver, found, measure)
    circular = 2 * np.pi * found.frequency
    swung = circular * levels / measure.unit if over == "amplitude" else np.sqrt(2 * levels)
    rows = []
    for level, load in zip(levels, (circular * swung).tolist(), strict=True):
        with naming(f"mode {mode} at {over} {level:g}"):
            rows.append(swing.cycle(load, increments // 2))
        if progress is not None:
            progress(1)
    curve = _assembled(system, mode, found, measure, rows, masing=masing)
    return replace(curve, over=over, remarks=_remarks(found, mode, rows, swing))


def _checked(
    system: System,
    mode: int,
    amplitudes: Sequence[float] | Vector,
    increments: int,
    over: str,
) -> Vector:
    wrong = []
    levels = np.atleast_1d(np.asarray(amplitudes, dtype=float))
    if not len(system.contact.rubbing):
        wrong.append("no interface has friction; give it with model.with_friction")
    if mode not in range(1, system.K.shape[0]):
        wrong.append(f"there is no mode {mode}; modes are whole numbers from 1")
    if levels.ndim != 1 or not len(levels) or not ((levels > 0) & (levels < np.inf)).all():
        wrong.append(f"the amplitudes are {levels.tolist()}; give positive numbers")
    if over not in ("amplitude", "energy"):
        wrong.append(f"there is no abscissa '{over}'; give over='amplitude' or 'energy'")
    if increments < 4 or increments % 2:
        wrong.append(f"a cycle has {increments} increments; give an even number from 4")
    if wrong:
        raise ModelError("; ".join(wrong))
    return levels


def _assembled(
    system: System,
    mode: int,
    found: StuckMode,
    measure: Measure,
    rows: Sequence[ModalCycle],
    *,
    masing: bool,
) -> Backbone:
    def column(name: str) -> Vector:
        return np.array([getattr(row, name) for row in rows])

    load, modal, energy = column("load"), column("modal"), column("energy")
    circular = np.sqrt(load / modal)
    friction = energy / (2 * np.pi * load * modal)
    linear = float(found.shape @ (system.C @ found.shape)) / (2 * circular)
    first = column("first_modal")
    # Masing: both halves of a loop are its first loading, twice as large.
    lost = 8 * column("first_loop") - 4 * load * first
    return Backbone(
        units=system.units,
        mode=mode,
        small_frequency=found.frequency,
        measured_at=measure.name,
        amplitude=column("reached"),
        load=load,
        modal_amplitude=modal,
        frequency=circular / (2 * np.pi),
        damping_ratio=friction + linear,
        friction_damping=friction,
        linear_damping=linear,
        energy_per_cycle=energy,
        loop_area=column("loop"),
        stick_share=column("stick_share"),
        macroslip=np.array([row.macroslip for row in rows]),
        cycles=np.array([row.cycles for row in rows]),
        stationary=np.array([row.stationary for row in rows]),
        loop_load=np.array([row.loads for row in rows]),
        loop_modal=np.array([row.modals for row in rows]),
        slip_distance=np.array([row.slip_distance for row in rows]),
        masing_frequency=np.sqrt(load / first) / (2 * np.pi) if masing else None,
        masing_damping=lost / (2 * np.pi * load * first) if masing else None,
    )


def _remarks(
    found: StuckMode, mode: int, rows: Sequence[ModalCycle], swing: Swing
) -> tuple[str, ...]:
    remarks = []
    if found.contact_share < AWAY:
        remarks.append(
            f"mode {mode} does not move the joint: its contact holds {found.contact_share:.1e} of "
            "the strain energy, so friction does not damp it"
        )
    elif not any(row.energy > 0 for row in rows):
        remarks.append(f"nothing slips in mode {mode} up to the largest amplitude")
    bound = 1.0 - swing.sticking(swing.start)[0]
    if bound > 0 and found.contact_share >= AWAY:
        remarks.append(
            f"{100 * bound:.2g} % of the area in contact lies on its friction bound before the "
            "first load, which is softer for it than small vibrations are; their frequency is that "
            "of small cycles once they repeat"
        )
    if any(row.macroslip for row in rows):
        reached = min(row.reached for row in rows if row.macroslip)
        remarks.append(
            f"all that is closed on an interface slips from an amplitude of {reached:.3g} on: no "
            "friction is left to stiffen it, and quasi-static cycles of one mode are a rough "
            "picture"
        )
    changing = [row.reached for row in rows if not row.stationary]
    if changing:
        remarks.append(
            f"cycles still changed after {MOST_CYCLES} at an amplitude of {min(changing):.3g}"
        )
    return tuple(remarks)
