"""The linear hand-over: the tangent of the contact joint at a static state."""

from types import SimpleNamespace

import numpy as np
import pytest

import faying as fy
from faying.export.linearized import boundary_names, linearize
from faying.model.boundary import FORCE_NAMES, Boundary
from lap_joints import tiny_lap


@pytest.fixture(scope="module")
def tiny():
    """A joint so coarse that all its modes are few."""
    model = tiny_lap(penalty=1e5)
    return fy.preload(model, {"bolt": 10e3})


@pytest.fixture(scope="module")
def reduced(joint, classic):
    return fy.reduce(joint, classic, compliance=True)


def steps(system, load, force, size):
    """Central difference of solutions about a load."""
    up, down = (
        fy.solve_static(
            system, fy.Load({**load.forces, force: load.forces.get(force, 0.0) + sign * size})
        )
        for sign in (1, -1)
    )
    return [(getattr(up, n) - getattr(down, n)) / (2 * size) for n in ("contact_forces", "gap")] + [
        (up.displacement("tip") - down.displacement("tip")) / (2 * size)
    ]


@pytest.mark.parametrize("penalty", [1e4, 1e6, np.inf])
def test_frequencies_of_a_complete_basis_are_those_of_the_full_model(tiny, penalty):
    model = tiny.with_penalty(penalty)
    count = len(model.structure.interior)
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=count - 1))
    found = linearize(fy.solve_static(rom)).frequencies(8)
    # The one mode left out, at the top of the spectrum, and round-off of penalties of 1e6 times K.
    np.testing.assert_allclose(found, fy.preloaded_frequencies(model, 8), rtol=1e-5)


def test_frequencies_with_residual_compliance(joint):
    """They converge to those of the full model; without it they do not."""
    exact = fy.preloaded_frequencies(joint, 4)
    errors = {True: [], False: []}
    for modes in (10, 40):
        basis = fy.craig_bampton(joint, normal_modes=modes)
        for compliance in (True, False):
            rom = fy.reduce(joint, basis, compliance=compliance)
            found = linearize(fy.solve_static(rom)).frequencies(4)
            errors[compliance].append((found / exact - 1).max())
            if not compliance:
                continue
            # A residual without mass may make them lower, by far less than what is left out.
            assert (found > (1 - 1e-4) * exact).all()
    # The third mode opens and shuts the lap, 0.7 % with ten modes.
    assert errors[True][0] < 1e-2
    assert errors[True][1] < 2e-3
    # Without it, too few points touch and the pressed ones are too stiff: 4 % even with forty.
    assert errors[True][1] < 0.05 * errors[False][1]


def test_static_response_is_that_of_the_full_model(joint, reduced):
    """The residual makes the tangent exact in statics: against steps of the full model."""
    load = fy.Load({"tip.Fz": -100.0})
    model = linearize(fy.solve_static(reduced, load))
    for force in ("tip.Fx", "tip.Fz", "tip.Mx"):
        place = model.input_names.index(force)
        motion = np.linalg.solve(model.K, model.inputs[:, place])
        # So small a step that no point changes sides, so large that differences of solutions, each
        # perhaps solved from another factorization, are good to 1e-7 (a step of 0.01: 2e-6).
        forces, gaps, tip = steps(joint, load, force, 0.5)
        scale = np.abs(forces).max()
        np.testing.assert_allclose(model.force_rows @ motion, forces, atol=1e-6 * scale)
        np.testing.assert_allclose(model.gap_rows @ motion, gaps, atol=1e-6 * np.abs(gaps).max())
        np.testing.assert_allclose(motion[model.boundary], tip, rtol=1e-6, atol=1e-12)


def test_static_response_of_hard_contact(joint, reduced):
    """Dependent points of hard contact share their force; the tip moves as in the limit."""
    hard = joint.with_penalty(np.inf)
    rom = fy.reduce(hard, reduced.basis, compliance=True)
    load = fy.Load({"tip.Fz": -100.0})
    model = linearize(fy.solve_static(rom, load))
    motion = np.linalg.solve(model.K, model.inputs[:, model.input_names.index("tip.Fz")])
    forces, _, tip = steps(hard, load, "tip.Fz", 1e-2)
    # A millionth of the points' own compliance, seen from the tip: 3e-5 were found.
    np.testing.assert_allclose(motion[model.boundary], tip, rtol=1e-4, atol=1e-9)
    clamp = model.outputs[model.output_names.index("joint.clamp")] @ motion
    assert clamp == pytest.approx(forces.sum(), rel=1e-4)


def test_bolts_are_inputs_and_outputs(joint, reduced):
    model = linearize(fy.solve_static(reduced))
    place = model.input_names.index("bolt.N0")
    motion = np.linalg.solve(model.K, model.inputs[:, place])
    change = model.outputs @ motion + model.feedthrough[:, place]
    first = joint.bolts["bolt"].initial_force
    up, down = (
        fy.solve_static(joint, fy.Load(bolt_forces={"bolt": first + step})) for step in (1, -1)
    )
    names = model.output_names
    found = change[[names.index("bolt.N"), names.index("joint.clamp")]]
    exact = [
        (f(up) - f(down)) / 2
        for f in (lambda s: s.bolt_force("bolt"), lambda s: s.contact_force("joint"))
    ]
    # Steps of 1 N of 10 kN; differences of solutions round to 1e-9.
    np.testing.assert_allclose(found, exact, rtol=1e-7)


def test_it_says_when_it_is_asked_for_too_much(reduced):
    model = linearize(fy.solve_static(reduced))
    motion = np.linalg.solve(model.K, model.inputs[:, model.input_names.index("tip.Fz")])
    assert (model.contact_forces(1e-3 * motion)[model.closed] > 0).all()
    assert (model.contact_forces(-1e4 * motion)[model.closed] < 0).any()
    assert (model.gaps(0 * motion)[~model.closed] >= 0).all()


def test_nothing_in_contact(joint, reduced):
    apart = fy.Load(bolt_forces={"bolt": -1e4})
    state = fy.solve_static(reduced, apart)
    model = linearize(state)
    assert not model.closed.any()
    np.testing.assert_array_equal(model.K, reduced.K)


def test_model_is_linearized_at_its_preload_or_any_load(reduced):
    direct = linearize(fy.solve_static(reduced))
    np.testing.assert_array_equal(linearize(reduced).K, direct.K)
    load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})
    opened = linearize(fy.solve_static(reduced, load))
    np.testing.assert_array_equal(opened.closed, fy.solve_static(reduced, load).pressure > 0)
    assert abs(opened.frequencies(1)[0] / direct.frequencies(1)[0] - 1) > 1e-3


def test_nodes_of_a_large_boundary_are_told_apart():
    several = Boundary(
        name="end", nodes=np.array([7, 7, 9]), components=np.array([0, 4, 2]), dofs=np.arange(3)
    )
    one = Boundary(name="tip", nodes=np.array([3]), components=np.array([5]), dofs=np.array([3]))
    system = SimpleNamespace(boundaries={"end": several, "tip": one})
    assert boundary_names(system, FORCE_NAMES) == ("end.7.Fx", "end.7.My", "end.9.Fz", "tip.Mz")
