"""Boundary: named points at which loads enter and a superelement is attached."""

from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Frozen, Indices, Vector
from faying.exceptions import refuse_model
from faying.model.assembly import Assembly, AverageCoupling, RigidCoupling
from faying.model.specs import BoundarySpec

DISPLACEMENT_NAMES = ("ux", "uy", "uz", "rx", "ry", "rz")
FORCE_NAMES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")


@dataclass(frozen=True, eq=False, kw_only=True)
class Boundary(Frozen):
    """Degrees of freedom of one boundary.

    Attributes
    ----------
    nodes : (n,)
        Node id of each boundary degree of freedom.
    components : (n,)
        Component 0..5 of each.
    dofs : (n,)
        Index of each in the degrees of freedom of the system.
    """

    name: str
    nodes: Indices
    components: Indices
    dofs: Indices

    @property
    def places(self) -> list[tuple[str, int]]:
        """Return name and component of each degree of freedom, by node where there are several."""
        one = len(np.unique(self.nodes)) == 1
        pairs = zip(self.nodes.tolist(), self.components.tolist(), strict=True)
        return [
            (self.name if one else f"{self.name}.{node}", component) for node, component in pairs
        ]

    def pattern(self, force: str) -> Vector:
        """Return a unit force or moment distributed evenly over the nodes of the boundary.

        Parameters
        ----------
        force
            One of Fx, Fy, Fz, Mx, My, Mz.

        Returns
        -------
        ndarray (n,)
            Unit total on the boundary's degrees of freedom.

        Raises
        ------
        ModelError
            If the boundary has no such component.
        """
        present = [FORCE_NAMES[c] for c in sorted(set(self.components.tolist()))]
        if force not in present:
            refuse_model(
                f"boundary '{self.name}' takes no load '{force}'; it has {', '.join(present)}"
            )
        chosen = self.components == FORCE_NAMES.index(force)
        return np.asarray(chosen / chosen.sum())

    def with_dofs(self, dofs: Indices) -> "Boundary":
        """Return the boundary with the indices of another system."""
        return replace(self, dofs=dofs)


def add_coupled_boundary(
    assembly: Assembly, spec: BoundarySpec, nodes: Indices
) -> tuple[Assembly, BoundarySpec]:
    """Add a node with six degrees of freedom to a boundary, coupled to the nodes of its set.

    The node is at ``at`` of the boundary, by default the mean of the nodes (indices (n,)). It is
    the last node of the assembly, which is returned with the boundary at this node.
    """
    points = assembly.mesh.nodes[nodes]
    spread = np.linalg.matrix_rank(points - points.mean(axis=0), tol=1e-9 * np.abs(points).max())
    if spread < 2:
        refuse_model(
            f"boundary '{spec.name}': the {len(nodes)} nodes of set '{spec.set}' lie on one line, "
            "so no rotation of its node is defined; couple a face, or leave 'coupling' away"
        )
    position = points.mean(axis=0) if spec.at is None else np.asarray(spec.at, dtype=float)
    reference, number = len(assembly.mesh.nodes), assembly.largest_id + 1
    mesh = assembly.mesh.with_nodes(position)
    reduced_spec = replace(
        spec, node=int(mesh.node_ids[reference]), set=None, coupling=None, at=None
    )
    moved = replace(assembly, mesh=mesh)
    return with_coupling(moved, spec.coupling or "rbe2", number, reference, nodes), reduced_spec


def with_coupling(
    assembly: Assembly, kind: str, number: int, reference: int, nodes: Indices
) -> Assembly:
    """Return an assembly whose nodes follow a reference node (rbe2), or it their mean (rbe3)."""
    if kind == "rbe2":
        rigid = RigidCoupling(id=number, reference=reference, nodes=nodes)
        return replace(assembly, rigid_couplings=(*assembly.rigid_couplings, rigid))
    average = AverageCoupling(
        id=number, reference=reference, nodes=nodes, weights=np.ones(len(nodes))
    )
    return replace(assembly, average_couplings=(*assembly.average_couplings, average))
