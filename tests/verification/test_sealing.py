"""Sealing: the best ring around a hole against thresholds, by hand and with random pressures."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.csgraph import minimum_spanning_tree

import faying as fy
from faying.assessment.sealing import ring_around, ring_pressure
from faying.exceptions import ModelError
from faying.reduction.projection import contact_surfaces


def _surface(size, **keys):
    return contact_surfaces(fy.lap_joint(element_size=size, **keys))["joint"]


SAME = 1e-14
"""Of sums of a few numbers, in another order."""


@pytest.fixture(scope="module")
def face():
    return _surface(2.5)


def by_thresholds(ring, nodal):
    """Smallest pressure up to which nodes join hole and rim, by a spanning tree."""
    rank = np.empty(len(nodal))
    rank[nodal.argsort()] = np.arange(1, len(nodal) + 1)
    a, b = ring.links.T
    tree = minimum_spanning_tree(
        sp.coo_array((np.maximum(rank[a], rank[b]), (a, b)), shape=(len(nodal),) * 2).tocsr()
    ).tocoo()
    for limit in np.sort(rank):
        kept = (tree.data <= limit) & (rank[tree.row] <= limit) & (rank[tree.col] <= limit)
        graph = sp.coo_array(
            (np.ones(kept.sum()), (tree.row[kept], tree.col[kept])), shape=(len(nodal),) * 2
        )
        _, label = sp.csgraph.connected_components(graph.tocsr(), directed=False)
        inside = label[ring.inside[rank[ring.inside] <= limit]]
        if np.isin(label[ring.outside[rank[ring.outside] <= limit]], inside).any():
            return nodal[rank == limit][0]
    return np.inf


def test_hole_and_rim_are_told_apart(face):
    ring = ring_around(face, (0.0, 0.0, 0.0))
    inside, outside = (
        np.linalg.norm(face.pair_points[n, :2], axis=1) for n in (ring.inside, ring.outside)
    )
    assert inside.max() < 6.0 < outside.min()  # hole of radius 4.2, 10 to the nearest side


@pytest.mark.parametrize("seed", range(5))
def test_random_pressures(face, seed):
    ring = ring_around(face, (0.0, 0.0, 0.0))
    pressure = np.random.default_rng(seed).random((2, len(face.weights)))
    nodal = pressure @ face.averaging.T
    expected = [by_thresholds(ring, one) for one in nodal]
    assert ring_pressure(ring, pressure) == pytest.approx(expected, rel=SAME)


def test_a_gate_decides(face):
    """Pressure 5 all around but 2 in a sector, nothing elsewhere."""
    ring = ring_around(face, (0.0, 0.0, 0.0))
    x, y = face.points[:, :2].T
    square = np.maximum(np.abs(x), np.abs(y))
    wall = 5.0 * ((square > 5.0) & (square < 10.0))
    gate = np.where((x > 0) & (np.abs(y) < 5.0), 2.0 / 5.0, 1.0)
    cases = np.array([wall, wall * gate, wall * (gate == 1)])
    assert ring_pressure(ring, cases) == pytest.approx([5.0, 2.0, 0.0], abs=1e-12)  # averages


def test_quadratic_facets_leak_along_their_middles(face):
    finer = _surface(5.0, shape="hex20")
    ring = ring_around(finer, (0.0, 0.0, 0.0))
    pressure = np.random.default_rng(1).random((1, len(finer.weights)))
    expected = by_thresholds(ring, (pressure @ finer.averaging.T)[0])
    assert ring_pressure(ring, pressure)[0] == pytest.approx(expected, rel=SAME)


def test_an_interface_without_hole_has_no_ring():
    with pytest.raises(ModelError, match="is its only one, so no ring"):
        ring_around(_surface(5.0, hole_radius=0.0), (0.0, 0.0, 0.0))


def test_a_ring_of_no_interface_is_refused():
    joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    wanted = fy.Requirements(closed_ring=(fy.ClosedRing(around=(0, 0, 0), interface="seal"),))
    with pytest.raises(ModelError, match="closed_ring: there is no interface 'seal'"):
        fy.assess(joint, [fy.Load({"tip.Fz": -1.0})], wanted, paths=False)


def test_the_ring_of_a_load_case_is_judged():
    joint = fy.preload(fy.lap_joint(element_size=2.5), {"bolt": 10e3})
    loads = [fy.Load({"tip.Fz": -f}, name=f"{f}") for f in (0.0, 400.0)]
    ring = fy.ClosedRing(around=(0.0, 0.0, 0.0), pressure=1.0)
    wanted = fy.Requirements(closed_ring=(ring, replace(ring, pressure=1e3)))
    lenient, strict = fy.assess(joint, loads, wanted, paths=False).verdicts
    assert lenient.value == strict.value
    assert (strict.met, strict.limit) == (False, 1e3)
    around = ring_around(_surface(2.5), ring.around)
    each = [ring_pressure(around, fy.solve_static(joint, one).pressure[None])[0] for one in loads]
    assert lenient.value == pytest.approx(min(each), rel=1e-9)  # solved one by one
    assert lenient.met == (min(each) >= 1.0)
