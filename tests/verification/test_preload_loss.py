"""Bolts that lose force after they were tightened."""

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.simulation.tightening import tightened_joint
from faying.study.keys.schema import read_study
from faying.study.stages.offline import prepare_joint
from small_study import TINY_JOINT

ROUND_OFF = 1e-9
"""Of bolt forces, which are found within 1e-10."""

FACES = (3e-3, 2e-3, 3e-3)


@pytest.fixture(scope="module")
def single():
    return fy.lap_joint(element_size=5.0)


@pytest.fixture(scope="module")
def pair():
    return fy.lap_joint(
        element_size=5.0, bolt_positions=((-10.0, 0.0), (10.0, 0.0)), hole_radius=None
    )


def test_embedding_takes_what_both_compliances_let_it(single):
    # With no gap the joint is a spring: the compliance of bolt and plates is N0 / (k N).
    before = fy.preload(single, {"bolt": 10e3}).bolts["bolt"]
    after = fy.preload(single, {"bolt": 10e3}, losses={"bolt": fy.PreloadLoss(embedding=FACES)})
    whole = before.initial_force / (before.stiffness * 10e3)
    left = fy.solve_static(after).bolt_force("bolt")
    assert left == pytest.approx(10e3 - sum(FACES) / whole, rel=ROUND_OFF)
    assert left < 9e3  # or a wrong sum of faces would not be seen


def test_relaxation_takes_its_share_of_each_bolt_together(pair):
    losses = {"bolt-1": fy.PreloadLoss(relaxation=0.1), "bolt-2": fy.PreloadLoss(relaxation=0.02)}
    told = fy.tighten(pair, {"bolt-1": 10e3, "bolt-2": 6e3}, losses=losses)
    assert told.stages[-1] == "relaxed"
    np.testing.assert_allclose(told.bolt_forces[-1], [9e3, 5880.0], rtol=ROUND_OFF)
    locked = fy.solve_static(pair.with_bolt_forces(told.initial_forces))
    assert locked.bolt_force("bolt-1") == pytest.approx(9e3, rel=ROUND_OFF)


def test_a_bolt_that_lost_all_is_loose(pair):
    losses = {"bolt-1": fy.PreloadLoss(embedding=(1.0,))}
    told = fy.tighten(pair, {"bolt-1": 10e3, "bolt-2": 6e3}, losses=losses)
    assert told.stages[-1] == "embedded"
    assert told.bolt_forces[-1, 0] == 0.0
    assert told.bolt_forces[-1, 1] > 5.9e3
    locked = fy.solve_static(pair.with_bolt_forces(told.initial_forces))
    assert abs(locked.bolt_force("bolt-1")) < ROUND_OFF * 10e3


def test_with_friction_losses_end_the_path(pair):
    losses = {"bolt-1": fy.PreloadLoss(embedding=FACES, relaxation=0.1)}
    rubbing = pair.with_friction(0.2)
    found = tightened_joint(rubbing, {"bolt-1": 10e3, "bolt-2": 6e3}, increments=2, losses=losses)
    assert found.tightening.stages[-2:] == ("relaxed", "embedded")
    assert found.tightening.bolt_forces[-2, 0] == pytest.approx(9e3, rel=ROUND_OFF)
    followed = fy.solve_path(rubbing, found.tightening.loads)
    for number, bolt in enumerate(found.tightening.bolts):
        last = found.tightening.bolt_forces[-1, number]
        assert found.rest(rubbing).bolt_force(bolt)[-1] == pytest.approx(last, rel=ROUND_OFF)
        assert followed.bolt_force(bolt)[-1] == pytest.approx(last, rel=1e-8)


def test_losses_of_a_study_lock_its_bolts(tmp_path):
    text = TINY_JOINT + "embedding = [1e-3, 1e-3]\nrelaxation = 0.05\n"
    (tmp_path / "joint.toml").write_text(text)
    study = read_study(tmp_path / "joint.toml")
    joint = prepare_joint(study)
    left = joint.rest.bolt_force("bolt")
    lost = fy.PreloadLoss(embedding=(2e-3,), relaxation=0.05)
    bare = joint.model.with_bolt_forces({"bolt": 0.0})
    again = fy.preload(bare, {"bolt": 5e3}, losses={"bolt": lost})
    assert left == pytest.approx(fy.solve_static(again).bolt_force("bolt"), rel=ROUND_OFF)
    assert left < 0.95 * 5e3


@pytest.mark.parametrize("bad", [{"embedding": (-1e-3,)}, {"relaxation": 1.0}])
def test_losses_that_cannot_be_are_refused(single, bad):
    with pytest.raises(ModelError, match="a share below 1"):
        fy.PreloadLoss(**bad)
    with pytest.raises(ModelError, match="no bolt 'nut'"):
        fy.tighten(single, {"bolt": 1e3}, losses={"nut": fy.PreloadLoss(relaxation=0.1)})
