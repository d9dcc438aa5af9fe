"""Where the models of studies come from: the built-in lap joint, decks, mesh files, matrices.

Each is an entry of :data:`SOURCES`; the functions for Python are in :mod:`faying.readers`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from faying.io.deck_lines import ABAQUS, NASTRAN
from faying.joint.build import build_model
from faying.joint.lap_joint import STEEL, lap_joint_assembly
from faying.joint.model import Model
from faying.model.assembly import Material
from faying.model.description import JointDescription
from faying.model.material import MaterialWishes, overridden
from faying.model.specs import Rayleigh


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
