"""Bolts, contact and steps of a written deck.

A straight beam is exactly equivalent to six springs at its middle and two rigid arms to its
ends: EA/L, GJ/L and EI/L (twice), and 12 EI / ((1 + Φ) L³) in shear. The bending and shear springs
decouple because the moment of an end force vanishes at the middle for equal end rotations.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.contact.laws import normal_law
from faying.digits import SOLVED
from faying.exceptions import refuse
from faying.interface.interface import FacePairs
from faying.interface.pairing import find_interfaces
from faying.interface.penalty import automatic_penalty, with_friction
from faying.io.abaqus.written_nodes import Term, WrittenNodes, real_text
from faying.model.assembly import Assembly, Beam, NodalLoads
from faying.model.deck_bolt import CUT_STIFFNESS
from faying.model.description import JointDescription
from faying.model.elements import SOLIDS
from faying.model.elements.beam import beam_frames, beam_properties, local_stiffness
from faying.model.specs import GapRule, InterfaceSpec
from faying.model.surface import triangular

# Positions along the beam of its nodes: both sides of the cut, and the far side of the spring.
_DRAWN = (0.3, 0.4, 0.5)
CUT_OVER_BOLT = CUT_STIFFNESS * (_DRAWN[1] - _DRAWN[0])
"""Young's modulus of the beam element in a cut over that of its bolt: adds 1e-4 to the compliance.

CalculiX removes the element; Abaqus and faying keep it.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class WrittenBeam:
    """A beam as springs, rigid arms and, if it is tightened, a cut.

    Attributes
    ----------
    nodes
        New node ids and their coordinates [length].
    equations
        Terms that sum to zero.
    springs
        [(node id, dof), (node id, dof)] and stiffness of each spring; the first is the axial one.
    cut
        Both nodes of the cut, in the direction of the beam; None if it is not tightened.
    control
        The pretension node; 0 if it is not tightened.
    beam, across
        The beam and its first local axis, also used for the beam element in the cut.
    """

    nodes: list[tuple[int, Vector]]
    equations: list[list[Term]]
    springs: list[tuple[list[tuple[int, int]], float]]
    cut: tuple[int, int] | None
    control: int
    beam: Beam
    across: list[float]


def written_beam(
    assembly: Assembly, beam: Beam, nodes: WrittenNodes, first: int, *, tightened: bool
) -> WrittenBeam:
    """Return a beam as springs, with up to four nodes from the first free id on."""
    ends = assembly.mesh.nodes[list(beam.nodes)]
    axis = ends[1] - ends[0]
    frames, lengths = beam_frames([beam], axis[None])
    frame = frames[0]
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
    stiffness = _stiffness(beam, frame, lengths)
    springs = [([(free, along + 1), (far, along + 1)], stiffness[along])]
    springs += [([(first_arm, c + 1), (far, c + 1)], stiffness[c]) for c in range(3) if c != along]
    springs += [([nodes.place(6 * n + c) for n in beam.nodes], stiffness[c]) for c in range(3, 6)]
    if tightened:
        added += [(cut, places[1]), (first + 3, ends[0])]
        # Springs activate all directions of their nodes; the cut opens only along the axis.
        across = [c + 1 for c in range(3) if c != along]
        equations += [[(cut, dof, 1.0), (first_arm, dof, -1.0)] for dof in across]
    return WrittenBeam(
        nodes=added,
        equations=equations,
        springs=[spring for spring in springs if spring[1] > 0],
        cut=(first_arm, cut) if tightened else None,
        control=first + 3 if tightened else 0,
        beam=beam,
        across=frame[1].tolist(),
    )


def _along(beam: Beam, frame: Matrix) -> int:
    """Return the coordinate axis of a beam; refuse inclined beams and sections."""
    if (np.abs(frame).max(axis=1) < 1 - SOLVED).any():
        refuse(
            f"beam {beam.id} or its section is not along coordinate axes, as springs of "
            "an input deck must be; rotate the model, or export matrices instead"
        )
    return int(np.abs(frame[0]).argmax())


def _arm(nodes: WrittenNodes, arm: int, node: int, lever: Vector) -> list[list[Term]]:
    """Return the equations u_arm = u_node + θ × lever, one per direction."""
    turning = np.cross(np.eye(3), lever).T.tolist()
    equations = []
    for c in range(3):
        terms: list[Term] = [(arm, c + 1, 1.0), (*nodes.place(6 * node + c), -1.0)]
        for d, factor in enumerate(turning[c]):
            if factor != 0.0:
                terms.append((*nodes.place(6 * node + 3 + d), -factor))
        equations.append(terms)
    return equations


def _stiffness(beam: Beam, frame: Matrix, lengths: Vector) -> list[float]:
    """Return the stiffness of the six springs, by component in the basic frame."""
    (local,) = local_stiffness(beam_properties([beam], lengths))
    springs = (np.diag(local[:6, :6]) - np.diag(local[:6, 6:])) / 2
    basic = np.abs(frame).argmax(axis=1)
    result = np.empty(6)
    result[basic], result[3 + basic] = springs[:3], springs[3:]
    return [float(value) for value in result]


