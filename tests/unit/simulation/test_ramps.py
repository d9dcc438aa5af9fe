"""Ramps of no loads from one state, whatever the law remembers."""

import numpy as np
import pytest

import faying as fy
from faying.simulation.path import solve_ramps

GASKET = fy.GasketClosure((0.0, 1e-5, 1e-4), (0.0, 2.0, 60.0), (4e5, 7e5, 3e6))
JOINT = fy.lap_joint(element_size=5.0).with_bolt_forces({"bolt": 1e4})
JOINTS = {
    "smooth": JOINT,
    "friction": JOINT.with_friction(0.2),
    "gasket": JOINT.with_closure(GASKET),
}


@pytest.mark.parametrize("name", JOINTS)
def test_no_loads_have_no_states(name):
    joint = JOINTS[name]
    rest = fy.solve_static(joint)
    none = np.zeros((0, rest.inputs.shape[-1]))
    ends = solve_ramps(joint, none, rest, increments=2)
    assert ends.pressure.shape == (0, joint.contact.n_points)
    assert ends.shear_slip.shape == (0, joint.contact.components - 1, joint.contact.n_points)
