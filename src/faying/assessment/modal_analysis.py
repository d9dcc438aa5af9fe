"""Quasi-static modal analysis: a preloaded joint under a load in the shape of one of its modes.

The load is α M φ with the mode φ of small vibrations, in which every closed point sticks. With
q = φᵀ M (u − u₀), full cycles ±α give

    ω²(α) = α / q,    ζ(α) = D(α) / (2 π α q),                                                (F5)

with D the energy dissipated by friction in a repeating cycle, else the area of the loop of load and
displacement, and q half the peak-to-peak value (Festjens, Chevallier & Dion 2013 and Lacayo & Allen
2019).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from faying._typing import Vector
from faying.assessment.backbone import Backbone, amplitude_unit
from faying.assessment.modal_cycles import (
    MULTIPLES,
    Measure,
    ModalCycle,
    Neighbours,
    Swing,
    measured,
)
from faying.assessment.stuck_modes import StuckMode, stuck_mode
from faying.digits import DECK_DIGITS
from faying.display.facts import WORTH_SAYING, with_unit
from faying.exceptions import ModelError, naming
from faying.joint.system import System
from faying.simulation.cycles import MOST_CYCLES
from faying.simulation.load import Load
from faying.simulation.path import path_start, solve_path
from faying.simulation.solution import Solution
from faying.units import units_of


@dataclass(frozen=True, eq=False, kw_only=True)
class ModalAnalysis:
    """The common data of the amplitudes of a backbone, each of which is computed independently.

    Attributes
    ----------
    mode
        Number of the mode, from 1.
    levels : (n,)
        Given amplitudes or energies.
    over
        Kind of the levels, ``"amplitude"`` or ``"energy"``.
    increments
        Number of increments of a cycle, even.
    shape
        The mode of small vibrations.
    measure
        Place of the measured amplitude.
    swing
        The preloaded joint under the load.
    """

    mode: int
    levels: Vector
    over: str
    increments: int
    shape: StuckMode
    measure: Measure
    swing: Swing

    def cycle(self, number: int) -> ModalCycle:
        """Return the repeating cycle of one of the levels.

        Raises
        ------
        ConvergenceError
            If an increment is not solved; the message names level and load.
        """
        circular, level = 2 * np.pi * self.shape.frequency, float(self.levels[number])
        amplitude = self.over == "amplitude"
        swung = circular * level / self.measure.unit if amplitude else np.sqrt(2 * level)
        with naming(f"mode {self.mode} at {self.over} {level:g}"):
            return self.swing.cycle(float(circular * swung), self.increments // 2)

    def backbone(self, rows: Sequence[ModalCycle], *, masing: bool = False) -> Backbone:
        """Return the backbone from the cycles of all levels."""

        def column(name: str) -> Vector:
            return np.array([getattr(row, name) for row in rows])

        system, load, modal = self.swing.system, column("load"), column("modal")
        energy, first = column("energy"), column("first_modal")
        circular = np.sqrt(load / modal)
        # A cycle that does not repeat also settles, by energy that the vibration does not lose.
        dissipated = np.where(column("stationary"), energy, column("loop"))
        friction = dissipated / (2 * np.pi * load * modal)
        linear = float(self.shape.shape @ (system.C @ self.shape.shape)) / (2 * circular)
        # Masing: both halves of a loop are the first loading, twice as large.
        lost = 8 * column("first_loop") - 4 * load * first
        return Backbone(
            units=system.units,
            mode=self.mode,
            small_frequency=self.shape.frequency,
            measured_at=self.measure.name,
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
            loop_load=column("loads"),
            loop_modal=column("modals"),
            slip_distance=column("slip_distance"),
            masing_frequency=np.sqrt(load / first) / (2 * np.pi) if masing else None,
            masing_damping=lost / (2 * np.pi * load * first) if masing else None,
            remarks=_remarks(self.shape, self.mode, rows, self.swing, self.measure),
            over=self.over,
        )


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
    progress: Callable[[int], object] | None = None,
) -> Backbone:
    """Return frequency and damping of a mode over its amplitude, from full cycles.

    Parameters
    ----------
    system
        Full or reduced model with friction.
    mode
        Number of the mode of small vibrations about the preloaded joint, from 1.
    amplitudes : (n,) [length]
        Displacements at the measured place of the joint without slip; slip increases them, and
        ``amplitude`` of the result has the final values.
    over
        ``"energy"``: ``amplitudes`` are energies of the vibration [force·length], α²/2ω² without
        slip; ``energy`` of the result has the final values.
    at
        A boundary, for its translation, or one of its components as ``"tip.rx"`` (amplitudes are
        then angles). By default the boundary that the mode moves most. The first loading, on which
        Masing's rule is based, moves it to the positive side of the first component that moves half
        as far as the largest; ``"-tip.uz"`` to the negative side.
    initial
        State to vibrate about, the last one of a path; by default the bolts are tightened with
        friction in one increment.
    increments
        Number of increments of a cycle, even.
    masing
        Whether to compute the result of Masing's rule too. It follows from the first quarter, and
        is wrong if normal forces change during a cycle.
    progress
        Called with 1 after each amplitude.

    Raises
    ------
    ModelError
        Without friction, if a number is out of range, or the measured place does not move.
    ConvergenceError
        If an increment is not solved; the message names amplitude and load.

    Notes
    -----
    Each amplitude starts from the preloaded joint, in a quarter of ``increments``. Full cycles
    follow until they repeat, each from the amplitude to its opposite and back. An increment is a
    few Newton steps between pairs; only the requested displacements are computed. Cycles repeat if
    the dissipation is the same twice, to a thousandth, or if the work of friction on the change of
    slip over a cycle is less than that.

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
    analysis = modal_analysis(
        system,
        mode,
        amplitudes,
        over=over,
        at=at,
        initial=initial,
        increments=increments,
    )
    rows = []
    for number in range(len(analysis.levels)):
        rows.append(analysis.cycle(number))
        if progress is not None:
            progress(1)
    return analysis.backbone(rows, masing=masing)


