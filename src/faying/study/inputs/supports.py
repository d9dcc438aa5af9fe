"""[[support]] and [[mass]]: what a study holds, and what fittings weigh."""

from dataclasses import replace
from typing import get_args

import numpy as np

from faying._typing import Indices
from faying.exceptions import ModelError, StudyError
from faying.model.assembly import Assembly, PointMass
from faying.model.supports import nodes_of_set, with_held_nodes
from faying.study.keys.model_tables import DisplacementComponent, MassSection, SupportSection
from faying.study.keys.positions import Location
from faying.study.keys.tables import Study


def with_study_supports(assembly: Assembly, study: Study) -> Assembly:
    """Return the assembly with the study's own supports.

    Raises
    ------
    StudyError
        If a node or a set does not exist.
    """
    components = get_args(DisplacementComponent)
    supports = [
        (
            named_nodes(assembly, study, ("support", number), section),
            [components.index(name) for name in section.components],
        )
        for number, section in enumerate(study.supports)
    ]
    return with_held_nodes(assembly, supports)


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


def named_nodes(
    assembly: Assembly, study: Study, location: Location, section: SupportSection | MassSection
) -> Indices:
    """Return the nodes (n,) of a table with a node or a set."""
    mesh, key = assembly.mesh, "set" if section.node is None else "node"
    try:
        if section.node is not None:
            return mesh.node_index(np.array([section.node]))
        return nodes_of_set(assembly, section.set or "")
    except ModelError as error:
        message = f"{study.source.place((*location, key))}: {error}"
        raise StudyError(message) from None
