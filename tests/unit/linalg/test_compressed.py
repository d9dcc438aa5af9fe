"""Compressed symmetric matrices against the dense ones they stand for."""

import numpy as np
import pytest

from faying.linalg.clusters import geometric_clusters
from faying.linalg.compressed import compress, cross_approximation, plus, smooth_compliance
from faying.reduction.stored_compliance import stored_compliance


@pytest.fixture(scope="module")
def places():
    return np.random.default_rng(0).uniform(0, 1, (900, 3)) * [30.0, 20.0, 0.0]


@pytest.fixture(scope="module")
def dense(places):
    """The kernel of an elastic half-space, 1/r, softened at the size of an element."""
    distance = np.linalg.norm(places[:, None] - places, axis=2)
    return 1.0 / np.hypot(distance, 1.0)


@pytest.fixture(scope="module")
def compressed(dense, places):
    return compress(lambda members: dense[:, members], places)


def test_clusters_hold_every_place_once(places):
    clusters = geometric_clusters(places, largest=50)
    np.testing.assert_array_equal(np.sort(np.concatenate(clusters)), np.arange(900))
    assert max(map(len, clusters)) <= 50


def test_clusters_of_coincident_places_end():
    assert sum(map(len, geometric_clusters(np.zeros((100, 3)), largest=8))) == 100


def test_products_stay_within_the_reported_error(compressed, dense):
    error = compressed @ np.eye(900) - dense
    # The Frobenius norm is what is reported; 1 for round-off of 900² sums of 1e-16.
    assert np.linalg.norm(error) <= compressed.error + 1e-12
    assert compressed.error <= 1e-9 * dense.diagonal().min()
    vector = np.random.default_rng(1).standard_normal(900)
    assert np.linalg.norm(compressed @ vector - dense @ vector) <= 1e-8


def test_a_looser_tolerance_takes_less_memory_and_is_kept(dense, places, compressed):
    loose = compress(lambda members: dense[:, members], places, tolerance=1e-3)
    assert loose.n_bytes < 0.8 * compressed.n_bytes < 0.8 * dense.nbytes
    assert np.linalg.norm(loose @ np.eye(900) - dense) <= loose.error + 1e-12  # round-off
    assert 1e-8 < loose.error <= 1e-3 * dense.diagonal().min()


def test_diagonal_blocks_are_exact(compressed, dense):
    for number, members in enumerate(compressed.clusters):
        np.testing.assert_array_equal(compressed.block(number), dense[np.ix_(members, members)])


def test_some_rows_and_columns(compressed, dense):
    rows = np.random.default_rng(4).permutation(900)[:70]
    some = compressed.plus(np.ones((900, 1)), np.eye(1)).principal(rows)
    # 1e-9 is the tolerance of the compression.
    np.testing.assert_allclose(some, dense[np.ix_(rows, rows)] + 1.0, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(some, some.T)


def test_sums_and_multiples(compressed, dense, places):
    rng = np.random.default_rng(2)
    smooth, core = rng.standard_normal((900, 3)), np.diag([1.0, 2.0, 3.0])
    total = 0.5 * dense + smooth @ core @ smooth.T
    one = plus(compressed.scaled(0.5), smooth, core)
    other = compressed.scaled(0.5).added(smooth_compliance(smooth, core, places))
    for candidate in (one, other):
        # 1e-9 is the tolerance of the compression.
        np.testing.assert_allclose(candidate @ np.eye(900), total, rtol=0, atol=1e-8)
        first = candidate.clusters[0]
        np.testing.assert_allclose(candidate.block(0), total[np.ix_(first, first)], atol=1e-12)
    np.testing.assert_allclose(plus(0.5 * dense, smooth, core), total, atol=1e-12)  # round-off


@pytest.mark.parametrize("rank", [0, 1, 7])
def test_cross_approximation_finds_the_rank(rank):
    rng = np.random.default_rng(3)
    block = rng.standard_normal((40, rank)) @ rng.standard_normal((rank, 30))
    left, right, missed = cross_approximation(block, 1e-10)
    assert left.shape[1] == right.shape[1] == rank
    assert missed <= 1e-10
    np.testing.assert_allclose(left @ right.T, block, rtol=0, atol=1e-10)


def test_what_files_keep_has_the_same_products_to_the_bit(compressed, places):
    rng = np.random.default_rng(1)
    smooth = rng.normal(size=(4, 900)).T
    whole = compressed.plus(smooth, np.eye(4))
    same = stored_compliance(whole).compliance(places, "compliance")
    vectors = rng.normal(size=(900, 3))
    assert len(whole.clusters) > 1
    np.testing.assert_array_equal(same @ vectors, whole @ vectors)
    np.testing.assert_array_equal(same.principal(np.arange(50)), whole.principal(np.arange(50)))
    assert same.error == whole.error