def modal_analysis(
    system: System,
    mode: int,
    amplitudes: Sequence[float] | Vector,
    *,
    over: Literal["amplitude", "energy"] = "amplitude",
    at: str | None = None,
    initial: Solution | None = None,
    increments: int = 50,
) -> ModalAnalysis:
    """Return the prepared analysis of :func:`backbone`, which has the same parameters.

    Raises
    ------
    ModelError
        Without friction, if a number is out of range, or the measured place does not move.
    """
    levels = _checked(system, mode, amplitudes, increments, over)
    preloaded = solve_path(system, [Load()]) if initial is None else initial
    stuck = stuck_mode(system, preloaded, mode)
    with naming(f"mode {mode}"):
        stuck, measure = measured(system, stuck, at)
    start = path_start(system, preloaded)
    return ModalAnalysis(
        mode=mode,
        levels=levels,
        over=over,
        increments=increments,
        shape=stuck,
        measure=measure,
        swing=Swing.of(
            system,
            start,
            system.static_contact.increments.about(start.increment),
            stuck,
            measure,
            Neighbours.of(system, preloaded, stuck, mode),
        ),
    )


def _checked(
    system: System,
    mode: int,
    amplitudes: Sequence[float] | Vector,
    increments: int,
    over: str,
) -> Vector:
    system.contact.check_rubs()
    wrong = []
    levels = np.atleast_1d(np.asarray(amplitudes, dtype=float))
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


OBLIQUE = 1e-2
"""Share of the motion of a place along a measured component below which amplitudes say little.

A sensor that is turned by half a degree measures as much of the rest.
"""


def _remarks(
    stuck: StuckMode, mode: int, rows: Sequence[ModalCycle], swing: Swing, measure: Measure
) -> tuple[str, ...]:
    remarks, unit = [], amplitude_unit(measure.name, swing.system.units)
    if measure.share < OBLIQUE:
        remarks.append(
            f"mode {mode} moves '{measure.name}' by {measure.share:.1e} of its motion there: "
            f"amplitudes stand for motions {1 / measure.share:.0f} times as large; measure along "
            "its main component, or leave 'at' out"
        )
    if stuck.contact_share < DECK_DIGITS:
        remarks.append(
            f"mode {mode} does not move the joint: its contact holds {stuck.contact_share:.1e} of "
            "the strain energy, so friction does not damp it"
        )
    elif not any(row.energy > 0 for row in rows):
        remarks.append(f"nothing slips in mode {mode} up to the largest amplitude")
    bound = 1.0 - swing.sticking(swing.start)[0]
    if bound > 0 and stuck.contact_share >= DECK_DIGITS:
        remarks.append(
            f"{bound:.0%} of the area in contact lies on its friction bound before the "
            "first load, which is softer for it than small vibrations are; their frequency is that "
            "of small cycles once they repeat"
        )
    if any(row.macroslip for row in rows):
        reached = min(row.reached for row in rows if row.macroslip)
        remarks.append(
            "all that is closed on an interface slips from an amplitude of "
            f"{with_unit(reached, unit)} on: no friction is left to stiffen it, and quasi-static "
            "cycles of one mode are a rough picture"
        )
    largest = np.max([row.met for row in rows], axis=0)
    if largest.size and largest.max() > WORTH_SAYING:
        k, n = np.unravel_index(int(np.argmax(largest)), largest.shape)
        others = swing.neighbours
        reached = min(row.reached for row in rows if row.met[k, n] > WORTH_SAYING)
        rate = units_of(swing.system.units).frequency
        remarks.append(
            f"{MULTIPLES[k]} times the frequency meets mode {others.modes[n]} of "
            f"{with_unit(others.circular[n] / (2 * np.pi), rate)}, which friction makes swing "
            f"from {with_unit(reached, unit)} on, up to {largest[k, n]:.0%} of the velocity of "
            "this mode: cycles have no inertia of other modes and may damp several times too "
            "little; fy.frequency_response and fy.ring_down have it"
        )
    changing = [row.reached for row in rows if not row.stationary]
    if changing:
        reach = with_unit(max(changing), unit)
        remarks.append(
            f"cycles still changed after {MOST_CYCLES} at {len(changing)} of {len(rows)} "
            f"amplitudes, the largest of them {reach}: the joint settles there by energy that "
            "tightening and loads have left in it, and damping is that of the loops, not of what "
            "friction takes"
        )
    return tuple(remarks)
