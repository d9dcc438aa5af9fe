"""What of an assembly holds nodes together, beside solids and shells."""

from typing import Any

import numpy as np

from faying._typing import Indices
from faying.model.assembly import Assembly

LINKS = {
    "beams": "beam",
    "bushes": "bush",
    "springs": "spring",
    "masses": "point mass",
    "scalar_masses": "scalar mass",
    "rigid_couplings": "rigid coupling",
    "average_couplings": "average coupling",
    "equations": "equation",
}
"""Families of an assembly whose members hold nodes together, and what one is called."""


def joined_nodes(assembly: Assembly) -> list[tuple[Any, Indices]]:
    """Return what joins several nodes, and these: masses at one of them join nothing."""
    return [
        (member, linked_nodes(family, member))
        for family in LINKS
        if not family.endswith("masses")
        for member in getattr(assembly, family)
    ]


def linked_nodes(family: str, member: Any) -> Indices:
    """Return the nodes that a member of a family holds."""
    if family == "masses":
        return np.array([member.node], dtype=np.int64)
    if family in ("springs", "scalar_masses"):
        return np.array([node for node, _ in member.ends], dtype=np.int64)
    if family == "equations":
        return np.array([node for node, _, _ in member.terms], dtype=np.int64)
    own = [member.reference] if family.endswith("couplings") else []
    return np.array([*member.nodes, *own], dtype=np.int64)
