"""[[support]]: what a study holds beside the supports of its source."""

from typing import get_args

import numpy as np

from faying._typing import Indices
from faying.exceptions import ModelError, StudyError
from faying.model.assembly import Assembly
from faying.model.supports import nodes_of_set, with_held_nodes
from faying.study.model_tables import DisplacementComponent
from faying.study.tables import Study


def with_study_supports(assembly: Assembly, study: Study) -> Assembly:
    """Return the assembly with the study's own supports.

    Raises
    ------
    StudyError
        If a node or a set does not exist.
    """
    components = get_args(DisplacementComponent)
    held = [
        (_nodes(assembly, study, place), [components.index(name) for name in section.components])
        for place, section in enumerate(study.supports)
    ]
    return with_held_nodes(assembly, held)


def _nodes(assembly: Assembly, study: Study, number: int) -> Indices:
    section, mesh = study.supports[number], assembly.mesh
    key = "set" if section.node is None else "node"
    try:
        if section.node is not None:
            return mesh.node_index(np.array([section.node]))
        return nodes_of_set(assembly, section.set or "")
    except ModelError as error:
        message = f"{study.source.place(('support', number, key))}: {error}"
        raise StudyError(message) from None
