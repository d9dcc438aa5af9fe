"""[[support]]: what a study holds beside the supports of its source."""

from typing import get_args

import numpy as np

from faying._typing import Indices
from faying.exceptions import ModelError, StudyError
from faying.model.assembly import Assembly
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
    held = [
        (
            named_nodes(assembly, study, ("support", number), section),
            [components.index(name) for name in section.components],
        )
        for number, section in enumerate(study.supports)
    ]
    return with_held_nodes(assembly, held)


def named_nodes(
    assembly: Assembly, study: Study, place: Location, section: SupportSection | MassSection
) -> Indices:
    """Return the nodes (n,) of a table with a node or a set.

    Raises
    ------
    StudyError
        If it does not exist.
    """
    mesh, key = assembly.mesh, "set" if section.node is None else "node"
    try:
        if section.node is not None:
            return mesh.node_index(np.array([section.node]))
        return nodes_of_set(assembly, section.set or "")
    except ModelError as error:
        message = f"{study.source.place((*place, key))}: {error}"
        raise StudyError(message) from None
