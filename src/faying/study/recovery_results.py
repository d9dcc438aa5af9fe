"""What a run keeps so that pressures can be recovered without it, and what recovery leaves."""

from collections.abc import Mapping
from dataclasses import dataclass

from faying._typing import Indices, Matrix, Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class SparseRecord:
    """A sparse matrix by rows (CSR).

    Attributes
    ----------
    values, columns : (n_entry,)
    row_starts : (n_row + 1,)
    shape
        Rows and columns.
    """

    values: Vector
    columns: Indices
    row_starts: Indices
    shape: tuple[int, int]


@dataclass(frozen=True, eq=False, kw_only=True)
class BoundaryRecord:
    """Degrees of freedom of one boundary.

    Attributes
    ----------
    nodes : (n,)
        Node ids.
    components : (n,)
        0..5 for ux..rz.
    """

    nodes: Indices
    components: Indices


@dataclass(frozen=True, eq=False, kw_only=True)
class PortsRecord:
    """The joint as seen through its ports; with it nothing else of the model is needed.

    Ports are the relative displacements of the contact pairs, the boundary degrees of freedom, the
    bolts and the load patterns, in this order.

    Attributes
    ----------
    compliance : (n_port, n_port)
        Q K⁻¹ Qᵀ.
    interpolation : (n_point, n_relative)
        Gaps at the contact points from relative displacements.
    boundaries
        By name, in the order of their ports.
    bolt_stiffness
        Bolt name to EA/L, in the order of their ports.
    frame_recovery : (n_port, 12), optional
        Q K⁻¹ M A: per factor of the accelerations of a moving frame, of the origin, then of
        e_i X_j row by row.
    load_patterns
        Names, in the order of their ports.
    """

    compliance: Matrix
    interpolation: SparseRecord
    boundaries: Mapping[str, BoundaryRecord]
    bolt_stiffness: Mapping[str, float]
    frame_recovery: Matrix | None = None
    load_patterns: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class ReducedRecord:
    """A reduced model, and what recovers the full model's pressures from its motion.

    Attributes
    ----------
    kinds
        Of the trial vectors: constraint, normal, bolt, load or joint; their order is that of q.
    mass, damping, stiffness : (n_mode, n_mode)
        ΦᵀMΦ, ΦᵀCΦ, ΦᵀKΦ.
    relative : (n_relative, n_mode)
        PΦ, relative displacements of the contact pairs.
    elongations : (n_bolt, n_mode)
    boundary : (n_boundary,)
        Coordinate that each boundary degree of freedom is.
    inertia_recovery, damping_recovery : (n_port, n_mode)
        Q K⁻¹ M Φ and Q K⁻¹ C Φ.
    compliance
        Whether the model keeps the residual compliance P K⁻¹ Pᵀ − PΦ (ΦᵀKΦ)⁻¹ (PΦ)ᵀ.
    shapes : (n_mode,), optional
        Which of the results' shapes its trial vectors are; None where those are not kept.
    invariants : (4 + 3 n_mode, 4 + 3 n_mode), optional
        ∫ρ a b dV of the fields 1, x, y, z and the components of the trial vectors.
    pattern_forces : (n_pattern, n_mode), optional
        Forces of the load patterns on q; None without patterns.
    """

    kinds: tuple[str, ...]
    mass: Matrix
    damping: Matrix
    stiffness: Matrix
    relative: Matrix
    elongations: Matrix
    boundary: Indices
    inertia_recovery: Matrix
    damping_recovery: Matrix
    compliance: bool
    shapes: Indices | None = None
    invariants: Matrix | None = None
    pattern_forces: Matrix | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class RecoveredRecord:
    """Pressures recovered from an imported history.

    Attributes
    ----------
    history
        Name of its file.
    route
        ``"modal"`` or ``"boundary loads"``.
    method, joint_modes
        Reduced model whose coordinates the history has, or that was simulated.
    derivatives
        Where velocities and accelerations come from.
    loads
        Boundary forces and load patterns that the history has; all others are zero.
    times : (n_time,)
    pressure, gap : (n_time, n_point)
    displacements
        Boundary name to (n_time, n).
    contact_force, bolt_force
        Interface or bolt name to (n_time,).
    max_pressure : (n_time,)
    iterations : (n_time,)
    """

    title: str
    units: str
    history: str
    route: str
    method: str
    joint_modes: int
    derivatives: str
    loads: tuple[str, ...]
    times: Vector
    pressure: Matrix
    gap: Matrix
    displacements: Mapping[str, Matrix]
    contact_force: Mapping[str, Matrix]
    bolt_force: Mapping[str, Matrix]
    max_pressure: Vector
    iterations: Indices
