"""Cycles of a preloaded joint in the shape of one of its modes, condensed to its contact."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.assessment.stuck_modes import StuckMode, stuck_modes
from faying.contact.increment import IncrementSolver
from faying.digits import DECK_DIGITS, ROUND_OFF, SHORT_DIGITS
from faying.exceptions import ModelError, check_known, refuse_model
from faying.joint.system import System, boundary_slices
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.simulation.cycles import repeat
from faying.simulation.path_steps import PathStep, follow
from faying.simulation.solution import Solution


class StillModeError(ModelError):
    """A mode does not move the place at which its amplitude is to be measured."""


MULTIPLES, SAMPLES = (2, 3, 4, 5), 256
"""Multiples of the frequency to compare with other modes, and instants of a cycle."""

RESONANCE_WIDTH = 0.5
"""Largest relative difference of the squares of a multiple and another mode's frequency to meet."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Measure:
    """Place and direction of measured amplitudes.

    Attributes
    ----------
    name
    rows : (n_boundary,)
        Direction of the mode there, over the boundary degrees of freedom of all boundaries.
    unit : [length]
        Displacement of the mode along it.
    share : [1]
        The same over the whole displacement, or rotation, of the mode there.
    """

    name: str
    rows: Vector
    unit: float
    share: float


def measured(system: System, mode: StuckMode, measured_at: str | None) -> tuple[StuckMode, Measure]:
    """Return a mode with the right sign, and the direction in which it is measured.

    An eigensolver returns either sign. With the right one, the mode moves the measured place
    towards its positive side, by the first component that moves at least half as far as the
    largest; with a minus before the name, as in ``"-tip.uz"``, to the negative side.
    """
    side, name, component = boundary_and_component(measured_at or "")
    if measured_at is not None:
        check_known(name, system.boundaries, "boundary")
    rows = [DISPLACEMENT_NAMES.index(component)] if component in DISPLACEMENT_NAMES else [0, 1, 2]
    if component and len(rows) > 1:
        refuse_model(
            f"boundary '{name}' has no component '{component}'; they are "
            f"{', '.join(DISPLACEMENT_NAMES)}"
        )
    names = [name] if name else list(system.boundaries)
    if not names:
        refuse_model("the model has no boundary, where amplitudes are measured; give it one")
    moved = [_direction(system, name, rows, mode.shape) for name in names]
    sizes = np.array([np.linalg.norm(motion) for motion in moved])
    best = _first(sizes, 1 - SHORT_DIGITS)
    name, direction, unit = names[best], moved[best], float(sizes[best])
    moves = np.abs(mode.shape).max(initial=0.0)
    if not unit > DECK_DIGITS * moves:
        message = (
            f"the mode of {mode.frequency:.6g} leaves '{name}' still; measure its amplitude "
            f"where it moves: at = a boundary, or one of its components as '{name}.rx'"
        )
        raise StillModeError(message)
    alike = [3, 4, 5] if rows[0] > 2 else [0, 1, 2]
    whole = float(np.linalg.norm(_direction(system, name, alike, mode.shape)))
    sign = side * np.sign(direction[_first(np.abs(direction), 0.5)])
    ports = np.zeros(system.port_compliance.n_boundary)
    ports[boundary_slices(system.boundaries)[name]] = sign * direction / unit
    return (
        replace(mode, shape=sign * mode.shape),
        Measure(name=measured_at or name, rows=ports, unit=unit, share=unit / whole),
    )


def boundary_and_component(measured_at: str) -> tuple[float, str, str]:
    """Return the sign, boundary and component of a place of measured amplitudes."""
    name, _, component = measured_at.removeprefix("-").partition(".")
    return -1.0 if measured_at.startswith("-") else 1.0, name, component


def _direction(system: System, name: str, components: Sequence[int], shape: Vector) -> Vector:
    """Return the displacement of the most moved node of a boundary (n_boundary_dof,)."""
    boundary = system.boundaries[name]
    moved = np.where(np.isin(boundary.components, components), shape[boundary.dofs], 0.0)
    nodes = np.unique(boundary.nodes)
    sizes = np.array([np.linalg.norm(moved[boundary.nodes == node]) for node in nodes])
    return np.where(boundary.nodes == nodes[_first(sizes, 1 - SHORT_DIGITS)], moved, 0.0)


def _first(sizes: Vector, share: float) -> int:
    """Return the index of the first size that is at least this share of the largest."""
    return int(np.argmax(sizes >= share * sizes.max()))


