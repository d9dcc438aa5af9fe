"""Displacements that are kept of transients and paths: those of the model, to less than a pixel."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.study.results.nodal_motion import (
    LARGEST_MISS,
    MOST_SHAPES,
    few_shapes,
    nodal_motion,
    shown_states,
)


@pytest.fixture(scope="module")
def joint():
    return fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})


@pytest.fixture(scope="module")
def swing(joint):
    load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})
    return fy.solve_transient(joint, load, step=1e-5, duration=6e-4)


def error(found, truth):
    states = np.tensordot(found.amplitudes, found.shapes, axes=1)
    return np.abs(states - truth).max() / np.abs(truth).max()


def test_motion_of_the_full_model_is_that_of_its_nodes(joint, swing):
    found = nodal_motion(joint, swing)
    assert len(found.chosen) < len(swing.times)
    truth = joint.dofs.nodal(swing.states[found.chosen])[..., :3]
    # The shapes say themselves what they miss; the rest is round-off.
    assert error(found, truth) == pytest.approx(found.missed, abs=1e-12)
    assert found.missed <= LARGEST_MISS
    assert found.amplitudes.shape[1] < len(found.chosen) / 4


def test_motion_of_a_reduced_model_has_what_its_compliance_moves(joint, swing):
    rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=10), compliance=True)
    load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})
    small = fy.solve_transient(rom, load, step=1e-5, duration=6e-4)
    found = nodal_motion(joint, small)
    full = np.array([joint.dofs.nodal(u)[:, :3] for u in fy.full_displacement(joint, small)])
    assert error(found, full[found.chosen]) <= LARGEST_MISS + 1e-12
    # Without what the compliance moves faces would cross the bolt head: more than is missed.
    bare = joint.dofs.nodal(small.states @ rom.trial_vectors.T)[..., :3]
    assert error(found, bare[found.chosen]) > 2 * LARGEST_MISS


def test_few_shapes_are_the_fewest_that_are_enough():
    rng = np.random.default_rng(5)
    shapes, amplitudes = rng.normal(size=(300, 3)), rng.normal(size=(20, 3))
    states = shapes @ amplitudes.T
    found, kept, missed = few_shapes(states)
    assert found.shape == (20, 3)
    assert missed < 1e-12
    assert np.allclose(kept @ found.T, states, rtol=0, atol=1e-12 * np.abs(states).max())
    none = few_shapes(np.zeros((300, 4)))
    assert none[0].shape == (4, 0)
    assert none[2] == 0.0
    many = few_shapes(rng.normal(size=(300, 40)))
    assert many[0].shape == (40, MOST_SHAPES)
    assert many[2] > 0.1


def test_states_shown_are_even_and_have_the_peak():
    peaks = np.ones(1001)
    peaks[333] = 2.0
    chosen = shown_states(peaks)
    assert len(chosen) == 42
    assert chosen[[0, -1]].tolist() == [0, 1000]
    assert 333 in chosen
    assert shown_states(np.ones(3)).tolist() == [0, 1, 2]


def test_motion_is_kept_of_the_reference_alone(joint, swing):
    from faying.files.flattening import flattened, restored
    from faying.study.results.responses import respond
    from faying.study.results.values import Response

    response = respond(swing, joint, 0.0, moves=True)
    again = restored(Response, flattened(response)).motion
    for name, value in vars(response.motion).items():
        assert np.array_equal(getattr(again, name), value)
    assert respond(swing, joint, 0.0).motion is None
    assert restored(Response, flattened(replace(response, motion=None))).motion is None
