"""Models in one call: the built-in lap joint, decks, mesh files, matrices."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from faying.model.assembly import Material
from faying.model.build import build_model
from faying.model.lap_joint import lap_joint_assembly
from faying.model.model import Model
from faying.model.specs import BoltSpec, BoundarySpec, InterfaceSpec, Rayleigh
from faying.model.supports import with_supports

AUTO = (InterfaceSpec(name="joint"),)


def lap_joint(*, damping: Rayleigh | None = None, **parameters: Any) -> Model:
    """Build the seed's bolted cantilever, or a lap joint like it.

    Parameters
    ----------
    damping
        Rayleigh factors.
    **parameters
        Those of :func:`faying.model.lap_joint.lap_joint_assembly`.

    Examples
    --------
    >>> import faying as fy
    >>> model = fy.lap_joint(element_size=5.0)
    >>> list(model.interfaces), list(model.bolts), list(model.boundaries)
    (['joint'], ['bolt'], ['tip'])
    """
    joint = lap_joint_assembly(**parameters)
    return build_model(
        joint.assembly,
        interfaces=joint.interfaces,
        bolts=joint.bolts,
        boundaries=joint.boundaries,
        damping=damping,
    )


def read_nastran(
    path: str | Path,
    *,
    interfaces: Sequence[InterfaceSpec] = AUTO,
    bolts: Sequence[BoltSpec] = (),
    boundaries: Sequence[BoundarySpec] = (),
    damping: Rayleigh | None = None,
) -> Model:
    """Build a model from a Nastran bulk-data deck.

    Parameters
    ----------
    interfaces
        Where bodies touch; by default all coincident facets of different bodies.
    bolts
        Bolts, as beam elements of the deck or as generated beams.
    boundaries
        Where loads enter.

    Raises
    ------
    FormatError
        If the deck cannot be read; the message names file and line.
    ModelError
        If the deck and what is said about it do not fit together.
    """
    from faying.io.nastran.reader import read_deck

    return build_model(
        read_deck(path),
        interfaces=interfaces,
        bolts=bolts,
        boundaries=boundaries,
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
    """
    from faying.io.matrices import matrices_assembly

    return build_model(
        matrices_assembly(**matrices),
        interfaces=interfaces,
        bolts=bolts,
        boundaries=boundaries,
        damping=damping,
    )
