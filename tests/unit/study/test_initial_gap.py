"""Initial gaps of a study: a number or a file on an interface changes the joint as in memory."""

import numpy as np
import pytest

import faying as fy
from faying.exceptions import FayingError, StudyError
from faying.interface.gap_field import with_gap_offset
from faying.study.inputs.load_model import build
from faying.study.keys.schema import read_study
from faying.study.stages.offline import prepare_joint
from lap_joints import tiny_lap
from small_study import reduction, tiny_joint

SMALL = reduction("compliance") + tiny_joint(preload="10e3")
SHIM = 5e-3


def study(folder, extra):
    path = folder / "STUDY.toml"
    path.write_text(SMALL + extra)
    return read_study(path)


@pytest.fixture(scope="module")
def bare():
    return tiny_lap()


def shim_file(folder, model):
    """5 µm of shim under the half of the joint towards the tip."""
    joint, mesh = model.interfaces["joint"], model.assembly.mesh
    thickness = np.where(mesh.nodes[joint.pairs[:, 0], 0] > 0, -SHIM, 0.0)
    ids = mesh.node_ids[joint.pairs[:, 0]]
    lines = [f"{node},{gap}" for node, gap in zip(ids, thickness, strict=True)]
    (folder / "shim.csv").write_text("node,gap\n" + "\n".join(lines) + "\n")
    return joint.point_shape @ thickness


def test_a_shim_on_half_the_joint_changes_the_preload_as_in_memory(tmp_path, bare):
    offset = shim_file(tmp_path, bare)
    shimmed = study(tmp_path, 'initial_gap = "shim.csv"\n')
    pressure = prepare_joint(shimmed).preload.pressure
    joint = with_gap_offset(bare.interfaces["joint"], offset)
    expected = fy.solve_static(
        fy.preload(bare.with_interfaces({"joint": joint}), {"bolt": 10e3})
    ).pressure
    # The same operations in the same order; only threads may sum otherwise.
    np.testing.assert_allclose(pressure, expected, atol=1e-9 * expected.max())
    flat = fy.solve_static(fy.preload(bare, {"bolt": 10e3})).pressure
    ahead = bare.interfaces["joint"].points[:, 0] > 0
    weights = bare.interfaces["joint"].weights
    carried, before = (weights[ahead] @ p[ahead] / (weights @ p) for p in (pressure, flat))
    # The clamp force moves onto the shim; half of it was there before.
    assert before == pytest.approx(0.5, abs=1e-6)
    assert carried > 0.55


def test_a_number_is_one_gap_everywhere(tmp_path, bare):
    model = build(study(tmp_path, "initial_gap = -0.01\n"))
    gap = bare.interfaces["joint"].initial_gap
    np.testing.assert_array_equal(model.interfaces["joint"].initial_gap, gap - 0.01)
    untouched = build(study(tmp_path, ""))
    np.testing.assert_array_equal(untouched.interfaces["joint"].initial_gap, gap)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ('"nowhere.csv"', r"'initial_gap' in \[\[interface\]\] number 1 .*does not exist"),
        ("true", "found true, expected a finite number or the name of a csv file"),
        ("nan", "found nan, expected a finite number"),
    ],
)
def test_values_that_are_no_gap_are_refused(tmp_path, value, message):
    with pytest.raises(StudyError, match=message):
        study(tmp_path, f"initial_gap = {value}\n")


def test_mistakes_in_the_file_are_found_when_the_study_is_read(tmp_path):
    (tmp_path / "gap.csv").write_text("node,gap\n1,0.0\n2,wide\n")
    with pytest.raises(StudyError, match=r"(?s)'initial_gap' in .*gap\.csv.*line 3: found 'wide'"):
        study(tmp_path, 'initial_gap = "gap.csv"\n')


def test_a_field_that_leaves_pairs_out_is_refused(tmp_path):
    (tmp_path / "gap.csv").write_text("node,gap\n1,0.0\n")
    with pytest.raises(FayingError, match="interface 'joint': the gap field has no value"):
        build(study(tmp_path, 'initial_gap = "gap.csv"\n'))
