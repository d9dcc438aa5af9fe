"""Boundary: the named interface points where loads enter and where a superelement is attached."""

from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices, Vector, frozen
from faying.exceptions import ModelError

DISPLACEMENT_NAMES = ("ux", "uy", "uz", "rx", "ry", "rz")
FORCE_NAMES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")


@dataclass(frozen=True, eq=False, kw_only=True)
class Boundary:
    """Degrees of freedom of one boundary.

    Attributes
    ----------
    nodes : (n,)
        Node id of each boundary degree of freedom.
    components : (n,)
        Its component 0..5.
    dofs : (n,)
        Its index among the degrees of freedom of the system.
    """

    name: str
    nodes: Indices
    components: Indices
    dofs: Indices

    def __post_init__(self) -> None:
        for name in ("nodes", "components", "dofs"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.int64))

    def pattern(self, force: str) -> Vector:
        """Distribute a unit force or moment evenly over the nodes of the boundary.

        Parameters
        ----------
        force
            One of Fx, Fy, Fz, Mx, My, Mz.

        Returns
        -------
        ndarray (n,)
            Unit total on the boundary's degrees of freedom.

        Raises
        ------
        ModelError
            If the boundary has no such component.
        """
        present = [FORCE_NAMES[c] for c in sorted(set(self.components.tolist()))]
        if force not in present:
            message = f"boundary '{self.name}' takes no load '{force}'; it has {', '.join(present)}"
            raise ModelError(message)
        chosen = self.components == FORCE_NAMES.index(force)
        unit: Vector = chosen / chosen.sum()
        return unit

    def with_dofs(self, dofs: Indices) -> "Boundary":
        """Return the same boundary in a system with other indices."""
        return replace(self, dofs=dofs)
