"""Interfaces that dense matrices have no room for, by sparse factors, against dense matrices."""

import logging

import numpy as np
import pytest

import faying as fy
from faying.contact.active_set import solve_complementarity
from faying.contact.dense_points import DensePoints
from faying.contact.pressing import PressingContact
from faying.contact.saddle_points import SaddlePoints
from faying.contact.sparse_pairs import SparsePairs
from faying.exceptions import ModelError
from faying.simulation.integrators import ImplicitEuler

LC2 = fy.Load({"tip.Fz": -20.0, "tip.Mx": 500.0}, name="LC2")
TINY = 1e3
"""Budget in bytes that no dense matrix of these models fits into."""

RUN = {"step": 1e-5, "duration": 3e-5}


def assert_alike(mine, exact):
    np.testing.assert_allclose(mine, exact, rtol=0, atol=1e-9 * np.abs(exact).max(initial=0.0))


@pytest.mark.parametrize("penalty", [1e4, 1e7, 1e9, 1e11])
def test_sequences_of_a_lap_joint(penalty):
    """From similar problems while round-off allows it, anew where a penalty is too stiff for it."""
    model = fy.preload(fy.lap_joint(element_size=5.0, penalty=penalty), {"bolt": 10e3})
    points, state = DensePoints(H=model.static_contact.flexibility), None
    first, last = moved_freely(model, 2)
    contact, solver = model.contact, model.static_contact.increments
    for share in np.linspace(0.0, 1.0, 12):
        free = (1 - share) * first + share * last
        state = solver.solve(free, contact.offset(), state)
        exact = solve_complementarity(points, contact.free_gap(free))
        # Round-off times the condition, which grows with the penalty.
        small = 1e-9 * max(1.0, penalty / 1e7) * exact.forces.max()
        np.testing.assert_allclose(state.forces[0], exact.forces, rtol=0, atol=small)


def moved_freely(model, count):
    rng = np.random.default_rng(3)
    ports = model.port_compliance
    initial = [-bolt.initial_force for bolt in model.bolts.values()]
    inputs = np.array(
        [
            [*(rng.uniform(-1, 1, 6) * [2e3, 5e2, 5e2, 2e4, 2e4, 2e4]), *initial]
            for _ in range(count)
        ]
    )
    return inputs @ ports.contact_columns


@pytest.fixture(scope="module")
def plates():
    """Two thin plates, dense and sparse."""
    sizes = {"element_size": 4.0, "thickness": 4.0, "length": 70.0}
    model = fy.lap_joint(**sizes, damping=fy.Rayleigh(beta=5e-7))
    dense = fy.preload(model, {"bolt": 1e3})
    return dense, dense.with_dense_budget(TINY)


def test_reduced_models_are_statically_exact_and_step_alike(plates):
    basis = fy.craig_bampton(plates[0], normal_modes=8)
    exact, mine = (fy.reduce(joint, basis, compliance=True) for joint in plates)
    assert isinstance(mine.static_contact.increments.pairs, SparsePairs)
    full = fy.solve_static(plates[0], LC2)
    assert_alike(fy.solve_static(mine, LC2).contact_forces, full.contact_forces)
    for scheme in (ImplicitEuler(), fy.EnergyDecaying()):
        dense, sparse = (
            fy.solve_transient(rom, LC2, **RUN, integrator=scheme) for rom in (exact, mine)
        )
        assert_alike(sparse.contact_forces, dense.contact_forces)
    recovered = [fy.recover_pressure(rom, dense).pressure for rom in (exact, mine)]
    assert_alike(*reversed(recovered))


def test_reduced_models_without_their_compliance_have_their_shapes_alone(plates):
    basis = fy.craig_bampton(plates[0], normal_modes=8)
    exact, mine = (fy.reduce(joint, basis) for joint in plates)
    assert_alike(
        fy.solve_static(mine, LC2).contact_forces, fy.solve_static(exact, LC2).contact_forces
    )
    dense, sparse = (fy.solve_transient(rom, LC2, **RUN) for rom in (exact, mine))
    assert_alike(sparse.contact_forces, dense.contact_forces)
    with pytest.raises(ModelError, match="which exceed the dense budget; raise it"):
        _ = mine.port_compliance.relative


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_steps_of_full_models(friction):
    model = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    if friction:
        model = model.with_friction(friction)
    dense, sparse = (
        fy.solve_transient(joint, LC2.scaled(20.0), step=1e-5, duration=3e-5)
        for joint in (model, model.with_dense_budget(TINY))
    )
    assert_alike(sparse.contact_forces, dense.contact_forces)
    assert_alike(sparse.shear_forces, dense.shear_forces)


@pytest.fixture(scope="module")
def hard():
    sizes = {"element_size": 2.5, "thickness": 2.5, "length": 60.0, "width": 15.0}
    return fy.preload(fy.lap_joint(**sizes, penalty="hard"), {"bolt": 2e3})


def test_hard_contact_with_one_point_a_pair(hard):
    assert hard.contact.n_points == hard.structure.relative_operator.shape[0]
    assert isinstance(hard.static_contact.space, DensePoints)
    small = hard.with_dense_budget(TINY)
    exact, mine = fy.solve_static(hard, LC2), fy.solve_static(small, LC2)
    assert isinstance(small.static_contact.space, SaddlePoints)
    assert_alike(mine.contact_forces, exact.contact_forces)
    basis = fy.craig_bampton(hard, normal_modes=8)
    rom = fy.reduce(small, basis, compliance=True)
    assert_alike(fy.solve_static(rom, LC2).contact_forces, exact.contact_forces)


def test_contact_far_stiffer_than_the_structure(hard):
    stiff = hard.with_penalty(1e11)
    small = stiff.with_dense_budget(TINY)
    assert isinstance(small.static_contact.increments, PressingContact)
    exact, mine = fy.solve_static(stiff, LC2), fy.solve_static(small, LC2)
    assert_alike(mine.contact_forces, exact.contact_forces)


def test_the_switch_is_automatic_and_announced(caplog):
    model = fy.lap_joint(element_size=5.0).with_dense_budget(100)
    with caplog.at_level(logging.INFO, logger="faying"):
        assert isinstance(model.static_contact.increments.pairs, SparsePairs)
    assert "contact is solved with sparse factors" in caplog.text
    assert "dense budget of 1e+02 bytes" in caplog.text


def test_dense_matrices_beyond_the_budget_are_refused():
    model = fy.lap_joint(element_size=5.0).with_dense_budget(100)
    with pytest.raises(ModelError, match="which exceed the dense budget; raise it"):
        _ = model.static_contact.flexibility
    wide = model.with_dense_budget(10**6)
    with pytest.raises(ModelError, match="112 contact forces exceeds the dense budg"):
        wide.with_dense_budget(100).contact.at_points(wide.port_compliance.relative)
