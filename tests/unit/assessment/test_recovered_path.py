"""Contact with friction along a row of instants, recovered."""

from types import SimpleNamespace

import numpy as np
import pytest

import faying as fy
from faying.assessment.recovery import solve_increments
from faying.exceptions import ConvergenceError
from faying.simulation.path import moved_alone, path_inputs


class Hesitant:
    """A solver that refuses what lies farther than some way from the last load it solved."""

    def __init__(self, solver, start, farthest):
        self.solver, self.last, self.farthest = solver, start, farthest
        self.contact, self.moved_by = solver.contact, solver.moved_by

    def solve(self, free, offset, start=None):
        if np.linalg.norm(free - self.last) > self.farthest:
            message = "too far"
            raise ConvergenceError(message)
        self.last = free
        return self.solver.solve(free, offset, start)


def test_increments_that_are_not_solved_are_halved():
    """Twice, from the instant before; the whole is then that of four quarters."""
    joint = fy.lap_joint(element_size=5.0, penalty=1e6)
    rubbing = joint.with_bolt_forces({"bolt": 8e3}).with_friction(0.2)
    loads = [fy.Load(), fy.Load({"tip.Fx": 1500.0, "tip.Fz": -300.0})]
    first, last = moved_alone(rubbing, path_inputs(rubbing, loads))
    plain = rubbing.static_contact.increments
    quarter = 1.001 * np.linalg.norm(last - first) / 4
    hesitant = Hesitant(plain, first, quarter)
    model = SimpleNamespace(
        contact=rubbing.contact, static_contact=SimpleNamespace(increments=hesitant)
    )
    halved = solve_increments(model, np.array([first, last]), None)
    steps = np.array([first + (last - first) * k / 4 for k in range(5)])
    quarters = solve_increments(rubbing, steps, None)
    largest, farthest = np.abs(quarters.forces).max(), np.abs(quarters.slip).max()
    # Increments are solved to 1e-9 of the largest force.
    np.testing.assert_allclose(halved.forces[-1], quarters.forces[-1], atol=1e-8 * largest)
    np.testing.assert_allclose(halved.slip[-1], quarters.slip[-1], atol=1e-8 * farthest)
    pressed = fy.solve_path(rubbing, loads[:1]).contact_forces[0]
    np.testing.assert_allclose(halved.forces[0], pressed, atol=1e-8 * largest)
    at_once = solve_increments(rubbing, np.array([first, last]), None)
    assert np.abs(at_once.slip[-1] - quarters.slip[-1]).max() > 1e-4 * farthest

    # The first instant has none before it: there is no way to go by halves.
    increments = Hesitant(plain, (first + last) / 2, quarter)
    model.static_contact.increments = increments
    with pytest.raises(ConvergenceError, match="load 1 of 2"):
        solve_increments(model, np.array([first, last]), None)
