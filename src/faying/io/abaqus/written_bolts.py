"""Beams as springs: CalculiX turns its own beam elements into bricks of another stiffness.

A straight beam is, to the last digit, six springs between its middle and two rigid arms to its
ends: EA/L, GJ/L and EI/L (twice), and 12 EI / ((1 + Φ) L³) in shear. The bending and shear springs
decouple because the moment of an end force vanishes half-way for equal end rotations.
"""

from dataclasses import dataclass

import numpy as np

from faying._typing import Vector
from faying.digits import SOLVED
from faying.exceptions import FormatError
from faying.io.abaqus.written_nodes import Term, WrittenNodes
from faying.model.assembly import Assembly, Beam
from faying.model.elements.beam import beam_frames

# Where along the beam its nodes are drawn: both sides of the cut, and the far side of the spring.
_DRAWN = (0.3, 0.4, 0.5)
# Axial stiffness of the beam element in a cut over that of the bolt: adds 1e-4 to its compliance.
_STIFF = 1e4


@dataclass(frozen=True, eq=False, kw_only=True)
class WrittenBeam:
    """A beam as springs, rigid arms and, if it is tightened, a cut.

    Attributes
    ----------
    nodes
        New node ids and their places [length].
    equations
        Terms that sum to zero.
    springs
        ((node id, dof), (node id, dof), stiffness) each; the first is the axial one.
    cut
        The two nodes of the cut, in the direction of the beam; None if it is not tightened.
    control
        The pretension node; 0 if it is not tightened.
    radius, across, youngs_modulus, poissons_ratio
        Of the beam element in the cut (``across`` is its first local axis). CalculiX takes it out;
        Abaqus and faying keep it, as stiff as makes no difference.
    """

    nodes: list[tuple[int, Vector]]
    equations: list[list[Term]]
    springs: list[tuple[tuple[int, int], tuple[int, int], float]]
    cut: tuple[int, int] | None
    control: int
    radius: float
    across: list[float]
    youngs_modulus: float
    poissons_ratio: float


def written_beam(
    assembly: Assembly, beam: Beam, nodes: WrittenNodes, first: int, *, tightened: bool
) -> WrittenBeam:
    """Write a beam as springs, with up to four nodes from the first free id on."""
    ends = assembly.mesh.nodes[list(beam.nodes)]
    axis = ends[1] - ends[0]
    frames, lengths = beam_frames([beam], axis[None])
    frame, length = frames[0], float(lengths[0])
    along = _along(beam, frame)
    first_arm, far, cut = first, first + 1, first + 2
    places = [ends[0] + part * axis for part in _DRAWN]
    added = [(first_arm, places[0]), (far, places[2])]
    equations = [
        terms
        for arm, node, point in ((first_arm, beam.nodes[0], ends[0]), (far, beam.nodes[1], ends[1]))
        for terms in _arm(nodes, arm, node, ends.mean(axis=0) - point)
    ]
    free = cut if tightened else first_arm
    stiffness = _stiffness(beam, frame, length)
    springs = [((free, along + 1), (far, along + 1), stiffness[along])]
    springs += [((first_arm, c + 1), (far, c + 1), stiffness[c]) for c in range(3) if c != along]
    for c in range(3, 6):
        first_end, second_end = (nodes.place(6 * node + c) for node in beam.nodes)
        springs.append((first_end, second_end, stiffness[c]))
    if tightened:
        added += [(cut, places[1]), (first + 3, ends[0])]
        # Springs activate all directions of their nodes; the cut opens along the axis only.
        across = [c + 1 for c in range(3) if c != along]
        equations += [[(cut, dof, 1.0), (first_arm, dof, -1.0)] for dof in across]
    return WrittenBeam(
        nodes=added,
        equations=equations,
        springs=[spring for spring in springs if spring[2] > 0],
        cut=(first_arm, cut) if tightened else None,
        control=first + 3 if tightened else 0,
        radius=float(np.sqrt(beam.section.area / np.pi)),
        across=[float(value) for value in frame[1]],
        youngs_modulus=_STIFF * (_DRAWN[1] - _DRAWN[0]) * beam.material.youngs_modulus,
        poissons_ratio=beam.material.poissons_ratio,
    )


def _along(beam: Beam, frame: np.typing.NDArray[np.float64]) -> int:
    """Return the coordinate axis a beam and its section lie along."""
    if (np.abs(frame).max(axis=1) < 1 - SOLVED).any():
        message = (
            f"beam {beam.id} or its section is not along coordinate axes, along which springs of "
            "an input deck act; turn the model, or export matrices instead"
        )
        raise FormatError(message)
    return int(np.abs(frame[0]).argmax())


def _arm(nodes: WrittenNodes, arm: int, node: int, lever: Vector) -> list[list[Term]]:
    """u_arm = u_node + θ × lever, one equation per direction."""
    x, y, z = lever.tolist()
    cross = ((0.0, z, -y), (-z, 0.0, x), (y, -x, 0.0))
    equations = []
    for c in range(3):
        terms: list[Term] = [(arm, c + 1, 1.0), (*nodes.place(6 * node + c), -1.0)]
        for d, factor in enumerate(cross[c]):
            if factor != 0.0:
                terms.append((*nodes.place(6 * node + 3 + d), -factor))
        equations.append(terms)
    return equations


def _stiffness(beam: Beam, frame: np.typing.NDArray[np.float64], length: float) -> list[float]:
    """Stiffness of the six springs, by component in the basic frame."""
    section, E, G = beam.section, beam.material.youngs_modulus, beam.material.shear_modulus
    bending = E * np.array([0.0, section.inertia_z, section.inertia_y])
    factors = np.array([np.inf, section.shear_factor_y, section.shear_factor_z])
    phi = 12 * bending / (factors * section.area * G * length**2)
    local = np.empty(6)
    local[:3] = 12 * bending / ((1 + phi) * length**3)
    local[0] = E * section.area / length
    # Deflection in local y bends about local z.
    local[3:] = G * section.torsion / length, bending[2] / length, bending[1] / length
    basic = np.abs(frame).argmax(axis=1)
    result = np.empty(6)
    result[basic], result[3 + basic] = local[:3], local[3:]
    return [float(value) for value in result]
