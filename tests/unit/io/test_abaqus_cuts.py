"""Pretension sections through solids of tetrahedra, some of which only touch the section."""

from itertools import permutations

import numpy as np
import pytest

import faying as fy
from faying.io.abaqus import read_joint
from faying.joint.bolt_surroundings import axis_distances

KEYWORDS = """\
*MATERIAL, NAME=S
*ELASTIC
210000., 0.
*DENSITY
7.85E-9
*SOLID SECTION, ELSET=ALL, MATERIAL=S
*PRE-TENSION SECTION, SURFACE=CUT, NODE=99
*BOUNDARY
{held}, 1, 3
*STEP
*STATIC
*CLOAD
99, 1, 100.
*END STEP
"""


def stacked(kind):
    """Two unit cubes on each other, each one brick or the six tetrahedra around its diagonal."""
    corners = [(x, y, z) for z in range(3) for y in range(2) for x in range(2)]
    number = {corner: i + 1 for i, corner in enumerate(corners)}
    elements = []
    for base in (0, 1):
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
    return "\n".join(
        [
            "*NODE",
            *(f"{number[c]}, {c[0]}, {c[1]}, {c[2]}" for c in corners),
            "99, 0.5, 0.5, 1.",
            f"*ELEMENT, TYPE={kind}, ELSET=ALL",
            *(f"{i + 1}, {', '.join(str(number[c]) for c in e)}" for i, e in enumerate(elements)),
            "*SURFACE, NAME=CUT",
            *(
                f"{i + 1}, {label}"
                for i, e in enumerate(elements)
                for label, local in faces[kind].items()
                if all(e[n][2] == 1 for n in local) and all(c[2] <= 1 for c in e)
            ),
            "*NSET, NSET=HELD",
            ", ".join(str(number[c]) for c in corners if c[2] != 1),
            KEYWORDS.format(held="HELD"),
        ]
    )


@pytest.mark.parametrize(("kind", "touching"), [("C3D8", 0), ("C3D4", 4)])
def test_elements_that_only_touch_a_section_are_parted_and_counted(tmp_path, kind, touching):
    (tmp_path / "bar.inp").write_text(stacked(kind))
    described = read_joint(tmp_path / "bar.inp")
    notes = [
        note for note in described.assembly.ignored if note.startswith("*PRE-TENSION SECTION CUT")
    ]
    assert [note.split(" elements")[0] for note in notes] == (
        [f"*PRE-TENSION SECTION CUT: {touching}"] if touching else []
    )
    model = fy.build_model(described.assembly, bolts=described.bolts)
    (bolt,) = model.bolts.values()
    # A place and a direction: the middle of the section, and as far to both sides as it is wide.
    np.testing.assert_allclose(
        np.sort(bolt.ends, axis=0), [[0.5, 0.5, 1 - r] for r in (np.pi**-0.5, -(np.pi**-0.5))]
    )
    np.testing.assert_allclose(axis_distances(np.array([[3.5, 0.5, 50.0]]), bolt), 3.0)
    pull = np.asarray(bolt.elongation).ravel()
    flexibility = pull @ model.factorize_static().solve(pull)
    # Of the bar alone: without the spring that closes the cut, which K holds beside it. Its
    # stiffness of 1e4 layers leaves 1e-11 of the difference's digits.
    stiffness = 1.0 / flexibility - bolt.stiffness
    assert stiffness == pytest.approx(210000.0 / 2.0, rel=1e-9)
