"""The seed's statements on methods A and B, where they hold and where they do not.

The seed gives neither loads nor overlap nor penalty, so its figures are compared as statements.
Bounds are the seed's own (10 %, 5 %); the penalties at which they are met are our measurement.
"""

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import faying as fy

EXAMPLE = Path(__file__).parents[2] / "examples" / "seed_reproduction.py"


def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("seed_reproduction", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


seed = example()


@pytest.fixture(scope="module")
def joint() -> fy.Model:
    return seed.joint()


def penalties() -> list:
    """Return the penalties; the seed's statement holds at one, others take minutes in all."""
    return [p if p == 3e4 else pytest.param(p, marks=pytest.mark.slow) for p in seed.PENALTIES]


@pytest.fixture(scope="module", params=penalties())
def rows(request, joint) -> list:
    return list(seed.rows(joint, request.param))


def find(rows, method: str, joint_modes: int):
    return next(r for r in rows if r.method == method and r.joint_modes == joint_modes)


def test_lc1_and_lc2_are_not_training_loads():
    joint = fy.lap_joint(element_size=10.0, hole_radius=None)
    trained = [load.forces for load in [*seed.BOX.static_loads(joint), *seed.BOX.step_loads()]]
    assert seed.LC1.forces not in trained
    assert {"tip.Fz": -500.0, "tip.Mx": 0.0} not in trained
    assert seed.LC2.forces not in trained


def test_method_b_needs_fewer_modes_than_method_a(rows):
    for count in seed.COUNTS:
        b = find(rows, "jim-b", count)
        for a in (find(rows, f"jim-a (W = {w})", count) for w in "KI"):
            assert b.lc1 < a.lc1
            assert b.lc2 < a.lc2
            assert b.unseen_median < a.unseen_median


def test_the_bounds_of_the_seed_at_twenty_modes_depend_on_the_penalty(rows):
    a, b = find(rows, "jim-a (W = K)", 20), find(rows, "jim-b", 20)
    a_above_10 = max(a.lc1, a.lc2) > 0.10
    b_below_5 = max(b.lc1, b.lc2) < 0.05
    assert (a_above_10, b_below_5) == {
        1e4: (False, True),  # so soft that method A is good as well
        3e4: (True, True),  # the seed's statement
        1e5: (True, False),
        8.4e5: (True, False),
    }[a.penalty]


def test_five_joint_modes_reproduce_the_tip_displacement(rows):
    # The seed's Fig. 15.7 shows no difference by eye; we ask for 1 % of the largest displacement,
    # and find it for method B everywhere, for method A at all but the stiffest penalty (1.2 %).
    assert find(rows, "jim-b", 5).step.displacement_error < 0.01
    assert find(rows, "jim-a (W = K)", 5).step.displacement_error < 0.015


def test_method_a_overestimates_the_peak_pressure_of_the_step_response(rows):
    a, b = find(rows, "jim-a (W = K)", 5), find(rows, "jim-b", 5)
    assert a.step.max_pressure_ratio > 1.15
    assert abs(b.step.max_pressure_ratio - 1) < abs(a.step.max_pressure_ratio - 1)


def test_symmetric_pressures_have_symmetric_errors(joint):
    # First conclusion of §15.4.4.1. LC1 is symmetric about y = 0; round-off of the bases stays
    # below 1e-6 of the largest pressure.
    rom = fy.reduce(joint, fy.jim_a(joint, joint_modes=20))
    error = fy.relative_error(
        fy.solve_static(rom, seed.LC1).pressure, fy.solve_static(joint, seed.LC1).pressure
    )
    points = joint.interfaces["joint"].points
    order = np.lexsort(np.round(points, 6).T)
    mirrored = np.lexsort(np.round(points * [1, -1, 1], 6).T)
    np.testing.assert_allclose(error[order], error[mirrored], atol=1e-6)
