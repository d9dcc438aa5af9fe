"""The joint in the checkpoint of a run: that it is the same, how it was tightened, its states."""

from collections.abc import Callable
from hashlib import blake2b
from typing import Any

import numpy as np

from faying._typing import Matrix
from faying.exceptions import refuse_study
from faying.execution.checkpoint import Bundles
from faying.joint.model import Model
from faying.joint.structure import Structure
from faying.joint.system import System
from faying.simulation.solution import Solution
from faying.simulation.solution_parts import arrays_of


def check_same_joint(checkpoint: Bundles, model: Model) -> None:
    """Refuse to go on with what was computed of another joint: a deck may have changed since."""
    contact, digest = model.contact, blake2b(digest_size=16)
    arrays = [model.K.data, model.K.indices, model.M.data, contact.interpolation.data]
    arrays += [contact.weights, contact.initial_gap, model.pattern_forces]
    arrays += [bolt.elongation for bolt in model.bolts.values()]
    for array in arrays:
        digest.update(array.tobytes())
    mark = np.array(f"{digest.hexdigest()} {dict(contact.laws)}")
    if checkpoint.bundle("joint", lambda: {"mark": mark})["mark"] != mark:
        refuse_study(
            "what an interrupted run left belongs to another joint: a deck, mesh or matrix of the "
            "study has changed since; run without --resume to start afresh"
        )


def keep_compliance(checkpoint: Bundles, key: str, structure: Structure) -> None:
    """Let a structure take what is between its pairs from a run before, or keep it for one.

    Nothing is kept of more pairs than matrices have room for.
    """
    if not structure.is_kept_whole:
        return

    def arrays() -> dict[str, Matrix]:
        if structure.held_stiffness is not None:
            return {"held_stiffness": structure.held_stiffness}
        return {"held_compliance": np.asarray(structure.held_compliance)}

    for name, matrix in checkpoint.bundle(key, arrays).items():
        structure.take_held(name, matrix)


def kept_state(
    checkpoint: Bundles, key: str, system: System, compute: Callable[[], Solution]
) -> Solution:
    """Return a static state of a joint as it is kept under a key, or compute and keep it."""

    def arrays() -> dict[str, Matrix]:
        state = compute()
        return {"name": np.array(state.name), **arrays_of(state)}

    members: dict[str, Any] = {
        name: value[()] for name, value in checkpoint.bundle(key, arrays).items()
    }
    return Solution(name=str(members.pop("name")), system=system, **members)
