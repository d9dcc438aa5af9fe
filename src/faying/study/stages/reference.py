"""What the load cases of a run are compared with: the full model, or the best reduced one."""

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
    """What load cases are compared with.

    Attributes
    ----------
    kind
        ``"full"``; ``"worst"``, the full model for the worst static cases only; or ``"none"``.
    reason
        Why, where the study leaves it open; empty otherwise.
    system
        The model that solves them, unless a case is confirmed by the full one.
    name
        What people call it.
    """

    kind: Kind
    reason: str
    system: System
    name: str = FULL_MODEL


REDUCED = "reference"
"""Label of a reduced model that the methods are compared with."""


@dataclass(frozen=True, eq=False)
class Solved:
    """A load case solved by what methods are compared with.

    Attributes
    ----------
    name
        What people call the model.
    label
        What its responses are kept under.
    remedy
        Of a transient that was solved again.
    """

    response: Response
    system: System
    name: str
    label: str = REDUCED
    remedy: Remedy | None = None


def reference_of(joint: PreparedJoint, normal_modes: int) -> Reference:
    """Return what the load cases of a study are compared with.

    Without the full model that is method ``compliance`` with twice the normal modes, static
    solutions of which are those of the full model; what the other methods differ from it in
    transients is a check of their number of modes. The normal modes are those of the methods.

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