def contact_lines(description: JointDescription) -> Iterator[str]:
    """Yield surfaces, behaviour and contact pair of each interface; minus sides are slaves."""
    number = 0
    for spec in description.interfaces:
        if spec.meshes != "matching":
            refuse(f"interface '{spec.name}' is {spec.meshes}; only matching ones are written")
        for name, faces in find_interfaces(description.assembly, spec).items():
            number += 1
            for side in ("minus", "plus"):
                yield f"*SURFACE,NAME={side.upper()}{number},TYPE=ELEMENT"
                for entry in faces:
                    yield from _facets(description.assembly, getattr(entry, side))
            yield f"*SURFACE INTERACTION,NAME={_label(name)}"
            yield from _behaviour(spec, description.assembly, faces)
            yield f"*CONTACT PAIR,INTERACTION={_label(name)},TYPE=SURFACE TO SURFACE"
            yield f"MINUS{number},PLUS{number}"
            gap = _clearance(spec)
            if gap is not None:
                yield f"*CLEARANCE,SLAVE=MINUS{number},MASTER=PLUS{number},VALUE={real_text(gap)}"


def _clearance(spec: InterfaceSpec) -> float | None:
    """Return the initial gap that replaces the gap of the mesh, if any."""
    if spec.gap is None or spec.gap.value is not None:
        return None if spec.gap is None else spec.gap.value
    if replace(spec.gap, offset=0.0) != GapRule():
        refuse(
            f"interface '{spec.name}' closes gaps of its mesh at the start (ADJUST, INIPENE), "
            "which is not written; move its nodes together"
        )
    return spec.gap.offset or None


def _label(name: str) -> str:
    return "".join(c if c.isalnum() and c.isascii() else "_" for c in name)[:60]


def _behaviour(
    spec: InterfaceSpec, assembly: Assembly, faces: tuple[FacePairs, ...]
) -> Iterator[str]:
    if spec.closure is not None:
        refuse(
            f"interface '{spec.name}' has closure '{spec.closure.name}', which is not written; "
            "give it a penalty"
        )
    if spec.penalty == "hard":
        yield "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=HARD"
        slope = np.inf
    else:
        automatic = spec.penalty == "auto"
        slope = automatic_penalty(assembly, faces) if automatic else float(spec.penalty)
        yield from ("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", real_text(slope))
    law = with_friction(normal_law(slope), spec.friction, spec.tangential_penalty, assembly)
    if law.components > 1:
        stick = law.tangential_penalty
        numbers = [law.friction] if np.isinf(stick) else [law.friction, stick]
        yield from ("*FRICTION", ",".join(map(real_text, numbers)))


def _facets(assembly: Assembly, facets: Indices) -> Iterator[str]:
    """Yield element and face number of facets (n_facet, n_node), given by node indices."""
    n_corner = 3 if triangular(facets).all() else 4
    corner_sets = {tuple(row) for row in np.sort(facets[:, :n_corner], axis=1).tolist()}
    touched = np.zeros(len(assembly.mesh.nodes), dtype=bool)
    touched[facets] = True
    for block in assembly.mesh.blocks:
        for number, (face, local) in enumerate(SOLIDS[block.kind].faces, start=1):
            if face.n_corners == n_corner:
                nodes = block.nodes[:, list(local[:n_corner])]
                touching = np.flatnonzero(touched[nodes].all(axis=1))
                rows = np.sort(nodes[touching], axis=1).tolist()
                for element, row in zip(block.ids[touching].tolist(), rows, strict=True):
                    if tuple(row) in corner_sets:
                        yield f"{element},S{number}"


Forces = dict[tuple[int, int], float]


def step_lines(
    nodes: WrittenNodes,
    loads: Mapping[str, NodalLoads],
    preloads: Mapping[int, float],
    locked: Sequence[int],
    contact: bool,
) -> Iterator[str]:
    """Yield the lines of the steps.

    Preloads are forces on pretension nodes; ``locked`` ones are held in the step after the
    first. With ``contact`` every step is one increment with tight tolerances.

    Notes
    -----
    Forces of a step remain until a later one changes them, so each step states all of them. The
    forces on pretension nodes remain too, without effect once the bolts are locked.
    """
    if preloads or not loads:
        yield from ("** preload", *_opening(contact))
        yield from _cload({(node, 1): force for node, force in preloads.items()})
        yield from _closing(contact)
    cases = {name: _forces(nodes, case) for name, case in loads.items()}
    places = dict.fromkeys(dof for forces in cases.values() for dof in forces)
    for number, (name, forces) in enumerate(cases.items()):
        yield from (f"** {' '.join(name.split())[:60]}", *_opening(contact))
        if locked and number == 0:
            yield "*BOUNDARY,FIXED"
            yield from (f"{node},1,1" for node in locked)
        yield from _cload({dof: forces.get(dof, 0.0) for dof in places})
        yield from _closing(contact)


def _opening(contact: bool) -> Iterator[str]:
    yield "*STEP,INC=100"
    if not contact:
        yield "*STATIC"
        return
    # More increments would follow the displaced geometry.
    yield from ("*STATIC,DIRECT", "1.,1.")
    yield from ("*CONTROLS,PARAMETERS=FIELD", "1e-8,1e-8,,,1e-8")
    # Contact may take more iterations than CalculiX usually allows.
    yield from ("*CONTROLS,PARAMETERS=TIME INCREMENTATION", "8,20,9,60,20,4,,20,,")


def _closing(contact: bool) -> Iterator[str]:
    yield from ("*NODE FILE", "U")
    if contact:
        yield from ("*CONTACT FILE", "CDIS,CSTR")
    yield "*END STEP"


def _cload(forces: Forces) -> Iterator[str]:
    if forces:
        yield "*CLOAD"
        yield from (f"{node},{dof},{real_text(value)}" for (node, dof), value in forces.items())


def _forces(nodes: WrittenNodes, case: NodalLoads) -> Forces:
    forces: Forces = {}
    for node, row in zip(case.nodes.tolist(), case.forces, strict=True):
        for component in np.flatnonzero(row).tolist():
            dof = nodes.place(6 * node + component)
            forces[dof] = forces.get(dof, 0.0) + float(row[component])
    return forces
