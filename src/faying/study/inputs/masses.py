"""[[mass]]: what sensors, shakers and other fittings weigh."""

from dataclasses import replace

from faying.model.assembly import Assembly, PointMass
from faying.study.inputs.supports import named_nodes
from faying.study.keys.tables import Study


def with_study_masses(assembly: Assembly, study: Study) -> Assembly:
    """Return the assembly with the study's masses, each shared evenly by the nodes it sits on.

    Raises
    ------
    StudyError
        If a node or a set does not exist.
    """
    sat_on = [
        (node, section.mass / len(nodes))
        for number, section in enumerate(study.masses)
        for nodes in [named_nodes(assembly, study, ("mass", number), section).tolist()]
        for node in nodes
    ]
    first = assembly.largest_id + 1
    added = tuple(
        PointMass(id=first + number, node=node, mass=mass)
        for number, (node, mass) in enumerate(sat_on)
    )
    return replace(assembly, masses=(*assembly.masses, *added))
