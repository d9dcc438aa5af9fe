"""Trial vectors that remember what kind they are."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.exceptions import ModelError
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.jim_a import subareas, unit_pressure_loads
from faying.reduction.normal_modes import fixed_interface_normal_modes

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


@pytest.mark.parametrize(("share", "kinds"), [(1.5e-8, (N, J)), (0.9e-8, (N,))])
def test_a_shape_is_new_from_a_hundred_millionth_of_its_norm(share, kinds):
    vectors = np.array([[1.0, 1.0], [0.0, share]])
    K = sp.eye_array(2).tocsr()
    assert Basis(vectors=vectors, kinds=(N, J)).orthonormalized(K).kinds == kinds


def test_extending_by_blocks():
    """What is new in shapes of any size is orthonormal in K; what is not is left out."""
    rng = np.random.default_rng(2)
    root = rng.standard_normal((9, 9))
    K = root @ root.T + np.eye(9)
    raw = Basis(vectors=rng.standard_normal((9, 3)), kinds=(C, N, B))
    basis = raw.orthonormalized(K)
    a, b = rng.standard_normal((2, 9))
    known = basis.of_kind(N, B)
    shapes = np.stack([1e-6 * a, 0 * a, known[:, 1], 1e6 * b, b - known[:, 0], known[:, 0]], axis=1)
    longer = basis.extended(shapes, J, K)
    assert longer.kinds == (C, N, B, J, J)
    np.testing.assert_array_equal(longer.vectors[:, :3], basis.vectors)
    held = longer.of_kind(N, B, J)
    # Round-off of the second pass, which the first cannot have amplified.
    np.testing.assert_allclose(held.T @ K @ held, np.eye(4), rtol=0, atol=1e-12)
    unit = shapes[:, [0, 3]] / np.linalg.norm(shapes[:, [0, 3]], axis=0)
    np.testing.assert_allclose(held @ (held.T @ K @ unit), unit, rtol=0, atol=1e-10)


@pytest.mark.parametrize(("share", "new"), [(1.5e-12, 1), (0.9e-12, 0)])
def test_a_block_has_what_is_new_from_1e_12_of_its_energy(share, new):
    basis = Basis(vectors=np.eye(3, 1), kinds=(N,))
    shapes = np.array([[1.0], [np.sqrt(share)], [0.0]])
    longer = basis.extended(shapes, J, sp.eye_array(3).tocsr())
    assert longer.count(J) == new


def chain(n, mass=None):
    """Fixed chain of unit springs whose first joint is the boundary."""
    K = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n)).tocsr()
    M = sp.diags_array(np.ones(n) if mass is None else mass).tocsr()
    inner = np.arange(1, n)
    return SimpleNamespace(
        K=K,
        M=M,
        n_dof=n,
        interior=inner,
        has_mass=bool(M.diagonal().any()),
        interior_stiffness=K[inner][:, inner],
        interior_factor=fy.factorize(K[inner][:, inner]),
    )


def chain_frequencies(n):
    """Of the fixed chain of unit masses: ω = 2 sin(k π / (2 (n + 1)))."""
    return np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1))) / np.pi


@pytest.mark.parametrize("count", [1, 3, 29])  # by Lanczos, dense, and next to all there are
@pytest.mark.parametrize("n", [31, 120])
def test_normal_modes_of_a_chain(n, count):
    structure = chain(n)
    modes = fixed_interface_normal_modes(structure, count)
    expected = chain_frequencies(n - 1)
    np.testing.assert_allclose(modes.frequencies, expected[:count], rtol=1e-9)  # eigsh
    assert modes.next_frequency == pytest.approx(expected[count], rel=1e-9)
    assert modes.vectors.shape == (n, count)
    np.testing.assert_array_equal(modes.vectors[0], 0.0)
    mass = modes.vectors.T @ (structure.M @ modes.vectors)
    np.testing.assert_allclose(mass, np.eye(count), atol=1e-9)


def test_all_normal_modes_there_are():
    modes = fixed_interface_normal_modes(chain(8), 7)
    np.testing.assert_allclose(modes.frequencies, chain_frequencies(7), rtol=1e-12)
    assert modes.next_frequency == np.inf
    with pytest.raises(ModelError, match="8 normal modes asked for, but the structure has 7"):
        fixed_interface_normal_modes(chain(8), 8)


def test_massless_joints_have_no_modes_of_their_own():
    """Every second mass is none: the others on springs of half the stiffness, frequency by hand."""
    modes = fixed_interface_normal_modes(chain(4, mass=[1.0, 0.0, 1.0, 0.0]), 1)
    np.testing.assert_allclose(modes.frequencies, 1 / (2 * np.pi), rtol=1e-12)
    np.testing.assert_allclose(np.abs(modes.vectors[:, 0]), [0.0, 0.5, 1.0, 0.5], rtol=1e-12)


def test_statics_need_neither_modes_nor_mass():
    none = chain(5, mass=np.zeros(5))
    modes = fixed_interface_normal_modes(none, 0)
    assert modes.vectors.shape == (5, 0)
    assert modes.frequencies.shape == (0,)
    assert modes.next_frequency == np.inf
    with pytest.raises(ModelError, match="2 normal modes asked for, but the structure has no mass"):
        fixed_interface_normal_modes(none, 2)


@pytest.mark.parametrize("count", [0, 7])
def test_craig_bampton_has_a_mode_for_everything(count, joint):
    basis = fy.craig_bampton(joint, normal_modes=count)
    assert basis.kinds == (C,) * 6 + (N,) * count + (B,)


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
    np.testing.assert_allclose(loads.sum(axis=1), uniform, atol=1e-12)  # sums of areas of 25
