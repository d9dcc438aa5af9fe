"""[[support]]: what a study holds beside the supports of its source."""

from dataclasses import replace
from typing import get_args

import numpy as np

from faying._typing import Indices
from faying.exceptions import ModelError, StudyError
from faying.model.assembly import Assembly, Support
from faying.model.supports import nodes_of_set
from faying.study.model_tables import DisplacementComponent
from faying.study.tables import Study


def with_study_supports(assembly: Assembly, study: Study) -> Assembly:
    """Return the assembly with the study's own supports.

    Raises
    ------
    StudyError
        If a node or a node set does not exist.
    """
    number = max((support.id for support in assembly.supports), default=0)
    components = get_args(DisplacementComponent)
    own = tuple(
        Support(
            id=number + 1 + place,
            nodes=_nodes(assembly, study, place),
            components=tuple(sorted({components.index(name) for name in section.components})),
        )
        for place, section in enumerate(study.supports)
    )
    return replace(assembly, supports=(*assembly.supports, *own))


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
