"""Mass, damping and stiffness of another program as an assembly, from memory or from files."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from faying._typing import Indices, Matrix, SparseMatrix
from faying.display.facts import listed
from faying.exceptions import ModelError, naming, refuse_model
from faying.io.deck_lines import ABAQUS, NASTRAN
from faying.io.matrix_checks import (
    RowLabel,
    check_mass,
    checked_matrix,
    symmetric_matrix,
    turning_nodes,
)
from faying.io.matrix_labels import aligned
from faying.io.matrix_tables import read_dof_table, read_id_sets, read_matrix, read_node_table
from faying.model.assembly import (
    Assembly,
    AverageCoupling,
    Beam,
    Equation,
    MatrixBlock,
    PointMass,
    RigidCoupling,
    Spring,
    Support,
)
from faying.model.elements import FACES
from faying.model.mesh import Mesh

_Path = str | PathLike[str]


def matrices_assembly(
    M: SparseMatrix | npt.ArrayLike,
    K: SparseMatrix | npt.ArrayLike,
    C: SparseMatrix | npt.ArrayLike | None = None,
    *,
    nodes: npt.ArrayLike,
    dofs: npt.ArrayLike | None = None,
    node_ids: npt.ArrayLike | None = None,
    faces: Mapping[str, npt.ArrayLike] | None = None,
    node_sets: Mapping[str, npt.ArrayLike] | None = None,
    beams: Sequence[Beam] = (),
    springs: Sequence[Spring] = (),
    masses: Sequence[PointMass] = (),
    rigid_couplings: Sequence[RigidCoupling] = (),
    average_couplings: Sequence[AverageCoupling] = (),
    equations: Sequence[Equation] = (),
    supports: Sequence[Support] = (),
    name: str = "matrices",
) -> Assembly:
    """Check matrices against their tables and wrap them as an assembly.

    Parameters
    ----------
    M, C, K : (n, n)
        Sparse or dense; ``M`` and ``K`` symmetric. Differences below 1e-8 of the largest entry
        are averaged away.
    nodes : (n_node, 3) [length]
    dofs : (n, 2)
        Node id and component 1..6 of each row. Without it, rows run through the nodes in their
        order with three or six components each, whichever fits the size.
    node_ids : (n_node,)
        1, 2, 3, … if None.
    faces
        Names of interface sides to node ids (n_face, 3 | 4 | 6 | 8), corners first,
        counter-clockwise seen from outside the body; -1 fills rows with fewer nodes.
    node_sets
        Names to node ids.
    beams, springs, masses, rigid_couplings, average_couplings, equations, supports
        Members of the assembly; they refer to nodes by index.

    Raises
    ------
    ModelError
        If a matrix or table does not fit; the message names row and column, or node id.
    """
    points = np.asarray(nodes, dtype=np.float64).reshape(-1, 3)
    ids = np.arange(1, len(points) + 1) if node_ids is None else np.asarray(node_ids)
    mesh = _mesh(points, np.asarray(ids, dtype=np.int64))
    table = _every_node(mesh, np.shape(K)) if dofs is None else np.asarray(dofs)
    index, component = _rows(mesh, table)
    label = RowLabel(mesh.node_ids[index], component)
    mass, stiffness = checked_matrix("M", M, label), checked_matrix("K", K, label)
    damping = None if C is None else checked_matrix("C", C, label)
    mass, stiffness = symmetric_matrix("M", mass, label), symmetric_matrix("K", stiffness, label)
    turning = turning_nodes(stiffness, index, component)
    component = np.where(np.isin(index, turning), component + 3, component)
    check_mass(mass, RowLabel(mesh.node_ids[index], component))
    face_sets = {key: _face_set(mesh, key, value) for key, value in (faces or {}).items()}
    notes = [_rowless(mesh, key, side, index) for key, side in face_sets.items()]
    notes.append(_turning(mesh, turning))
    for key, value in (node_sets or {}).items():
        with naming(f"node set '{key}'"):
            mesh = mesh.with_node_set(key, np.unique(mesh.node_index(np.asarray(value))))
    return Assembly(
        mesh=mesh,
        matrices=MatrixBlock(M=mass, C=damping, K=stiffness, nodes=index, components=component),
        face_sets=face_sets,
        beams=tuple(beams),
        springs=tuple(springs),
        masses=tuple(masses),
        rigid_couplings=tuple(rigid_couplings),
        average_couplings=tuple(average_couplings),
        equations=tuple(equations),
        supports=tuple(supports),
        name=name,
        ignored=tuple(note for note in notes if note),
    )


def read_matrices(
    M: _Path,
    K: _Path,
    C: _Path | None = None,
    *,
    nodes: _Path,
    dofs: _Path | None = None,
    faces: _Path | None = None,
    node_sets: _Path | None = None,
    held: _Path | None = None,
    **parts: Any,
) -> Assembly:
    """Read matrices and tables from files.

    Parameters
    ----------
    M, C, K
        Files of the kinds in :data:`faying.io.matrix_tables.READERS`.
    nodes
        Rows of id, x, y, z (``.csv``, ``.txt``, ``.npz``), or the deck (``.inp``, ``.bdf``,
        ``.nas``, ``.fem``), which also supplies surfaces and node sets.
    dofs
        Node id and component 1..6 of each matrix row (``.csv``, ``.txt``, ``.npz``). Without it,
        M and C are sorted to the row labels of K; without labels, rows run
        through the nodes with three or six components each, whichever fits.
    faces, node_sets
        Rows of set name, node id, node id, …; or an ``.npz`` with one array per set.
    held
        Node id and component 1..6 of each degree of freedom to hold at zero, if the matrices
        are unconstrained; a file like ``dofs``.
    **parts
        Other arguments of :func:`matrices_assembly`: couplings, supports, ``name``, …

    Raises
    ------
    FormatError
        If a file cannot be read.
    ModelError
        If the contents do not fit together.
    """
    if Path(nodes).suffix.lower() in (*ABAQUS, *NASTRAN):
        mesh, surfaces = _read_geometry(nodes)
    else:
        ids, points = read_node_table(nodes)
        mesh, surfaces = Mesh(nodes=points, node_ids=ids), {}
    sides = {name: np.where(side >= 0, mesh.node_ids[side], -1) for name, side in surfaces.items()}
    given = read_id_sets(faces, "face set") if faces is not None else {}
    sides |= {key: _stacked(value) for key, value in given.items()}
    named = read_id_sets(node_sets, "node set") if node_sets is not None else {}
    files = {"M": M, "K": K, "C": C}
    labelled = {key: read_matrix(file, key) for key, file in files.items() if file is not None}
    matrices, rows = aligned(labelled, None if dofs is None else read_dof_table(dofs))
    assembly = matrices_assembly(
        matrices["M"],
        matrices["K"],
        matrices.get("C"),
        nodes=mesh.nodes,
        node_ids=mesh.node_ids,
        dofs=rows,
        faces=sides,
        node_sets={
            **{name: mesh.node_ids[members] for name, members in mesh.node_sets.items()},
            **{name: np.concatenate(parts) for name, parts in named.items()},
        },
        **parts,
    )
    if held is None:
        return assembly
    supports = _supports(assembly.mesh, read_dof_table(held))
    return replace(assembly, supports=(*assembly.supports, *supports))


def _read_geometry(path: _Path) -> tuple[Mesh, Mapping[str, Indices]]:
    """Read nodes, node sets and surfaces of an Abaqus, CalculiX or Nastran deck."""
    if Path(path).suffix.lower() in ABAQUS:
        from faying.io.abaqus.matrices import read_geometry

        return read_geometry(path)
    from faying.io.nastran import read_joint

    assembly = read_joint(path).assembly
    return assembly.mesh, assembly.face_sets


def _mesh(points: Matrix, ids: Indices) -> Mesh:
    if not np.isfinite(points).all():
        refuse_model(f"node table: node {ids[~np.isfinite(points).all(axis=1)][0]} is not finite")
    mesh = Mesh(nodes=points, node_ids=ids)
    unique, count = np.unique(ids, return_counts=True)
    if (count > 1).any():
        refuse_model(f"node table: node {unique[count > 1][0]} occurs twice; keep one row")
    return mesh


def _every_node(mesh: Mesh, shape: tuple[int, ...]) -> Indices:
    """Return the dof table of a matrix with three or six components of every node in order."""
    n_node = len(mesh.node_ids)
    for size in (3, 6):
        if shape == (size * n_node, size * n_node):
            components = np.tile(np.arange(1, size + 1), n_node)
            return np.stack([np.repeat(mesh.node_ids, size), components], axis=1)
    message = (
        f"matrix K has shape {shape} for {n_node} nodes, neither 3 nor 6 rows a node; give the "
        "dof table (node id and component 1..6 of each row)"
    )
    raise ModelError(message)


def _rows(mesh: Mesh, dofs: npt.NDArray[Any], what: str = "dof table") -> tuple[Indices, Indices]:
    """Return node index and component 0..5 of each row."""
    if dofs.ndim != 2 or dofs.shape[1] != 2 or dofs.dtype.kind not in "iu":
        refuse_model(
            f"{what}: shape {dofs.shape} of {dofs.dtype}; expected whole numbers (n, 2): "
            "node id and component 1..6 of each row"
        )
    table = dofs.astype(np.int64)
    unknown = np.flatnonzero(~np.isin(table[:, 0], mesh.node_ids))
    if unknown.size:
        row = int(unknown[0])
        refuse_model(f"{what}: row {row + 1} names node {table[row, 0]}, which does not exist")
    wrong = np.flatnonzero((table[:, 1] < 1) | (table[:, 1] > 6))
    if wrong.size:
        row = int(wrong[0])
        refuse_model(f"{what}: row {row + 1} has component {table[row, 1]}; expected 1 to 6")
    _, first, which = np.unique(table, axis=0, return_index=True, return_inverse=True)
    again = np.flatnonzero(first[which.ravel()] != np.arange(len(table)))
    if again.size:
        row = int(again[0])
        refuse_model(
            f"{what}: node {table[row, 0]} component {table[row, 1]} occurs in rows "
            f"{first[which.ravel()[row]] + 1} and {row + 1}; keep one"
        )
    return mesh.node_index(table[:, 0]), table[:, 1] - 1


def _face_set(mesh: Mesh, name: str, ids: npt.ArrayLike) -> Indices:
    table = np.asarray(ids)
    *widths, last = (face.n_nodes for face in FACES.values())
    given = np.atleast_2d(table != -1)
    known = np.isin(given.sum(axis=1), [*widths, last]).all() and given.shape[1] <= last
    gaps = (given[:, 1:] > given[:, :-1]).any()
    if table.ndim != 2 or table.dtype.kind not in "iu" or not known or gaps:
        refuse_model(
            f"face set '{name}': shape {table.shape} of {table.dtype}; expected node ids "
            f"(n_face, {', '.join(map(str, widths))} or {last}), -1 only at the ends of rows"
        )
    nodes = np.full(table.shape, -1, dtype=np.int64)
    with naming(f"face set '{name}'"):
        nodes[given] = mesh.node_index(table[given])
    return nodes


def _supports(mesh: Mesh, table: Indices) -> list[Support]:
    """Return one support for each component named in a table."""
    index, component = _rows(mesh, table, "held components")
    return [
        Support(id=int(number) + 1, nodes=index[component == number], components=(int(number),))
        for number in np.unique(component)
    ]


def _rowless(mesh: Mesh, name: str, faces: Indices, present: Indices) -> str:
    """Return the note that interface nodes without rows count as held; they may be eliminated."""
    missing = mesh.node_ids[np.setdiff1d(faces[faces >= 0], present)]
    if not len(missing):
        return ""
    nodes = listed(missing)
    return f"{len(missing)} nodes of face set '{name}' have no rows and count as held: {nodes}"


def _turning(mesh: Mesh, nodes: Indices) -> str:
    """Return the note that rows labelled as displacements were taken as rotations."""
    if not len(nodes):
        return ""
    return (
        f"rows 1 to 3 of {len(nodes)} nodes, taken as their rotations 4 to 6, for a translation of "
        f"the structure does not move them: {listed(mesh.node_ids[nodes])}"
    )


def _stacked(rows: list[Indices]) -> Indices:
    """Return rows as a table, -1 where a row is shorter."""
    width = max(map(len, rows))
    return np.stack([np.pad(row, (0, width - len(row)), constant_values=-1) for row in rows])
