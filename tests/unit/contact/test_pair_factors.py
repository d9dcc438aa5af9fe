"""Factors between changed pairs, updated to other points, against products with the system."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from faying.contact.between_pairs import ByCompliance
from faying.contact.glued_pairs import GluedPairs
from faying.contact.held_pairs import change_from
from faying.contact.pair_factors import Factors, PairSystem, Room
from few_points import ELASTIC, PAIRS, N, joint


@pytest.mark.parametrize("seed", range(4))
def test_factors_are_updated_to_other_points_and_more_pairs(seed, monkeypatch):
    """Those that the first ones know, others, and both; by fewer components at points, or pairs."""
    monkeypatch.setattr("faying.contact.pair_factors.MOST_UPDATED", 9.0)
    monkeypatch.setattr("faying.contact.pair_factors.STIFFNESS_CHANGE", 0.0)
    plain, _ = joint(seed, ELASTIC)
    pairs = GluedPairs.of(plain.contact.rows, plain.laws.springs, ByCompliance(plain.S))
    random, glued = np.random.default_rng(seed), pairs.glued

    def changed(points):
        K = np.zeros((N, 3, 3))
        K[:, np.arange(3), np.arange(3)] = glued.springs.T
        K[points] *= random.uniform(0.2, 0.5, (len(points), 3, 3))
        change = change_from(glued.springs, K)
        rows, columns = pairs.points.touched(change)
        block = pairs.points.between_pairs(change)[:, columns]
        between = glued.compliance[columns]
        return K, rows, lambda r: PairSystem(r, columns, block[r], between[:, r])

    K, rows, system = changed([0])
    first = Factors.of(glued, K, system(rows), pairs.room)
    assert len(rows) < 3 * PAIRS
    for points, acting in (([0], 3), ([0, N - 1], 6), ([N - 1], 6), (range(N), 3 * PAIRS)):
        K, rows, system = changed(list(points))
        factors = first.updated(K, rows, pairs.points)
        assert factors.update.places.shape[1] == acting
        right = random.normal(size=len(factors.system.rows))
        product = system(factors.system.rows).times(factors.solve(right))
        # Single precision.
        np.testing.assert_allclose(product, right, rtol=0, atol=1e-5)
        assert factors.updated(K, rows, pairs.points) is factors
    monkeypatch.setattr("faying.contact.pair_factors.MOST_UPDATED", 0.0)
    assert first.updated(K, rows, pairs.points) is None


def test_threads_have_rooms_of_their_own():
    """Factors of one are not overwritten by another's; the same thread's next ones take theirs."""
    room = Room(5)
    mine = room.factors(4)
    with ThreadPoolExecutor(1) as other:
        assert not np.shares_memory(mine, other.submit(room.factors, 4).result())
    assert np.shares_memory(mine, room.factors(5))
    assert not np.shares_memory(room.between(5, 4, mine), room.factors(5))
