"""Load pattern: a fixed distribution of nodal forces, such as a load set of a deck."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from faying._typing import Frozen, Mask, Matrix, Vector
from faying.exceptions import ModelError, refuse_model
from faying.model.assembly import Assembly, NodalLoads
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES, Boundary
from faying.model.dofs import DofMap
from faying.model.matrices import used_components


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadPattern(Frozen):
    """Nodal forces that one amplitude a scales, f = a · forces; they do not turn with the body.

    Attributes
    ----------
    forces : (n_dof,) [force], [force·length]
        On the degrees of freedom of the system, for an amplitude of one.
    bolt_forces : [force]
        Bolt to the force added to k e + N₀ at an amplitude of one: −E A α ΔT of a shank that
        expands.
    """

    name: str
    forces: Vector
    bolt_forces: Mapping[str, float] = field(default_factory=dict)

    def projected(self, vectors: Matrix) -> "LoadPattern":
        """Return the pattern in coordinates q of u = vectors q."""
        return replace(self, forces=self.forces @ vectors)


def pattern_forces(patterns: Mapping[str, LoadPattern], n_dof: int) -> Matrix:
    """Return the forces of all patterns (n_pattern, n_dof)."""
    rows = [pattern.forces for pattern in patterns.values()]
    return np.array(rows, dtype=float).reshape(len(rows), n_dof)


def load_pattern(name: str, loads: NodalLoads, assembly: Assembly, dofs: DofMap) -> LoadPattern:
    """Return nodal loads of an assembly as a pattern of its free degrees of freedom, Tᵀ f.

    Loads on dependent nodes act on the nodes that these follow; loads on supports go to ground.

    Raises
    ------
    ModelError
        If a load acts on a node of no element, or as a moment on a node without rotations, if no
        free degree of freedom is loaded, or if a load is not finite.
    """
    nodal = np.zeros((dofs.n_nodes, 6))
    np.add.at(nodal, loads.nodes, loads.forces)
    if not np.isfinite(nodal).all():
        refuse_model(f"load '{name}' holds NaN or infinity; give finite forces")
    _check_carried(name, nodal, assembly, dofs)
    forces = dofs.transformation.T @ nodal.ravel()
    if not forces.any():
        refuse_model(
            f"load '{name}' moves nothing: it is zero, or all of it acts on supports; "
            "leave it out, or correct the deck"
        )
    return LoadPattern(name=name, forces=forces)


def check_pattern_name(name: str, boundaries: Mapping[str, Boundary]) -> None:
    """Refuse a name that a load on a boundary already has."""
    boundary, _, component = name.rpartition(".")
    if boundary in boundaries and component in FORCE_NAMES:
        refuse_model(
            f"'{name}' is the load {component} on boundary '{boundary}' and cannot also be a load "
            "pattern; rename one of them"
        )


def _check_carried(name: str, nodal: Matrix, assembly: Assembly, dofs: DofMap) -> None:
    """Refuse loads on components that no element, coupling or support has."""
    carried = _existing_components(assembly, dofs)
    lost = np.flatnonzero((nodal.ravel() != 0) & ~carried)
    if not lost.size:
        return
    node, component = divmod(int(lost[0]), 6)
    message = (
        f"load '{name}' puts {FORCE_NAMES[component]} on node {assembly.mesh.node_ids[node]}, but "
        f"nothing there has the displacement {DISPLACEMENT_NAMES[component]}; load the node of a "
        "coupling or beam instead, or write a moment as forces"
    )
    raise ModelError(message)


def _existing_components(assembly: Assembly, dofs: DofMap) -> Mask:
    moving = np.diff(dofs.transformation.indptr) > 0
    existing: Mask = used_components(assembly) | moving
    for support in assembly.supports:
        for component in support.components:
            existing[6 * support.nodes + component] = True
    return existing
