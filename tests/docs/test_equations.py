"""Equations (15.15) to (15.31) as they stand, on a coarse cantilever."""

import numpy as np
import pytest

import faying as fy
from faying.reduction.basis import ModeKind
from faying.reduction.jim_a import unit_pressure_loads
from faying.reduction.pod import pod

BOX = fy.LoadBox(ranges={"tip.Fz": (-500.0, 500.0), "tip.Mx": (-2e4, 2e4)}, levels=3)


@pytest.fixture(scope="module")
def training(joint):
    return fy.static_snapshots(joint, BOX.static_loads(joint))


@pytest.fixture(scope="module")
def bases(joint, classic, training):
    return {
        "classic": classic,
        "a": fy.jim_a(joint, joint_modes=8, classic=classic),
        "b": fy.jim_b(joint, training, joint_modes=8, classic=classic),
    }


@pytest.mark.long
def test_identity_basis_is_the_full_model(joint):
    boundary, inner = joint.structure.boundary, joint.structure.interior
    identity = np.eye(joint.structure.n_dof)[:, np.r_[boundary, inner]]
    kinds = (ModeKind.CONSTRAINT,) * len(boundary) + (ModeKind.NORMAL,) * len(inner)
    rom = fy.reduce(joint, fy.Basis(vectors=identity, kinds=kinds))
    load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})
    pairs = [
        [fy.solve_static(system, load) for system in (rom, joint)],
        [fy.solve_transient(system, load, step=1e-5, duration=1e-4) for system in (rom, joint)],
    ]
    for reduced, full in pairs:
        error = fy.compare(reduced, full)
        # Round-off times the condition of K, 1e7.
        assert error.max_relative_error < 1e-9
        assert error.displacement_error < 1e-9


@pytest.mark.parametrize("name", ["classic", "a", "b"])
def test_boundary_rows_of_a_basis_are_identity_and_zero(joint, bases, name):
    basis, boundary = bases[name], joint.structure.boundary
    rows = basis.vectors[boundary]
    expected = np.eye(len(boundary), len(basis))
    np.testing.assert_array_equal(rows, expected)
    assert set(boundary.tolist()) | set(joint.structure.interior.tolist()) == set(
        range(joint.structure.n_dof)
    )


@pytest.mark.parametrize("name", ["classic", "a", "b"])
def test_shapes_that_vanish_on_the_boundary_are_orthonormal(joint, bases, name):
    inner = bases[name].of_kind(ModeKind.NORMAL, ModeKind.BOLT, ModeKind.JOINT)
    gram = inner.T @ (joint.K @ inner)
    # Gram-Schmidt twice is orthogonal to round-off times the size of the sums.
    np.testing.assert_allclose(gram, np.eye(len(gram)), rtol=0, atol=1e-10)


def snapshots(rank=6, count=9, n=40):
    rng = np.random.default_rng(2)
    Y = rng.standard_normal((n, rank)) @ rng.standard_normal((rank, count))
    root = rng.standard_normal((n, n))
    return Y, root @ root.T + n * np.eye(n)


@pytest.mark.parametrize("weighted", [False, True])
def test_pod_modes_are_orthonormal(weighted):
    Y, W = snapshots()
    inner = W if weighted else np.eye(len(Y))
    modes = pod(Y, inner=W if weighted else None).vectors
    assert modes.shape[1] == 6  # the rank of the snapshots
    np.testing.assert_allclose(modes.T @ inner @ modes, np.eye(6), atol=1e-12)


@pytest.mark.parametrize("weighted", [False, True])
def test_pod_misses_what_the_discarded_values_say(weighted):
    Y, W = snapshots()
    inner = W if weighted else np.eye(len(Y))

    def missed(modes):
        rest = Y - modes @ (modes.T @ inner @ Y)
        return np.einsum("ij,ij->", rest, inner @ rest) / np.einsum("ij,ij->", Y, inner @ Y)

    found = pod(Y, inner=W if weighted else None, count=3)
    assert missed(found.vectors) == pytest.approx(found.discarded, rel=1e-9)
    # No other three directions do better, Eq. (15.20).
    rng = np.random.default_rng(3)
    for _ in range(20):
        trial = np.linalg.qr(found.vectors + 0.1 * rng.standard_normal((len(Y), 3)))[0]
        factor = np.linalg.cholesky(trial.T @ inner @ trial)
        assert missed(np.linalg.solve(factor, trial.T).T) > found.discarded


