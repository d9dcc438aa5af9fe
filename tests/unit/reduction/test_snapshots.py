"""Training loads and the contact forces they cause (§15.3.4)."""

from itertools import product

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.simulation import instants

BOX = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)})


def test_static_loads_are_all_combinations(joint):
    """Five levels of two components at three preloads: 75."""
    loads = BOX.static_loads(joint)
    assert len(loads) == 75
    locked = joint.bolts["bolt"].initial_force
    found = {(*load.forces.values(), load.bolt_forces["bolt"]) for load in loads}
    fz, mx = (-750.0, -375.0, 0.0, 375.0, 750.0), (-30e3, -15e3, 0.0, 15e3, 30e3)
    assert found == set(product(fz, mx, (0.5 * locked, locked, 1.5 * locked)))


def test_step_loads_are_the_eight_directions():
    loads = BOX.step_loads()
    assert len(loads) == 8
    found = {tuple(load.forces.values()) for load in loads}
    expected = set(product((-750.0, 0.0, 750.0), (-30e3, 0.0, 30e3))) - {(0.0, 0.0)}
    assert found == expected


def test_a_box_of_one_component():
    box = fy.LoadBox(ranges={"tip.Fz": (0.0, 10.0)}, levels=3, preload_factors=(1.0,))
    assert [dict(load.forces) for load in box.step_loads()] == [{"tip.Fz": 0.0}, {"tip.Fz": 10.0}]


def test_random_loads_lie_in_the_box_and_repeat(joint):
    loads = BOX.random_loads(joint, 50, seed=3)
    locked = joint.bolts["bolt"].initial_force
    for load in loads:
        assert -750 <= load.forces["tip.Fz"] <= 750
        assert -30e3 <= load.forces["tip.Mx"] <= 30e3
        assert 0.5 * locked <= load.bolt_forces["bolt"] <= 1.5 * locked
    again = BOX.random_loads(joint, 50, seed=3)
    assert [load.forces for load in again] == [load.forces for load in loads]
    assert BOX.random_loads(joint, 50, seed=4)[0].forces != loads[0].forces
    assert np.ptp([load.forces["tip.Fz"] for load in loads]) > 1000  # they fill the range


def test_static_snapshots_are_the_contact_forces(joint):
    loads = BOX.static_loads(joint)[::20]
    snapshots = fy.static_snapshots(joint, loads)
    assert snapshots.shape == (joint.contact.n_points, len(loads))
    for column, load in zip(snapshots.T, loads, strict=True):
        expected = fy.solve_static(joint, load).contact_forces
        # The order of cases changes warm starts only; matrix products may round differently.
        np.testing.assert_allclose(column, expected, rtol=0, atol=1e-9 * expected.max())


def test_step_snapshots_hold_every_instant_of_every_run(joint):
    loads = BOX.step_loads()[:2]
    snapshots = fy.step_snapshots(joint, loads, step=1e-4, duration=3e-4)
    assert snapshots.shape == (joint.contact.n_points, 2 * 4)
    for number, load in enumerate(loads):
        motion = fy.solve_transient(joint, load, step=1e-4, duration=3e-4)
        found, expected = snapshots[:, 4 * number : 4 * number + 4], motion.contact_forces.T
        # Round-off of several right-hand sides at once and one by one.
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * expected.max())


def test_step_snapshots_of_a_reduced_model_fit_the_full_one(joint, classic):
    rom = fy.reduce(joint, classic, compliance=True)
    snapshots = fy.step_snapshots(rom, BOX.step_loads()[:1], step=1e-4, duration=3e-4)
    assert snapshots.shape[0] == joint.contact.n_points


@pytest.mark.parametrize(
    "bad", [{"ranges": {}}, {"levels": 0}, {"preload_factors": ()}], ids=lambda b: next(iter(b))
)
def test_refuses_an_empty_box(bad):
    with pytest.raises(ModelError, match="at least one load range"):
        fy.LoadBox(**{"ranges": {"tip.Fz": (0.0, 1.0)}, **bad})


def test_step_snapshots_do_not_depend_on_how_many_runs_fit_in_memory(joint, monkeypatch):
    loads = BOX.step_loads()[:3]
    together = fy.step_snapshots(joint, loads, step=1e-4, duration=3e-4)
    n_number = 4 * (3 * joint.K.shape[0] + 2 * joint.contact.n_points)
    for runs in (0, 2):  # less than one run, and a last group that is not full
        monkeypatch.setattr(instants, "HISTORY_BYTES", runs * 8 * n_number)
        alone = fy.step_snapshots(joint, loads, step=1e-4, duration=3e-4)
        # Round-off of several right-hand sides at once and one by one.
        np.testing.assert_allclose(alone, together, rtol=0, atol=1e-9 * together.max())
