"""Derivatives of static solutions against finite differences and exact statements."""

import numpy as np
import pytest

import faying as fy
from faying.assessment.sensitivity import sensitivity
from faying.exceptions import ModelError
from faying.joint.system import initial_bolt_forces
from faying.simulation.static import solve_static_inputs

LOAD = fy.Load({"tip.Fz": -300.0, "tip.Mx": 8e3, "tip.Fy": 40.0})

# The solution is piecewise linear: inside the range a central difference has no truncation error,
# only the round-off of the two solutions (1e-12) divided by the step (1e-1 of the range or less).
EXACT = 1e-6


@pytest.fixture(scope="module", params=["full", "compliance"])
def system(request, joint, classic):
    return joint if request.param == "full" else fy.reduce(joint, classic, compliance=True)


@pytest.fixture(scope="module")
def solution(system):
    return fy.solve_static(system, LOAD)


@pytest.fixture(scope="module")
def derivative(system, solution):
    return sensitivity(system, solution)


def bolt_forces(solution):
    return np.array([solution.bolt_force(name) for name in solution.system.bolts])


def outputs(solution):
    ends = [solution.displacement(name) for name in solution.system.boundaries]
    return solution.pressure, bolt_forces(solution), np.concatenate(ends)


def central(solve, response, column=0):
    """Differences of pressure, bolt force and boundary displacement across half the range."""
    step = 0.5 * min(-response.lower[column], response.upper[column])
    assert 0 < step < np.inf
    after, before = outputs(solve(step)), outputs(solve(-step))
    return [(a - b) / (2 * step) for a, b in zip(after, before, strict=True)]


def agree(response, differences, column=0):
    derivatives = response.pressure, response.bolt_forces, response.displacements
    for derivative, difference in zip(derivatives, differences, strict=True):
        scale = np.abs(difference).max()
        np.testing.assert_allclose(derivative[:, column], difference, rtol=0, atol=EXACT * scale)


@pytest.mark.parametrize("component", ["Fx", "Fy", "Fz", "Mx", "My", "Mz"])
def test_load_components(system, derivative, component):
    response = derivative.loads.of(f"tip.{component}")

    def solve(step):
        key = f"tip.{component}"
        changed = {**LOAD.forces, key: LOAD.forces.get(key, 0.0) + step}
        return fy.solve_static(system, fy.Load(changed))

    agree(response, central(solve, response))


def test_initial_bolt_force(system, derivative):
    locked = initial_bolt_forces(system)[0]

    def solve(step):
        return fy.solve_static(system, fy.Load(LOAD.forces, bolt_forces={"bolt": locked + step}))

    agree(derivative.initial_bolt_forces, central(solve, derivative.initial_bolt_forces))


def test_final_preload(system, derivative):
    response = derivative.final_preloads

    def solve(step):
        forces = fy.tighten(system, {"bolt": 10e3 + step}).initial_forces
        return fy.solve_static(system, fy.Load(LOAD.forces, bolt_forces=forces))

    agree(response, central(solve, response))


def crown(model):
    """A form error without symmetry, so that it changes the bolt force as well."""
    x, y = model.interfaces["joint"].points.T[:2] / 20.0
    return 1e-3 * (x + x**2 - y**2)


def test_initial_gap(joint):
    direction = crown(joint)
    response = sensitivity(joint, fy.solve_static(joint, LOAD)).initial_gap(direction)

    def solve(step):
        return fy.solve_static(joint.with_initial_gap("joint", step * direction), LOAD)

    agree(response, central(solve, response))


def test_final_preload_without_load_moves_the_bolt_force_one_to_one(joint):
    response = sensitivity(joint, fy.solve_static(joint)).final_preloads
    # Two triangular solves with the same factor; round-off times the condition of H, 1e4.
    np.testing.assert_allclose(response.bolt_forces, [[1.0]], rtol=1e-10)
    np.testing.assert_allclose(response.contact_force("joint"), [1.0], rtol=1e-8)


def test_range_ends_where_a_point_opens_or_closes(system, solution, derivative):
    response = derivative.loads.of("tip.Fz")
    for end in (response.lower[0], response.upper[0]):
        cases = []
        for fraction in (0.999, 1.001):
            inputs = solution.inputs.copy()
            inputs[2] += fraction * end
            cases.append(inputs)
        inside, outside = solve_static_inputs(system, np.array(cases)).contact_forces > 0
        np.testing.assert_array_equal(inside, solution.contact_forces > 0)
        # Points that mirror each other change together.
        assert 1 <= np.count_nonzero(outside != inside) <= 8


def test_scaling_all_inputs_scales_the_solution(joint):
    """With no initial gap λ is homogeneous of degree one: Euler's theorem."""
    solution = fy.solve_static(joint, LOAD)
    change = sensitivity(joint, solution)
    inputs = [LOAD.forces.get(name, 0.0) for name in change.loads.parameters]
    along = change.loads.pressure @ inputs
    along = along + change.initial_bolt_forces.pressure @ initial_bolt_forces(joint)
    # Linear algebra only: round-off times the condition of H, below 1e6.
    np.testing.assert_allclose(along, solution.pressure, rtol=0, atol=1e-9 * along.max())


def test_several_bolts():
    model = fy.lap_joint(element_size=5.0, bolt_positions=((-10.0, 0.0), (10.0, 0.0)))
    model = fy.preload(model, {"bolt-1": 8e3, "bolt-2": 12e3})
    load = fy.Load({"tip.Fz": -200.0})
    response = sensitivity(model, fy.solve_static(model, load)).final_preloads
    assert response.parameters == ("bolt-1", "bolt-2")
    for column, name in enumerate(response.parameters):

        def solve(step, name=name):
            goal = {"bolt-1": 8e3, "bolt-2": 12e3}
            goal[name] += step
            forces = fy.tighten(model, goal).initial_forces
            return fy.solve_static(model, fy.Load(load.forces, bolt_forces=forces))

        agree(response, central(solve, response, column), column)


def test_hard_contact_at_gauss_points_is_refused_with_a_remedy(joint):
    hard = joint.with_penalty(np.inf)
    with pytest.raises(ModelError, match="nodal quadrature"):
        _ = sensitivity(hard, fy.solve_static(hard, LOAD)).loads


def test_transients_and_wrong_shapes_are_refused(joint):
    cases = solve_static_inputs(joint, np.zeros((2, 7)) + initial_bolt_forces(joint))
    with pytest.raises(ModelError, match="one static solution"):
        sensitivity(joint, cases)
    single = sensitivity(joint, fy.solve_static(joint))
    with pytest.raises(ModelError, match="contact points"):
        single.initial_gap(np.zeros(3))
    with pytest.raises(ModelError, match="no parameter"):
        single.loads.of("tip.Fq")
    with pytest.raises(ModelError, match="no interface"):
        single.loads.contact_force("nowhere")
    with pytest.raises(ModelError, match="no boundary"):
        single.loads.displacement("nowhere")
