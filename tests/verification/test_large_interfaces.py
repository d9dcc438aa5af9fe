"""Contact between pairs and with a compressed compliance against the dense point matrix."""

import logging
from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.contact.active_set import solve_complementarity
from faying.contact.compressed_space import CompressedSpace
from faying.contact.dense_points import DensePoints
from faying.exceptions import ModelError
from faying.linalg.compressed import compress
from faying.simulation.integrators import ImplicitEuler
from faying.simulation.path import moved_alone

LC2 = fy.Load({"tip.Fz": -20.0, "tip.Mx": 500.0}, name="LC2")
TINY = 1e5
"""Budget in bytes that no dense matrix of these models fits into."""


def dense_points(N, S, D):
    return DensePoints(H=N @ (N @ S).T + np.diag(D))


def test_active_systems_are_solved_alike(joint):
    contact, S = joint.contact, joint.port_compliance.relative
    active = fy.solve_static(joint).contact_forces > 0
    g_free = np.random.default_rng(2).standard_normal(contact.n_points)
    exact, _ = DensePoints(H=joint.static_contact.flexibility).equilibrate(g_free, active)
    N, D = contact.interpolation, contact.flexibility
    compressed = compress(lambda members: S[:, members], contact.places)
    spaces = (
        CompressedSpace(N=N, S=compressed, D=D),
        CompressedSpace(N=N, S=compressed, D=D, direct=0),
    )
    for space in spaces:
        # Gradients end at 1e-12 of the largest gap, times the condition 1e4.
        small = 1e-8 * np.abs(exact).max()
        forces, _ = space.equilibrate(g_free, active)
        np.testing.assert_allclose(forces, exact, rtol=0, atol=small)


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
    """Two thin plates: 1920 contact points on 540 pairs."""
    sizes = {"element_size": 1.25, "thickness": 1.25, "length": 70.0}
    model = fy.lap_joint(**sizes, damping=fy.Rayleigh(beta=5e-7))
    return fy.preload(model, {"bolt": 1e3})


@pytest.fixture(scope="module")
def small_plates(plates):
    return plates.with_dense_budget(TINY)


def test_two_thousand_points_within_the_stated_tolerance(plates, small_plates):
    assert plates.contact.n_points == 1920
    exact = fy.solve_static(plates, LC2).contact_forces
    static = small_plates.static_contact
    assert isinstance(static.space, CompressedSpace)
    free = moved_alone(small_plates, LC2.inputs(small_plates, np.zeros(1)))[0]
    compressed = static.space.solve(static.contact.free_gap(free))
    bound = compressed.error
    assert 0.0 < bound < 1e-5
    D = plates.contact.flexibility
    difference = compressed.forces - exact
    assert np.sqrt(difference**2 @ D) <= bound * np.sqrt(exact**2 @ D)
    # The bound is for the root mean square; single points are a few times worse.
    assert np.abs(difference).max() <= 10 * bound * exact.max()


@pytest.mark.long
def test_iterative_and_direct_solutions_of_compressed_problems_agree(small_plates):
    direct = small_plates.static_contact.space
    iterative = replace(direct, direct=0)
    for g_free in small_plates.contact.free_gap(moved_freely(small_plates, 2)) / 100:
        few, many = (space.solve(g_free) for space in (direct, iterative))
        assert 0 < direct.truncation <= min(few.error, many.error)
        assert max(few.error, many.error) < 1e-5
        # Gaps are closed to 1e-12 of the largest, a hundred times the penetration.
        np.testing.assert_allclose(many.forces, few.forces, rtol=0, atol=1e-7 * few.forces.max())


def test_the_compressed_reduced_model_is_statically_exact_and_steps_alike(plates, small_plates):
    basis = fy.craig_bampton(plates, normal_modes=8)
    rom = fy.reduce(plates, basis, compliance=True)
    small = fy.reduce(small_plates, basis, compliance=True)
    full = fy.solve_static(small_plates, LC2)
    reduced = fy.solve_static(small, LC2)
    # Both carry the same truncation; what is left is the noise of the iteration.
    assert fy.compare(reduced, full).max_relative_error < 1e-5
    run = {"step": 1e-5, "duration": 5e-5, "integrator": ImplicitEuler()}
    exact, compressed = (fy.solve_transient(r, LC2, **run) for r in (rom, small))
    assert isinstance(small.static_contact.space, CompressedSpace)
    worst = float(np.max(compressed.contact_error))
    assert 0.0 < worst < 1e-5
    # As above, and errors of five steps add up.
    assert fy.compare(compressed, exact).max_relative_error <= 50 * worst


def test_full_transients_are_compressed_too():
    model = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    run = {"step": 1e-5, "duration": 3e-5}
    exact = fy.solve_transient(model, LC2, **run)
    compressed = fy.solve_transient(model.with_dense_budget(TINY / 100), LC2, **run)
    assert float(np.max(compressed.contact_error)) > 0.0
    # The bound is below 1e-6 here.
    assert fy.compare(compressed, exact).max_relative_error < 1e-6


def test_hard_contact_with_one_point_a_pair():
    sizes = {"element_size": 1.25, "thickness": 2.5, "length": 60.0, "width": 15.0}
    model = fy.preload(fy.lap_joint(**sizes, penalty="hard"), {"bolt": 2e3})
    assert model.contact.n_points == model.structure.relative_operator.shape[0]
    assert isinstance(model.static_contact.space, DensePoints)
    small = model.with_dense_budget(TINY / 10)
    exact, compressed = fy.solve_static(model, LC2), fy.solve_static(small, LC2)
    assert isinstance(small.static_contact.space, CompressedSpace)
    # Without a penalty the bound rests on an estimate of the least eigenvalue; 1e-8 is measured.
    assert fy.compare(compressed, exact).max_relative_error < 1e-6


def test_the_switch_is_automatic_and_announced(caplog):
    model = fy.lap_joint(element_size=5.0).with_dense_budget(100)
    with caplog.at_level(logging.INFO, logger="faying"):
        assert isinstance(model.static_contact.space, CompressedSpace)
    assert "the compliance is compressed to" in caplog.text
    assert "dense budget of 1e+02 bytes" in caplog.text


def test_dense_matrices_beyond_the_budget_are_refused():
    model = fy.lap_joint(element_size=5.0).with_dense_budget(100)
    with pytest.raises(ModelError, match="112 contact points exceeds the dense budg"):
        _ = model.static_contact.flexibility


def test_the_bound_holds_for_coarse_compression(joint):
    """A tolerance loose enough to be seen: the true error stays below what is reported."""
    contact, structure = joint.contact, joint.structure
    D, N, S = contact.flexibility, contact.interpolation, joint.port_compliance.relative
    held = structure.held_compliance
    smooth = structure.relative_operator @ structure.constraint_modes
    core = np.linalg.inv(structure.boundary_stiffness)
    for tolerance in (1e-1, 1e-3):
        coarse = compress(lambda members: held[:, members], contact.places, tolerance, largest=8)
        assert coarse.error > 0
        space = CompressedSpace(N=N, S=coarse.plus(smooth, core), D=D)
        for g_free in joint.contact.free_gap(moved_freely(joint, 3)):
            exact = solve_complementarity(dense_points(N, S, D), g_free)
            mine = space.solve(g_free)
            error = np.sqrt((mine.forces - exact.forces) ** 2 @ D)
            assert error <= mine.error * np.sqrt(mine.forces**2 @ D)
