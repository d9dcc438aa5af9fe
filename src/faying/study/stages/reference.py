"""The reference of the load cases of a run: the full model, or the best reduced model."""

from dataclasses import dataclass

from faying.joint.model import Model
from faying.joint.system import System
from faying.reduction.craig_bampton import craig_bampton
from faying.reduction.projection import completed, projected
from faying.study.keys.friction_rules import Kind, reference_kind
from faying.study.results.second_solution import Remedy
from faying.study.results.values import FULL_MODEL, Response
from faying.study.stages.offline import PreparedJoint


@dataclass(frozen=True, eq=False, kw_only=True)
class Reference:
    """The reference of load cases.

    Attributes
    ----------
    kind
        ``"full"``; ``"worst"``, the full model for the worst static cases only; or ``"none"``.
    reason
        Reason of the choice; empty if the study made it.
    system
        Reference model, unless a case is confirmed by the full model.
    name
        Name of the model for the user.
    """

    kind: Kind
    reason: str
    system: System
    name: str = FULL_MODEL


REDUCED = "reference"
"""Label of a reduced model as reference."""


@dataclass(frozen=True, eq=False)
class Solved:
    """A load case solved by the reference.

    Attributes
    ----------
    name
        Name of the model for the user.
    label
        Label of the model in checkpoint keys.
    remedy
        Record of a transient that was solved again.
    """

    response: Response
    system: System
    name: str
    label: str = REDUCED
    remedy: Remedy | None = None


def reference_of(joint: PreparedJoint, normal_modes: int) -> Reference:
    """Return the reference of the load cases of a study.

    Without the full model it is method ``compliance`` with twice the normal modes. Its static
    solutions are exact. The differences of the other methods to it in
    transients check their number of modes. ``normal_modes`` is the number of the methods.

    Notes
    -----
    Twice the normal modes cost another Lanczos run.
    """
    kind, reason = reference_kind(joint.study, joint.model)
    if kind == "full":
        return Reference(kind=kind, reason=reason, system=joint.model)
    model: Model = joint.model
    modes = min(2 * normal_modes, len(model.structure.interior))
    with joint.books.stage("reduced reference"):
        rom = projected(model, craig_bampton(model, normal_modes=modes), compliance=True)
        (rom,) = completed(model, [rom])
    name = f"compliance with {modes} normal modes" if modes else "compliance"
    return Reference(kind=kind, reason=reason, system=rom, name=name)