def test_pod_agrees_with_the_method_of_snapshots():
    Y, W = snapshots()
    found = pod(Y, inner=W)
    squares, vectors = np.linalg.eigh(Y.T @ W @ Y)
    largest = slice(None, -len(found.singular_values) - 1, -1)
    # The Gram matrix keeps half of the digits.
    np.testing.assert_allclose(np.sqrt(squares[largest]), found.singular_values, rtol=1e-7)
    by_gram = Y @ vectors[:, largest] / found.singular_values
    overlap = np.abs(np.diag(by_gram.T @ W @ found.vectors))
    np.testing.assert_allclose(overlap, 1.0, rtol=1e-7)


def test_unit_pressures_add_up_to_one_everywhere(joint):
    loads = unit_pressure_loads(joint, 12)
    assert loads.shape[1] == 12
    everywhere = joint.contact.gap_operator.T @ joint.contact.weights
    # Sums of about a hundred rounded terms.
    np.testing.assert_allclose(loads.sum(axis=1), everywhere, atol=1e-12)


def test_joint_modes_are_static_shapes_of_contact_forces(joint, bases):
    """K φ is zero but at the interface, at the boundary that is held, and where earlier shapes act.

    Only the span counts: orthonormalization mixes normal modes and bolt shapes into φ.
    """
    held = joint.structure.solve_held(unit_pressure_loads(joint, 200))
    inner = bases["a"].of_kind(ModeKind.NORMAL, ModeKind.BOLT, ModeKind.JOINT)
    before = bases["classic"].of_kind(ModeKind.NORMAL, ModeKind.BOLT)
    span = np.hstack([before, held])
    residual = inner - span @ np.linalg.lstsq(span, inner, rcond=None)[0]
    # Round-off times the condition of two hundred neighbouring loads.
    assert np.abs(residual).max() < 1e-8 * np.abs(inner).max()


def test_training_loads_fill_the_box(joint):
    statics, steps = BOX.static_loads(joint), BOX.step_loads()
    assert len(statics) == 3 * 3 * 3
    assert len(steps) == 8
    values = {(load.forces["tip.Fz"], load.forces["tip.Mx"]) for load in steps}
    assert (0.0, 0.0) not in values
    assert (-500.0, 2e4) in values


def test_method_b_reproduces_its_training(joint, classic, training):
    """With all its modes the basis holds every training force, hence every training solution."""
    everything = fy.jim_b(joint, training, joint_modes=training.shape[1], classic=classic)
    rom = fy.reduce(joint, everything)
    loads = BOX.static_loads(joint)
    fast, full = fy.solve_static_cases(rom, loads), fy.solve_static_cases(joint, loads)
    # The Ritz solution is the exact one where the basis contains it; shapes whose energy is 1e-8
    # of the largest are dropped.
    assert fy.compare(fast, full).max_relative_error < 1e-5


def test_step_snapshots_are_responses_from_rest(joint):
    loads = BOX.step_loads()[:2]
    forces = fy.step_snapshots(joint, loads, step=2e-5, duration=1e-4)
    assert forces.shape == (joint.contact.n_points, 2 * 6)
    at_rest = fy.solve_static(joint).contact_forces
    np.testing.assert_array_equal(forces[:, 0], at_rest)
    np.testing.assert_array_equal(forces[:, 6], at_rest)
    later = fy.solve_transient(joint, loads[1], step=2e-5, duration=1e-4)
    # side by side and alone the same systems are solved from other factorizations
    last = later.contact_forces[-1]
    np.testing.assert_allclose(forces[:, 11], last, rtol=0, atol=1e-10 * last.max())


def test_relative_error_is_over_the_largest_reference():
    error = fy.relative_error(np.array([1.0, 5.0]), np.array([2.0, 4.0]))
    np.testing.assert_allclose(error, [-0.25, 0.25])
