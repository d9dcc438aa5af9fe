"""Trial vectors that remember what kind they are."""

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.exceptions import ModelError
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.jim_a import unit_pressure_loads
from faying.reduction.normal_modes import fixed_interface_normal_modes, lowest_modes
from faying.reduction.subareas import subareas

C, N, B, J = ModeKind.CONSTRAINT, ModeKind.NORMAL, ModeKind.BOLT, ModeKind.JOINT


def some_basis():
    return Basis(vectors=np.arange(12.0).reshape(2, 6), kinds=(C, N, J, B, J, J))


def test_counts_and_selects_kinds():
    basis = some_basis()
    assert len(basis) == 6
    assert basis.count(J) == 3
    np.testing.assert_array_equal(basis.of_kind(J), [[2, 4, 5], [8, 10, 11]])
    np.testing.assert_array_equal(basis.of_kind(C, B), [[0, 3], [6, 9]])


@pytest.mark.parametrize(("count", "kept"), [(0, [0, 1, 3]), (2, [0, 1, 2, 3, 4]), (9, range(6))])
def test_fewer_joint_modes(count, kept):
    shorter = some_basis().with_joint_modes(count)
    np.testing.assert_array_equal(shorter.vectors[0], list(kept))
    assert shorter.count(N) == shorter.count(C) == shorter.count(B) == 1


def test_sum_keeps_order():
    both = some_basis() + Basis(vectors=np.ones((2, 1)), kinds=(N,))
    assert both.kinds == (C, N, J, B, J, J, N)
    np.testing.assert_array_equal(both.vectors[:, -1], 1)


def test_vectors_cannot_be_changed():
    vectors = np.ones((3, 1))
    basis = Basis(vectors=vectors, kinds=(N,))
    vectors[:] = 5.0
    assert basis.vectors.max() == 1.0
    with pytest.raises(ValueError, match="read-only"):
        basis.vectors[0, 0] = 2.0


def test_refuses_kinds_that_do_not_fit():
    with pytest.raises(ModelError, match="2 trial vectors but 1 kinds"):
        Basis(vectors=np.ones((3, 2)), kinds=(N,))


def test_orthonormalizing_drops_what_is_dependent():
    K = sp.diags_array([1.0, 4.0, 9.0, 16.0]).tocsr()
    a, b = np.array([1.0, 1, 0, 0]), np.array([0.0, 1, 1, 0])
    vectors = np.stack([np.array([0, 0, 0, 1.0]), a, b, a - 2 * b, 3 * a], axis=1)
    basis = Basis(vectors=vectors, kinds=(C, N, J, J, B)).orthonormalized(K)
    assert basis.kinds == (C, N, J)
    held = basis.of_kind(N, J, B)
    np.testing.assert_allclose(held.T @ (K @ held), np.eye(2), atol=1e-14)  # round-off
    np.testing.assert_array_equal(basis.of_kind(C), vectors[:, :1])
    np.testing.assert_allclose(held[:, 0], a / np.sqrt(5.0))  # the first keeps its direction


def test_orthonormalizing_survives_bad_scaling():
    rng = np.random.default_rng(0)
    K = sp.diags_array(np.geomspace(1, 1e8, 40)).tocsr()
    vectors = rng.standard_normal((40, 15)) * np.geomspace(1, 1e-12, 15)
    basis = Basis(vectors=vectors, kinds=(J,) * 15).orthonormalized(K)
    assert len(basis) == 15
    # "Twice is enough" keeps this at round-off whatever the scaling.
    np.testing.assert_allclose(basis.vectors.T @ (K @ basis.vectors), np.eye(15), atol=1e-12)


def test_orthonormalizing_survives_nearly_parallel_shapes():
    rng = np.random.default_rng(1)
    K = sp.diags_array(np.geomspace(1, 1e4, 40)).tocsr()
    common = rng.standard_normal((40, 1))
    vectors = common + 1e-6 * rng.standard_normal((40, 10))
    basis = Basis(vectors=vectors, kinds=(J,) * 10).orthonormalized(K)
    assert len(basis) == 10
    # One pass alone would leave round-off over the new part, 1e-16 / 1e-6.
    np.testing.assert_allclose(basis.vectors.T @ (K @ basis.vectors), np.eye(10), atol=1e-13)


def test_a_column_of_zeros_is_dropped():
    basis = Basis(vectors=np.array([[0.0, 1.0]]).T @ np.array([[1.0, 0.0]]), kinds=(N, J))
    assert basis.orthonormalized(sp.eye_array(2).tocsr()).kinds == (N,)


def test_craig_bampton_has_a_mode_for_everything(joint):
    basis = fy.craig_bampton(joint, normal_modes=7)
    assert basis.kinds == (C,) * 6 + (N,) * 7 + (B,)


def test_without_normal_modes(joint):
    basis = fy.craig_bampton(joint, normal_modes=0)
    assert basis.kinds == (C,) * 6 + (B,)


def test_refuses_more_normal_modes_than_there_are(joint):
    with pytest.raises(ModelError, match="99999 normal modes asked for"):
        fy.craig_bampton(joint, normal_modes=99999)


@pytest.mark.parametrize("count", [3, 100])  # Lanczos, and the dense solver where it has no room
def test_lowest_modes_of_a_chain(count):
    """Fixed chain of unit masses and springs: ω = 2 sin(k π / (2 (n + 1)))."""
    n = 120
    K = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n)).tocsr()
    M = sp.eye_array(n).tocsr()
    squares, vectors = lowest_modes(K, M, fy.factorize(K), count)
    expected = 4 * np.sin(np.arange(1, count + 1) * np.pi / (2 * (n + 1))) ** 2
    np.testing.assert_allclose(squares, expected, rtol=1e-10)  # round-off of the eigensolver
    np.testing.assert_allclose(vectors.T @ vectors, np.eye(count), atol=1e-10)


def test_normal_modes_leave_the_boundary_at_rest(joint):
    modes = fixed_interface_normal_modes(joint.structure, 5)
    np.testing.assert_array_equal(modes.vectors[joint.structure.boundary], 0)
    assert (np.diff(modes.frequencies) > 0).all()
    inner = joint.structure.interior
    rest = (
        joint.K @ modes.vectors - (joint.M @ modes.vectors) * (2 * np.pi * modes.frequencies) ** 2
    )
    assert np.abs(rest[inner]).max() < 1e-6 * np.abs(joint.K @ modes.vectors).max()  # eigsh


@pytest.mark.parametrize("count", [1, 4, 7, 28, 200])
def test_subareas_are_nearly_equal_and_whole(count, joint):
    interface = joint.interfaces["joint"]
    part = subareas(interface, count)
    expected = min(count, int(interface.face_of_point.max()) + 1)
    assert sorted(set(part.tolist())) == list(range(expected))
    facets = {(f, p) for f, p in zip(interface.face_of_point, part, strict=True)}
    assert len(facets) == 28  # no facet is divided
    area = np.bincount(part, interface.weights)
    assert area.max() <= 2.001 * area.min() or count == 7  # halves of halves; odd leaves differ
    assert area.sum() == pytest.approx(interface.area)


def test_unit_pressure_loads_add_up_to_uniform_pressure(joint):
    loads = unit_pressure_loads(joint, 10)
    assert loads.shape == (joint.K.shape[0], 10)
    uniform = joint.contact.gap_operator.T @ joint.contact.weights
    np.testing.assert_allclose(loads.sum(axis=1), uniform, atol=1e-10)  # sums of areas of 25
