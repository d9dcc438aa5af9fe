"""Interfaces as surfaces and contact pairs."""

from collections.abc import Iterator

import numpy as np

from faying._typing import Indices
from faying.contact.laws import Coulomb, normal_law
from faying.exceptions import FormatError
from faying.interface.friction import with_friction
from faying.interface.interface import FacePairs
from faying.interface.pairing import find_interfaces
from faying.interface.penalty import automatic_penalty
from faying.io.abaqus.written_nodes import real_text
from faying.model.assembly import Assembly
from faying.model.description import JointDescription
from faying.model.elements import SOLIDS
from faying.model.specs import InterfaceSpec
from faying.model.surface import triangular


def contact_lines(description: JointDescription) -> Iterator[str]:
    """Yield surfaces, behaviour and contact pair of each interface; minus sides are slaves."""
    number = 0
    for spec in description.interfaces:
        if spec.meshes != "matching":
            message = f"interface '{spec.name}' is {spec.meshes}; only matching ones are written"
            raise FormatError(message)
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
            gap = _clearance(description, name)
            if gap is not None:
                yield f"*CLEARANCE,SLAVE=MINUS{number},MASTER=PLUS{number},VALUE={real_text(gap)}"


def _clearance(description: JointDescription, name: str) -> float | None:
    """Return the gap that replaces that of the mesh, if any."""
    rule = description.gap_rules.get(name)
    if rule is None:
        return description.initial_gaps.get(name) or None
    if rule.value is None:
        message = (
            f"interface '{name}' starts with gaps of its mesh closed (ADJUST, INIPENE), which is "
            "not written; move its nodes together"
        )
        raise FormatError(message)
    return rule.value


def _label(name: str) -> str:
    return "".join(c if c.isalnum() and c.isascii() else "_" for c in name)[:60]


def _behaviour(
    spec: InterfaceSpec, assembly: Assembly, faces: tuple[FacePairs, ...]
) -> Iterator[str]:
    if spec.closure is not None:
        message = (
            f"interface '{spec.name}' has closure '{spec.closure.name}', which is not written; "
            "give it a penalty"
        )
        raise FormatError(message)
    if spec.penalty == "hard":
        yield "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=HARD"
        slope = np.inf
    else:
        automatic = spec.penalty == "auto"
        slope = automatic_penalty(assembly, faces) if automatic else float(spec.penalty)
        yield from ("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", real_text(slope))
    law = with_friction(normal_law(slope), spec.friction, spec.tangential_penalty, assembly)
    if isinstance(law, Coulomb):
        stick = law.tangential_penalty
        numbers = [law.friction] if np.isinf(stick) else [law.friction, stick]
        yield from ("*FRICTION", ",".join(map(real_text, numbers)))


def _facets(assembly: Assembly, facets: Indices) -> Iterator[str]:
    """Element and face number of facets (n_facet, n_node), given by node indices."""
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
