"""Steps: tighten the bolts, lock them, then one load set after the other."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from faying.io.abaqus.written_nodes import WrittenNodes, real_text
from faying.model.assembly import NodalLoads

Forces = dict[tuple[int, int], float]


def step_lines(
    nodes: WrittenNodes,
    loads: Mapping[str, NodalLoads],
    preloads: Mapping[int, float],
    locked: Sequence[int],
    contact: bool,
) -> Iterator[str]:
    """Yield the steps.

    Preloads are forces on pretension nodes; those that are locked are so in the step behind the
    first. If anything touches (``contact``), every step is one increment with tight tolerances.

    Notes
    -----
    Forces of a step stay until a later one changes them, so each step says all of them anew. The
    forces on pretension nodes stay too, where they do nothing once the bolts are locked.
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
