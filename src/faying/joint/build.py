"""Building of a model: matrices, constraints, interfaces, bolts and boundaries."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import cast

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector, read_only
from faying.contact.laws import Hard, Law, normal_law
from faying.exceptions import naming, refuse_model
from faying.interface.gap_field import with_gap_rule
from faying.interface.gap_pairing import declared_area
from faying.interface.interface import Interface, stack
from faying.interface.mortar import build_mortar_interface, find_couplings
from faying.interface.pairing import check_not_doubled, find_interfaces
from faying.interface.penalty import automatic_penalty, facet_penalty, with_friction
from faying.interface.zero_thickness import build_interface
from faying.joint.diagnosis import unconstrained
from faying.joint.free_matrices import free_matrices
from faying.joint.model import Model
from faying.joint.structure import Structure
from faying.joint.system import boundary_dofs, elongations
from faying.model.assembly import Assembly, Beam
from faying.model.bolt import Bolt, shank
from faying.model.boundary import FORCE_NAMES, Boundary, add_coupled_boundary
from faying.model.clamping import (
    Seats,
    check_clamping,
    check_not_twice,
    element_seats,
    spring_sense,
)
from faying.model.constraints import constrain, movable_components
from faying.model.contained_bolt import check_contained, elongation_factors
from faying.model.deck_bolt import (
    are_carried,
    axial_stiffness,
    bolt_axis_element,
    bolt_chain,
    bolt_ends,
    end_moments,
    end_nodes,
)
from faying.model.dofs import DofMap
from faying.model.generated_bolt import add_bolt
from faying.model.local_stiffness import stiffness_at
from faying.model.matrices import used_components
from faying.model.rigid_motion import whole_motions
from faying.model.solid_cells import check_cells
from faying.model.specs import BoltSpec, BoundarySpec, InterfaceSpec, Rayleigh
from faying.model.supports import nodes_of_set


def build_model(
    assembly: Assembly,
    *,
    interfaces: Sequence[InterfaceSpec] = (InterfaceSpec(name="joint"),),
    bolts: Sequence[BoltSpec] = (),
    boundaries: Sequence[BoundarySpec] = (),
    damping: Rayleigh | None = None,
    units: str = "mm-t-s",
) -> Model:
    """Build a model of an assembly.

    Parameters
    ----------
    interfaces
        Areas of contact; by default all coincident facets of different bodies.
    bolts
        Bolts to be tightened; those with an ``axis`` are generated, those with ``elements`` are
        beams of the assembly, those with ``nodes`` are part of its given stiffness matrix.
    boundaries
        Nodes or faces for loads; their degrees of freedom stay free.
    damping
        Rayleigh factors, added to any damping matrix of the assembly.

    Raises
    ------
    ModelError
        If a name does not exist, elements are inverted, facets do not match, a boundary is
        supported, or two boundaries share a node.

    Notes
    -----
    Elimination of constraints only; matrices are formed at their first use.

    Examples
    --------
    >>> import faying as fy
    >>> assembly = fy.lap_joint(element_size=5.0).assembly
    >>> stiff = fy.build_model(assembly, interfaces=[fy.InterfaceSpec(name="lap", penalty=1e6)])
    >>> list(stiff.interfaces)
    ['lap']
    """
    model = structure_model(
        assembly,
        interfaces=interfaces,
        bolts=bolts,
        boundaries=boundaries,
        damping=damping,
        units=units,
    )
    if not model.interfaces:
        refuse_model("the model has no interface; name one, or let faying find it with 'auto'")
    return model


def structure_model(
    assembly: Assembly,
    *,
    interfaces: Sequence[InterfaceSpec] = (),
    bolts: Sequence[BoltSpec] = (),
    boundaries: Sequence[BoundarySpec] = (),
    damping: Rayleigh | None = None,
    units: str = "mm-t-s",
) -> Model:
    """Build as :func:`build_model`; without interfaces a structure for inspection."""
    assembly, bolts = _with_generated_bolts(assembly, bolts)
    axes = {spec.name: bolt_axis_element(assembly, spec) for spec in bolts if spec.nodes is None}
    seats = {name: element_seats(assembly, element) for name, element in axes.items()}
    check_not_twice(seats)
    assembly, boundaries = _with_coupled_boundaries(assembly, boundaries)
    check_cells(assembly)
    used = used_components(assembly)
    movable = movable_components(assembly, used)
    ends = [_boundary_components(assembly, spec, movable) for spec in boundaries]
    _check_disjoint(assembly, boundaries, ends)
    dofs = constrain(assembly, used, keep=np.concatenate([*ends, np.empty(0, dtype=np.int64)]))
    joints = _interfaces(assembly, dofs, interfaces)
    placed = {
        spec.name: Boundary(
            name=spec.name,
            nodes=assembly.mesh.node_ids[end // 6],
            components=end % 6,
            dofs=dofs.index(end // 6, end % 6),
        )
        for spec, end in zip(boundaries, ends, strict=True)
    }
    tightened = _bolts_by_name(assembly, dofs, bolts, seats)
    n_dof = len(dofs.free)
    structure = Structure(
        matrices=free_matrices(assembly, dofs, damping or Rayleigh()),
        relative_operator=cast("SparseMatrix", stack(joints, n_dof).relative_operator),
        boundary=boundary_dofs(placed),
        elongations=elongations(tightened, n_dof),
        whole_motions=partial(whole_motions, assembly.mesh.nodes, dofs.free),
        diagnose=partial(unconstrained, assembly, dofs),
    )
    return Model(
        structure=structure,
        interfaces=joints,
        bolts=tightened,
        boundaries=placed,
        dofs=dofs,
        assembly=assembly,
        name=assembly.name,
        units=units,
    )


def _with_generated_bolts(
    assembly: Assembly, bolts: Sequence[BoltSpec]
) -> tuple[Assembly, list[BoltSpec]]:
    """Add the bolts that the deck does not have; all specs then name elements."""
    specs = []
    for spec in bolts:
        if spec.axis is None:
            specs.append(spec)
            continue
        assembly = add_bolt(assembly, spec)
        specs.append(replace(spec, elements=(assembly.beams[-1].id,), axis=None))
    return assembly, specs


def _with_coupled_boundaries(
    assembly: Assembly, boundaries: Sequence[BoundarySpec]
) -> tuple[Assembly, list[BoundarySpec]]:
    """Add nodes for boundaries that couple a face, and return all boundaries."""
    specs = []
    for spec in boundaries:
        if spec.coupling is None:
            specs.append(spec)
            continue
        assembly, reduced_spec = add_coupled_boundary(
            assembly, spec, _boundary_nodes(assembly, spec)
        )
        specs.append(reduced_spec)
    return assembly, specs


def _interfaces(
    assembly: Assembly, dofs: DofMap, specs: Sequence[InterfaceSpec]
) -> dict[str, Interface]:
    joints: dict[str, Interface] = {}
    for spec in specs:
        for name, interface in _find_interfaces(assembly, dofs, spec):
            if name in joints:
                refuse_model(f"two interfaces are called '{name}'; give each its own name")
            joints[name] = (
                interface
                if spec.gap is None
                else with_gap_rule(interface, assembly.mesh.nodes, assembly.mesh.node_ids, spec.gap)
            )
    check_not_doubled(joints)
    return joints


def _find_interfaces(
    assembly: Assembly, dofs: DofMap, spec: InterfaceSpec
) -> Iterator[tuple[str, Interface]]:
    """Yield the interfaces of a spec, wherever its sides touch."""
    area = declared_area(assembly, spec)
    if spec.meshes == "non-matching":
        for name, coupling in find_couplings(assembly, spec).items():
            facets = coupling.segments.minus.joined(coupling.segments.plus)
            law = _law(assembly, spec, partial(facet_penalty, assembly, facets))
            named_spec = replace(spec, name=name)
            joint = build_mortar_interface(assembly, dofs, named_spec, coupling, law)
            yield name, replace(joint, declared_area=area)
    else:
        for name, faces in find_interfaces(assembly, spec).items():
            law = _law(assembly, spec, partial(automatic_penalty, assembly, faces))
            joint = build_interface(assembly, dofs, replace(spec, name=name), faces, law)
            yield name, replace(joint, declared_area=area)


def _law(assembly: Assembly, spec: InterfaceSpec, automatic: Callable[[], float]) -> Law:
    """Return the law of a spec, with the penalty of the elements where it is automatic."""
    with naming(f"interface '{spec.name}'"):
        if spec.closure is not None and spec.penalty != "auto":
            refuse_model(f"it has a penalty and closure '{spec.closure.name}'; give one of them")
        normal: Law
        if spec.closure is not None:
            normal = spec.closure
        elif spec.penalty == "hard":
            normal = Hard()
        else:
            normal = normal_law(automatic() if spec.penalty == "auto" else float(spec.penalty))
        return with_friction(normal, spec.friction, spec.tangential_penalty, assembly)


def _boundary_components(assembly: Assembly, spec: BoundarySpec, movable: Mask) -> Indices:
    """Rows 6 i + c of the components that can carry a load."""
    nodes = _boundary_nodes(assembly, spec)
    rows = (6 * nodes[:, None] + np.arange(6)).ravel()
    free: Indices = rows[movable[rows]]
    if not len(free):
        refuse_model(
            f"boundary '{spec.name}' takes no load: its node {assembly.mesh.node_ids[nodes[0]]} is "
            "fixed by supports in every component, or touches nothing; choose a node that can move"
        )
    return free


def _boundary_nodes(assembly: Assembly, spec: BoundarySpec) -> Indices:
    if spec.node is not None:
        with naming(f"boundary '{spec.name}'"):
            return assembly.mesh.node_index(np.array([spec.node]))
    with naming(f"boundary '{spec.name}'"):
        return nodes_of_set(assembly, spec.set or "")


def _check_disjoint(
    assembly: Assembly, specs: Sequence[BoundarySpec], ends: Sequence[Indices]
) -> None:
    owner: dict[int, str] = {}
    for spec, end in zip(specs, ends, strict=True):
        for row in end.tolist():
            first_name = owner.setdefault(row, spec.name)
            if first_name != spec.name:
                refuse_model(
                    f"boundaries '{first_name}' and '{spec.name}' share node "
                    f"{assembly.mesh.node_ids[row // 6]} ({FORCE_NAMES[row % 6]}); "
                    "let each node belong to one boundary"
                )


def _bolts_by_name(
    assembly: Assembly, dofs: DofMap, specs: Sequence[BoltSpec], seats: Mapping[str, Seats]
) -> dict[str, Bolt]:
    """Return the bolts by name."""
    if not specs:
        return {}
    nodes = [node for spec in specs for node in _nodes_of(assembly, spec)]
    K = stiffness_at(assembly, dofs, np.unique(nodes))
    return {spec.name: _bolt(assembly, dofs, K, spec, seats) for spec in specs}


def _bolt(
    assembly: Assembly,
    dofs: DofMap,
    K: SparseMatrix,
    spec: BoltSpec,
    seats: Mapping[str, Seats],
) -> Bolt:
    """Return a bolt with axial stiffness and elongation row; K holds at its nodes."""
    if spec.nodes is not None:
        row, stiffness = elongation_factors(assembly, spec), float(spec.stiffness or 0.0)
    else:
        row, stiffness = _element_rows(assembly, spec, seats[spec.name])
    elongation = (row @ dofs.transformation).toarray().ravel()
    if spec.nodes is not None:
        check_contained(K, elongation, spec)
    moments = _moment_rows(assembly, dofs, K, spec) if spec.nodes is None else None
    return Bolt(
        name=spec.name,
        elongation=elongation,
        stiffness=stiffness,
        ends=_ends(assembly, spec),
        bending=moments,
        shank=None if spec.nodes is not None else shank(assembly, spec, dofs.transformation),
    )


def _moment_rows(
    assembly: Assembly, dofs: DofMap, K: SparseMatrix, spec: BoltSpec
) -> SparseMatrix | None:
    """Return the rows of the bending moments of a bolt; None where it has no bending."""
    moments = end_moments(assembly, spec)
    if moments is None:
        return None
    rows = (moments @ dofs.transformation).tocsr()
    rows.eliminate_zeros()
    beams = isinstance(bolt_axis_element(assembly, spec), Beam)
    return read_only(rows) if not beams or are_carried(rows, K) else None


def _nodes_of(assembly: Assembly, spec: BoltSpec) -> list[int]:
    """Return all nodes of the element or pair of nodes at which a bolt is tightened."""
    if spec.nodes is not None:
        with naming(f"bolt '{spec.name}'"):
            return [int(node) for node in _end_nodes(assembly, spec)]
    chain = [bolt_axis_element(assembly, spec), *bolt_chain(assembly, spec)]
    return [node for element in chain for node in end_nodes(element)]


def _ends(assembly: Assembly, spec: BoltSpec) -> Matrix:
    """Return the positions (2, 3) of the ends of a bolt; for a spring those of its nodes."""
    ends = None if spec.axis is not None else bolt_ends(assembly, spec)
    return assembly.mesh.nodes[_end_nodes(assembly, spec)] if ends is None else ends


def _end_nodes(assembly: Assembly, spec: BoltSpec) -> Indices:
    """Return the two nodes (2,) between which a bolt is tightened."""
    if spec.nodes is not None:
        return assembly.mesh.node_index(np.array(spec.nodes))
    element = bolt_axis_element(assembly, spec)
    if isinstance(element, Beam):
        return np.array(element.nodes)
    return np.array([node for node, _ in element.ends])


def _element_rows(assembly: Assembly, spec: BoltSpec, seats: Seats) -> tuple[SparseMatrix, float]:
    """Return elongation row (1, 6 n_node) and axial stiffness of the tightened element."""
    element = bolt_axis_element(assembly, spec)
    check_clamping(assembly.mesh, spec, seats)
    if isinstance(element, Beam):
        start, end = (assembly.mesh.nodes[node] for node in element.nodes)
        length = float(np.linalg.norm(end - start))
        rows = 6 * np.repeat(element.nodes, 3) + np.tile(np.arange(3), 2)
        factors: Vector = np.concatenate([start - end, end - start]) / length
    else:
        (first, component), (second, _) = element.ends
        sign = spring_sense(assembly, element, seats)
        rows = 6 * np.array([first, second]) + component
        factors = np.array([-sign, sign])
    shape = (1, 6 * len(assembly.mesh.nodes))
    row = sp.csr_array((factors, (np.zeros(len(rows), dtype=int), rows)), shape=shape)
    return row, axial_stiffness(assembly, element)
