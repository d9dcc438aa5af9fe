"""BGSET, IGLUE: surfaces that neither open nor slide, as equations."""

from collections.abc import Sequence
from dataclasses import replace

from faying.io.nastran.contact_pairs import Pair, glue_distance
from faying.io.tied_surfaces import moving_together
from faying.model.assembly import Assembly
from faying.model.specs import InterfaceSpec


def with_glue(assembly: Assembly, pairs: Sequence[Pair], ignored: dict[str, None]) -> Assembly:
    """Add the equations of pairs that are glued.

    Parameters
    ----------
    assembly
        With the regions of the pairs as sets.

    Raises
    ------
    ModelError
        If two regions see nothing of each other within the search distance.
    """
    if not pairs:
        return assembly
    specs = [
        InterfaceSpec(
            name=pair.name,
            minus=pair.minus.name,
            plus=pair.plus.name,
            meshes="non-matching",
            search_distance=glue_distance(pair, assembly.mesh),
        )
        for pair in pairs
    ]
    equations, partial = moving_together(assembly, specs)
    for name, share in partial:
        ignored[f"{name}: {share:.0%} of the smaller surface is glued"] = None
    ignored[
        "glued surfaces move together where they see each other within the search distance, node "
        "by node where meshes match and else in the mean (mortar); Nastran's glue is a stiff "
        "penalty or holds node by node"
    ] = None
    return replace(assembly, equations=(*assembly.equations, *equations))
