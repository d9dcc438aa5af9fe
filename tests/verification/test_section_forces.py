"""Section forces of a bolt of solids: in balance with the loads whatever the mesh."""

from itertools import permutations

import numpy as np
import pytest

import faying as fy
from faying.io.abaqus import read_joint
from faying.model.bolt_bending import section_rows

KEYWORDS = """\
*MATERIAL, NAME=S
*ELASTIC
210000., 0.3
*DENSITY
7.85E-9
*SOLID SECTION, ELSET=ALL, MATERIAL=S
*PRE-TENSION SECTION, SURFACE=CUT, NODE=99
*BOUNDARY
FOOT, 1, 3
*STEP
*STATIC
*CLOAD
99, 1, 1.
*END STEP
"""
LAYERS, CUT = 5, 2
"""Unit cubes on each other, cut on the second."""


def bar(kind):
    """Return the deck of a bar, each cube one brick or six tetrahedra around its diagonal."""
    corners = [(x, y, z) for z in range(LAYERS + 1) for y in range(2) for x in range(2)]
    number = {corner: i + 1 for i, corner in enumerate(corners)}
    elements = []
    for base in range(LAYERS):
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
        f"99, 0.5, 0.5, {CUT}.",
        f"*ELEMENT, TYPE={kind}, ELSET=ALL",
        *(f"{i + 1}, {', '.join(str(number[c]) for c in e)}" for i, e in enumerate(elements)),
        "*SURFACE, NAME=CUT",
        *(
            f"{i + 1}, {label}"
            for i, e in enumerate(elements)
            for label, local in faces[kind].items()
            if all(e[n][2] == CUT for n in local) and all(c[2] <= CUT for c in e)
        ),
    ]
    for name, level in (("FOOT", 0), ("TOP", LAYERS)):
        chosen = [str(number[c]) for c in corners if c[2] == level]
        lines += [f"*NSET, NSET={name}", ", ".join(chosen)]
    return "\n".join([*lines, KEYWORDS])


@pytest.mark.parametrize("kind", ["C3D8", "C3D4"])
def test_section_forces_balance_the_loads(tmp_path, kind):
    (tmp_path / "bar.inp").write_text(bar(kind))
    described = read_joint(tmp_path / "bar.inp")
    model = fy.build_model(
        described.assembly,
        bolts=described.bolts,
        boundaries=[fy.BoundarySpec(name="top", set="TOP")],
    )
    load = fy.Load({"top.Fx": 30.0, "top.Fy": -20.0, "top.Fz": 500.0})
    (name,) = model.bolts
    solution = fy.solve_static(model, load)
    displacement = model.dofs.nodal(fy.full_displacement(model, solution)).ravel()
    (spec,) = described.bolts
    axial, *across, torsion, first, second = section_rows(model.assembly, spec) @ displacement
    reach = LAYERS - CUT
    # Balance, by far below what a mesh of cubes knows of stresses: 1e-9 is round-off of K, whose
    # spring at the cut is a thousand times as stiff.
    assert axial == pytest.approx(500.0, rel=1e-9)
    assert np.hypot(*across) == pytest.approx(np.hypot(30, 20), rel=1e-9)
    assert np.hypot(first, second) == pytest.approx(reach * np.hypot(30, 20), rel=1e-9)
    assert abs(torsion) < 1e-9 * 500
    assert float(solution.bolt_force(name)) == pytest.approx(500.0, rel=1e-9)
    moments = solution.bolt_bending(name)
    assert np.array_equal(moments[0], moments[1])
    assert np.linalg.norm(moments[0]) == pytest.approx(reach * np.hypot(30, 20), rel=1e-9)


def test_beams_have_no_section_of_solids():
    model = fy.lap_joint(element_size=10.0)
    assert (
        section_rows(
            model.assembly, fy.BoltSpec(name="bolt", elements=[model.assembly.beams[0].id])
        )
        is None
    )
