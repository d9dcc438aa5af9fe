"""Pretension: bolts tightened in sequence to their nominal final forces, then locked."""

import logging
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Self

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.increment import Increment
from faying.exceptions import ModelError
from faying.joint.model import Model
from faying.joint.sticking import sticking_stiffness, stuck_pairs
from faying.joint.system import Joint, initial_bolt_forces
from faying.simulation.bolted_state import bolted_state
from faying.simulation.bolts_by_force import BoltsByForce, forces_of_bolts
from faying.simulation.path import solve_static
from faying.simulation.preload_loss import PreloadLoss, loses

_log = logging.getLogger("faying")

NOTHING_LOST: Mapping[str, PreloadLoss] = MappingProxyType({})

CLAMPS_NOTHING = 1e-9
"""Gap closed per elongation of the bolt under its own force, at or below which it is round-off."""

SURPLUS = 1e-6
"""Relative excess of a bolt's stiffness over all that resists it; more than rounding is wrong."""


@dataclass(frozen=True, kw_only=True)
class Sticking:
    """Where the parts are taken to stick together in tangential direction (§15.4.2).

    Attributes
    ----------
    threshold
        Fraction of an interface's largest preload pressure above which node pairs stick.
    stiffness : [force/length]
        Tangential penalty of each pair, in both directions.
    """

    threshold: float = 0.5
    stiffness: float = 1e6

    def __post_init__(self) -> None:
        if not (0 <= self.threshold < 1 and self.stiffness > 0):
            message = (
                f"sticking: threshold {self.threshold:g} must lie in [0, 1) and stiffness "
                f"{self.stiffness:g} must be positive"
            )
            raise ModelError(message)


@dataclass(frozen=True, eq=False, kw_only=True)
class Tightening:
    """How the bolts were tightened.

    Attributes
    ----------
    initial_forces
        Bolt name to the initial force N₀ it is locked at.
    bolts
        Names in the order of the columns of ``bolt_forces``.
    stages
        What was done in each row of ``bolt_forces``.
    bolt_forces : (n_stage, n_bolt) [force]
        Forces of all bolts after each increment; shows how tightening one relaxes another.
    """

    initial_forces: Mapping[str, float]
    bolts: tuple[str, ...]
    stages: tuple[str, ...]
    bolt_forces: Matrix

    @classmethod
    def of(
        cls, names: Sequence[str], initial: Vector, reached: Sequence[tuple[str, Vector]]
    ) -> Self:
        """Return how bolts were tightened to initial forces, by stages and forces then."""
        return cls(
            initial_forces=dict(zip(names, initial.tolist(), strict=True)),
            bolts=tuple(names),
            stages=tuple(stage for stage, _ in reached),
            bolt_forces=np.array([row for _, row in reached]).reshape(len(reached), len(names)),
        )


def tighten(
    system: Joint,
    forces: Mapping[str, float],
    *,
    losses: Mapping[str, PreloadLoss] = NOTHING_LOST,
) -> Tightening:
    """Tighten bolts one after the other to their nominal final forces, without friction.

    Each bolt is brought to its nominal force while those before it stay locked; a last pass on all
    of them together restores what the neighbours took away, so every bolt ends at its nominal
    force. Bolts not named keep the initial force they are locked at.

    Parameters
    ----------
    forces
        Bolt name to final axial force [force], in tightening order.
    losses
        Bolt name to what it loses after all are tightened.

    Raises
    ------
    ModelError
        If a bolt does not exist, is stiffer than K allows or closes no gap, or a force is not
        finite and positive.
    ConvergenceError
        If no initial force gives the nominal force, e.g. because a bolt clamps nothing.

    Notes
    -----
    One contact problem between pairs for each step, in which the initial forces are unknown beside
    the pressures.
    """
    system.contact.check_frictionless()
    names, state = checked_bolts(system, forces), initial_bolt_forces(system)
    contact: Increment | None = None
    reached: list[tuple[str, Vector]] = []
    for stage, chosen, goal in tightening_stages(names, forces, 1):
        solved = BoltsByForce(joint=system, bolts=chosen).solve(goal, state, 0.0, contact)
        contact, state = solved
        reached.append((stage, forces_of_bolts(system, state, contact)))
    if contact is not None:
        say_open(system, contact)
    for stage, loss_state in loses(bolted_state(system, state), losses) if losses else ():
        state = loss_state.initial
        reached.append((stage, loss_state.forces))
    return Tightening.of(names, state, reached)


def say_open(system: Joint, contact: Increment) -> None:
    """Warn of interfaces that tightened bolts do not press."""
    for text in open_interfaces(system.contact.slices, contact.forces[0]):
        _log.warning("%s", text)


