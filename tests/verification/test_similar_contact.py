"""Elastic contact solved for displacements, each problem from the last, against active sets."""

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse as sp

from faying.contact.active_set import solve_complementarity
from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.contact.dense_points import DensePoints
from faying.contact.laws import Penalty
from faying.contact.yielding import YieldingContact

N_PAIR, N_POINT = 60, 240
STIFFNESS = 1e3


def parts(rng, sizes):
    """A compliance of these eigenvalues, and points with four pairs each on springs."""
    shapes = la.qr(rng.standard_normal((N_PAIR, N_PAIR)))[0][:, : len(sizes)]
    S = (shapes * sizes) @ shapes.T
    columns = np.array([rng.choice(N_PAIR, 4, replace=False) for _ in range(N_POINT)])
    shares = rng.uniform(0.05, 1.0, (N_POINT, 4))
    shares /= shares.sum(axis=1, keepdims=True)
    rows = np.repeat(np.arange(N_POINT), 4)
    N = sp.csr_array((shares.ravel(), (rows, columns.ravel())), shape=(N_POINT, N_PAIR))
    contact = Contact(
        relative_operator=np.eye(N_PAIR),
        interpolation=N,
        initial_gap=1e-2 * rng.standard_normal(N_POINT),
        weights=rng.uniform(1.0, 10.0, N_POINT),
        laws={"joint": Penalty(STIFFNESS)},
        slices={"joint": slice(0, N_POINT)},
    )
    return CondensedContact(contact=contact, compliance=(S + S.T) / 2)


def drifting(rng, count):
    """What pairs move without contact in a joint that opens here and closes there."""
    start, end = (rng.standard_normal(N_PAIR) - 1.0 for _ in range(2))
    return [(1 - t) * start + t * end for t in np.linspace(0.0, 0.5, count)]


@pytest.mark.parametrize("sizes", [np.geomspace(1.0, 1e-2, N_PAIR), np.ones(5)], ids=["", "rank 5"])
def test_a_drifting_contact_is_that_solved_anew(sizes):
    rng = np.random.default_rng(0)
    condensed, state = parts(rng, sizes), None
    solver, points = condensed.increments, DensePoints(H=condensed.flexibility)
    assert isinstance(solver, YieldingContact)
    for free in drifting(rng, 20):
        state = solver.solve(free, condensed.contact.offset(), state)
        anew = solve_complementarity(points, condensed.contact.free_gap(free))
        # Round-off times stiffness over structure, 1e4.
        small = 1e-10 * max(anew.forces.max(), 1.0)
        np.testing.assert_allclose(state.forces[0], anew.forces, rtol=0, atol=small)
        assert (state.forces[0] >= 0).all()


def test_the_same_call_gives_the_same_digits_whatever_ran_before():
    rng = np.random.default_rng(7)
    condensed = parts(rng, np.geomspace(1.0, 1e-2, N_PAIR))
    solver, frees, offset = condensed.increments, drifting(rng, 6), condensed.contact.offset()
    start = solver.solve(frees[0], offset)
    first = solver.solve(frees[3], offset, start)
    for free in frees:
        solver.solve(free, offset, start)
    np.testing.assert_array_equal(first.forces, solver.solve(frees[3], offset, start).forces)
