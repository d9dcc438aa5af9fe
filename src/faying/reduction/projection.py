"""Galerkin projection, Eq. (15.16), and the data of the full model in a reduced one."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix, frozen
from faying.exceptions import refuse_model
from faying.interface.surface import ContactSurface, contact_surface
from faying.joint.model import Model
from faying.joint.system import PortCompliance
from faying.joint.tangential import tangential_rows
from faying.linalg.factorization import factorize
from faying.linalg.singular import SingularMatrixError
from faying.linalg.sparse_compliance import Compliance, plus
from faying.model.boundary import Boundary
from faying.reduction.basis import VANISHING, Basis, ModeKind
from faying.reduction.model_data import MeshShapes
from faying.reduction.recovery import frame_operator, supported_operator
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.frame_motion import mass_invariants
from faying.simulation.solution import Solution

MOST_SHAPE_BYTES = 256_000_000
"""Most memory of nodal displacements of trial vectors: 100 vectors of 100 000 nodes."""


def reduce(model: Model, basis: Basis, *, compliance: bool = False) -> ReducedModel:
    """Return the reduced model of a model and a basis.

    Parameters
    ----------
    model
        Usually preloaded: bolts stay locked at their initial forces.
    basis
        Trial vectors; boundary rows [I 0] where it has constraint modes.
    compliance
        Whether to keep the compliance between contact points that the basis lacks, as a massless
        spring between contact forces and gaps, (M5): static solutions are then exact.

    Returns
    -------
    ReducedModel
        Solved by the same functions as the full model, and independent of it.

    Notes
    -----
    Three projections; with ``compliance`` one back-substitution per contact pair, once for all
    bases of a structure; two per trial vector for the recovery of pressures.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    >>> push = fy.Load({"tip.Fz": -500.0})
    >>> fast, full = fy.solve_static(rom, push), fy.solve_static(joint, push)
    >>> rom.K.shape, bool(abs(fast.max_pressure / full.max_pressure - 1) < 1e-8)
    ((11, 11), True)
    """
    rom = projected(model, basis, compliance=compliance)
    ports = _ports(model)
    if ports is None:
        return rom
    operator = supported_operator(model, basis)
    return replace(
        rom,
        ports=ports,
        recovery_inertia=operator.inertia,
        recovery_damping=operator.damping,
        tangential=tangential_rows(model),
    )


def projected(model: Model, basis: Basis, *, compliance: bool = False) -> ReducedModel:
    """Project as :func:`reduce`, without the recovery matrices for pressures."""
    phi, mesh = basis.vectors, model.assembly.mesh
    M, C, K = _matrices(model, phi)
    residual: Compliance | None = None
    bending: dict[str, Matrix] = {}
    if compliance:
        stiffness = _held_stiffness(model, basis)
        residual = _residual_compliance(model, basis, stiffness)
        moments = {n: port.bending for n, port in model.bolts.items() if port.bending is not None}
        bending = _residuals(model, basis, stiffness, moments)
    return ReducedModel(
        M=M,
        C=C,
        K=K,
        contact=replace(
            model.contact,
            relative_operator=frozen(model.contact.relative_operator @ phi),
            residual_compliance=residual,
        ),
        boundaries=_boundaries(model, basis),
        bolts={
            name: replace(bolt.projected(phi), residual_bending=bending.get(name))
            for name, bolt in model.bolts.items()
        },
        rigid_motions=_rigid_motions(model, phi),
        weak_supports={body: port.projected(phi) for body, port in model.weak_supports.items()},
        basis=basis,
        load_patterns={name: port.projected(phi) for name, port in model.load_patterns.items()},
        name=model.name,
        units=model.units,
        method=_method(basis, compliance=compliance),
        interfaces=contact_surfaces(model),
        mesh=MeshShapes(
            nodes=mesh.nodes,
            node_ids=mesh.node_ids,
            blocks=mesh.blocks,
            vectors=phi,
            columns=np.arange(len(basis)),
            translations=model.dofs.translations,
        ),
    )


def contact_surfaces(model: Model) -> dict[str, ContactSurface]:
    """Return geometry and law of the interfaces of a model, by name."""
    nodes, slices = model.assembly.mesh.nodes, model.contact.slices
    return {
        name: contact_surface(interface, slices[name], nodes, model.stuck.get(name))
        for name, interface in model.interfaces.items()
    }


def for_moving_supports(model: Model, rom: ReducedModel) -> ReducedModel:
    """Return a reduced model with the matrices for moving supports and floating frames.

    Notes
    -----
    Two assemblies of the mass matrix and twelve back-substitutions.
    """
    shapes = nodal_shapes(model, rom.basis)
    return replace(
        rom,
        recovery_frame=frame_operator(model),
        invariants=mass_invariants(model, rom.trial_vectors, shapes)
        if len(shapes) == len(rom.K)
        else None,
    )


def completed(
    model: Model, models: Sequence[ReducedModel], most_bytes: int = MOST_SHAPE_BYTES
) -> list[ReducedModel]:
    """Return reduced models of one full model with all data of their files, computed together.

    These are recovery matrices, also for moving supports, and nodal shapes of the models whose
    shapes fit entirely into ``most_bytes`` for all.

    Notes
    -----
    As :func:`~faying.reduction.recovery.recovery_operator`; trial vectors that bases share are
    solved once.
    """
    ports = _ports(model)
    if ports is None:
        return list(models)
    tangential = tangential_rows(model)
    # The shortest first, so that the shapes of most models fit.
    order = sorted(models, key=lambda rom: len(rom.basis))
    together, columns = _shared_vectors([rom.basis for rom in order])
    operator, frame = supported_operator(model, together), frame_operator(model)
    ends = [int(columns_of_rom.max(initial=-1)) + 1 for columns_of_rom in columns]
    row_bytes = 24 * model.dofs.n_nodes
    end_stored = max((end for end in ends if end * row_bytes <= most_bytes), default=0)
    shapes = nodal_shapes(model, together, end_stored * row_bytes)
    invariants = mass_invariants(model, together.vectors[:, : len(shapes)], shapes)
    rows = shapes.reshape(len(shapes), -1).T
    roms: dict[int, ReducedModel] = {}
    for rom, columns_of_rom, end in zip(order, columns, ends, strict=True):
        fields = np.concatenate(
            [np.arange(4), (4 + 3 * columns_of_rom[:, None] + np.arange(3)).ravel()]
        )
        fits = end <= end_stored
        roms[id(rom)] = replace(
            rom,
            ports=ports,
            recovery_inertia=operator.inertia[:, columns_of_rom],
            recovery_damping=operator.damping[:, columns_of_rom],
            recovery_frame=frame,
            invariants=invariants[np.ix_(fields, fields)] if fits else None,
            tangential=tangential,
            mesh=replace(
                rom.mesh, vectors=rows if fits else None, columns=columns_of_rom, translations=None
            ),
        )
    return [roms[id(rom)] for rom in models]


def nodal_shapes(model: Model, basis: Basis, most_bytes: int = MOST_SHAPE_BYTES) -> Matrix:
    """Return the first trial vectors that fit as nodal displacements (n_shape, n_node, 3)."""
    n_node = model.dofs.n_nodes
    count = min(len(basis), most_bytes // max(24 * n_node, 1))
    shapes: Matrix = model.dofs.translations @ basis.vectors[:, :count]
    return np.ascontiguousarray(shapes.T).reshape(count, n_node, 3)


def residual_compliance(model: Model, basis: Basis) -> Compliance:
    """Compliance R (n_relative, n_relative) between contact pairs that a basis cannot express.

    R = P K_ii⁻¹ Pᵀ − PΦ_f (Φ_fᵀ K Φ_f)⁻¹ (PΦ_f)ᵀ, (M6), with Φ_f the shapes that vanish on the
    boundary.
    Constraint modes are exact and K-orthogonal to Φ_f, so this equals (M5),
    P K⁻¹ Pᵀ − PΦ K_r⁻¹ (PΦ)ᵀ, where the structure is held, and it exists for free structures too.
    It is positive semidefinite: the compliance of the structure with its boundary and Φ_f held.
    """
    return _residual_compliance(model, basis, _held_stiffness(model, basis))


def _residual_compliance(model: Model, basis: Basis, stiffness: Matrix) -> Compliance:
    seen = model.structure.relative_operator @ basis.of_kind(*VANISHING)
    flexibility = np.asarray(np.linalg.inv(stiffness), dtype=np.float64)
    return plus(model.structure.firm_compliance, seen, -flexibility)


def full_displacement(model: Model, solution: Solution) -> Matrix:
    """Return displacements at the free degrees of freedom of the full model (..., n_dof).

    For a reduced model with residual compliance the result includes the displacements that this
    represents: it agrees with the gaps, and is exact in statics.

    Parameters
    ----------
    model
        The full model that was reduced.
    solution
        Solution of a reduced model with trial vectors, or of the full model.

    Raises
    ------
    ModelError
        If the model came without its trial vectors, or is no reduced one of this full model.

    Notes
    -----
    One back-substitution for each case or instant where there is a residual compliance.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    >>> push = fy.Load({"tip.Fz": -500.0})
    >>> moved = fy.full_displacement(joint, fy.solve_static(rom, push))
    >>> bool(abs(moved - fy.solve_static(joint, push).states).max() < 1e-9)
    True
    """
    rom = solution.system
    residual = rom.contact.residual_compliance
    if not isinstance(rom, ReducedModel) or residual is None:
        return solution.full_displacement()
    vectors = trial_vectors_of(rom, model)
    moved: Matrix = solution.states @ vectors.T
    pairs = rom.contact.at_pairs(solution.contact_forces, solution.shear_forces).T
    at_dofs = (np.atleast_2d(pairs) @ model.structure.relative_operator).T
    # K_ii⁻¹ Pᵀ f − Φ_f (Φ_fᵀ K Φ_f)⁻¹ Φ_fᵀ Pᵀ f, which P takes to R f.
    behind = _beyond_basis(model, rom.basis, _held_stiffness(model, rom.basis), at_dofs)
    return np.asarray(moved + behind.T.reshape(moved.shape))


def trial_vectors_of(rom: ReducedModel, model: Model) -> Matrix:
    """Return the trial vectors (n_dof, n_mode) of a reduced model.

    Raises
    ------
    ModelError
        If it has none, or was not reduced from this full model.
    """
    vectors = rom.trial_vectors
    if len(vectors) != model.structure.n_dof:
        refuse_model(
            f"the trial vectors have {len(vectors)} rows but the model {model.structure.n_dof} "
            "degrees of freedom; give the model that was reduced"
        )
    return vectors


def _residuals(
    model: Model, basis: Basis, stiffness: Matrix, rows: Mapping[str, SparseMatrix | Matrix]
) -> dict[str, Matrix]:
    """Return values of rows (k, n_dof) per pair force, beyond those of a basis (k, n_relative).

    By symmetry these are displacements of the pairs under the rows as forces: one back-substitution
    for each row.
    """
    if not rows:
        return {}
    stacked = np.vstack([sp.csr_array(matrix).toarray() for matrix in rows.values()])
    seen = model.structure.relative_operator @ _beyond_basis(model, basis, stiffness, stacked.T)
    ends = np.cumsum([matrix.shape[0] for matrix in rows.values()])[:-1]
    residuals: Matrix = frozen(np.ascontiguousarray(seen.T))
    return dict(zip(rows, np.split(residuals, ends), strict=True))


def _beyond_basis(model: Model, basis: Basis, stiffness: Matrix, forces: Matrix) -> Matrix:
    """Return displacements (n_dof, n) under forces, boundary held, outside the span of a basis."""
    fixed = basis.of_kind(*VANISHING)
    statics = model.structure.firm.solve_held(forces)
    shares = np.linalg.solve(stiffness, fixed.T @ forces)
    return statics - fixed @ shares


def _ports(model: Model) -> PortCompliance | None:
    """Return the compliance of the full model; None where its boundary alone holds it."""
    try:
        ports = model.port_compliance
        return replace(ports, pairs=ports.pairs.alone())
    except SingularMatrixError:
        return None


def _shared_vectors(bases: Sequence[Basis]) -> tuple[Basis, list[Indices]]:
    """Return the distinct vectors of several bases, and the columns of each basis in them."""
    places: dict[bytes, int] = {}
    columns: list[tuple[Basis, int]] = []
    chosen: list[Indices] = []
    for basis in bases:
        keys = [column.tobytes() for column in basis.vectors.T]
        for number, key in enumerate(keys):
            if key not in places:
                places[key] = len(columns)
                columns.append((basis, number))
        chosen.append(np.array([places[key] for key in keys], dtype=np.int64))
    together = Basis(
        vectors=np.column_stack([basis.vectors[:, number] for basis, number in columns]),
        kinds=tuple(basis.kinds[number] for basis, number in columns),
    )
    return together, chosen


def _matrices(model: Model, phi: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Return M, C and K of a reduced model, without forming C of the full one."""
    law, dampers = model.damping, model.structure.matrices.dampers
    M, K = _projection(model.M, phi), _projection(model.K, phi)
    C = law.alpha * M + law.beta * K
    return M, C if dampers is None else C + _projection(dampers, phi), K


