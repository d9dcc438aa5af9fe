"""Counts of negative eigenvalues against dense ones and closed forms, on every backend."""

import gc

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import faying as fy
from faying.linalg.backends import available_backends, count_negative
from faying.linalg.mkl import PardisoHandle
from faying.linalg.singular import InertiaError

BACKENDS = available_backends()


@pytest.fixture(params=BACKENDS)
def backend(request):
    return request.param


@settings(max_examples=60)
@given(
    n=st.integers(1, 60),
    density=st.floats(0, 0.3),
    dofs=st.sampled_from([1, 2, 3]),  # with and without the blocks of a node
    negative=st.integers(0, 60),
    seed=st.integers(0, 1000),
)
def test_congruence_keeps_the_signs(n, density, dofs, negative, seed):
    """L D Lᵀ has the signs of D (Sylvester), L being triangular with a unit diagonal."""
    rng = np.random.default_rng(seed)
    strict = sp.tril(sp.random_array((n, n), density=density, rng=rng), -1) / np.sqrt(n)
    signs = np.where(np.arange(n) < min(negative, n), -1.0, 1.0)
    lower = (strict + sp.eye_array(n)).tocsr()
    one = lower @ sp.diags_array(rng.permutation(signs) * rng.uniform(0.5, 2, n)) @ lower.T
    A = sp.kron(one, np.eye(dofs) + 0.1).tocsr()
    for backend in BACKENDS:
        assert count_negative(A, backend=backend) == dofs * min(negative, n)
    assert count_negative(A.toarray()) == dofs * min(negative, n)


def test_a_bar_of_known_frequencies(backend):
    """A chain fixed at one end: λ_j = 4 sin²((2j - 1) π / (4n + 2))."""
    n = 3000
    main = np.append(np.full(n - 1, 2.0), 1.0)
    K = sp.diags_array([-np.ones(n - 1), main, -np.ones(n - 1)], offsets=[-1, 0, 1]).tocsr()
    exact = 4 * np.sin((2 * np.arange(1, n + 1) - 1) * np.pi / (4 * n + 2)) ** 2
    for below in (0, 1, 7, 1500, 2999):
        shift = 0.5 * (exact[below - 1] if below else 0.0) + 0.5 * exact[below]
        shifted = K - shift * sp.eye_array(n)
        assert count_negative(shifted, backend=backend) == below


def test_every_gap_of_a_solid(backend):
    structure = fy.lap_joint(element_size=10.0).structure
    inner = structure.interior
    K, M = (matrix[inner][:, inner] for matrix in (structure.K, structure.M))
    squares = la.eigh(K.toarray(), M.toarray(), eigvals_only=True)
    for below in range(0, len(squares) - 1, 29):
        # Not in gaps that round-off fills.
        if squares[below + 1] > squares[below] * (1 + 1e-6):
            shift = (squares[below] + squares[below + 1]) / 2
            assert count_negative(K - shift * M, backend=backend) == below + 1


@pytest.mark.parametrize("copies", [2, 5])
def test_multiple_eigenvalues_count_as_often(backend, copies):
    one = sp.diags_array([-np.ones(39), np.full(40, 1.5), -np.ones(39)], offsets=[-1, 0, 1])
    A = sp.block_diag([one] * copies, format="csr")
    below = np.count_nonzero(np.linalg.eigvalsh(one.toarray()) < 0)
    assert below > 0
    assert count_negative(A, backend=backend) == copies * below


@pytest.mark.parametrize(
    "A",
    [
        [[0.0, 0.0], [0.0, 1.0]],
        [[1.0, 1.0], [1.0, 1.0]],
        [[1.0, 1e9], [1e9, 1.0]],  # the diagonal alone would do, and lose all digits
    ],
)
def test_doubtful_signs_are_refused_or_right(backend, A):
    exact = np.linalg.eigvalsh(A)
    try:
        found = count_negative(sp.csr_array(np.array(A)), backend=backend)
    except InertiaError as error:
        assert "cannot be counted" in str(error)  # noqa: PT017  either outcome is right
        return
    assert np.abs(exact).min() > 1e-12
    assert found == np.count_nonzero(exact < 0)


def test_a_pivot_off_the_diagonal_is_refused():
    """SuperLU turns to one where the diagonal is zero, and signs are no longer kept."""
    A = np.kron([[0.0, 1.0], [1.0, 0.0]], np.eye(30)) + 0.0
    with pytest.raises(InertiaError, match="cannot be counted"):
        count_negative(sp.csr_array(A), backend="superlu")


def test_factors_that_do_not_stand_for_the_matrix_are_refused(backend, monkeypatch):
    A = sp.diags_array(np.arange(40) - 13.5).tocsr()
    assert count_negative(A, backend=backend) == 14
    monkeypatch.setattr("faying.linalg.singular.ROUND_OFF", -1.0)
    with pytest.raises(InertiaError, match="the factors are off by"):
        count_negative(A, backend=backend)


@pytest.mark.skipif("pardiso" not in BACKENDS, reason="MKL is not installed")
def test_nothing_is_left_in_memory(monkeypatch):
    gc.collect()  # factorizations that other tests left are none of this one's
    released = []
    release = PardisoHandle.release
    monkeypatch.setattr(
        PardisoHandle, "release", lambda handle: (released.append(handle), release(handle))
    )
    count_negative(sp.eye_array(9, format="csr"), backend="pardiso")
    assert len(released) == 1


def test_empty_matrices_have_none(backend):
    assert count_negative(sp.csr_array((0, 0)), backend=backend) == 0
