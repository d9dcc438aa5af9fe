"""Models of other programs' decks, meshes and matrices, one function each."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from faying.exceptions import ModelError
from faying.joint.build import build_model
from faying.joint.model import Model
from faying.model.assembly import Material
from faying.model.deck_bolt import with_unlocked_bolts
from faying.model.description import JointDescription
from faying.model.specs import BoltSpec, BoundarySpec, InterfaceSpec, Rayleigh
from faying.model.supports import with_supports

AUTO = (InterfaceSpec(name="joint"),)


def read_nastran(
    path: str | Path,
    *,
    interfaces: Sequence[InterfaceSpec] | None = None,
    bolts: Sequence[BoltSpec] | None = None,
    boundaries: Sequence[BoundarySpec] = (),
    damping: Rayleigh | None = None,
    subcase: int | None = None,
    ignore: Sequence[str] = (),
) -> Model:
    """Build a model from a Nastran bulk-data deck.

    Parameters
    ----------
    interfaces
        Where bodies touch; by default the contact definitions of the deck or, if it has none, all
        coincident facets of different bodies.
    bolts
        Bolts, as beam elements of the deck or as generated beams; by default those of the deck.
    boundaries
        Where loads enter.
    subcase
        Subcase whose sets count; the first unless given.
    ignore
        What the deck has and the model shall not: ``"plastic"``, ``"friction"``, ``"temperature"``
        (:data:`faying.io.left_out.IGNORABLE` says what each means).

    Raises
    ------
    FormatError
        If the deck cannot be read; the message names file and line.
    ModelError
        If the deck and what is said about it do not fit together.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import faying as fy
    >>> from faying.io.nastran.writer import write_deck
    >>> with TemporaryDirectory() as folder:
    ...     write_deck(fy.lap_joint(element_size=5.0).assembly, f"{folder}/joint.bdf")
    ...     list(fy.read_nastran(f"{folder}/joint.bdf").interfaces)
    ['joint']
    """
    from faying.io.nastran import read_joint

    described = read_joint(path, subcase=subcase, ignore=ignore)
    return _of_deck(described, interfaces, bolts, boundaries, damping)


def read_abaqus(
    path: str | Path,
    *,
    interfaces: Sequence[InterfaceSpec] | None = None,
    bolts: Sequence[BoltSpec] | None = None,
    boundaries: Sequence[BoundarySpec] = (),
    damping: Rayleigh | None = None,
    step: int | None = None,
    ignore: Sequence[str] = (),
) -> Model:
    """Build a model from an Abaqus or CalculiX input deck.

    Parameters
    ----------
    interfaces
        Where bodies touch; by default the contact pairs of the deck or, if it has none, all
        coincident facets of different bodies.
    bolts
        Beam elements of the deck, or generated beams; by default its pretension sections, whose
        forces :func:`faying.io.abaqus.read_joint` tells.
    boundaries
        Where loads enter.
    step
        Step whose boundary conditions count; the last general one unless given.
    ignore
        As for :func:`read_nastran`.

    Raises
    ------
    FormatError
        If the deck cannot be read; the message names file and line.
    ModelError
        If the deck and what is said about it do not fit together.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import faying as fy
    >>> from faying.io.abaqus.writer import write_deck
    >>> from faying.joint.lap_joint import lap_joint_assembly
    >>> with TemporaryDirectory() as folder:
    ...     write_deck(lap_joint_assembly(element_size=5.0), f"{folder}/joint.inp")
    ...     list(fy.read_abaqus(f"{folder}/joint.inp").interfaces)
    ['joint']
    """
    from faying.io.abaqus import read_joint

    described = read_joint(path, step=step, ignore=ignore)
    return _of_deck(described, interfaces, bolts, boundaries, damping)


def _of_deck(
    described: JointDescription,
    interfaces: Sequence[InterfaceSpec] | None,
    bolts: Sequence[BoltSpec] | None,
    boundaries: Sequence[BoundarySpec],
    damping: Rayleigh | None,
) -> Model:
    """Build what a deck describes; what is given replaces what the deck says."""
    sides = described.interfaces or AUTO if interfaces is None else interfaces
    if sides is AUTO and described.has_joined_faces:
        message = "the deck has no contact pairs, and faces found automatically would be those "
        raise ModelError(message + "of ties and of cuts through bolts too; name the sides")
    free = described.unlocked if bolts is None else ()
    return build_model(
        with_unlocked_bolts(described.assembly, [b for b in described.bolts if b.name in free]),
        interfaces=sides,
        bolts=described.bolts if bolts is None else bolts,
        boundaries=[*described.boundaries, *boundaries],
        damping=damping,
    )


def read_mesh(
    path: str | Path,
    *,
    materials: Mapping[str, Material],
    separate: Sequence[str] = (),
    supports: Mapping[str, Sequence[int]] | None = None,
    interfaces: Sequence[InterfaceSpec] = AUTO,
    bolts: Sequence[BoltSpec] = (),
    boundaries: Sequence[BoundarySpec] = (),
    damping: Rayleigh | None = None,
) -> Model:
    """Build a model from a mesh file: gmsh ``.msh``, ``.vtu``, ``.med`` and others meshio reads.

    Parameters
    ----------
    materials
        Volume group to its material; ``"default"`` is that of groups without one of their own.
    separate
        Volume groups that get nodes of their own where they share nodes with other solids.
    supports
        Group to the components 0..5 that are held at zero, usually ``(0, 1, 2)``.
    interfaces, bolts, boundaries
        As for :func:`read_nastran`; sides and boundaries are groups of the file, bolts are
        generated.

    Raises
    ------
    FormatError
        If the file cannot be read, or a group has no material.
    ModelError
        If the mesh and what is said about it do not fit together.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import faying as fy
    >>> import meshio
    >>> import numpy as np
    >>> steel = fy.Material(youngs_modulus=210e3, poissons_ratio=0.3, density=7.85e-9)
    >>> z, y, x = np.mgrid[0:2.0, 0:2.0, 0:2.0].reshape(3, 8)
    >>> brick, order = np.stack([x, y, z], axis=1), [0, 1, 3, 2, 4, 5, 7, 6]
    >>> cells = [("hexahedron", [order, [node + 8 for node in order]])]
    >>> stack = meshio.Mesh(np.vstack([brick, brick + [0, 0, 1]]), cells)
    >>> with TemporaryDirectory() as folder:
    ...     stack.write(f"{folder}/stack.vtu")
    ...     fy.read_mesh(f"{folder}/stack.vtu", materials={"default": steel}).contact.n_points
    4
    """
    from faying.io.mesh_files import read_mesh_file

    assembly = read_mesh_file(path, materials=materials, separate=tuple(separate))
    return build_model(
        with_supports(assembly, supports or {}),
        interfaces=interfaces,
        bolts=bolts,
        boundaries=boundaries,
        damping=damping,
    )


def from_matrices(
    *,
    interfaces: Sequence[InterfaceSpec] = AUTO,
    bolts: Sequence[BoltSpec] = (),
    boundaries: Sequence[BoundarySpec] = (),
    damping: Rayleigh | None = None,
    **matrices: Any,
) -> Model:
    """Build a model from mass, damping and stiffness of another program.

    Parameters
    ----------
    interfaces, bolts, boundaries
        As for :func:`read_nastran`; interface sides are names of face sets, penalties are numbers
        or ``"hard"``, and bolts have ``nodes`` and ``stiffness``: K contains them already.
    **matrices
        ``M``, ``K``, ``C``, ``nodes``, ``dofs``, ``faces`` …: those of
        :func:`faying.io.matrices.matrices_assembly`. Matrices may come constrained, without rows
        for what is held or depends on others, or with ``supports``. Interface nodes need their
        rows: one without counts as held.

    Examples
    --------
    >>> import faying as fy
    >>> import numpy as np
    >>> joint = fy.lap_joint(element_size=5.0)
    >>> mesh, free, (faces,) = joint.assembly.mesh, joint.dofs.free, joint.interfaces["joint"].faces
    >>> ids = mesh.node_ids
    >>> again = fy.from_matrices(
    ...     M=joint.M, K=joint.K, nodes=mesh.nodes, node_ids=ids,
    ...     dofs=np.column_stack([ids[free // 6], free % 6 + 1]),
    ...     faces={"below": ids[faces.minus], "above": ids[faces.plus[:, ::-1]]},
    ...     interfaces=[fy.InterfaceSpec(name="joint", minus="below", plus="above", penalty=4e5)],
    ... )
    >>> again.contact.n_points == joint.contact.n_points
    True
    """
    from faying.io.matrices import matrices_assembly

    return build_model(
        matrices_assembly(**matrices),
        interfaces=interfaces,
        bolts=bolts,
        boundaries=boundaries,
        damping=damping,
    )
