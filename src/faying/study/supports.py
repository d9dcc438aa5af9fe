"""[[support]]: what a study holds beside the supports of its source."""

from dataclasses import replace
from typing import get_args

import numpy as np

from faying._typing import Indices
from faying.exceptions import StudyError
from faying.model.assembly import Assembly, Support
from faying.study.errors import nearest
from faying.study.tables import DisplacementComponent, Study


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
    if section.node is not None:
        if section.node not in mesh.node_ids:
            _refuse(study, number, "node", f"the model has no node {section.node}; correct the id")
        return mesh.node_index(np.array([section.node]))
    name = section.set or ""
    if name in mesh.node_sets:
        return mesh.node_sets[name]
    if name in assembly.face_sets:
        return np.unique(assembly.face_sets[name].nodes)
    known = [*mesh.node_sets, *assembly.face_sets]
    _refuse(study, number, "set", f"there is no node set '{name}'; {nearest(name, known)}")
    return np.empty(0, dtype=np.int64)


def _refuse(study: Study, number: int, key: str, text: str) -> None:
    message = f"{study.source.place(('support', number, key))}: {text}"
    raise StudyError(message)
