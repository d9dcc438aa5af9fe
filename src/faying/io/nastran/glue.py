"""BGSET, IGLUE: surfaces that neither open nor slide, as equations."""

from collections.abc import Sequence
from dataclasses import replace

from faying.io.nastran.contact_pairs import Pair, glue_distance
from faying.io.tied_surfaces import MOST_OF_IT, tied_equations
from faying.model.assembly import Assembly, Equation
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
    first = max((equation.id for equation in assembly.equations), default=0) + 1
    equations: list[Equation] = []
    for pair in pairs:
        spec = InterfaceSpec(
            name=pair.name,
            minus=pair.minus.name,
            plus=pair.plus.name,
            meshes="non-matching",
            search_distance=glue_distance(pair, assembly.mesh),
        )
        found, share = tied_equations(assembly, spec, first + len(equations))
        if share < MOST_OF_IT:
            ignored[f"{pair.name}: {share:.0%} of the smaller surface is glued"] = None
        equations += found
    ignored[
        "glued surfaces move together where they see each other within the search distance, node "
        "by node where meshes match and else in the mean (mortar); Nastran's glue is a stiff "
        "penalty or holds node by node"
    ] = None
    return replace(assembly, equations=(*assembly.equations, *equations))
