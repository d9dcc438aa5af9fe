"""What a source says of a joint: the assembly, where it touches, its bolts and their forces."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from faying.exceptions import refuse
from faying.model.assembly import Assembly
from faying.model.specs import BoltSpec, BoundarySpec, GapRule, InterfaceSpec


@dataclass(frozen=True, eq=False, kw_only=True)
class JointDescription:
    """An assembly and what belongs to it.

    Attributes
    ----------
    interfaces, bolts, boundaries
        Those the source itself defines; a study overrides them by name and adds its own.
    preloads : [force]
        Bolt name to the final force the source asks for.
    initial_forces : [force]
        Bolt name to the force it is locked at, of bolts that the source gives a length.
    unlocked
        Bolts of ``preloads`` that the source never locks: they pull with that force under any load.
    initial_gaps : [length]
        Interface name to an offset added to the gap of the geometry.
    gap_rules
        Interface name to what the source makes of the gap of the geometry.
    selected_load
        Which of the assembly's loads the source applies, in the subcase or step that counts.
    has_joined_faces
        Whether solids were cut at bolts or tied, so that faces that touch may be joined already.
    """

    assembly: Assembly
    interfaces: tuple[InterfaceSpec, ...] = ()
    bolts: tuple[BoltSpec, ...] = ()
    boundaries: tuple[BoundarySpec, ...] = ()
    preloads: Mapping[str, float] = field(default_factory=dict)
    initial_forces: Mapping[str, float] = field(default_factory=dict)
    unlocked: frozenset[str] = frozenset()
    initial_gaps: Mapping[str, float] = field(default_factory=dict)
    gap_rules: Mapping[str, GapRule] = field(default_factory=dict)
    selected_load: str | None = None
    has_joined_faces: bool = False


def check_surfaces(described: JointDescription, path: Path) -> None:
    """Refuse a deck in which nothing has a surface that could touch another."""
    assembly = described.assembly
    if not assembly.mesh.n_elements and not assembly.shells and assembly.matrices is None:
        refuse(
            f"{path}: the deck has no solids, no shells and no matrices ({len(assembly.beams)} "
            f"beams, {len(assembly.mesh.nodes)} nodes), so nothing in it can touch; give the deck "
            "of the parts of the joint"
        )
