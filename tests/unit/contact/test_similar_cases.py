"""Cases solved side by side against each alone, and against the law."""

import numpy as np
import pytest

import faying as fy
from faying.contact import similar_cases
from faying.contact.similar_cases import side_by_side, solve_similar
from faying.simulation.static import port_forces, solved_cases


@pytest.fixture(scope="module")
def joint():
    return fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})


def moved_freely(joint, count, size):
    """What loads at the tip move pairs without contact."""
    forces = np.random.default_rng(3).normal(size=(count, 3)) * size
    loads = [
        fy.Load({f"tip.F{axis}": force for axis, force in zip("xyz", row, strict=True)})
        for row in forces
    ]
    inputs = np.concatenate([load.inputs(joint, np.zeros(1)) for load in loads])
    ports = joint.port_compliance
    return port_forces(ports, inputs) @ ports.contact_columns


@pytest.mark.parametrize("most", [similar_cases.MOST_STEPS, 2])
def test_cases_side_by_side_are_those_alone(joint, most, monkeypatch):
    """From a third closed to half; and where some are not solved side by side."""
    monkeypatch.setattr(similar_cases, "MOST_STEPS", most)
    solver, free = joint.static_contact.increments, moved_freely(joint, 12, 600.0)
    assert side_by_side(solver, len(free))
    begun = np.zeros_like(free)
    forces, gaps, steps = solve_similar(solver, free, begun)
    closed = (forces > 0).mean(axis=1)
    assert closed.min() < 0.35 < 0.5 < closed.max()
    # What is solved alone has taken all steps before.
    assert (steps.max() > most) == (most == 2)
    for case, row in enumerate(free):
        alone = solver.solve(row, joint.contact.offset())
        # Both are solved to round-off; compliances of 1e-5 mm/N leave 1e-10 of it.
        small = 1e-9 * alone.forces.max()
        np.testing.assert_allclose(forces[case], alone.forces[0], rtol=0, atol=small)
        penetrated = -np.minimum(gaps[case], 0.0)
        pressed = joint.contact.penalty * joint.contact.weights * penetrated
        np.testing.assert_allclose(forces[case], pressed, rtol=0, atol=small)


def test_few_cases_follow_one_another(joint):
    free = moved_freely(joint, 3, 600.0)
    assert not side_by_side(joint.static_contact.increments, len(free))
    few, many = (solved_cases(joint, rows).forces for rows in (free, np.tile(free, (4, 1))))
    np.testing.assert_allclose(few, many[:3], rtol=0, atol=1e-9 * few.max())
