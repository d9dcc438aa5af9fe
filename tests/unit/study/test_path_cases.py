"""Where paths begin: what tightening left, of the full model and of a reduced one."""

import numpy as np

import faying as fy
from faying.simulation.path import last_of
from faying.simulation.tightening import tightened_joint
from faying.study.stages.path_cases import rest_state


def test_what_tightening_leaves_is_where_its_path_leads():
    """Two bolts, so that the first slips under the second; the reduced model has its statics."""
    model = fy.lap_joint(
        element_size=5.0, hole_radius=None, bolt_positions=((-10.0, 0.0), (10.0, 0.0))
    ).with_friction(0.15)
    tightened = tightened_joint(model, {"bolt-1": 1e4, "bolt-2": 1e4}, increments=3)
    locked = model.with_bolt_forces(tightened.tightening.initial_forces)
    reduced = fy.reduce(locked, fy.craig_bampton(locked, normal_modes=5), compliance=True)
    left = last_of(tightened.rest(locked))
    followed = [rest_state(system, tightened.tightening.loads) for system in (locked, reduced)]
    assert (left.shear_forces != 0).any()
    for state in (*followed, rest_state(reduced, tightened.tightening.loads, left)):
        for name in ("contact_forces", "gap", "shear_forces", "shear_slip", "dissipation"):
            expected = getattr(left, name)
            # Newton's method leaves 1e-14, and paths gather it.
            small = 1e-9 * np.abs(expected).max()
            np.testing.assert_allclose(getattr(state, name), expected, rtol=0, atol=small)
