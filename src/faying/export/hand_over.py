"""What every export takes: a reduced model of a run, its contact, its preload, its recovery.

Two classes of hand-over exist. A *contact-capable* one carries gap operator, law and residual
compliance, so that the receiving program opens and closes the joint itself. A *linear* one is the
joint linearized at its preloaded state (:mod:`faying.export.linearized`).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypedDict

from faying._typing import Indices, Matrix
from faying.assessment.recovery import Recovery
from faying.exceptions import StudyError
from faying.model.mesh import CellBlock
from faying.reduction.basis import ModeKind
from faying.reduction.portable import PortableJoint, PortableModel
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.simulation.static import solve_static
from faying.study.portable_records import (
    MOST_PORTS,
    joint_of,
    ports_record,
    reduced_records,
    restored_joint,
    restored_model,
    restored_recovery,
)
from faying.study.record import interface_records
from faying.study.recovery_results import PortsRecord, ReducedRecord
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
        M, C, K, contact, boundaries, bolts (locked at their initial forces) and load patterns in q.
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
    blocks
        Solid elements.
    modes : (n_mode, n_node, 3) or None
        Displacement of every node per q; None where the run kept none.
    results
        The run it comes from; None for a model made in Python.
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
    blocks: tuple[CellBlock, ...] = ()
    modes: Matrix | None = None
    results: Results | None = None


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
    record = sizes[count]
    shapes = results.shapes if record.shapes is not None else None
    return HandOver(
        title=results.title,
        units=results.units,
        method=name,
        joint_modes=count,
        nodes=results.nodes,
        node_ids=results.node_ids,
        blocks=results.blocks,
        interfaces=results.interfaces,
        modes=None if shapes is None else shapes[record.shapes],
        results=results,
        **_parts(restored_joint(results), record, results.ports),
    )


def hand_over_of(rom: ReducedModel, *, title: str = "joint", method: str = "model") -> HandOver:
    """Take a reduced model made in Python, without a run.

    Parameters
    ----------
    rom
        Of a tightened model; its bolts stay locked at their initial forces.
    title, method
        What the files are to call the joint and the model.

    Raises
    ------
    StudyError
        If the interfaces need more ports than are handed over.

    Notes
    -----
    Two back-substitutions per trial vector for the recovery matrices.
    """
    model = rom.model.with_bolt_forces(
        {name: bolt.initial_force for name, bolt in rom.bolts.items()}
    )
    ports = ports_record(model)
    if ports is None:
        message = (
            f"the interfaces of '{model.name}' need more than {MOST_PORTS} ports, whose compliance "
            "would not fit into a file; use a coarser interface"
        )
        raise StudyError(message)
    records, shapes = reduced_records(model, {method: {0: rom}})
    record = records[method][0]
    interfaces = interface_records(model, solve_static(model).pressure)
    forces = {name: bolt.initial_force for name, bolt in model.bolts.items()}
    return HandOver(
        title=title,
        units=model.units,
        method=method,
        joint_modes=rom.basis.count(ModeKind.JOINT),
        nodes=model.assembly.mesh.nodes,
        node_ids=model.assembly.mesh.node_ids,
        blocks=model.assembly.mesh.blocks,
        interfaces=interfaces,
        modes=shapes if record.shapes is not None else None,
        **_parts(joint_of(ports, interfaces, forces), record, ports),
    )


def refuse_deck_loads(given: HandOver, receiver: str) -> None:
    """Refuse to hand a model with deck loads to a program that could not apply them.

    Raises
    ------
    StudyError
    """
    if given.model.load_patterns:
        names = ", ".join(f"'{name}'" for name in given.model.load_patterns)
        message = (
            f"{receiver} cannot apply the deck load {names} of this run; export to mat, npz, fmu "
            "or exudyn, or run the study without 'deck_load', with loads at a [[boundary]]"
        )
        raise StudyError(message)


class _Parts(TypedDict):
    record: ReducedRecord
    model: PortableModel
    joint: PortableJoint
    recovery: Recovery
    preloaded: Solution


def _parts(joint: PortableJoint, record: ReducedRecord, ports: PortsRecord | None) -> _Parts:
    """Return what a joint at its ports and a stored reduced model give together."""
    model = restored_model(joint, record)
    return _Parts(
        record=record,
        model=model,
        joint=joint,
        recovery=restored_recovery(joint, record, None if ports is None else ports.frame_recovery),
        preloaded=solve_static(model, Load({}, name="preload")),
    )
