"""A joint of a few contact points that all move each other, and Coulomb's law written out again."""

import numpy as np
import pytest
import scipy.sparse as sp

from faying.contact.augmented import AugmentedContact
from faying.contact.between_pairs import ByCompliance
from faying.contact.contact import Contact
from faying.contact.laws import Coulomb, Hard, Penalty
from faying.digits import SOLVED

N, PAIRS = 6, 4
FRICTION = np.array([0.4, 0.4, 0.4, 0.0, 0.2, 0.2])
WEIGHTS = np.array([1.0, 2.0, 0.5, 1.0, 3.0, 1.0])
LAWS = {
    "one": Coulomb(Penalty(2.0), 0.4, 1.5),
    "two": Penalty(5.0),
    "three": Coulomb(Hard(), 0.2, np.inf),
}
ELASTIC = LAWS | {"three": Coulomb(Penalty(20.0), 0.2, 15.0)}
PLACES = {"one": slice(0, 3), "two": slice(3, 4), "three": slice(4, N)}
YIELD = np.zeros((3, N))
YIELD[0, :4] = 1 / (np.array([2.0, 2.0, 2.0, 5.0]) * WEIGHTS[:4])
YIELD[1:, :3] = 1 / (1.5 * WEIGHTS[:3])
ELASTIC_YIELD = YIELD.copy()
ELASTIC_YIELD[:, 4:] = 1 / (np.array([[20.0], [15.0], [15.0]]) * WEIGHTS[4:])
# Increments are solved to 1e-11 of the largest force or better, and their conditions are below 100.
SAME = 1e-9


def joint(seed=0, laws=LAWS):
    """Points between pairs that all move each other; G by rows (3, n_point, n_relative)."""
    random = np.random.default_rng(seed)
    G = np.zeros((3, N, 3 * PAIRS))
    for p in range(N):
        turn = np.linalg.qr(np.eye(3) + 0.2 * random.normal(size=(3, 3)))[0]
        for pair in (p % PAIRS, (3 * p + 1) % PAIRS):
            G[:, p, 3 * pair : 3 * pair + 3] += random.uniform(0.3, 0.7) * turn
    root = random.normal(size=(3 * PAIRS, 3 * PAIRS))
    S = 0.2 * root @ root.T / (3 * PAIRS) + np.eye(3 * PAIRS)
    rubbing = [0, 1, 2, 4, 5]
    contact = Contact(
        relative_operator=np.eye(3 * PAIRS),
        interpolation=sp.csr_array(G[0]),
        shear=sp.csr_array(np.vstack([G[1, rubbing], G[2, rubbing]])),
        initial_gap=np.zeros(N),
        weights=WEIGHTS,
        laws=laws,
        slices=PLACES,
    )
    G[1:, 3] = 0.0  # without friction nothing is known of tangential displacements
    return AugmentedContact(contact=contact, between=ByCompliance(S)), G


def check_forces(x, z):
    """Nothing pulls, what is open has no force, and what slips does so against μ times pressure.

    Forces and slack (3, n_point) after an increment; returns which points slip and which stick.
    """
    small = SAME * np.abs(x).max() if x.any() else SAME
    assert x[0].min() > -small
    assert z[0].min() > -small
    assert np.minimum(x[0], z[0]).max() < small
    size, slip = np.hypot(*x[1:]), np.hypot(*z[1:])
    assert (size <= FRICTION * x[0] + small).all()
    slips = (slip > small) & (x[0] > small) & (FRICTION > 0)
    bound = np.where(slips, FRICTION * x[0], 0.0)
    np.testing.assert_allclose(
        np.where(slips, x[1:] * slip, 0.0), -bound * np.where(slips, z[1:], 0.0), atol=5 * small
    )
    assert not x[1:, 3].any()
    assert -(x[1:] * z[1:]).sum() > -small
    return slips, (x[0] > 0) & ~slips & (FRICTION > 0)


def check_law(plain, G, z_free, found, closure=YIELD):
    """An increment is one of Coulomb's law, and says itself what it took."""
    x, rows = found.forces, G.reshape(3 * N, -1)
    moved = (rows @ plain.S @ rows.T @ x.ravel()).reshape(3, N)
    z = moved + closure * x + z_free
    small = SAME * np.abs(x).max() if x.any() else SAME
    np.testing.assert_allclose(found.slack, z, rtol=0, atol=small)
    assert found.dissipation == pytest.approx(-(x[1:] * z[1:]).sum(), abs=small)
    assert found.residual <= SOLVED
    return check_forces(x, z)


def free(seed, press=1.0, shear=0.5):
    random = np.random.default_rng(seed)
    z = np.array([press, shear, shear])[:, None] * random.normal(size=(3, N))
    return z - np.array([0.7 * press, 0.0, 0.0])[:, None]


POINT_FRICTION, POINT_STIFFNESS, POINT_TANGENTIAL = 0.3, 10.0, 5.0


def apart(count, compliance=0.0):
    """Points that do not move each other, each with a compliance of its own in all directions."""
    rows = np.arange(3 * count).reshape(count, 3)
    each = sp.eye_array(3 * count, format="csr")
    contact = Contact(
        relative_operator=np.eye(3 * count),
        interpolation=each[rows[:, 0]],
        initial_gap=np.zeros(count),
        weights=np.ones(count),
        laws={"all": Coulomb(Penalty(POINT_STIFFNESS), POINT_FRICTION, POINT_TANGENTIAL)},
        slices={"all": slice(0, count)},
        shear=sp.vstack([each[rows[:, 1]], each[rows[:, 2]]]).tocsr(),
    )
    return AugmentedContact(contact=contact, between=ByCompliance(compliance * np.eye(3 * count)))
