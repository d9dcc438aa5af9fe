"""Linear pieces between pairs, from one to the next, against blocks solved one by one."""

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.assessment.load_path import Walk, load_path
from faying.contact import pair_pieces
from faying.contact.linear_pieces import PointPiece
from faying.contact.pair_pieces import PairPiece
from faying.contact.supported_pairs import InaccurateError, SupportedPairs


def problem(rng, *, rank=20):
    """Sixty points between twenty pairs, each between three of them."""
    half = rng.normal(size=(20, rank))
    columns = np.array([rng.choice(20, 3, replace=False) for _ in range(60)])
    entries = (rng.uniform(0.2, 1, 180), (np.repeat(np.arange(60), 3), columns.ravel()))
    N, D = sp.csr_array(entries, shape=(60, 20)), rng.uniform(0.5, 1, 60)
    S = half @ half.T
    H = N @ S @ N.T + np.diag(D)
    return SupportedPairs(N=N, S=S, D=D, own=np.diag(H)), H, rng.normal(size=(60, 2))


@pytest.mark.parametrize(("least", "unproved"), [(0, 0), (10, 3), (1000, 10_000)])
@pytest.mark.parametrize("rank", [20, 12])
def test_walks_from_piece_to_piece(monkeypatch, least, unproved, rank):
    monkeypatch.setattr(pair_pieces, "MOST_CHANGES", 0.0)
    monkeypatch.setattr(pair_pieces, "LEAST_CHANGES", least)
    monkeypatch.setattr(pair_pieces, "UNPROVED", unproved)
    rng = np.random.default_rng(1)
    pairs, H, sides = problem(rng, rank=rank)
    active = rng.random(60) < 0.5
    piece, points = PairPiece.of(pairs, sides, active), PointPiece.of(H, sides)
    for _ in range(40):
        active = active ^ (rng.random(60) < 0.03)  # points come, go and come back
        piece, points = piece.moved_to(active), points.moved_to(active)
        # Round-off times the condition of H, some 1e3, and two hundred changes at worst.
        assert piece.forces == pytest.approx(points.forces, rel=1e-9, abs=1e-10)
        assert not piece.forces[~active].any()
        assert piece.slack[~active] == pytest.approx(points.slack[~active], rel=1e-9, abs=1e-9)
        away = np.flatnonzero(~active)[:5]
        assert piece.between(away) == pytest.approx(points.between(away), rel=1e-9, abs=1e-9)


def test_path_that_pairs_cannot_prove_is_followed_between_points(joint, monkeypatch):
    load = fy.Load({"tip.Fx": 3e3, "tip.Fz": -400.0})
    expected = load_path(joint, load)
    with monkeypatch.context() as strict:
        strict.setattr(pair_pieces, "CLOSED", -1.0)
        strict.setattr(pair_pieces, "ROUND_OFF", -1.0)
        with pytest.raises(InaccurateError):
            PairPiece.of(joint.static_contact.supported_pairs, np.ones((112, 2)), np.ones(112) > 0)
        found = load_path(joint, load)
    # Both are exact to 1e-9 of the largest force.
    assert found.factors == pytest.approx(expected.factors, rel=1e-8)
    largest = expected.forces.max()
    assert found.forces == pytest.approx(expected.forces, abs=1e-9 * largest)


@pytest.mark.parametrize("of", ["pairs", "points"])
def test_a_stiff_flange_lets_go_everywhere_at_once(of):
    """Gap and forces vanish together there, and nothing of them tells how large round-off is."""
    rng = np.random.default_rng(2)
    for _ in range(20):
        half = rng.normal(size=(30, 30))
        half -= half.mean(axis=0)  # moves of single pairs, none of all together
        S = half @ half.T + np.full((30, 30), rng.uniform(0.1, 10.0))
        N, D = sp.eye_array(30, format="csr"), np.full(30, rng.uniform(0.01, 1.0))
        H = S + np.diag(D)
        opening = rng.uniform(0.3, 30.0)
        sides = np.column_stack([-np.ones(30), np.full(30, 1.0 / opening)])
        pairs = SupportedPairs(N=N, S=S, D=D, own=np.diag(H))
        at_rest = np.linalg.solve(H, np.ones(30))
        every = at_rest > 0
        piece = PairPiece.of(pairs, sides, every) if of == "pairs" else PointPiece.of(H, sides)
        walk = Walk(a=sides[:, 0], b=sides[:, 1], at_rest=at_rest)
        factors, forces, closed, rate, ended = walk.followed(piece, np.inf)
        # One kink, of as many digits as the condition of H leaves.
        assert factors == pytest.approx([0.0, opening], rel=1e-10)
        assert ended
        assert not closed[-1].any()
        assert not rate.any()
        assert forces[-1] == pytest.approx(0.0, abs=1e-10 * at_rest.max())
