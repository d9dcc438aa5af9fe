"""The data of a reduced model: matrices in its coordinates, contact, ports of the full model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from faying._typing import Frozen, Indices, Matrix, SparseMatrix
from faying.contact.contact import Contact
from faying.interface.surface import ContactSurface
from faying.joint.load_pattern import LoadPattern
from faying.joint.system import PortCompliance
from faying.joint.tangential import TangentialRows
from faying.joint.weak_support import WeakSupport
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary
from faying.model.cells import CellBlock
from faying.reduction.basis import Basis
from faying.units import Units, units_of


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshShapes:
    """The mesh of a reduced model, and its trial vectors as displacements of all nodes.

    Attributes
    ----------
    nodes : (n_node, 3) [length]
    node_ids : (n_node,)
    blocks
        Solid elements.
    vectors : (n_row, n_shape) or None
        Shapes of this model and perhaps of others; None where they were left out.
    columns : (n_mode,)
        Columns of ``vectors`` that belong to this model.
    translations : (3 n_node, n_row) sparse, or None
        Map from the rows of ``vectors`` to the nodes; None where the rows are those of the nodes.
    """

    nodes: Matrix
    node_ids: Indices
    blocks: Sequence[CellBlock]
    vectors: Matrix | None = None
    columns: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    translations: SparseMatrix | None = None

    @property
    def modes(self) -> Matrix | None:
        """Displacement of every node per coordinate (n_mode, n_node, 3)."""
        if self.vectors is None:
            return None
        chosen = self.vectors[:, self.columns]
        moved = chosen if self.translations is None else self.translations @ chosen
        return np.ascontiguousarray(moved.T).reshape(len(self.columns), len(self.nodes), 3)


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelData(Frozen):
    """The data of a reduced model, in memory and in its file.

    Optional parts are None where they are unknown or were left out.

    Attributes
    ----------
    M, C, K : (n_mode, n_mode)
    contact
        With PΦ in place of P, and the residual compliance where it is kept.
    boundaries, bolts, load_patterns, weak_supports
        In generalized coordinates.
    basis
        Φ with the kinds of its vectors; without rows where the vectors were left out.
    interfaces
        Geometry and law of the contact points, by name.
    mesh
        Nodes, elements and their displacements.
    name, units
        Name and units of the full model.
    period
        Longest period of small vibrations about the preloaded state [time]; None where unknown.
    method
        Name of the reduction.
    ports
        Q K⁻¹ Qᵀ, compliance of the full model between its ports; None where the structure is not
        held without its boundary.
    recovery_inertia, recovery_damping : (n_port, n_mode)
        Q K⁻¹ M Φ and Q K⁻¹ C Φ, see :class:`~faying.reduction.recovery.Recovery`.
    recovery_frame : (n_port, 12)
        Q K⁻¹ M A, for moving supports.
    invariants : (4 + 3 n_mode, 4 + 3 n_mode)
        ∫ρ a b dV of the fields 1, x, y, z and the components of the trial vectors, for floating
        frames.
    rigid_motions : (n_mode, n_motion)
        R, free rigid motions, RᵀMR = I.
    tangential
        Tangential resultants of interfaces per input and contact force of the full model.
    """

    M: Matrix
    C: Matrix
    K: Matrix
    contact: Contact
    boundaries: Mapping[str, Boundary]
    bolts: Mapping[str, Bolt]
    basis: Basis
    interfaces: Mapping[str, ContactSurface]
    mesh: MeshShapes
    load_patterns: Mapping[str, LoadPattern] = field(default_factory=dict)
    weak_supports: Mapping[str, WeakSupport] = field(default_factory=dict)
    name: str = "model"
    units: str = "mm-t-s"
    period: float | None = None
    method: str = "model"
    ports: PortCompliance | None = None
    recovery_inertia: Matrix | None = None
    recovery_damping: Matrix | None = None
    recovery_frame: Matrix | None = None
    invariants: Matrix | None = None
    rigid_motions: Matrix = field(default_factory=partial(np.zeros, (0, 0)))
    tangential: tuple[TangentialRows, ...] = ()

    @property
    def unit_set(self) -> Units:
        """Units of all values."""
        return units_of(self.units)
