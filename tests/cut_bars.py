"""Input decks of bars of unit cubes that a pretension section cuts."""

from itertools import permutations

import numpy as np

KEYWORDS = """\
*MATERIAL, NAME=S
*ELASTIC
210000., {nu}
*DENSITY
7.85E-9
*SOLID SECTION, ELSET=ALL, MATERIAL=S
*PRE-TENSION SECTION, SURFACE=CUT, NODE=99
*BOUNDARY
FOOT, 1, 3
*STEP
*STATIC
*CLOAD
99, 1, 100.
*END STEP
"""


def bar(kind, layers, cut, *, nu=0.0, **sets):
    """Return the deck of a bar, each cube one brick or the six tetrahedra around its diagonal.

    It is cut at a height. Sets have the nodes at some heights; FOOT is held.
    """
    corners = [(x, y, z) for z in range(layers + 1) for y in range(2) for x in range(2)]
    number = {corner: i + 1 for i, corner in enumerate(corners)}
    elements = []
    for base in range(layers):
        if kind == "C3D8":
            ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
            elements.append([(x, y, base + z) for z in range(2) for x, y in ring])
            continue
        for order in permutations(range(3)):
            steps = np.vstack([np.zeros(3, int), np.cumsum(np.eye(3, dtype=int)[list(order)], 0)])
            if np.linalg.det(np.diff(steps, axis=0)) < 0:
                steps[[1, 2]] = steps[[2, 1]]
            elements.append([tuple(step) for step in steps + np.array([0, 0, base])])
    faces = {"C3D8": {"S2": range(4, 8)}, "C3D4": dict(zip(
        ("S1", "S2", "S3", "S4"), ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)), strict=True
    ))}  # fmt: skip
    lines = [
        "*NODE",
        *(f"{number[c]}, {c[0]}, {c[1]}, {c[2]}" for c in corners),
        f"99, 0.5, 0.5, {cut}.",
        f"*ELEMENT, TYPE={kind}, ELSET=ALL",
        *(f"{i + 1}, {', '.join(str(number[c]) for c in e)}" for i, e in enumerate(elements)),
        "*SURFACE, NAME=CUT",
        *(
            f"{i + 1}, {label}"
            for i, e in enumerate(elements)
            for label, local in faces[kind].items()
            if all(e[n][2] == cut for n in local) and all(c[2] <= cut for c in e)
        ),
    ]
    for name, heights in sets.items():
        chosen = [str(number[c]) for c in corners if c[2] in heights]
        lines += [f"*NSET, NSET={name}", ", ".join(chosen)]
    return "\n".join([*lines, KEYWORDS.format(nu=nu)])