def _projection(A: SparseMatrix, phi: Matrix) -> Matrix:
    """Return ΦᵀAΦ of a symmetric matrix."""
    product: Matrix = phi.T @ (A @ phi)
    return (product + product.T) / 2


def _held_stiffness(model: Model, basis: Basis) -> Matrix:
    """Return Φ_fᵀ K̂ Φ_f of the shapes that vanish on the boundary."""
    return _projection(model.structure.firm.supported_stiffness, basis.of_kind(*VANISHING))


def _rigid_motions(model: Model, phi: Matrix) -> Matrix:
    """Return rigid motions R (n_mode, n_motion) in coordinates of a basis that contains them."""
    motions, stiffness = model.rigid_motions, model.structure.supported_stiffness
    if not motions.shape[1]:
        return np.zeros((phi.shape[1], 0))
    return factorize(_projection(stiffness, phi)).solve(phi.T @ (stiffness @ motions))


def _boundaries(model: Model, basis: Basis) -> dict[str, Boundary]:
    """Constraint modes come in the order of the structure's boundary."""
    constraint = np.array([kind is ModeKind.CONSTRAINT for kind in basis.kinds])
    column = dict(
        zip(model.structure.boundary.tolist(), np.flatnonzero(constraint).tolist(), strict=True)
    )
    return {
        name: boundary.with_dofs(np.array([column[dof] for dof in boundary.dofs.tolist()]))
        for name, boundary in model.boundaries.items()
    }


def _method(basis: Basis, *, compliance: bool) -> str:
    """Return a name for a reduction without one, from its basis."""
    if basis.count(ModeKind.ATTACHMENT):
        return "compliance+inertia"
    if not basis.count(ModeKind.JOINT):
        return "compliance" if compliance else "craig-bampton"
    return "joint-modes+compliance" if compliance else "joint-modes"
