"""Where a bolt is and which way it points, for tables and pictures."""

import numpy as np

from faying._typing import Matrix, Vector
from faying.model.assembly import Assembly, Beam
from faying.model.deck_bolt import bolt_axis_element
from faying.model.specs import BoltSpec


def bolt_ends(assembly: Assembly, spec: BoltSpec) -> Matrix | None:
    """Return the ends (2, 3) of what is tightened of a bolt; None for a spring.

    Of a cut through a shank of solids two points on its axis.
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
    unit: Vector = along / length * np.sign(along[np.abs(along).argmax()] or 1.0)
    return unit
