"""Section forces of a bolt of solids: in balance with the loads whatever the mesh."""

import numpy as np
import pytest

import faying as fy
from cut_bars import bar
from faying.io.abaqus import read_joint
from faying.model.deck_bolt import section_rows

LAYERS, CUT = 5, 2
"""Unit cubes on each other, cut on the second."""


@pytest.mark.parametrize("kind", ["C3D8", "C3D4"])
def test_section_forces_balance_the_loads(tmp_path, kind):
    text = bar(kind, LAYERS, CUT, nu=0.3, FOOT=(0,), TOP=(LAYERS,))
    (tmp_path / "bar.inp").write_text(text)
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
