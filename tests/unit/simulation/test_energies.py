"""What contact stores: work of normal and tangential forces on what yields under them."""

import numpy as np
import pytest
import scipy.sparse as sp

from faying.contact.contact import Contact
from faying.contact.laws import Coulomb, Penalty
from faying.simulation.energies import contact_energy

WEIGHTS = np.array([2.0, 0.5])
NORMAL, TANGENTIAL = 100.0, 30.0
FORCES = np.array([[8.0, 0.0], [3.0, 5.0], [0.0, 7.0]])
SHEAR = np.array([[[1.0, 2.0], [-3.0, 0.5]], [[0.0, 4.0], [0.0, 0.0]], [[-2.0, 0.0], [1.0, 6.0]]])
BEHIND = np.diag([1e-2, 2e-2, 3e-2, 4e-2, 5e-2, 6e-2])


def two_points(residual_compliance):
    """Pairs with a normal and two tangential displacements each."""
    return Contact(
        relative_operator=sp.csr_array(np.eye(6)),
        interpolation=sp.csr_array(np.eye(2, 6)),
        initial_gap=np.zeros(2),
        weights=WEIGHTS,
        laws={"joint": Coulomb(Penalty(NORMAL), 0.3, TANGENTIAL)},
        slices={"joint": slice(0, 2)},
        residual_compliance=residual_compliance,
        shear=sp.csr_array(np.eye(4, 6, k=2)),
    )


@pytest.mark.parametrize("residual_compliance", [None, BEHIND])
def test_springs_store_half_force_times_what_they_yield(residual_compliance):
    """One spring behind the other in each direction: c w of the law, 1/R of the compliance."""
    behind = np.zeros(6) if residual_compliance is None else np.diag(residual_compliance)
    yields = np.concatenate([1 / (NORMAL * WEIGHTS), *2 * [1 / (TANGENTIAL * WEIGHTS)]]) + behind
    forces = np.concatenate([FORCES, SHEAR.reshape(3, 4)], axis=1)
    expected = (0.5 * forces * (forces * yields)).sum(axis=1)
    found = contact_energy(two_points(residual_compliance), FORCES, SHEAR)
    np.testing.assert_allclose(found, expected, rtol=1e-14)  # sums of six products
