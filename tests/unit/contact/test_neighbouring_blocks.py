"""Blocks that differ by a few points against blocks factorized one by one."""

import numpy as np
import pytest

from faying.contact import neighbouring_blocks
from faying.contact.neighbouring_blocks import NeighbouringBlocks
from faying.exceptions import ModelError


def flexibility(n=60, seed=0):
    """Smooth between neighbours, as between contact points."""
    places = np.random.default_rng(seed).random((n, 2))
    apart = np.linalg.norm(places[:, None] - places[None], axis=-1)
    return np.exp(-3 * apart) + 0.1 * np.eye(n)


@pytest.mark.parametrize("most", [0, 5, 1000])
def test_walks_from_block_to_block(monkeypatch, most):
    monkeypatch.setattr(neighbouring_blocks, "MOST_CHANGES", most)
    H, rng = flexibility(), np.random.default_rng(1)
    blocks, active, right = NeighbouringBlocks(H=H), rng.random(60) < 0.5, rng.random((60, 2))
    for _ in range(200):
        active = active ^ (rng.random(60) < 0.02)  # points come, go and come back
        found, blocks = blocks.solved(active, right)
        expected = np.linalg.solve(H[np.ix_(active, active)], right[active])
        # 1e-11: round-off times the condition of H, about 300.
        assert found[active] == pytest.approx(expected, rel=1e-11, abs=1e-11)
        assert not found[~active].any()


def test_nothing_closed_carries_nothing():
    blocks = NeighbouringBlocks(H=flexibility())
    found, _ = blocks.solved(np.zeros(60, dtype=bool), np.ones((60, 2)))
    assert not found.any()


def test_points_that_make_the_block_singular_are_refused():
    H = flexibility()
    H[:, 7], H[7] = H[:, 3], H[3]  # two points at one place, without any penalty
    H[7, 7] = H[3, 3]
    active = np.ones(60, dtype=bool)
    active[7] = False
    _, blocks = NeighbouringBlocks(H=H).solved(active, np.ones((60, 1)))
    active[7] = True
    with pytest.raises(ModelError, match="contact forces are not unique"):
        blocks.solved(active, np.ones((60, 1)))
