"""Proper orthogonal decomposition against the singular value decomposition it is."""

import numpy as np
import pytest
import scipy.linalg as la
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from faying.exceptions import ModelError
from faying.reduction.pod import pod

ENTRIES = st.floats(-10, 10, allow_subnormal=False).map(lambda x: round(x, 3))


@st.composite
def snapshots(draw):
    shape = (draw(st.integers(1, 12)), draw(st.integers(1, 12)))
    Y = draw(arrays(float, shape, elements=ENTRIES))
    assume(Y.any())
    return Y


@st.composite
def weighted(draw):
    Y = draw(snapshots())
    B = draw(arrays(float, (len(Y), len(Y)), elements=st.floats(-1, 1)))
    return Y, B.T @ B + np.eye(len(Y))  # condition below 13


@settings(max_examples=150)
@given(weighted(), st.integers(1, 12))
def test_modes_are_orthonormal_in_the_inner_product(drawn, count):
    Y, W = drawn
    modes = pod(Y, inner=W, count=count)
    identity = modes.vectors.T @ W @ modes.vectors
    # Round-off times the condition of W.
    np.testing.assert_allclose(identity, np.eye(len(identity)), rtol=0, atol=1e-12)
    assert modes.vectors.shape[1] <= count
    assert (np.diff(modes.singular_values) <= 0).all()


@pytest.mark.long
@settings(max_examples=150)
@given(weighted(), st.integers(1, 12))
def test_missed_energy_is_what_is_discarded(drawn, count):
    Y, W = drawn
    modes = pod(Y, inner=W, count=count)
    rest = Y - modes.vectors @ (modes.vectors.T @ W @ Y)
    missed, total = np.trace(rest.T @ W @ rest), np.trace(Y.T @ W @ Y)
    # A difference of numbers of the size of the total.
    assert missed == pytest.approx(modes.discarded * total, abs=1e-12 * total)


@settings(max_examples=100)
@given(snapshots())
def test_equals_the_singular_value_decomposition(Y):
    modes = pod(Y)
    left, values, _ = la.svd(Y, full_matrices=False)
    kept = len(modes.singular_values)
    small = 1e-12 * values[0]  # round-off of an SVD, and the rank at which it is cut
    np.testing.assert_allclose(modes.singular_values, values[:kept], rtol=0, atol=small)
    assert (values[kept:] <= 2 * small).all()
    gaps = values[:kept] - np.append(values[1:kept], values[kept] if kept < len(values) else 0)
    assume(kept == 1 or np.abs(np.diff(values[:kept])).min() > 1e-3 * values[0])
    assume(gaps.min() > 1e-3 * values[0])
    # Vectors of separate values are determined but for their sign.
    overlap = np.abs(np.einsum("ni,ni->i", modes.vectors, left[:, :kept]))
    np.testing.assert_allclose(overlap, 1.0, rtol=0, atol=1e-9)


@settings(max_examples=100)
@given(weighted())
def test_eigenvalues_of_the_gram_matrix_are_the_squares(drawn):
    Y, W = drawn
    squares = np.zeros(Y.shape[1])
    values = pod(Y, inner=W).singular_values
    squares[: len(values)] = values**2
    difference = np.linalg.eigvalsh(Y.T @ W @ Y)[::-1] - squares
    # The eigenproblem knows squares to round-off.
    np.testing.assert_allclose(difference, 0, atol=1e-12 * squares[0])


@settings(max_examples=100)
@given(weighted(), st.integers(1, 4))
def test_snapshots_of_low_rank(drawn, copies):
    Y, W = drawn
    rank = np.linalg.matrix_rank(Y, tol=1e-9 * np.abs(Y).max())
    repeated = np.hstack([Y * factor for factor in range(1, copies + 2)])
    modes = pod(repeated, inner=W)
    assert len(modes.singular_values) <= min(Y.shape)
    assert len(modes.singular_values) >= rank
    rest = repeated - modes.vectors @ (modes.vectors.T @ W @ repeated)
    # All of them are in the span of the modes, to round-off.
    assert np.abs(rest).max() < 1e-9 * np.abs(repeated).max()


def test_discarded_energy_falls_with_every_mode():
    Y = np.random.default_rng(0).standard_normal((30, 12))
    missed = [pod(Y, count=count).discarded for count in range(1, 13)]
    assert (np.diff(missed) < 0).all()
    assert missed[-1] == 0


def test_modes_are_nested():
    Y = np.random.default_rng(1).standard_normal((30, 12))
    np.testing.assert_array_equal(pod(Y, count=4).vectors, pod(Y, count=9).vectors[:, :4])


def test_what_is_left_of_round_off_is_no_mode():
    assert len(pod(np.diag([1.0, 1.5e-12])).singular_values) == 2
    assert len(pod(np.diag([1.0, 0.9e-12])).singular_values) == 1


@pytest.mark.parametrize(
    "bad", [np.zeros((3, 2)), np.full((3, 2), np.nan), np.ones(3), np.full((2, 2), np.inf)]
)
def test_refuses_what_is_no_collection(bad):
    with pytest.raises(ModelError, match="finite, nonzero matrix"):
        pod(bad)


def test_refuses_an_indefinite_inner_product():
    with pytest.raises(ModelError, match="not positive definite"):
        pod(np.eye(3), inner=np.diag([1.0, 1.0, -1.0]))
