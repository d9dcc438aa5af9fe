"""Tightening plans: closed forms of a plate on two springs, and the settings applied by force."""

import csv

import numpy as np
import pytest

import faying as fy
from faying.assessment.strength.thread import tightening_stress
from faying.exceptions import ModelError
from faying.model.bolt import Bolt
from faying.study.keys.schema import read_study
from faying.workflow.tighten import overstressed, plan_of_study, torques_per_force, write_plan
from small_system import small_system

ROUND_OFF = 1e-9
"""Of bolt forces, which BoltsByForce finds within 1e-10."""

SPRING, STIFFNESS, SUPPORT, HEAD = 4e3, 1e3, 30.0, 20.0
"""Contact springs at ± SUPPORT, bolts of STIFFNESS at ± HEAD of a rigid plate."""


def plate():
    rows = [np.array([1.0, at]) for at in (-HEAD, HEAD)]
    bolts = [
        Bolt(name=name, elongation=row, stiffness=STIFFNESS)
        for name, row in zip(("left", "right"), rows, strict=True)
    ]
    return small_system(
        np.eye(2),
        np.zeros((2, 2)),
        STIFFNESS * sum(np.outer(row, row) for row in rows),
        [[1.0, -SUPPORT], [1.0, SUPPORT]],
        gap=0.0,
        stiffness=SPRING,
        bolts=bolts,
    )


def test_one_round_on_a_plate_has_its_closed_form():
    # A bolt of force N closes the plate by d N where it is and by c N at the other bolt.
    d = (1 + (HEAD / SUPPORT) ** 2) / (2 * SPRING)
    c = (1 - (HEAD / SUPPORT) ** 2) / (2 * SPRING)
    taken = c / (1 / STIFFNESS + d)
    plan = fy.tightening_plan(plate(), {"left": 100.0, "right": 100.0})
    # The bolt that was not turned yet is loose, for the plate goes down beneath its head.
    np.testing.assert_allclose(
        plan.unplanned, [[100.0, 0.0], [100.0 * (1 - taken), 100.0]], rtol=ROUND_OFF, atol=1e-7
    )
    np.testing.assert_allclose(
        plan.bolt_forces, [[100.0 * (1 + taken), 0.0], [100.0, 100.0]], rtol=ROUND_OFF, atol=1e-7
    )
    np.testing.assert_allclose(plan.settings, [100.0 * (1 + taken), 100.0], rtol=ROUND_OFF)
    # N0 is what the bolt would have if nothing gave way.
    expected = 100.0 * (1 + STIFFNESS * (d + c))
    assert list(plan.initial_forces.values()) == pytest.approx([expected] * 2, rel=ROUND_OFF)


@pytest.mark.parametrize("passes", [2, 3])
def test_more_rounds_need_as_much_as_they_say(passes):
    most = fy.tightening_plan(plate(), {"left": 100.0, "right": 100.0}).shares.max()
    plan = fy.tightening_plan(plate(), {"left": 100.0, "right": 100.0}, passes=passes)
    np.testing.assert_allclose(plan.reached, 1.0, rtol=ROUND_OFF)
    assert plan.shares.max() < most
    # In proportion but for the first round, in which the other bolt is loose: a hundredth of what
    # neighbours take, which is 4 %.
    assert plan.shares.max() == pytest.approx(1 / (1 - (1 - 1 / most) ** passes), rel=4e-4)


@pytest.fixture(scope="module")
def soft():
    """Three bolts in a row on a soft layer."""
    joint = fy.lap_joint(
        element_size=5.0,
        hole_radius=None,
        washer_radius=5.0,
        overlap=60.0,
        bolt_positions=((-20.0, 0.0), (0.0, 0.0), (20.0, 0.0)),
    )
    return joint.with_closure(fy.PowerClosure(pressure=20.0, depth=0.1, exponent=2.0))


TARGETS = {"bolt-2": 6e3, "bolt-1": 5e3, "bolt-3": 5e3}


def brought_to_settings(joint, plan, increments=10):
    """Forces over the targets once each bolt was brought to its setting, by force, in order."""
    settings = dict(zip(plan.turned, plan.settings.tolist(), strict=True))
    applied = fy.tightening_plan(joint, settings, increments=increments).unplanned[-1]
    return applied[[plan.bolts.index(name) for name in TARGETS]] / list(TARGETS.values())


