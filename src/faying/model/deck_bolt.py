"""Bolts of a deck: the tightened beam or spring, its position, and the bending of the bolt."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector, read_only
from faying.digits import DECK_DIGITS, SOLVED
from faying.exceptions import ModelError, refuse_model
from faying.model.assembly import Assembly, Beam, Spring
from faying.model.elements.beam import beam_frames, beam_matrices
from faying.model.matrices import solid_matrices
from faying.model.specs import BoltSpec

CUT_STIFFNESS = 1e4
"""Stiffness of the spring across a cut over E A / h of the adjacent layer of elements: it adds one
part in ten thousand of one layer to the bolt's compliance, and costs four digits of K at most."""


def bolt_axis_element(assembly: Assembly, spec: BoltSpec) -> Beam | Spring:
    """Return the tightened beam or spring of a deck's bolt: the middle one of its chain.

    The ids of the bolt's elements, in any order, form one chain end to end. For an even number it
    is the one before the middle, counted from the end listed first.

    Raises
    ------
    ModelError
        If an id is not a beam or an axial spring, or the elements do not form one chain.
    """
    chain = bolt_chain(assembly, spec)
    return chain[(len(chain) - 1) // 2]


def axial_stiffness(assembly: Assembly, element: Beam | Spring) -> float:
    """Return force over elongation of an element of a bolt."""
    if isinstance(element, Spring):
        return element.stiffness
    start, end = assembly.mesh.nodes[list(element.nodes)]
    length = float(np.linalg.norm(end - start))
    section = element.section
    return section.axial_factor * element.material.youngs_modulus * section.area / length


def with_unlocked_bolts(assembly: Assembly, specs: Sequence[BoltSpec]) -> Assembly:
    """Return an assembly whose bolts keep their initial force at any length: nearly no stiffness.

    Their force changes by a millionth of the change in a locked bolt. This remainder of stiffness
    supports parts that only the bolt and contact hold.
    """
    ids = {bolt_axis_element(assembly, spec).id for spec in specs}
    return replace(
        assembly,
        beams=tuple(
            replace(beam, section=replace(beam.section, axial_factor=DECK_DIGITS))
            if beam.id in ids
            else beam
            for beam in assembly.beams
        ),
        springs=tuple(
            replace(spring, stiffness=spring.stiffness * DECK_DIGITS / CUT_STIFFNESS)
            if spring.id in ids
            else spring
            for spring in assembly.springs
        ),
    )


def bolt_chain(assembly: Assembly, spec: BoltSpec) -> list[Beam | Spring]:
    """Return the elements of a deck's bolt end to end, starting at the end listed first."""
    if not spec.elements:
        refuse_model(f"bolt '{spec.name}' names no elements; give the ids of its beam elements")
    chosen = [_line_element(assembly, spec, i) for i in dict.fromkeys(spec.elements)]
    return _chain(spec, chosen)


def _line_element(assembly: Assembly, spec: BoltSpec, element_id: int) -> Beam | Spring:
    """Return a beam or axial spring by id."""
    for beam in assembly.beams:
        if beam.id == element_id:
            return beam
    for spring in assembly.springs:
        if spring.id == element_id:
            components = {component for _, component in spring.ends}
            if len(spring.ends) == 2 and len(components) == 1 and components <= {0, 1, 2}:
                return spring
            refuse_model(
                f"bolt '{spec.name}': spring {element_id} is not axial; it must join the same "
                "translation (1, 2 or 3) of two nodes"
            )
    if any(bush.id == element_id for bush in assembly.bushes):
        refuse_model(
            f"bolt '{spec.name}': element {element_id} has springs along and about several axes "
            "(CBUSH), which are not tightened; put a CBEAM or an axial CELAS between its nodes"
        )
    message = (
        f"bolt '{spec.name}': element {element_id} is no beam and no spring; "
        "name the beam elements of the bolt's shank"
    )
    raise ModelError(message)


def _chain(spec: BoltSpec, elements: list[Beam | Spring]) -> list[Beam | Spring]:
    """Return elements in order, end to end."""
    at_node: dict[int, list[Beam | Spring]] = defaultdict(list)
    for element in elements:
        for node in end_nodes(element):
            at_node[node].append(element)
    loose = [node for element in elements for node in end_nodes(element) if len(at_node[node]) == 1]
    chain: list[Beam | Spring] = []
    node = loose[0] if loose else -1
    while following := [e for e in at_node.get(node, []) if e not in chain]:
        chain.append(following[0])
        node = next(n for n in end_nodes(following[0]) if n != node)
    if len(chain) != len(elements) or len(loose) != 2:
        ids = ", ".join(str(element.id) for element in elements)
        refuse_model(
            f"bolt '{spec.name}': elements {ids} do not form one chain end to end; "
            "list the shank's elements only"
        )
    return chain


def end_nodes(element: Beam | Spring) -> tuple[int, ...]:
    """Return the indices of the nodes of a line element."""
    return element.nodes if isinstance(element, Beam) else tuple(node for node, _ in element.ends)


def chain_ends(chain: Sequence[Beam | Spring]) -> list[tuple[Beam | Spring, int]]:
    """Return the first and the last element of a chain, each with its end node."""
    if len(chain) == 1:
        first, last = end_nodes(chain[0])
        return [(chain[0], first), (chain[0], last)]
    return [
        (end, next(node for node in end_nodes(end) if node not in end_nodes(inner)))
        for end, inner in ((chain[0], chain[1]), (chain[-1], chain[-2]))
    ]


def bolt_ends(assembly: Assembly, spec: BoltSpec) -> Matrix | None:
    """Return the positions (2, 3) of the ends of a bolt; None for a spring.

    For a cut through a shank of solids two points on its axis.
    """
    nodes = assembly.mesh.nodes
    if spec.axis is not None:
        return np.array(spec.axis)
    if spec.nodes is not None:
        return nodes[assembly.mesh.node_index(np.array(spec.nodes))]
    element = bolt_axis_element(assembly, spec)
    if isinstance(element, Beam):
        return nodes[list(element.nodes)]
    return None if element.axis is None else np.array(element.axis)


def bolt_direction(assembly: Assembly, spec: BoltSpec) -> Vector:
    """Return the unit vector along a bolt, its largest component positive."""
    ends = bolt_ends(assembly, spec)
    if spec.direction is not None:
        along = np.array(spec.direction, dtype=float)
    elif ends is not None:
        along = ends[1] - ends[0]
    else:
        along = np.zeros(3)
        element = bolt_axis_element(assembly, spec)
        along[[component for _, component in getattr(element, "ends", ())]] = 1.0
    length = float(np.linalg.norm(along)) or 1.0
    return np.asarray(along / length * np.sign(along[np.abs(along).argmax()] or 1.0))


def end_moments(assembly: Assembly, spec: BoltSpec) -> SparseMatrix | None:
    """Return rows (4, 6 n_node) of the bending moments of a bolt per displacement.

    Two components across the axis at the first end of its elements, then two at the second: a shank
    without lateral loads between its ends has its largest bending at one of them. For a shank of
    solids both are at the section where it is cut. None where the element at an end has no bending
    stiffness: a spring, or a rod.
    """
    nodes = assembly.mesh.nodes
    section = section_rows(assembly, spec)
    if section is not None:
        return read_only(sp.csr_array(sp.vstack([section[4:], section[4:]])))
    values, columns = [], []
    for element, node in chain_ends(bolt_chain(assembly, spec)):
        if not isinstance(element, Beam):
            return None
        if not max(element.section.inertia_y, element.section.inertia_z) > 0:
            return None
        frames, _ = beam_frames([element], np.diff(nodes[list(element.nodes)], axis=0))
        _, stiffness = beam_matrices([element], nodes)
        first = 6 * element.nodes.index(node) + 3
        values.append(frames[0, 1:] @ stiffness[0, first : first + 3])
        dofs = (6 * np.array(element.nodes)[:, None] + np.arange(6)).ravel()
        columns += [dofs, dofs]
    entries = (np.concatenate(values).ravel(), (np.repeat(np.arange(4), 12), np.ravel(columns)))
    return read_only(sp.csr_array(entries, shape=(4, 6 * len(nodes))))


def are_carried(moments: SparseMatrix, K: SparseMatrix) -> bool:
    """Return whether any motion causes these moments.

    None does if they follow from equilibrium of degrees of freedom without other elements: hinges
    at both ends, or a beam in place of a section across which a bolt is tightened. The moments are
    rows (4, n_dof).
    """
    columns = np.unique(moments.indices)
    rows = K[columns]
    outside = np.ones(K.shape[1], dtype=bool)
    outside[columns] = False
    row = np.repeat(np.arange(len(columns)), np.diff(rows.indptr))
    touched = np.bincount(row[outside[rows.indices]], minlength=len(columns))
    alone = columns[touched == 0]
    loads = moments[:, columns].toarray().T
    balance = K[alone][:, columns].toarray().T
    left = loads - balance @ np.linalg.lstsq(balance, loads)[0] if len(alone) else loads
    return bool(np.abs(left).max(initial=0.0) > SOLVED * np.abs(loads).max(initial=0.0))


def section_rows(assembly: Assembly, spec: BoltSpec) -> SparseMatrix | None:
    """Return rows (6, 6 n_node) of the section forces of a cut bolt per displacement.

    The axial force, tension positive, two forces across the axis, the moment about it, and the
    bending moments about the same two directions, about the centre of the section. They are the
    nodal forces K_e u of the elements on one side of the cut, in equilibrium with all others to
    round-off on any mesh. None for a bolt that is not cut through solids.

    Notes
    -----
    Free strains of the elements beside the cut, as of temperature, are not subtracted.
    """
    spring = bolt_axis_element(assembly, spec)
    if not isinstance(spring, Spring) or spring.axis is None:
        return None
    side = _nodes_of_side(assembly, spring)
    if not len(side):
        return None
    ends, size = np.array(spring.axis), 6 * len(assembly.mesh.nodes)
    weights = _resultant_weights(assembly.mesh.nodes[side] - ends.mean(axis=0), ends[1] - ends[0])
    dofs = (6 * side[:, None] + np.arange(3)).ravel()
    which = np.repeat(np.arange(6), len(dofs))
    sums = sp.csr_array((weights.ravel(), (which, np.tile(dofs, 6))), shape=(6, size))
    rows = sp.csr_array((6, size))
    for block in assembly.mesh.blocks:
        touching: Mask = np.asarray(np.isin(block.nodes, side).any(axis=1))
        if touching.any():
            rows = rows + sums @ solid_matrices(assembly, block.taken(touching))[1]
    return sp.csr_array(rows)


def _nodes_of_side(assembly: Assembly, spring: Spring) -> Indices:
    """Return the nodes of a cut that follow the other side, and the end of its spring."""
    moving = spring.ends[1][0]
    followers = {
        equation.terms[0][0]
        for equation in assembly.equations
        if any(node == moving for node, _, _ in equation.terms[2:])
    }
    return np.array(sorted(followers), dtype=np.int64)


def _resultant_weights(arms: Matrix, along: Vector) -> Matrix:
    """Return the matrices (6, n, 3) from forces at places (n, 3) to resultants at the centre."""
    normal = along / np.linalg.norm(along)
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    frame = np.array([normal, first, np.cross(normal, first)])
    forces = np.repeat(frame[:, None], len(arms), axis=1)
    # t · (r × f) = (t × r) · f
    moments = np.cross(frame[:, None], arms[None])
    return np.concatenate([forces, moments])
