"""Where models come from: the built-in lap joint, decks, mesh files, matrices.

One function for Python and one entry of :data:`SOURCES` for studies each.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from faying.exceptions import ModelError
from faying.io.deck_lines import ABAQUS, NASTRAN
from faying.joint.build import build_model
from faying.joint.lap_joint import STEEL, lap_joint_assembly
from faying.joint.model import Model
from faying.model.assembly import Material
from faying.model.deck_bolt import with_unlocked_bolts
from faying.model.description import JointDescription
from faying.model.material import MaterialWishes, overridden
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
        Those of :func:`faying.joint.lap_joint.lap_joint_assembly`.

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
    from faying.interface.gap_field import with_gap_offset, with_gap_rule

    sides = described.interfaces or AUTO if interfaces is None else interfaces
    if sides is AUTO and described.has_joined_faces:
        message = "the deck has no contact pairs, and faces found automatically would be those "
        raise ModelError(message + "of ties and of cuts through bolts too; name the sides")
    free = described.unlocked if bolts is None else ()
    model = build_model(
        with_unlocked_bolts(described.assembly, [b for b in described.bolts if b.name in free]),
        interfaces=sides,
        bolts=described.bolts if bolts is None else bolts,
        boundaries=[*described.boundaries, *boundaries],
        damping=damping,
    )
    mesh = model.assembly.mesh
    model = model.with_interfaces(
        {
            name: with_gap_rule(model.interfaces[name], mesh.nodes, mesh.node_ids, rule)
            for name, rule in described.gap_rules.items()
            if name in model.interfaces
        }
    )
    gaps = {n: gap for n, gap in described.initial_gaps.items() if n in model.interfaces}
    return model.with_interfaces(
        {n: with_gap_offset(model.interfaces[n], np.asarray(gap)) for n, gap in gaps.items()}
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


@dataclass(frozen=True, eq=False, kw_only=True)
class SourceKeys:
    """What a study says to its source: keys of [model], and materials by name."""

    file: Path
    files: Mapping[str, Path | None] = field(default_factory=dict)
    subcase: int | None = None
    ignore: tuple[str, ...] = ()
    element: str = "incompatible"
    separate: tuple[str, ...] = ()
    lap_joint: Mapping[str, Any] = field(default_factory=dict)
    materials: Mapping[str, MaterialWishes] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Source:
    """A source that studies name.

    Attributes
    ----------
    name
        As in ``source = "nastran"``.
    key
        Key of [model] that says what to read; sources with ``needs_key`` refuse to go without.
    read
        From the keys to what is there.
    is_deck
        Whether it has subcases, tightens bolts, and has materials and bricks of its own that a
        study overrides.
    has_joint, has_boundaries
        Whether interfaces and bolts, and boundaries, come with it.
    has_elements
        Whether there are elements, hence materials and bolts that are elements.
    is_mesh
        Whether materials must be given whole, and groups may be separated.
    suffixes
        Of files that are read by it without a study.
    remedy
        What to do about a bolt that comes with it and is not as wished.
    """

    name: str
    key: str
    read: Callable[[SourceKeys], JointDescription]
    needs_key: bool = True
    is_deck: bool = False
    has_joint: bool = False
    has_boundaries: bool = False
    has_elements: bool = True
    is_mesh: bool = False
    suffixes: tuple[str, ...] = ()
    remedy: str = "remove the key, or change the deck"


def _lap_joint(keys: SourceKeys) -> JointDescription:
    steel = keys.materials.get(STEEL.name)
    material = STEEL if steel is None else overridden(STEEL, steel)
    keywords: Mapping[str, Any] = {"element": keys.element, **keys.lap_joint}
    return lap_joint_assembly(material=material, **keywords)


def _nastran(keys: SourceKeys) -> JointDescription:
    from faying.io.nastran import read_joint

    return read_joint(keys.file, subcase=keys.subcase, ignore=keys.ignore)


def _abaqus(keys: SourceKeys) -> JointDescription:
    from faying.io.abaqus import read_joint

    return read_joint(keys.file, step=keys.subcase, ignore=keys.ignore)


def _mesh(keys: SourceKeys) -> JointDescription:
    from faying.io.mesh_files import read_mesh_file

    materials = {name: _whole(name, wishes) for name, wishes in keys.materials.items()}
    assembly = read_mesh_file(keys.file, materials=materials, separate=keys.separate)
    return JointDescription(assembly=replace(assembly, element=keys.element))


def _whole(name: str, wishes: MaterialWishes) -> Material:
    """Return a material of a study whose source brings none; that all is given was checked."""
    return Material(
        name=name,
        youngs_modulus=wishes.E or 0.0,
        poissons_ratio=wishes.nu or 0.0,
        density=wishes.rho or 0.0,
        expansion=wishes.alpha,
    )


def _matrices(keys: SourceKeys) -> JointDescription:
    from faying.io.matrices import read_matrices

    files: Mapping[str, Any] = keys.files
    return JointDescription(assembly=read_matrices(**files))


_deck = partial(Source, key="file", is_deck=True, has_joint=True)

SOURCES: Mapping[str, Source] = MappingProxyType(
    {
        source.name: source
        for source in (
            Source(
                name="lap-joint",
                key="lap_joint",
                read=_lap_joint,
                needs_key=False,
                has_joint=True,
                has_boundaries=True,
                remedy="give measures in [model.lap_joint] (bolt_diameter, washer_radius, ...)",
            ),
            _deck(name="nastran", read=_nastran, suffixes=(*NASTRAN, ".dat")),
            _deck(name="abaqus", read=_abaqus, suffixes=ABAQUS),
            Source(name="mesh", key="file", read=_mesh, is_mesh=True),
            Source(name="matrices", key="files", read=_matrices, has_elements=False),
        )
    }
)
"""Name to source."""
