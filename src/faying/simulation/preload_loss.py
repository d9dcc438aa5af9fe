"""Preload losses after tightening: embedding of faces, and relaxation in time."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from faying.exceptions import check_known, refuse_model
from faying.simulation.bolted_state import BoltedState


@dataclass(frozen=True, kw_only=True)
class PreloadLoss:
    """Loss of preload of a bolt after tightening.

    Attributes
    ----------
    embedding : [length]
        Flattening of each face between head and nut, the thread among them. The bolt is shorter by
        the sum f_Z and loses f_Z / (δ_S + δ_P) if nothing else acts (T3).
    relaxation
        Share of its force that it loses in time, before the faces have flattened.

    Examples
    --------
    >>> import faying as fy
    >>> seated = fy.PreloadLoss(embedding=(3e-3, 3e-3), relaxation=0.02)
    >>> joint = fy.lap_joint(element_size=5.0)
    >>> kept = fy.solve_static(fy.preload(joint, {"bolt": 10e3}, losses={"bolt": seated}))
    >>> bool(kept.bolt_force("bolt") < 10e3)
    True
    """

    embedding: tuple[float, ...] = ()
    relaxation: float = 0.0

    def __post_init__(self) -> None:
        if not all(0 <= face < np.inf for face in self.embedding) or not 0 <= self.relaxation < 1:
            refuse_model(
                f"embedding {self.embedding} must be lengths that are not negative, and relaxation "
                f"{self.relaxation:g} a share below 1"
            )


def loses(
    state: BoltedState, losses: Mapping[str, PreloadLoss]
) -> Iterator[tuple[str, BoltedState]]:
    """Yield a name and the state of the joint after each loss: relaxation first, then embedding.

    All tightened bolts lose at the same time.

    Raises
    ------
    ModelError
        If a bolt does not exist.
    ConvergenceError
        If contact is not solved.
    """
    names = list(state.joint.bolts)
    for name in losses:
        check_known(name, names, "bolt")
    every = [losses.get(name, PreloadLoss()) for name in names]
    remaining = 1.0 - np.array([loss.relaxation for loss in every])
    relaxing = np.flatnonzero((remaining < 1.0) & (state.forces > 0.0))
    if len(relaxing):
        state = state.tightened_to(relaxing, remaining[relaxing] * state.forces[relaxing])
        yield "relaxed", state
    shorter = np.array([sum(loss.embedding) for loss in every])
    if shorter.any():
        stiffness = np.array([bolt.stiffness for bolt in state.joint.bolts.values()])
        yield "embedded", state.locked_at(state.nuts - stiffness * shorter)
