"""Compliances that are not formed, against those that are."""

import numpy as np
import pytest
import scipy.sparse as sp

from faying.exceptions import ModelError
from faying.linalg.singular import NotDefiniteError
from faying.linalg.sparse_compliance import SparseCompliance, plus
from faying.linalg.sparse_stiffness import SparseStiffness

RANDOM = np.random.default_rng(0)
N = 60
ALONG = sp.diags_array([-np.ones(N - 1), 3.0 * np.ones(N), -np.ones(N - 1)], offsets=[-1, 0, 1])
PORTS = sp.csr_array((np.tile([1.0, -1.0], 12), ([*np.repeat(range(12), 2)], range(24))), (12, N))


@pytest.fixture
def sparse():
    return SparseCompliance.of(SparseStiffness.of(ALONG.tocsr(), PORTS))


@pytest.fixture
def dense():
    return PORTS @ np.linalg.solve(ALONG.toarray(), PORTS.T.toarray())


def shapes_of(dense, count):
    shapes = RANDOM.standard_normal((12, count))
    core = RANDOM.standard_normal((count, count))
    return shapes, 0.1 * (core + core.T) * dense[0, 0] / 12


def test_products(sparse, dense):
    shapes, core = shapes_of(dense, 3)
    forces = RANDOM.standard_normal((12, 2))
    mine = plus(sparse, shapes, core)
    assert mine.shape == (12, 12)
    np.testing.assert_allclose(mine @ forces, plus(dense, shapes, core) @ forces, rtol=1e-12)


@pytest.mark.parametrize("count", [0, 3, 20])
def test_stiffness_beside_shapes_more_than_ports_among_them(sparse, dense, count):
    shapes, core = shapes_of(dense, count)
    z, yields = sparse.plus(shapes, core).across
    stiffness = np.linalg.inv(dense) - z.T @ np.linalg.solve(yields, z)
    exact = np.linalg.inv(dense + shapes @ core @ shapes.T)
    np.testing.assert_allclose(stiffness, exact, rtol=0, atol=1e-9 * np.abs(exact).max())


def test_shapes_that_cancel_leave_nothing(sparse, dense):
    shapes, core = shapes_of(dense, 3)
    z, _ = sparse.plus(shapes, core).plus(2.0 * shapes, -core / 4.0).across
    assert len(z) == 0


def test_it_is_not_formed(sparse):
    with pytest.raises(ModelError, match="12 relative displacements, which exceed the dense bud"):
        np.asarray(sparse)


@pytest.mark.parametrize("yields", [0.0, 1e-9, 1.0])
def test_forces_that_close_gaps(sparse, dense, yields):
    rows = sp.csr_array(RANDOM.standard_normal((5, 12)))
    gaps = RANDOM.standard_normal((5, 2))
    forces = sparse.stiffness.pressing(rows, np.full(5, yields))(gaps)
    N = rows.toarray()
    exact = -np.linalg.solve(N @ dense @ N.T + yields * np.eye(5), gaps)
    np.testing.assert_allclose(forces, exact, rtol=1e-9)


def test_gaps_that_depend_on_each_other_are_refused(sparse):
    rows = sp.csr_array(np.eye(12)[[0, 0]])
    with pytest.raises(NotDefiniteError):
        sparse.stiffness.pressing(rows, np.zeros(2))
