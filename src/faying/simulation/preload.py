"""Preload: models with tightened and locked bolts, and ties where the parts stick."""

from collections.abc import Mapping
from dataclasses import dataclass

import scipy.sparse as sp

from faying._typing import Mask
from faying.exceptions import refuse_model
from faying.joint.model import Model
from faying.joint.sticking import sticking_stiffness, stuck_pairs
from faying.simulation.path import solve_static
from faying.simulation.preload_loss import PreloadLoss
from faying.simulation.tightening import NOTHING_LOST, tighten


@dataclass(frozen=True, kw_only=True)
class Sticking:
    """Rule for the area in which the parts stick together in tangential direction (§15.4.2).

    Attributes
    ----------
    threshold
        Fraction of an interface's largest preload pressure above which node pairs stick.
    stiffness : [force/length]
        Tangential penalty of each pair, in both directions.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=5.0)
    >>> tied = fy.preload(joint, {"bolt": 10e3}, sticking=fy.Sticking(threshold=0.3))
    >>> bool(tied.stuck["joint"].any())
    True
    """

    threshold: float = 0.5
    stiffness: float = 1e6

    def __post_init__(self) -> None:
        if not (0 <= self.threshold < 1 and self.stiffness > 0):
            refuse_model(
                f"sticking: threshold {self.threshold:g} must lie in [0, 1) and stiffness "
                f"{self.stiffness:g} must be positive"
            )


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
        Losses after tightening as in :func:`tighten`; the bolts are locked with what remains.

    Raises
    ------
    ModelError, ConvergenceError
        As :func:`tighten`.

    Notes
    -----
    Ties change the stiffness: with ``sticking`` the structure is factorized once more.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> round(float(fy.solve_static(joint).bolt_force("bolt")), 6)
    10000.0
    """
    model.contact.check_frictionless()
    if sticking is None:
        tightened = tighten(model, forces, losses=losses)
        return model.with_bolt_forces(tightened.initial_forces)
    tightened = tighten(model, forces)
    tied = with_sticking(model.with_bolt_forces(tightened.initial_forces), sticking)
    return tied.with_bolt_forces(tighten(tied, forces, losses=losses).initial_forces)


def with_sticking(model: Model, sticking: Sticking) -> Model:
    """Return a preloaded model with tangential penalties in the sticking area (§15.4.2)."""
    pressure = solve_static(model).pressure
    stuck: dict[str, Mask] = {}
    added = sp.csr_array(model.K.shape)
    for name, points in model.contact.slices.items():
        interface = model.interfaces[name]
        stuck[name] = stuck_pairs(interface, pressure[points], sticking.threshold)
        added = added + sticking_stiffness(interface, stuck[name], sticking.stiffness)
    return model.with_stiffness(added, stuck, sticking.stiffness)