def test_settings_applied_by_force_end_at_the_targets(soft):
    plan = fy.tightening_plan(soft, TARGETS)
    assert plan.turned == tuple(TARGETS)
    # Otherwise a plan would not be needed: the neighbours take more than a tenth.
    assert plan.reached_unplanned.min() < 0.9
    np.testing.assert_allclose(plan.reached, 1.0, rtol=ROUND_OFF)
    np.testing.assert_allclose(brought_to_settings(soft, plan), 1.0, rtol=ROUND_OFF)


def test_with_friction_the_sequence_meets_the_targets(soft):
    rubbing = soft.with_friction(0.3)
    plan = fy.tightening_plan(rubbing, TARGETS, increments=4)
    # What a plan allows itself.
    np.testing.assert_allclose(plan.reached, 1.0, atol=1e-4)
    # By force increments are of other sizes, and slips differ.
    np.testing.assert_allclose(brought_to_settings(rubbing, plan, 4), 1.0, atol=1e-3)


def test_bad_plans_are_refused():
    for forces, passes in (({}, 1), ({"left": 1.0}, 0)):
        with pytest.raises(ModelError, match="at least"):
            fy.tightening_plan(plate(), forces, passes=passes)
    with pytest.raises(ModelError, match="no bolt 'middle'"):
        fy.tightening_plan(plate(), {"middle": 1.0})


STUDY = """
[model]
source = "lap-joint"

[model.lap_joint]
element_size = 10.0
hole_radius = 0.0
washer_radius = 11.0
bolt_positions = [[-10.0, 0.0], [10.0, 0.0]]

[[interface]]
name = "joint"
closure = { power = { pressure = 20.0, depth = 0.1, exponent = 1.0 } }

[[bolt]]
name = "bolt-2"
preload = 6e3

[[bolt]]
name = "bolt-1"
preload = 5e3
"""


def test_a_study_is_planned_into_a_table(tmp_path):
    (tmp_path / "joint.toml").write_text(STUDY)
    plan = plan_of_study(read_study(tmp_path / "joint.toml"), passes=2)
    write_plan(plan, tmp_path / "plan.csv", {"bolt-1": 1.5})
    head, *rows = csv.reader((tmp_path / "plan.csv").read_text(encoding="utf-8").splitlines())
    assert head[:6] == ["turn", "pass", "bolt", "tighten to", "share of preload", "torque"]
    assert head[6:] == ["bolt-1 after", "bolt-2 after"]
    order = dict.fromkeys(plan.turned)
    assert [row[1:3] for row in rows] == [[f"{n}", name] for n in (1, 2) for name in order]
    # Seven digits are written.
    assert [float(cell) for cell in rows[-1][6:]] == pytest.approx([5e3, 6e3], rel=1e-6)
    assert [row[5] == "" for row in rows] == [True, False] * 2
    assert float(rows[1][5]) == pytest.approx(1.5 * plan.settings[1], rel=1e-6)
    assert float(rows[0][3]) == pytest.approx(plan.settings[0], rel=1e-6)


def test_torques_are_told_where_size_and_friction_are(tmp_path):
    sized = 'size = "M8"\ngrade = "8.8"\nthread_friction = 0.12\nhead_friction = 0.12\n'
    (tmp_path / "joint.toml").write_text(STUDY + sized)
    (arm,) = torques_per_force(read_study(tmp_path / "joint.toml")).values()
    # M8 of a hexagon head: P / 2 pi + 0.58 d2 mu + D_K mu / 2, D_K between hole and face.
    assert arm == pytest.approx(1.25 / (2 * np.pi) + 0.12 * (0.577 * 7.188 + 10.3 / 2), rel=0.02)


def test_bolts_that_would_yield_meanwhile_are_told(tmp_path):
    sized = 'size = "M6"\ngrade = "4.6"\nthread_friction = 0.12\n'
    (tmp_path / "joint.toml").write_text(STUDY + sized)
    study = read_study(tmp_path / "joint.toml")
    plan = plan_of_study(study)
    thread = fy.Thread.named("M6", "4.6", friction=0.12)
    setting = dict(zip(plan.turned, plan.settings.tolist(), strict=True))["bolt-1"]
    used = tightening_stress(thread, setting) / 240.0
    assert used > 1
    assert overstressed(study, plan) == {"bolt-1": pytest.approx(used, rel=1e-12)}
    strong = STUDY + sized.replace("4.6", "12.9")
    (tmp_path / "joint.toml").write_text(strong)
    assert overstressed(read_study(tmp_path / "joint.toml"), plan) == {}
