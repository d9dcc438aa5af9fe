"""Pretension sections through solids of tetrahedra, some of which only touch the section."""

import numpy as np
import pytest

import faying as fy
from cut_bars import bar
from faying.io.abaqus import read_joint
from faying.joint.bolt_surroundings import axis_distances


@pytest.mark.parametrize(("kind", "touching"), [("C3D8", 0), ("C3D4", 4)])
def test_elements_that_only_touch_a_section_are_parted_and_counted(tmp_path, kind, touching):
    (tmp_path / "bar.inp").write_text(bar(kind, 2, 1, FOOT=(0, 2)))
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
