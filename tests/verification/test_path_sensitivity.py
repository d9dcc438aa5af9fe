"""Derivatives of paths with friction against differences of paths that are solved anew."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError

LOADS = (
    fy.Load(),
    fy.Load({"tip.Fx": 500.0, "tip.Fy": 30.0}),
    fy.Load({"tip.Fx": 900.0, "tip.Mx": 5e3}),
    fy.Load({"tip.Fx": -300.0, "tip.Fz": -60.0}),
)
FIELDS = ("pressure", "traction", "slip", "dissipation", "bolts", "tip")
COARSE = {"element_size": 10.0, "hole_radius": 0.0, "washer_radius": 11.0}


def joint(penalty=1e6, **parameters):
    model = fy.lap_joint(**COARSE, penalty=penalty, **parameters)
    return model.with_bolt_forces(dict.fromkeys(model.bolts, 5e3))


@pytest.fixture(
    scope="module",
    params=[
        "hard",
        "gauss",
        *(pytest.param(one, marks=pytest.mark.slow) for one in ("reduced", "two laws", "nodal")),
    ],
)
def solved(request):
    """A function of a coefficient, a tangential penalty, a bolt force and a last pull."""
    kind = request.param
    several = kind == "two laws"
    smooth = joint(
        penalty="hard" if kind == "hard" else 1e6,
        quadrature={"gauss": "gauss", "two laws": "gauss"}.get(kind, "nodal"),
        **({"plates": 3, "tip_suspension": (1e5, 1e8)} if several else {}),
    )
    name = "joint-2" if several else "joint"

    def model(friction=0.2, stiffness=8e5, bolt=5e3):
        given = {name: float("inf") if kind == "hard" else stiffness}
        rough = smooth.with_friction(
            {"joint-1": 0.35, name: friction} if several else {name: friction}, given
        ).with_bolt_forces({"bolt": bolt})
        if kind == "reduced":
            classic = fy.craig_bampton(rough, normal_modes=3)
            return fy.reduce(rough, classic, compliance=True)
        return rough

    def path(pull=-300.0, **changed):
        last = replace(LOADS[-1], forces=LOADS[-1].forces | {"tip.Fx": pull})
        return fy.solve_path(model(**changed), [*LOADS[:-1], last])

    rough = model()
    return name, kind, path, fy.sensitivity(rough, path())


def values(solution):
    return {
        **{name: getattr(solution, name) for name in FIELDS[:4]},
        "bolts": np.stack([solution.bolt_force(name) for name in solution.system.bolts], axis=1),
        "tip": solution.displacement("tip"),
    }


def compare(path, derivatives, parameter, argument, value):
    """Central differences, whose error is of second order in the step."""
    column = derivatives.parameters.index(parameter)
    # No point changes its state within the step, nor does it miss digits.
    near = min(-derivatives.lower[column], derivatives.upper[column])
    step = min(1e-4 * abs(value), 0.3 * near)
    assert step > 1e-8 * abs(value)
    up, down = (values(path(**{argument: value + sign * step})) for sign in (1, -1))
    found = {name: getattr(derivatives, name) for name in FIELDS[:4]} | {
        "bolts": derivatives.bolt_forces,
        "tip": derivatives.displacement("tip"),
    }
    for name in FIELDS:
        expected = (up[name] - down[name]) / (2 * step)
        mine = found[name][..., column]
        assert mine.shape == expected.shape
        # Curvature over steps of 1e-4, and round-off of what is solved over the step.
        noise = 1e-11 * np.abs(up[name]).max() / step
        atol = 3e-6 * np.abs(expected).max() + noise
        np.testing.assert_allclose(mine, expected, rtol=0, atol=atol, err_msg=name)


def test_paths_change_as_their_derivatives_say(solved):
    name, kind, path, change = solved
    compare(path, change.friction, name, "friction", 0.2)
    compare(path, change.initial_bolt_forces, "bolt", "bolt", 5e3)
    compare(path, change.loads, "tip.Fx", "pull", -300.0)
    assert not change.loads.contact_forces[:-1].any()
    if kind == "hard":
        assert change.tangential_penalty.parameters == ()
    else:
        compare(path, change.tangential_penalty, name, "stiffness", 8e5)


def states(solution):
    """Who is pressed, and who is on the bound."""
    normal, shear = solution.contact_forces, np.linalg.norm(solution.shear_forces, axis=1)
    return np.stack([normal > 0, shear >= 0.2 * normal * (1 - 1e-9)])


def test_ranges_end_where_a_first_point_changes_its_state():
    """The nearer end of each, up to which paths are nearly linear."""
    model = joint(quadrature="nodal").with_friction(0.2)
    path = fy.solve_path(model, LOADS)
    change = fy.sensitivity(model, path).loads
    for name in ("tip.Fx", "tip.Fz", "tip.Mx"):
        column = change.parameters.index(name)
        end = min(change.lower[column], change.upper[column], key=abs)
        for share, same in ((0.97, True), (1.03, False)):
            forces = dict(LOADS[-1].forces)
            forces[name] = forces.get(name, 0.0) + share * end
            found = fy.solve_path(model, [*LOADS[:-1], fy.Load(forces)])
            assert (states(found) == states(path)).all() == same


def test_a_path_that_goes_on_from_another_leaves_it_as_it_was():
    model = joint(quadrature="nodal").with_friction(0.2)
    begun = fy.solve_path(model, LOADS[:2])
    rest = fy.solve_path(model, LOADS[2:], initial=begun)
    whole = fy.sensitivity(model, fy.solve_path(model, LOADS)).loads
    found = fy.sensitivity(model, rest, begun)
    mine, exact = (one.displacement("tip")[-1] for one in (found.loads, whole))
    np.testing.assert_allclose(mine, exact, rtol=0, atol=1e-9 * np.abs(exact).max())
    assert np.abs(found.friction.contact_forces[0]).max() > 0
    with pytest.raises(ModelError, match="load 1 on the path is not one increment from the state"):
        _ = fy.sensitivity(model, rest).loads


def test_what_has_no_such_derivative_is_refused():
    smooth = joint()
    with pytest.raises(ModelError, match="need one static solution"):
        fy.sensitivity(smooth, fy.solve_path(smooth, LOADS))
    rough = smooth.with_friction(0.2)
    tight = fy.solve_path(rough, LOADS[:1])
    with pytest.raises(ModelError, match=r"has contact forces of shape \(1, 32\) for 15 contact"):
        fy.sensitivity(joint(quadrature="nodal").with_friction(0.2), tight)
    with pytest.raises(ModelError, match="a path of it with friction"):
        fy.sensitivity(rough, fy.solve_transient(rough, LOADS[1], step=1e-5, duration=2e-5))
    loose = joint(penalty="hard", shape="hex20")  # eight-node facets have one more point each
    found = fy.solve_path(loose.with_friction(0.2), LOADS[:2])
    with pytest.raises(ModelError, match="derivative is not unique: contact is hard and has more"):
        _ = fy.sensitivity(found.system, found).friction
    change = fy.sensitivity(rough, tight)
    with pytest.raises(ModelError, match="there is no boundary 'top'; the boundaries are tip"):
        change.friction.displacement("top")
    with pytest.raises(ModelError, match="final preloads depend on the order"):
        _ = change.final_preloads