def open_interfaces(points: Mapping[str, slice], pressed: Vector) -> Iterator[str]:
    """Yield of each interface that is open at all of its points that bolts do not press it.

    ``points`` are those of each interface, ``pressed`` pressures or forces (n_point,).
    """
    for name, own in points.items():
        if not pressed[own].any():
            yield (
                f"interface '{name}' is open everywhere after tightening: no bolt presses it; if "
                "one should, check its gap, and that the bolt draws its head and nut together"
            )


def tightening_stages(
    names: Sequence[str], forces: Mapping[str, float], increments: int
) -> Iterator[tuple[str, Indices, Vector]]:
    """Yield what is done, the bolts (n_chosen,) it is done to, and the forces they get."""
    for name, target in forces.items():
        chosen = np.array([names.index(name)], dtype=np.int64)
        for number in range(1, increments + 1):
            share = number / increments
            yield f"{name} to {share:.0%}", chosen, np.array([share * target])
    if forces:
        every = np.array([names.index(name) for name in forces], dtype=np.int64)
        yield "all to nominal", every, np.array(list(forces.values()))


def preload(
    model: Model,
    forces: Mapping[str, float],
    *,
    sticking: Sticking | None = None,
    losses: Mapping[str, PreloadLoss] = NOTHING_LOST,
) -> Model:
    """Return the model with its bolts tightened to final forces and locked.

    Parameters
    ----------
    forces
        Bolt name to final axial force [force], in tightening order.
    sticking
        If given, pairs pressed hard enough are tied in tangential direction and the bolts are
        tightened again, so that their forces are final in the model that is returned.
    losses
        As of :func:`tighten`, with which the bolts are locked.

    Raises
    ------
    ModelError, ConvergenceError
        As :func:`tighten`.

    Notes
    -----
    Ties change the stiffness: with ``sticking`` the structure is factorized once more.
    """
    if sticking is None:
        tightened = tighten(model, forces, losses=losses)
        return model.with_bolt_forces(tightened.initial_forces)
    tightened = tighten(model, forces)
    tied = with_sticking(model.with_bolt_forces(tightened.initial_forces), sticking)
    return tied.with_bolt_forces(tighten(tied, forces, losses=losses).initial_forces)


def with_sticking(model: Model, sticking: Sticking) -> Model:
    """Return a preloaded model with tangential penalties where the parts stick (§15.4.2)."""
    pressure = solve_static(model).pressure
    stuck: dict[str, Mask] = {}
    added = sp.csr_array(model.K.shape)
    for name, points in model.contact.slices.items():
        interface = model.interfaces[name]
        stuck[name] = stuck_pairs(interface, pressure[points], sticking.threshold)
        added = added + sticking_stiffness(interface, stuck[name], sticking.stiffness)
    return model.with_stiffness(added, stuck, sticking.stiffness)


def checked_bolts(system: Joint, forces: Mapping[str, float]) -> list[str]:
    """Return the names of all bolts, after a look at those that are to be tightened."""
    names = list(system.bolts)
    _check(forces, names)
    _check_stiffness(system)
    _check_clamping(system, forces)
    return names


def _check(forces: Mapping[str, float], names: list[str]) -> None:
    for name, force in forces.items():
        if name not in names:
            message = f"there is no bolt '{name}'; the bolts are {', '.join(names) or 'none'}"
            raise ModelError(message)
        if not (np.isfinite(force) and force > 0):
            message = f"bolt '{name}': the preload is {force:g}; give a positive force"
            raise ModelError(message)


def _check_stiffness(system: Joint) -> None:
    """Refuse bolts of given matrices that are stiffer than the structure they are part of.

    K ⪰ k eᵀe exactly where k e K⁻¹ eᵀ ≤ 1; bolts faying assembled itself always satisfy it.
    """
    ports = system.port_compliance
    for number, bolt in enumerate(system.bolts.values()):
        row = ports.n_boundary + number
        flexibility = float(ports.input_rows[row, row])
        if bolt.stiffness * flexibility > 1 + SURPLUS:
            message = (
                f"bolt '{bolt.name}': its stiffness {bolt.stiffness:g} is not contained in K, "
                f"which resists its elongation with {1 / flexibility:.6g} in all; give EA/L of "
                "what K holds between its nodes"
            )
            raise ModelError(message)


def _check_clamping(system: Joint, forces: Mapping[str, float]) -> None:
    """Refuse bolts whose tension closes no gap."""
    ports = system.port_compliance
    for name in forces:
        row = ports.n_boundary + list(system.bolts).index(name)
        closing = system.contact.interpolation @ ports.contact_columns[row]
        if closing.max(initial=0.0) <= CLAMPS_NOTHING * ports.input_rows[row, row]:
            message = (
                f"bolt '{name}' clamps nothing: its tension closes no interface; check that head "
                "and nut are on the far sides of one, and that its direction is not reversed"
            )
            raise ModelError(message)
