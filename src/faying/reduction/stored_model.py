"""Reduced models as plain values, which files hold: one model alone, or those of a run.

The docstrings below are what :mod:`faying.files.described` writes into a file, and what a file is
checked against when it is read. Both kinds of file have the joint at its ports under ``/ports``,
and matrices in the coordinates under ``/reduced``. A file of one model restores its numbers to the
last bit, so that it holds the residual compliance too; for the models of a run this is computed
from the compliance of the ports.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from faying._typing import Indices, Matrix, SparseMatrix
from faying.files.described import Format
from faying.files.meanings import Table, tables_within
from faying.interface.surface import ContactSurface
from faying.joint.tangential import TangentialRows
from faying.joint.weak_support import WeakSupport
from faying.model.cells import CellBlock
from faying.reduction.stored_compliance import StoredCompliance

MODEL = Format(
    name="reduced model",
    version=1,
    wanted="a file that faying reduce or ReducedModel.save wrote",
    remedy="save the model again",
    description=(
        "A jointed structure in a few generalized coordinates, with its contact and what recovers "
        "the contact pressures of the full finite element model. Gaps are positive where open."
    ),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class StoredBoundary:
    """A boundary.

    Attributes
    ----------
    nodes : (n,) [1]
        Node id of each degree of freedom.
    components : (n,) [1]
        Its component, 0..5 for ux..rz.
    """

    nodes: Indices
    components: Indices


@dataclass(frozen=True, eq=False, kw_only=True)
class StoredPorts:
    """The full model at its ports.

    Attributes
    ----------
    compliance : (n_port, n_port) [length/force]
        Displacement per force between ports: relative displacements of the contact pairs, boundary
        degrees of freedom, bolt elongations, load patterns.
    interpolation : (n_point, n_relative)
        Gaps at contact points from relative displacements (CSR).
    boundaries
        Boundaries by name, in the order of their ports.
    bolt_stiffness : [force/length]
        EA/L by bolt, in the order of their ports.
    frame_recovery : (n_port, 12) [time²]
        Port displacements per acceleration of a moving frame, Q K⁻¹ M A: of the origin in x, y, z
        [time²], then e_i X_j row by row [length·time²].
    load_patterns : (n_pattern,)
        Loads of the deck, in the order of their ports.
    pattern_bolt_forces : (n_pattern, n_bolt) [force]
        What they add to the forces of bolts that expand; absent if nothing.
    shear : (n_shear, n_relative)
        Tangential displacements from relative ones (CSR); absent without friction.
    tangents : (2, n_point, 3) [1]
        Directions of those.
    relative_stiffness : (n_relative, n_relative) [force/length]
        Force between the pairs per relative displacement, the inverse of what compliance has of
        them; absent where it was not formed.
    relative_compliance : (n_relative, n_relative) [length/force]
        Relative displacements per force between the pairs, not formed; in place of compliance where
        interfaces are too large for that.
    contact_columns : (n_input, n_relative) [length/force]
        Other ports per force between the pairs, beside it.
    input_rows : (n_input, n_input) [length/force]
        Displacements of the other ports per force at them.
    tangential
        What is carried along the interfaces per force at the ports, whole ones and around bolts.
    dense_budget : [1]
        Memory that dense matrices between contact points may take.
    """

    compliance: Matrix | None = None
    interpolation: SparseMatrix
    boundaries: Mapping[str, StoredBoundary]
    bolt_stiffness: Mapping[str, float]
    frame_recovery: Matrix | None = None
    load_patterns: tuple[str, ...] = ()
    pattern_bolt_forces: Matrix | None = None
    shear: SparseMatrix | None = None
    tangents: Matrix | None = None
    relative_stiffness: Matrix | None = None
    relative_compliance: Matrix | StoredCompliance | None = None
    contact_columns: Matrix | None = None
    input_rows: Matrix | None = None
    tangential: tuple[TangentialRows, ...] | None = None
    dense_budget: int | None = None


OWN_PORTS = (
    "relative_stiffness", "relative_compliance", "contact_columns", "input_rows", "tangential",
    "dense_budget",
)  # fmt: skip
"""Members of :class:`StoredPorts` in files of one model alone."""


@dataclass(frozen=True, eq=False, kw_only=True)
class StoredCoordinates:
    """A reduced model in its coordinates.

    Attributes
    ----------
    kinds : (n_mode,)
        Kinds of the coordinates q in their order.
    mass : (n_mode, n_mode) [mass]
        Φᵀ M Φ.
    damping : (n_mode, n_mode) [mass/time]
        Φᵀ C Φ.
    stiffness : (n_mode, n_mode) [force/length]
        Φᵀ K Φ.
    relative : (n_relative, n_mode) [1]
        Relative displacements of the pairs.
    elongations : (n_bolt, n_mode) [1]
        Elongations of the bolts.
    boundary : (n_boundary,) [into n_mode]
        Coordinate of each boundary degree of freedom.
    inertia_recovery : (n_port, n_mode) [time²]
        Port displacements per acceleration, Q K⁻¹ M Φ.
    damping_recovery : (n_port, n_mode) [time]
        Port displacements per velocity, Q K⁻¹ C Φ.
    compliance
        Whether pairs also move by (S - relative stiffness⁻¹ relativeᵀ) times their forces, S of
        ports/compliance.
    shapes : (n_mode,) [into n_shape]
        Which of /shapes each coordinate moves.
    invariants : (4 + 3 n_mode, 4 + 3 n_mode) [mass]
        Mass integrals of products of the fields 1, x, y, z [length] and the components x, y, z of
        each trial vector, for floating frames.
    rigid_motions : (n_mode, n_motion) [1/mass^(1/2)]
        Motions as a whole that nothing resists, in coordinates, orthonormal in the mass; absent
        where the structure is held.
    pattern_forces : (n_pattern, n_mode) [force]
        Forces of the load patterns; absent without any.
    residual_compliance : (n_relative, n_relative) [length/force]
        Displacement of the pairs per force between them that the trial vectors lack, a group of its
        parts where it is not formed; absent where the model does without.
    trial_vectors : (n_dof, n_mode) [1]
        Displacements at the free degrees of freedom of the full model per coordinate.
    translations : (3 n_node, n_dof)
        Displacements x, y, z of all nodes per free degree of freedom (CSR).
    bending : (4, n_mode) [force]
        Bending moments of bolts that are beams, two components where they begin and two where they
        end.
    residual_bending : (4, n_relative) [length]
        Such moments per force between the pairs that the trial vectors lack.
    weak_supports
        Springs beside contact alone, by the bodies that they hold together.
    nodal_shapes : (n_mode, n_node, 3) [1]
        Displacements of all nodes per coordinate, where the trial vectors are not known.
    """

    kinds: tuple[str, ...]
    mass: Matrix
    damping: Matrix
    stiffness: Matrix
    relative: Matrix
    elongations: Matrix
    boundary: Indices
    inertia_recovery: Matrix | None = None
    damping_recovery: Matrix | None = None
    compliance: bool
    shapes: Indices | None = None
    invariants: Matrix | None = None
    pattern_forces: Matrix | None = None
    rigid_motions: Matrix | None = None
    residual_compliance: Matrix | StoredCompliance | None = None
    trial_vectors: Matrix | None = None
    translations: SparseMatrix | None = None
    bending: Mapping[str, Matrix] | None = None
    residual_bending: Mapping[str, Matrix] | None = None
    weak_supports: Mapping[str, WeakSupport] | None = None
    nodal_shapes: Matrix | None = None


OWN_COORDINATES = (
    "residual_compliance", "trial_vectors", "translations", "bending", "residual_bending",
    "weak_supports", "nodal_shapes",
)  # fmt: skip
"""Members of :class:`StoredCoordinates` in files of one model alone."""


@dataclass(frozen=True, eq=False, kw_only=True)
class StoredJoint:
    """The joint of a reduced model, in a file of its own or beside fields that were solved with it.

    Attributes
    ----------
    name
        Name of the full model.
    method
        Name of the reduction.
    units
        Consistent unit set, length-mass-time.
    nodes : (n_node, 3) [length]
        Coordinates in the basic frame.
    interfaces
        Contact interfaces by name.
    """

    name: str
    method: str
    units: str
    nodes: Matrix
    interfaces: Mapping[str, ContactSurface]


@dataclass(frozen=True, eq=False, kw_only=True)
class StoredModel(StoredJoint):
    """One reduced model, in a file of its own.

    Attributes
    ----------
    node_ids : (n_node,) [1]
        Node ids as the user knows them.
    blocks
        Solid elements, one group per block of one kind.
    laws
        Contact law of each interface: its name, and its parameters in model units.
    period : [time]
        Longest period of small vibrations about the preloaded state; absent where unknown.
    bolts : [force]
        Initial force each bolt is locked at.
    bolt_ends : (2, 3) [length]
        Where each bolt begins and ends, as far as known.
    provenance
        What made this file.
    ports
        The joint as seen through its ports, for recovery and export.
    reduced
        The reduced model in its coordinates.
    """

    node_ids: Indices
    blocks: tuple[CellBlock, ...]
    laws: Mapping[str, Any]
    period: float | None = None
    bolts: Mapping[str, Mapping[str, float]]
    bolt_ends: Mapping[str, Matrix] = field(default_factory=dict)
    provenance: Mapping[str, str]
    ports: StoredPorts
    reduced: StoredCoordinates


@dataclass(frozen=True, eq=False, kw_only=True)
class StoredModels:
    """The reduced models of a run, in its results.

    Attributes
    ----------
    ports
        The joint as seen through its ports, for recovery and export.
    reduced
        Reduced models: method name, then number of joint modes.
    shapes : (n_shape, n_node, 3) [1]
        Displacements of all nodes per coordinate q, each shape once.
    """

    ports: StoredPorts | None = None
    reduced: Mapping[str, Mapping[int, StoredCoordinates]] | None = None
    shapes: Matrix | None = None


TABLES: dict[type, Table] = tables_within(StoredModel, StoredModels)
"""Meanings of the members of all stored values of reduced models."""
