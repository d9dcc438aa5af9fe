"""What every export takes: a reduced model of a run, its contact, its preload, its recovery.

Two classes of hand-over exist. A *contact-capable* one carries gap operator, law and residual
compliance, so that the receiving program opens and closes the joint itself. A *linear* one is the
joint linearized at its preloaded state (:mod:`faying.export.linearized`).
"""

from collections.abc import Mapping
from dataclasses import dataclass

from faying._typing import Indices, Matrix
from faying.exceptions import StudyError
from faying.reduction.portable import PortableJoint, PortableModel
from faying.simulation.load import Load
from faying.simulation.recovery import Recovery
from faying.simulation.solution import Solution
from faying.simulation.static import solve_static
from faying.study.portable_records import restored_joint, restored_model, restored_recovery
from faying.study.recovery_results import ReducedRecord
from faying.study.results import InterfaceRecord, Results

DEFAULT_METHOD = "compliance"


@dataclass(frozen=True, eq=False, kw_only=True)
class HandOver:
    """A reduced model of a run with everything another program needs.

    Attributes
    ----------
    method, joint_modes
        Which reduced model of the run it is.
    record
        Its matrices as stored; ``record.kinds`` and ``record.boundary`` tell what q means.
    model
        M, C, K, contact, boundaries and bolts (locked at their initial forces) in q.
    joint
        The full model at its ports.
    recovery
        What turns a history of q into pressures of the full model.
    interfaces
        Geometry of the contact points.
    preloaded
        Static equilibrium of ``model`` under its bolts alone: where a simulation starts.
    nodes : (n_node, 3) [length]
    node_ids : (n_node,)
    modes : (n_mode, n_node, 3) or None
        Displacement of every node per q; None where the run kept none.
    """

    title: str
    units: str
    method: str
    joint_modes: int
    record: ReducedRecord
    model: PortableModel
    joint: PortableJoint
    recovery: Recovery
    interfaces: Mapping[str, InterfaceRecord]
    preloaded: Solution
    nodes: Matrix
    node_ids: Indices
    modes: Matrix | None = None


def hand_over(
    results: Results, method: str | None = None, joint_modes: int | None = None
) -> HandOver:
    """Take a reduced model out of the results of a run.

    Parameters
    ----------
    method
        ``"compliance"`` unless given.
    joint_modes
        The most the run has unless given.

    Raises
    ------
    StudyError
        If the run has no such model.
    """
    name = DEFAULT_METHOD if method is None else method
    sizes = results.reduced.get(name)
    if not sizes:
        known = ", ".join(results.reduced) or "none"
        message = f"the run has no reduced model '{name}'; it has {known}"
        raise StudyError(message)
    count = max(sizes) if joint_modes is None else joint_modes
    if count not in sizes:
        known = ", ".join(map(str, sizes))
        message = f"the run has no model '{name}' with {count} joint modes; it has {known}"
        raise StudyError(message)
    record, joint = sizes[count], restored_joint(results)
    model = restored_model(joint, record)
    return HandOver(
        title=results.title,
        units=results.units,
        method=name,
        joint_modes=count,
        record=record,
        model=model,
        joint=joint,
        recovery=restored_recovery(joint, record),
        interfaces=results.interfaces,
        preloaded=solve_static(model, Load({}, name="preload")),
        nodes=results.nodes,
        node_ids=results.node_ids,
    )
