"""The direction in which bolts pull the faces that they clamp: together, along, or apart."""

from collections.abc import Iterator, Sequence

import numpy as np

from faying.joint.bolt_surroundings import nearest_bolts, told_apart
from faying.joint.model import Model
from faying.model.contained_bolt import elongation_factors
from faying.model.deck_bolt import bolt_direction
from faying.model.rigid_motion import rigid_parts
from faying.model.specs import BoltSpec

AS_MUCH = np.sqrt(0.5)
"""Cosine of the angle at which a bolt's pull along faces equals that onto them."""


def misdirected(model: Model, specs: Sequence[BoltSpec]) -> Iterator[str]:
    """Yield a message for each bolt that opens its faces, or pulls along all faces near it.

    The positions of head and nut are known for bolts in given matrices, if bolts alone join the
    parts that they hold; all others are tightened from end to end.
    """
    mesh, bolts = model.assembly.mesh, model.bolts
    if not told_apart(bolts):
        return
    cuts = {
        spec.name: mesh.node_index(np.array(spec.nodes)) for spec in specs if spec.nodes is not None
    }
    parts = rigid_parts(model.assembly, cuts=list(cuts.values()))
    for spec in specs:
        squarest, closing, names = 0.0, 0.0, list[str]()
        along, number = bolt_direction(model.assembly, spec), list(bolts).index(spec.name)
        head, nut = cuts.get(spec.name, (0, 0))
        if spec.name in cuts:
            row = elongation_factors(model.assembly, spec).toarray().ravel()
            along = row[6 * head : 6 * head + 3]
        for name, interface in model.interfaces.items():
            nearest = nearest_bolts(mesh.nodes[interface.pairs[:, 0]], bolts) == number
            cosines = interface.pair_normals[nearest] @ along
            sides = parts[interface.pairs[nearest]]
            # The part at the head moves against the direction, the part at the nut along it.
            minus, plus = ((sides == parts[head]).astype(int) - (sides == parts[nut])).T
            closing += float(cosines @ (plus - minus))
            squarest = max(squarest, float(np.abs(cosines).max(initial=0.0)))
            names += [f"'{name}'"] if nearest.any() else []
        if closing < 0:
            yield (
                f"bolt '{spec.name}' pulls {' and '.join(names)} open: its direction "
                f"{tuple(along.round(3).tolist())} goes from its head to its nut, as the parts lie "
                "that they hold; turn it round, or exchange nodes = [head, nut]"
            )
        elif names and squarest < AS_MUCH:
            angle = np.degrees(np.arccos(squarest))
            yield (
                f"bolt '{spec.name}' lies {angle:.0f}° or more from the normals of the faces "
                f"nearest to it, those of {' and '.join(names)}, and pulls more along them than "
                "onto them; check its axis"
            )