@dataclass(frozen=True, eq=False, kw_only=True)
class Neighbours:
    """Other modes that a multiple of the frequency may meet, and their quasi-static motion.

    Attributes
    ----------
    modes : (n,)
        Their numbers, from 1.
    circular : (n,) [1/time]
    damping : (n,) [1]
        ζ of the damping matrix.
    moved : (n_relative, n) [length]
        Displacements of the pairs under M φ of each mode alone.
    own : (n,)
        Modal coordinate of each under M φ of the loaded mode alone.
    """

    modes: Indices
    circular: Vector
    damping: Vector
    moved: Matrix
    own: Vector

    @classmethod
    def of(cls, system: System, state: Solution, mode: StuckMode, number: int) -> Self:
        """Return the other modes up to the highest multiple of the frequency of the given mode."""
        every = stuck_modes(system, state, 1.1 * MULTIPLES[-1] * mode.frequency, number)
        others = np.arange(len(every.frequencies)) != number - 1
        shapes = every.shapes[:, others]
        answers = system.factorize_static().solve(np.asarray(system.M @ shapes))
        circular = 2 * np.pi * every.frequencies[others]
        linear = np.einsum("im,im->m", shapes, system.C @ shapes)
        return cls(
            modes=np.flatnonzero(others) + 1,
            circular=circular,
            damping=linear / (2 * circular),
            moved=np.asarray(system.contact.relative_operator @ answers),
            own=np.asarray((system.M @ mode.shape) @ answers),
        )

    def swung(self, cycle: Matrix, factors: Vector, circular: float, lowest: float) -> Matrix:
        """Return amplitudes (n_multiple, n) in each multiple of a frequency that meets a mode.

        ``cycle`` (n_step, n) are quasi-static modal coordinates, while the load has the factors cos
        θ (n_step,), down and up again. ``lowest`` is the least damping ratio of each mode.
        """
        turn = np.arccos(np.clip(factors, -1.0, 1.0))
        half = len(turn) // 2
        turn[half + 1 :] = 2 * np.pi - turn[half + 1 :]
        even = np.linspace(0, 2 * np.pi, SAMPLES, endpoint=False)
        along = np.array([np.interp(even, turn, values) for values in cycle.T])
        along = along.reshape(-1, SAMPLES)
        multiples = np.array(MULTIPLES)
        wave = 2 / SAMPLES * np.exp(-1j * np.outer(even, multiples))
        ratio = multiples[:, None] * circular / self.circular
        damping = np.maximum(self.damping, lowest)
        far = np.abs((along @ wave).T / (1 - ratio**2 + 2j * damping * ratio))
        return np.where(np.abs(1 - ratio**2) < RESONANCE_WIDTH, far, 0.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class ModalCycle:
    """Result at one amplitude; for ``met`` see :meth:`Swing.met`."""

    load: float
    modal: float
    reached: float
    energy: float
    loop: float
    stick_share: float
    macroslip: bool
    cycles: int
    stationary: bool
    first_modal: float
    first_loop: float
    loads: Vector
    modals: Vector
    slip_distance: Vector
    met: Matrix


@dataclass(frozen=True, eq=False, kw_only=True)
class Swing:
    """The preloaded joint under α M φ, condensed to its contact and the measured displacement.

    Attributes
    ----------
    start
        The preloaded joint.
    solver
        Solver of its increments.
    moved : (n_relative,) [length]
        Displacements of the pairs under M φ alone.
    own, own_at
        q and the measured displacement under M φ alone.
    at : (n_relative,) [length/force]
        Measured displacement per force between the pairs.
    neighbours
        Other modes.
    """

    system: System
    start: PathStep
    solver: IncrementSolver
    moved: Vector
    own: float
    own_at: float
    at: Vector
    neighbours: Neighbours

    @classmethod
    def of(
        cls,
        system: System,
        start: PathStep,
        solver: IncrementSolver,
        mode: StuckMode,
        measure: Measure,
        neighbours: Neighbours,
    ) -> Self:
        """Return the swing from the static response of the bare structure to the load."""
        force = np.asarray(system.M @ mode.shape)
        answer = system.factorize_static().solve(force)
        ports = system.port_compliance
        rows = measure.rows @ ports.contact_columns[: ports.n_boundary]
        boundary = np.concatenate(
            [answer[boundary_of.dofs] for boundary_of in system.boundaries.values()]
        )
        return cls(
            system=system,
            start=start,
            solver=solver,
            moved=np.asarray(system.contact.relative_operator @ answer),
            own=float(force @ answer),
            own_at=float(measure.rows @ boundary),
            at=rows,
            neighbours=neighbours,
        )

    def met(self, steps: Sequence[PathStep], loads: Vector, swing: float) -> Matrix:
        """Return velocities of other modes in multiples of the frequency (n_multiple, n).

        They are relative to the velocity of the mode, and due to friction and gaps along the cycle.
        Other modes have inertia and at least the damping of the cycle, but do not react on it.
        """
        others = self.neighbours
        along = np.outer(loads, others.own) + self._pairs(steps) @ others.moved
        load = float(loads[0])
        lost = -float(np.trapezoid(self._modal(steps, loads), loads))
        ratio = max(lost / (2 * np.pi * load * swing), 0.0)
        far = others.swung(along, loads / load, float(np.sqrt(load / swing)), ratio)
        return np.asarray(np.array(MULTIPLES)[:, None] * far / swing)

    def cycle(self, load: float, half: int) -> ModalCycle:
        """Return the repeating cycle under a load, with ``half`` increments each way."""
        rise = np.arange(1, (half + 1) // 2 + 1) / ((half + 1) // 2)
        down = 1 - 2 * np.arange(1, half + 1) / half

        def targets(shares: Vector) -> Matrix:
            return self.start.relative + load * np.outer(shares, self.moved)

        steps = list(follow(self.solver, targets(rise), self.start))
        first = self._modal([self.start, *steps], np.concatenate([[0.0], load * rise]))
        first_loop = float(np.trapezoid(np.concatenate([[0.0], load * rise]), first))
        factors = np.concatenate([down, -down])
        loads = load * np.concatenate([[1.0], factors])
        repeated = repeat(self.solver, targets(factors), steps[-1])
        cycle, energy = repeated.steps, float(repeated.energies[-1])
        modal = self._modal(cycle, loads)
        sticking = np.array([self.sticking(step) for step in cycle[1:]])
        return ModalCycle(
            load=load,
            modal=(modal[-1] - modal[half]) / 2,
            reached=np.ptp(self._at(cycle, loads)) / 2,
            energy=energy if energy > ROUND_OFF * load * np.ptp(modal) else 0.0,
            loop=-float(np.trapezoid(modal, loads)),
            stick_share=float(sticking[:, 0].min()),
            macroslip=bool(sticking[:, 1].any()),
            cycles=len(repeated.energies),
            stationary=repeated.stationary,
            first_modal=float(first[-1]),
            first_loop=first_loop,
            loads=loads,
            modals=modal,
            slip_distance=_distance(cycle),
            met=self.met(cycle, loads, (modal[-1] - modal[half]) / 2),
        )

    def _pairs(self, steps: Sequence[PathStep]) -> Matrix:
        """Return changes of the forces between pairs since the preload (n_step, n_relative)."""
        forces = np.array([step.increment.forces - self.start.increment.forces for step in steps])
        return self.system.contact.at_pairs(forces[:, 0], forces[:, 1:]).T

    def _modal(self, steps: Sequence[PathStep], loads: Vector) -> Vector:
        """Return q (n_step,)."""
        return np.asarray(self.own * loads + self._pairs(steps) @ self.moved)

    def _at(self, steps: Sequence[PathStep], loads: Vector) -> Vector:
        """Return the measured displacement since the preload (n_step,)."""
        return np.asarray(self.own_at * loads + self._pairs(steps) @ self.at)

    def sticking(self, step: PathStep) -> tuple[float, bool]:
        """Return the sticking share of the closed area, and whether it is zero on an interface."""
        contact, forces = self.system.contact, step.increment.forces
        closed = (forces[0] > 0) & (contact.coefficients > 0)
        sticks = contact.sticking(forces[0], forces[1:])
        area = float(contact.weights[closed].sum())
        gross = [
            bool(closed[points].any() and not sticks[points].any())
            for points in contact.slices.values()
        ]
        return float(contact.weights[sticks].sum()) / area if area > 0 else 0.0, any(gross)


def _distance(steps: Sequence[PathStep]) -> Vector:
    """Return the slip distance of each point (n_point,) in a cycle under pressure [length]."""
    change = np.diff([step.slip for step in steps], axis=0)
    pressed = np.array([step.increment.forces[0] > 0 for step in steps[1:]])
    return np.asarray((np.hypot(change[:, 0], change[:, 1]) * pressed).sum(axis=0))
