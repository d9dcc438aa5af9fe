"""Which bolts pass an interface, and where."""

from types import SimpleNamespace

import numpy as np
import pytest

from faying.joint.tangential import _bolts_through

TANGENTS = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
INTERFACE = SimpleNamespace(points=np.array([[x, y, 0.0] for x in (-1, 0, 1) for y in (-1, 0, 1)]))


@pytest.mark.parametrize(
    ("ends", "sign"),
    [
        (([0.3, 0.0, 2.0], [0.3, 0.0, -2.0]), 1.0),  # upright
        (([2.0, 0.2, 1.0], [-6.0, 0.2, -3.0]), 1.0),  # at (0, 0.2), far from both ends
        (([-6.0, 0.2, -3.0], [2.0, 0.2, 1.0]), -1.0),  # the same axis from below
        (([0.5, 0.2, 1.0], [6.5, 0.2, -1.0]), None),  # at (3.5, 0.2), beside the interface
        (([0.3, 0.0, 2.0], [0.3, 0.0, 1.0]), None),  # ends above it
    ],
)
def test_a_tilted_bolt_passes_where_its_axis_meets_the_interface(ends, sign):
    bolt = SimpleNamespace(shank=None, ends=np.array(ends))
    pierced = _bolts_through(INTERFACE, TANGENTS, np.zeros(3), {"bolt": bolt}, ())
    assert pierced == ({} if sign is None else {"bolt": sign})


def test_a_bolt_that_joins_the_sides_passes_beside_their_contact():
    bolt = SimpleNamespace(shank=None, ends=np.array([[3.0, 0.2, 1.0], [3.0, 0.2, -1.0]]))
    pierced = _bolts_through(INTERFACE, TANGENTS, np.zeros(3), {"bolt": bolt}, ("bolt",))
    assert pierced == {"bolt": 1.0}
