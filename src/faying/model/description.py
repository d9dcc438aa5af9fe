"""The description of a joint by its source: assembly, interfaces, bolts and their forces."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from faying.exceptions import refuse
from faying.model.assembly import Assembly
from faying.model.specs import BoltSpec, BoundarySpec, InterfaceSpec


@dataclass(frozen=True, eq=False, kw_only=True)
class JointDescription:
    """An assembly with its interfaces, bolts, boundaries and forces.

    Attributes
    ----------
    interfaces, bolts, boundaries
        Those of the source; a study overrides them by name and adds others.
    preloads : [force]
        Bolt name to the final force in the source.
    initial_forces : [force]
        Bolt name to the initial force, for bolts with a given length in the source.
    unlocked
        Bolts of ``preloads`` that the source never locks: their force is constant under any load.
    selected_load
        Load of the assembly that the source applies, in the selected subcase or step.
    has_joined_faces
        Whether solids were cut at bolts or tied, so that touching faces may be joined already.
    """

    assembly: Assembly
    interfaces: tuple[InterfaceSpec, ...] = ()
    bolts: tuple[BoltSpec, ...] = ()
    boundaries: tuple[BoundarySpec, ...] = ()
    preloads: Mapping[str, float] = field(default_factory=dict)
    initial_forces: Mapping[str, float] = field(default_factory=dict)
    unlocked: frozenset[str] = frozenset()
    selected_load: str | None = None
    has_joined_faces: bool = False


def check_surfaces(described: JointDescription, path: Path) -> None:
    """Refuse a deck without surfaces for contact."""
    assembly = described.assembly
    if not assembly.mesh.n_elements and not assembly.shells and assembly.matrices is None:
        refuse(
            f"{path}: the deck has no solids, no shells and no matrices ({len(assembly.beams)} "
            f"beams, {len(assembly.mesh.nodes)} nodes), so nothing in it can touch; give the deck "
            "of the parts of the joint"
        )
