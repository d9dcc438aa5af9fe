"""Which points stick: pressed on, with a traction below its bound, with friction and without."""

import numpy as np

import faying as fy

FORCES = np.array([10.0, 10.0, 10.0, 0.0])


def states(friction):
    contact = fy.lap_joint(element_size=10.0).with_friction(friction).contact
    n, along = contact.n_points - len(FORCES), contact.components - 1
    normal = np.concatenate([FORCES, np.zeros(n)])
    shear = np.zeros((2, contact.n_points))
    shear[:, :4] = [[1.5, 0.0, 1.2, 0.0], [0.0, 2.0, 1.6 - 1e-9, 0.0]]  # bounds of 2
    return contact.sticking(normal, shear[:along])


def test_points_stick_below_their_bounds():
    # At the bound to what increments are solved to is at the bound; what is open never sticks.
    np.testing.assert_array_equal(states(0.2)[:4], [True, False, False, False])
    assert not states(0.2)[4:].any()


def test_nothing_sticks_without_friction():
    assert not states(0.0).any()
